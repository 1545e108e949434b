#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Relighting: what is written, a scene that is changed, and mistakes in the changes.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 "" "$igi" synth -q "$tests/cli/mini.json" -o room

# render NAME OPTIONS...: the picture's mean sRGB levels, red green blue, on one line in `levels`.
render() {
    name=$1
    shift
    expect 0 "" "$igi" relight -q room/truth --cameras room/transforms.json --samples 8 -o "$name" "$@"
    "$build/pixels" "$name/0002.exr" 1 16 | awk '{ s[NR % 3] += $1 } END {
        printf "%.1f %.1f %.1f", s[1] / NR * 3, s[2] / NR * 3, s[0] / NR * 3 }' >levels
}
# holds EXPRESSION: of awk, in a0 a1 a2, the levels of `plain`, and b0 b1 b2, those of now.
holds() {
    echo "$plain $(cat levels)" | awk "{ exit !($1) }" || fail "$1: $plain, then $(cat levels)"
}

render plain --aov --png --variance
for file in 0002.exr 0002.layers.exr 0002.png 0002.variance.exr manifest.json; do
    [ -s plain/$file ] || fail "$file is missing"
done
grep -q '"noise reached": "0\.[0-9]' plain/manifest.json || fail "no noise in the manifest"
plain=$(cat levels)
holds '$1 == $4 && $1 > 20'
# A truth has no error bars; a result has, and they come with the pictures.
render sigma --sigma
[ -s sigma/0002.sigma.exr ] || fail "no error bars"
python3 - <<'PY' || fail "sigma.json is not as documented"
import json
s = json.load(open("sigma/sigma.json"))
assert len(s) == 6 and max(s["0002"].values()) < 1e-6, s
PY
cp -r room doubtful
python3 - <<'PY'
import json, pathlib
p = pathlib.Path("doubtful/truth/truth.json")
t = json.loads(p.read_text())
for m in t["regions"].values():
    m["albedo_std"] = [x / 20 for x in m["albedo"]]
p.write_text(json.dumps(t))
PY
expect 0 "" "$igi" relight -q doubtful/truth --cameras room/transforms.json --samples 8 --sigma -o bars
python3 - <<'PY' || fail "error bars of relit pictures: $(cat bars/sigma.json)"
import json
s = json.load(open("bars/sigma.json"))["0000"]
assert 0.05 < s["pixel"] < 0.2 and 0.02 < s["picture"] <= s["pixel"], s
PY
render preview --preview
holds '$4 > $1 - 3 && $4 < $1 + 3'

# Radiosity, gathered or shot, has the light of paths; what has met one surface only is darker.
for method in radiosity progressive; do
    render $method --method $method
    holds '$4 > $1 - 6 && $4 < $1 + 6'
done
render whitted --method whitted # no lobe here: the same light as direct
cp levels whitted.levels
render direct --method direct
holds '$4 < $1 - 20'
awk '{ getline w <"whitted.levels"; split(w, x); exit !(x[1] - $1 < 2 && $1 - x[1] < 2) }' levels ||
    fail "whitted $(cat whitted.levels), direct $(cat levels)"
expect 2 'must be one of path' "$igi" relight room/truth --method patches --cameras room/transforms.json -o bad
expect 2 'a method of its own' "$igi" relight room/truth --method direct --preview --cameras room/transforms.json -o bad

echo '{ "regions": { "walls": { "albedo": [0.7, 0.1, 0.1] } } }' >edits.json
render edited --materials edits.json
holds '$4 > $1 * .7 && $5 < $2 * .8'
echo '{ "regions": { "walls": { "albedo_hsv": [0, 0.6, 0.854] } } }' >edits.json
render hued --materials edits.json
holds '$4 > $1 * .7 && $5 < $2 * .8'
echo '{ "regions": { "walls": { "model": "ggx", "specular": 0.04, "alpha": 0.2 } } }' >edits.json
render glossy --materials edits.json
holds '$4 != $1'
echo '{ "regions": { "wals": { } } }' >edits.json
expect 3 "no region 'wals'" "$igi" relight room/truth --cameras room/transforms.json --materials edits.json -o bad
echo '{ "regions": { "walls": { "albedo": [2, 0, 0] } } }' >edits.json
expect 3 'numbers from 0 to 1' "$igi" relight room/truth --cameras room/transforms.json --materials edits.json -o bad
echo '{ "regions": { "walls": { "colour": 1 } } }' >edits.json
expect 3 '"colour" must be left out' "$igi" relight room/truth --cameras room/transforms.json --materials edits.json -o bad
echo '{ "regions": { "walls": { "specular": 0.1 } } }' >edits.json
expect 3 'which has no lobe' "$igi" relight room/truth --cameras room/transforms.json --materials edits.json -o bad
[ ! -e bad ] || fail "a failure left a folder"

# A green screen across the room.
printf 'mtllib s.mtl\nv 0.1 0.1 0.2\nv 2.9 0.1 0.2\nv 2.9 2.9 0.2\nv 0.1 2.9 0.2\nusemtl screen\nf 1 2 3 4\n' >s.obj
printf 'newmtl other\nKd 1 0 0\nnewmtl screen\nKd 0.05 0.8 0.05\nKs 0.1 0.1 0.1\nPr 0.5\n' >s.mtl
render screened --insert s.obj
holds '$4 < $1 * .97 && $5 > $2 * 1.05'
sed 's/screen/walls/' s.obj >clash.obj
expect 3 "'walls' is a region of the scene already" \
    "$igi" relight room/truth --cameras room/transforms.json --insert clash.obj -o bad
sed '/mtllib/d' s.obj >grey.obj
expect 0 'names no mtllib' "$igi" relight room/truth --cameras room/transforms.json --insert grey.obj \
    --samples 1 -o grey
rm s.mtl
expect 3 's\.mtl' "$igi" relight room/truth --cameras room/transforms.json --insert s.obj -o bad

# A light's file is named from the scene's folder, wherever igi is run.
printf '%s\n' IESNA:LM-63-2002 TILT=NONE '1 1000 1 2 1 1 2 0 0 0' '1 1 10' '0 180' '0' '20 20' >room/lamp.ies
python3 - <<'END'
import json
lamp = {"type": "goniometric", "position": [1.5, 1.5, 2], "profile": "lamp.ies", "scale": 1.0}
for path in "room/scene.json", "room/truth/truth.json":
    with open(path) as file:
        scene = json.load(file)
    scene["lights"].append(lamp)
    with open(path, "w") as file:
        json.dump(scene, file)
END
render lamp
holds '$4 > $1 + 3'
expect 0 "" "$igi" recover -q room -o result --model lambert
expect 0 "" "$igi" relight -q result --cameras room/transforms.json --samples 1 -o lamp2
rm room/lamp.ies
expect 3 'lamp\.ies' "$igi" relight -q result --cameras room/transforms.json --samples 1 -o lamp3
finish
