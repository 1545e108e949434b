#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# The same room elsewhere, turned, or in another unit of length has the same materials; a room as far
# from the origin as surveys put it is refused, because its coordinates are too coarse there.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
expect 0 'photographs' "$igi" synth "$tests/cli/mini.json" -o room
cat >move.py <<'PY'
import json, math, os, shutil, sys
name, scale, degrees, away = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4])
c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
def turn(v):  # about two axes
    x, y, z = c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]
    return [x, c * y - s * z, s * y + c * z]
def place(v): return [scale * x + away * k for x, k in zip(turn(v), (1, -.5, .2))]
shutil.copytree("room", name)
with open(name + "/scene.obj", "w") as obj:
    for line in open("room/scene.obj"):
        v = line.split()
        if v and v[0] == "v": line = "v %.9g %.9g %.9g\n" % tuple(place([float(x) for x in v[1:4]]))
        obj.write(line)
cameras = json.load(open("room/transforms.json"))
for frame in cameras["frames"]:
    m = frame["transform_matrix"]
    columns = [turn([m[i][k] for i in range(3)]) for k in range(3)] + [place([m[i][3] for i in range(3)])]
    frame["transform_matrix"] = [[column[i] for column in columns] for i in range(3)] + [[0, 0, 0, 1]]
json.dump(cameras, open(name + "/transforms.json", "w"))
PY
expect 0 "" "$igi" recover -q room -o room.out
for how in "moved 1 0 1000" "turned 1 33 0" "millimetres 1000 0 0" "small .01 0 0"; do
    name=${how%% *}
    # shellcheck disable=SC2086
    python3 move.py $how || fail "cannot be $name"
    expect 0 "" "$igi" recover -q "$name" -o "$name.out"
    python3 - "$name" >problems 2>&1 <<'PY'
import json, sys
old, new = [json.load(open(p + ".out/materials.json")) for p in ("room", sys.argv[1])]
if new["warnings"] != old["warnings"]: print(new["warnings"])
for name, r in old["regions"].items():
    for x, y, std in zip(new["regions"][name]["albedo"], r["albedo"], r["albedo_std"]):
        if abs(x - y) > 2 * std: print(sys.argv[1], name, x, "not", y, "+-", std)
PY
    [ ! -s problems ] || fail "$(cat problems)"
done

# Sixteen times the light is the same room to the last bit: no number of igi's has the unit of radiance.
sed 's/"radiance": \[6, 6, 6\]/"radiance": [96, 96, 96]/' "$tests/cli/mini.json" >bright.json
expect 0 'photographs' "$igi" synth bright.json -o bright
expect 0 "" "$igi" recover -q bright -o bright.out
python3 - >problems 2>&1 <<'PY'
import json
old, new = [json.load(open(p + ".out/materials.json")) for p in ("room", "bright")]
if old["regions"] != new["regions"]: print("not alike:", old["regions"], new["regions"])
PY
[ ! -s problems ] || fail "$(cat problems)"

python3 move.py survey 1 0 4000000 || fail "cannot be moved"
expect 3 'survey/scene.obj: the mesh is 3 m large and lies 4e\+06 m from the origin.*take \(' \
    "$igi" recover -q survey -o survey.out
finish
