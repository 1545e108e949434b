#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Cameras in a frame of reference of their own, and each a pixel off, find the mesh again.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

sed 's/"width": 160, "height": 120, "count": 8, "samples": 8/"width": 200, "height": 150, "count": 3, "samples": 16/' \
    "$tests/cli/blocks.json" >spec.json
grep -q '"count": 3' spec.json || fail "blocks.json has other views"
expect 0 '' "$igi" synth -q spec.json -o room
cat >spoil.py <<'PYTHON'
import json, random
random.seed(4)
T = json.load(open("room/transforms.json"))
for frame in T["frames"]:
    m = frame["transform_matrix"]
    w = [random.gauss(0, .004) for _ in range(3)]          # about half a pixel each
    for i in range(3):
        x, y, z, c = m[i]
        m[i][:3] = [x + w[2]*y - w[1]*z, y - w[2]*x + w[0]*z, z + w[1]*x - w[0]*y]
        m[i][3] = c + random.gauss(0, .008)
    # half the size, a quarter turn about z, moved: what structure from motion might have chosen
    a, b, c = m[0], m[1], m[2]
    turned = [[-v for v in b], list(a), list(c)]
    for i in range(3):
        turned[i][3] = .5 * turned[i][3] + (1, 2, 3)[i]
    frame["transform_matrix"] = turned + [m[3]]
json.dump(T, open("room/spoilt.json", "w"))
# Of four points of the table and one above, where they lie in both frames, to a centimetre.
with open("points.txt", "w") as out:
    for x, y, z in [(0, 0, 0), (4, 0, 0), (0, 4, 0), (4, 4, 0), (1, 1, 1)]:
        print(-.5*y + 1, .5*x + 2, .5*z + 3, *[v + random.gauss(0, .01) for v in (x, y, z)], file=out)
PYTHON
python3 spoil.py || skip "no python3"
sed 's|transforms.json|spoilt.json|' room/scene.json >spoilt.json && mv spoilt.json room/scene.json
expect 2 'where to\?' "$igi" register room
expect 0 '' "$igi" register -q room --points points.txt -o room/registered.json
expect 0 '' "$igi" register room --points points.txt -o room/again.json -q --json --threads 3
cmp room/registered.json room/again.json || fail "threads change the cameras"
cp "$out" register.out
python3 - <<'PYTHON' || fail "not registered: $(cat register.out)"
import json, math, sys
said = json.load(open("register.out"))
truth = json.load(open("room/transforms.json"))
found = json.load(open("room/registered.json"))
worst = 0
for t, f in zip(truth["frames"], found["frames"]):
    assert f["file_path"] == t["file_path"], f["file_path"]
    a, b = t["transform_matrix"], f["transform_matrix"]
    turn = math.sqrt(sum((a[i][j] - b[i][j])**2 for i in range(3) for j in range(3)) / 2)
    worst = max(worst, turn, math.dist([r[3] for r in a[:3]], [r[3] for r in b[:3]]))
print("cameras off by up to %.4f m or rad; edges off by %.3f, then %.3f px"
      % (worst, said["before_px"], said["after_px"]))
sys.exit(not (worst < .003 and said["after_px"] < .15 < said["before_px"]))
PYTHON
finish
