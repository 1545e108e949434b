#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Albedos recovered under every kind of light, each alone over two surfaces and a box.
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
cat >spec.py <<'END'
import json, sys
LIGHTS = {
    "area": {"region": "lamp", "radiance": [9, 8, 6]},
    "point": {"position": [.6, .4, 1.8], "intensity": [3, 2, 2]},
    "spot": {"position": [1.5, 1.2, 1.9], "direction": [.2, .9, -1], "intensity": [9, 9, 8], "cutoff_deg": 60, "beam_deg": 25},
    "line": {"from": [1, .5, 1.7], "to": [2, .6, 1.9], "intensity": [1, 2, 1.5]},
    "directional": {"direction": [-.5, .4, -1], "irradiance": [2, 2, 1.8]},
    "goniometric": {"position": [1.3, 1.2, 1.9], "profile": "lamp.ies", "scale": .005},
    "env": {"image": "room/images/0000.exr", "rotation_deg": 30, "scale": 2},
    "sky": {"sun_elevation_deg": 40, "sun_azimuth_deg": 100, "turbidity": 3, "cloudiness": .5, "scale": 1},
    "ambient": {"radiance": [.3, .4, .5]}}
kind = sys.argv[1]
shapes = [{"type": "quad", "corner": [0, 0, 0], "u": [3, 0, 0], "v": [0, 3, 0], "material": "floor"},
          {"type": "quad", "corner": [0, 3, 0], "u": [3, 0, 0], "v": [0, 0, 2], "material": "wall"},
          {"type": "box", "at": [1.6, 1.8, 0], "size": [.6, .6, .8], "turn_deg": 25, "material": "box"}]
materials = {"floor": {"albedo": [.45, .35, .25]}, "wall": {"albedo": [.6, .5, .4]}, "box": {"albedo": [.3, .4, .5]}}
if kind == "area":
    materials["lamp"] = {"emitter": True}
    shapes.append({"type": "quad", "corner": [.8, .8, 2.2], "u": [0, .5, 0], "v": [.5, 0, 0], "material": "lamp"})
look = [{"eye": e, "target": t} for e, t in (([1.5, .3, 1.8], [1.5, 2, .3]), ([.4, .5, 2], [2, 2.4, .3]), ([2.7, .5, 1.6], [1.2, 2.4, .3]))]
json.dump({"igi_synth": 1, "name": kind, "materials": materials, "shapes": shapes, "lights": [dict(LIGHTS[kind], type=kind)],
           "views": {"width": 80, "height": 60, "samples": 16, "fov_deg": 75, "look": look}}, open("spec.json", "w"))
END
cat >judge.py <<'END'
import json, sys
got, truth = json.load(open("out/materials.json"))["regions"], json.load(open("scene/truth/truth.json"))["regions"]
for name in ("floor", "wall", "box"):
    for x, y, s in zip(truth[name]["albedo"], got[name]["albedo"], got[name]["albedo_std"]):
        if not abs(y / x - 1) < .025 or not abs(y - x) < 3 * s + .002 * x:
            print(f"{sys.argv[1]}: {name} {y} +- {s}, not {x}")
END
for kind in point area spot line directional goniometric sky ambient env; do
    python3 spec.py $kind
    expect 0 "" "$igi" synth -q spec.json -o scene -f
    expect 0 "" "$igi" recover -q scene --model lambert -o out
    python3 judge.py $kind >problems 2>&1
    [ ! -s problems ] || fail "$(cat problems)"
    [ -d room ] || cp -r scene room # its first photograph is the map for env
done
finish
