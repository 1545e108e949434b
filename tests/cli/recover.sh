#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# The main job through the program: what is written, when, and the same bytes every time.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
spec=$tests/cli/mini.json

expect 0 'photographs' "$igi" synth "$spec" -o room
stdout '^room: written'
expect 0 "" "$igi" synth -q "$spec" -o again
for file in scene.json scene.obj transforms.json images/0003.exr truth/truth.json; do
    cmp -s "room/$file" "again/$file" || fail "synth: $file differs from run to run"
done

# Progress on stderr, the table on stdout, everything in the folder.
expect 0 'observe' "$igi" recover room -o out -j 1
stdout '^walls +lambert +0\.[67][0-9]'
stdout 'out/report\.html'
for file in materials.json manifest.json report.html scene.glb comparison/index.json; do
    [ -s "out/$file" ] || fail "out/$file is missing"
done
python3 - <<'PY' || fail "evidence.json does not add up"
import json
regions = json.load(open("out/evidence.json"))["regions"]
sent = {s["name"]: s["rays"] for s in json.load(open("out/manifest.json"))["stages"]}
gathered = sum(r["gathered_rays"] for r in regions.values())
lobes = sum(r["lobe_rays"] for r in regions.values())
assert min(r["gathered_rays"] for r in regions.values()) > 0
assert 0 < gathered and 0 < lobes and gathered + lobes <= sum(sent.values()), (gathered, lobes, sent)
print("of", sent, "rays", gathered, "gathered and", lobes, "for lobes")
PY
grep -q '"xxh64": "[0-9a-f]\{16\}"' out/manifest.json || fail "no hashes in manifest.json"
[ "$(grep -c 'images/000' out/manifest.json)" -eq 6 ] || fail "manifest.json lacks photographs"
[ -z "$(find . -name '*.part*')" ] || fail "left behind: $(find . -name '*.part*')"

# The same bytes for any number of threads, run after run, and without the truth.
rm -rf room/truth room/heldout
for threads in 2 7; do
    expect 0 "" "$igi" recover -q room -o "out$threads" -j "$threads"
    [ ! -s "$out" ] || fail "--quiet speaks"
    find out -name '*.exr' -o -name 'materials.json' -o -name '*.glb' | while read -r file; do
        cmp "$file" "out$threads/${file#out/}"
    done >differences 2>&1
    [ ! -s differences ] || fail "threads $threads: $(cat differences)"
done

expect 0 "" "$igi" recover -q --json room -o out
diff -B "$out" out/materials.json >/dev/null || fail "--json is not materials.json"
expect 0 "scene" "$igi" recover -n room -o none
stdout '6 photographs'
[ ! -e none ] || fail "a dry run writes"
expect 0 "CPU s" "$igi" recover -v room -o out

# Others' folders are kept; one's own are replaced.
mkdir letters
echo dear >letters/letter
expect 4 'letters: holds files that igi did not write' "$igi" recover room -o letters
[ -s letters/letter ] || fail "a folder was overwritten"
expect 0 "" "$igi" recover -q room -o letters -f
[ -s letters/materials.json ] || fail "-f does not write"
[ ! -e letters/letter ] || fail "-f does not replace"
expect 2 'room: holds the input' "$igi" recover room -o room -f
[ -s room/scene.json ] || fail "the input is gone"
expect 4 'scene\.json: is a file' "$igi" recover room -o room/scene.json
expect 4 '/proc/' "$igi" recover room -o /proc/none/out
if [ "$(id -u)" -ne 0 ]; then
    mkdir locked && chmod a-w locked
    expect 4 'locked' "$igi" recover room -o locked/out
fi

# validate and report on what was made.
"$igi" synth -q "$spec" -o room
expect 0 "" "$igi" validate -q out --truth room/truth
expect 0 "comparing" "$igi" validate out --truth room/truth
stdout '^mean +0\.[0-9]+ %.* 4 of 4 right'
expect 0 "" "$igi" validate -q --json out --truth room/truth
stdout '^\{"albedo_mean": 0\.00[0-9]+, .*"regions": \{"floor": \{"albedo": '
expect 0 "" "$igi" validate -q out --truth room/truth --tolerance 0.02
expect 1 'above the tolerance' "$igi" validate -q out --truth room/truth --tolerance 1e-9
expect 3 'has neither materials\.json' "$igi" validate room --truth room/truth
rm out/report.html
expect 0 "" "$igi" report -q out
[ -s out/report.html ] || fail "igi report writes no page"

# Every method runs, and says which in the manifest.
for method in patches gather radiosity direct yu99; do
    expect 0 "" "$igi" recover -q room -o "by-$method" --method "$method"
    grep -q "\"method\": \"$method\"" "by-$method/manifest.json" || fail "manifest: no $method"
done

# Ctrl-C: 130 within a moment, and nothing left.
"$igi" recover room -o stopped -j 1 --rays 100000 >/dev/null 2>stopped.err &
pid=$!
while ! grep -qs gather stopped.err && kill -0 $pid 2>/dev/null; do sleep 0.02; done
kill -INT $pid
wait $pid
status=$?
[ $status -eq 130 ] || fail "exit status $status after Ctrl-C"
grep -q '^igi: interrupted' stopped.err || fail "no word of the interruption: $(cat stopped.err)"
[ -z "$(find . -maxdepth 1 -name 'stopped*' ! -name stopped.err)" ] || fail "Ctrl-C leaves a folder"
finish
