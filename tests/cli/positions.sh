#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Lights whose place the manifest knows to some centimetres: found by shading and shadows, with an error
# that holds the truth; what the photographs do not determine is named.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

cat >lamp.ies <<'END'
IESNA:LM-63-1995
TILT=NONE
1 1000 1 4 1 1 2 0.1 0.1 0
1 1 0
0 60 120 180
0
600 500 200 100
END
cat >room.json <<'END'
{ "igi_synth": 1, "name": "room",
  "materials": { "floor": { "albedo": [0.45, 0.35, 0.25] }, "ceiling": { "albedo": [0.7, 0.7, 0.7] },
    "walls": { "albedo": [0.6, 0.5, 0.4] }, "box": { "albedo": [0.3, 0.4, 0.5] }, "panel": { "emitter": true } },
  "shapes": [
    { "type": "room", "size": [3.5, 4, 2.6], "floor": "floor", "ceiling": "ceiling", "walls": "walls",
      "panels": [ { "from": [0.5, 0.6], "to": [1.0, 1.1], "material": "panel" } ] },
    { "type": "box", "at": [2.2, 1.4, 0], "size": [0.6, 0.6, 0.8], "turn_deg": 25, "material": "box" } ],
  "lights": [ { "type": "area", "region": "panel", "radiance": [6, 6, 6] },
    { "type": "point", "position": [1.4, 2.6, 1.9], "intensity": [3, 2.5, 2] },
    { "type": "goniometric", "position": [2.6, 3.2, 2.1], "profile": "lamp.ies", "scale": 0.006 } ],
  "views": { "width": 96, "height": 72, "count": 8, "samples": 12, "fov_deg": 75 } }
END
cat >lights.py <<'END'
import json, math
def load(path): return json.load(open(path))
def save(scene, path): json.dump(scene, open(path, "w"))
END
expect 0 'photographs' "$igi" synth room.json -o room
cp lamp.ies room
python3 - <<'END'
from lights import *
scene = load("room/scene.json")
for light, off in zip(scene["lights"][1:], ([.03, -.03, .027], [-.02, .03, -.035])):
    light["position"] = [x + d for x, d in zip(light["position"], off)]
save(scene, "room/given.json")
for light in scene["lights"][1:]: light["position_std"] = .05
del scene["lights"][2]["scale"]
save(scene, "room/moved.json")
# What shines outside of the closed room says nothing of where it stands.
scene["lights"].append({ "type": "point", "position": [9, 9, 9], "intensity": [1, 1, 1], "position_std": .05 })
save(scene, "room/outside.json")
scene["lights"][3]["position_std"] = -1
save(scene, "room/negative.json")
scene["lights"] = [dict(scene["lights"][0], position_std=.1)]
save(scene, "room/area.json")
END

expect 0 "" "$igi" recover -q room/moved.json --model lambert -o out -j 2
python3 - >problems 2>&1 <<'END'
from lights import *
truth, got = load("room/scene.json")["lights"], load("out/materials.json")
for t, g in zip(truth[1:], got["lights"][1:]):
    far = math.dist(t["position"], g["position"])
    if not far < .01: print(f"{t['type']}: {1000 * far} mm off")
    for x, y, s in zip(t["position"], g["position"], g["position_std"]):
        if not abs(x - y) < 2 * s or not s < .01: print(f"{t['type']}: {y} +- {s}, not {x}")
scale, std = got["lights"][2]["scale"], got["lights"][2]["scale_std"]
if not abs(scale - truth[2]["scale"]) < 3 * std or not std < .05 * scale: print("scale", scale, std)
if any("place" in w for w in got["warnings"]): print("named without need", got["warnings"])
regions, albedos = got["regions"], load("room/truth/truth.json")["regions"]
for name in ("floor", "ceiling", "walls", "box"):
    for x, y, s in zip(albedos[name]["albedo"], regions[name]["albedo"], regions[name]["albedo_std"]):
        if not abs(y - x) < 3 * s + .002 * x: print(f"{name}: {y} +- {s}, not {x}")
END
[ ! -s problems ] || fail "$(cat problems)"
cp -r out once
expect 0 "" "$igi" recover -q room/moved.json --model lambert -o out -j 5
cmp once/materials.json out/materials.json || fail "other threads, other places"
expect 0 "" "$igi" relight out --cameras room/transforms.json --samples 1 -q -o relit

# A floor that mirrors the lamps: where they stand is told by diffuse light alone, and the lobe by where they stand.
python3 - <<'END'
from lights import *
spec = load("room.json")
spec["materials"]["floor"] = {"albedo": [.35, .25, .15], "model": "ward", "specular": .08, "alpha": .12}
spec["lights"][2] = {"type": "point", "position": [2.6, 3.2, 2.1], "intensity": [2, 2, 2.5]}
save(spec, "glossy.json")
END
expect 0 "" "$igi" synth -q glossy.json -o glossy
python3 - <<'END'
from lights import *
scene = load("glossy/scene.json")
for light, off in zip(scene["lights"][1:], ([.03, -.03, .027], [-.02, .03, -.035])):
    light["position"] = [x + d for x, d in zip(light["position"], off)]
    light["position_std"] = .05
del scene["lights"][2]["intensity"]
save(scene, "glossy/moved.json")
END
expect 0 "" "$igi" recover -q glossy/moved.json -o out
python3 - >problems 2>&1 <<'END'
from lights import *
truth, got = load("glossy/scene.json")["lights"], load("out/materials.json")
for t, g in zip(truth[1:], got["lights"][1:]):
    far = math.dist(t["position"], g["position"])
    if not far < .01: print(f"over a glossy floor: {1000 * far} mm off")
    for x, y, s in zip(t["position"], g["position"], g["position_std"]):
        if not abs(x - y) < 3 * s or not s < .01: print(f"over a glossy floor: {y} +- {s}, not {x}")
for x, y, s in zip(truth[2]["intensity"], got["lights"][2]["intensity"], got["lights"][2]["intensity_std"]):
    if not abs(y - x) < min(3 * s, .03 * x): print(f"over a glossy floor: power {y} +- {s}, not {x}")
floor = got["regions"]["floor"]
if floor["model"] != "ward" or not abs(floor["specular"] - .08) < .004 or not abs(floor["alpha"] - .12) < .006: print(floor)
END
[ ! -s problems ] || fail "$(cat problems)"

# Nobody asks: lights stay where they are.
expect 0 "" "$igi" recover -q room/given.json --model lambert -o out
grep -q position_std out/materials.json && fail "a light was moved that nobody asked for"
expect 0 "" "$igi" recover -q room/outside.json --model lambert -o out
grep -q '"lights\[3\]: the photographs do not determine its place' out/materials.json || fail "the lamp outside is not named"
grep -q '"lights\[1\]: .*place' out/materials.json && fail "the lamp inside is named"
expect 3 'position_std": is -1; give a standard deviation' "$igi" recover room/negative.json -o bad
expect 3 'unknown key' "$igi" recover room/area.json -o bad
finish
