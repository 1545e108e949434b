#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# What is off is told apart by its edges: each camera, the lens of all, the mesh's scale, things in it.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 '' "$igi" synth -q "$tests/cli/blocks.json" -o room
cat >spoil.py <<'PYTHON'
import json, math, random, sys
what = sys.argv[1]
random.seed(5)
T = json.load(open("room/transforms.json"))
lines = open("room/scene.obj").read().splitlines()
region, of = None, {}
for line in lines:
    if line.startswith("usemtl"):
        region = line.split()[1]
    if line.startswith("f "):
        for corner in line.split()[1:]:
            of[int(corner.split("/")[0])] = region
moves = {"a": (.05, .03), "b": (-.05, .02), "c": (.02, -.06), "d": (-.03, -.04)}
n = 0
for i, line in enumerate(lines):
    if not line.startswith("v "):
        continue
    n += 1
    p = [float(x) for x in line.split()[1:4]]
    if what == "scale":
        p = [2 + 1.04 * (p[0] - 2), 2 + 1.04 * (p[1] - 2), 1.04 * p[2]]
    if what == "things" and of.get(n) in moves:
        p = [p[0] + moves[of[n]][0], p[1] + moves[of[n]][1], p[2]]
    lines[i] = "v %.6f %.6f %.6f" % tuple(p)
for frame in T["frames"]:
    m = frame["transform_matrix"]
    w = [random.gauss(0, .01) if what == "cameras" else 0 for _ in range(3)]
    for row in m[:3]:
        x, y, z, c = row
        row[:3] = [x + w[2]*y - w[1]*z, y - w[2]*x + w[0]*z, z + w[1]*x - w[0]*y]
if what == "lens":
    for k in ("fl_x", "fl_y"):
        T[k] *= 1.03
json.dump(T, open("room/%s.json" % what, "w"))
open("room/%s.obj" % what, "w").write("\n".join(lines) + "\n")
scene = json.load(open("room/scene.json"))
scene["mesh"], scene["cameras"] = what + ".obj", what + ".json"
json.dump(scene, open("room/scene.json", "w"))
PYTHON
cp room/scene.json given.json

# tells WHAT PATTERN: what is off, and the one line that says so.
tells() {
    cp given.json room/scene.json
    python3 spoil.py "$1" || skip "no python3"
    "$igi" register room -o "$1.json" --threads 1 >said 2>words || fail "$1: $(cat words)"
    said=$(grep -E "mesh is off|moved together|photographs share" said)
    echo "$said" | grep -qE "^$2\$" || fail "$1: '$said' in: $(cat said)"
}
tells cameras ''
tells lens 'all photographs share .* a magnification of 0\.97.*'
tells scale 'all cameras were off alike: moved together, scale 1\.0(39|40).*'
tells things 'edges of different things ask for different cameras: the mesh is off; mend it'
finish
