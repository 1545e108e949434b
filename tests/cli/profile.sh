#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Lamps of the mesh that shine with a power of the cosine: albedos, a lobe, and a power read from the
# photographs while the other is given; wrong, and said to be, when nobody tells the profile; relit as they were.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 'photographs' "$igi" synth "$tests/cli/profile.json" -o room -j 2
cat >manifests.py <<'END'
import copy, json
scene = json.load(open("room/scene.json"))
def save(name, key, lights):
    changed = copy.deepcopy(scene)
    for light in changed["lights"][:lights]: del light[key]
    json.dump(changed, open(f"room/{name}.json", "w"))
save("unknown", "radiance", 1)
save("without", "profile", 2)
scene["lights"][0]["profile"] = -1
cameras = json.load(open("room/transforms.json"))
cameras["frames"] = cameras["frames"][:1]
json.dump(cameras, open("room/one.json", "w"))
save("wrong", "profile", 0)
END
cat >judge.py <<'END'
import json, sys
truth, got, off = json.load(open("room/truth/truth.json")), json.load(open("out/materials.json")), []
for name, region in truth["regions"].items():
    for x, y in zip(region["albedo"], got["regions"][name]["albedo"]):
        if x > 0: off.append(abs(y / x - 1))
if not sum(off) / len(off) < .005 or not max(off) < .01: print("albedo is off", off)
table = got["regions"]["table"]
if not abs(table["specular"] / .08 - 1) < .02 or not abs(table["alpha"] / .1 - 1) < .03: print("lobe", table)
for t, g in zip(truth["lights"], got["lights"]):
    if g.get("profile") != t["profile"]: print("profile", g)
    for x, y, s in zip(t["radiance"], g["radiance"], g.get("radiance_std", [0] * 3)):
        if not abs(y - x) < .003 * x + 3 * s or not s < .02 * x: print(f"radiance {y} +- {s}, not {x}")
if got["warnings"]: print(got["warnings"])
END
expect 0 "" python3 manifests.py
expect 0 "" "$igi" recover -q room/unknown.json -o out -j 2
python3 judge.py >problems 2>&1
[ ! -s problems ] || fail "$(cat problems)"

# The same lamps over what was recovered look as they did.
expect 0 "" "$igi" relight out --cameras room/one.json --samples 16 -o relit -q
for picture in room/images/0000.exr relit/0000.exr; do
    "$build/pixels" $picture 1 8 | awk '{ sum += $1 } END { print sum / NR }'
done >means
awk 'NR == 1 { a = $1 } NR == 2 { exit !(a > 20 && $1 / a > .99 && $1 / a < 1.01) }' means || fail "relit: $(cat means)"
expect 0 'mitsuba knows no lamps with a profile' "$igi" export out --to mitsuba -o room.xml
expect 0 "" "$igi" export out --to radiance --cameras room/one.json -o room.rad -q
grep -q '^profile_[0-9]* light' room.rad || fail "Radiance knows profiles"

expect 0 "" "$igi" recover -q room/without.json -o out
python3 judge.py >problems 2>&1
grep -q "'lamp' brighter.*cos^3 " out/materials.json || fail "nobody says that the lamp has a profile"
grep -q 'albedo is off.*0\.[2-9]' problems || fail "the profile makes no difference"
expect 3 'the exponent n of cos' "$igi" recover room/wrong.json -o wrong
finish
