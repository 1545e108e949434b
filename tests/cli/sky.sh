#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# A sky by date and place: made, recovered under, and relit with.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

cat >spec.json <<'END'
{ "igi_synth": 1, "name": "sky",
  "materials": { "floor": { "albedo": [0.45, 0.35, 0.25] }, "wall": { "albedo": [0.6, 0.6, 0.5] },
                 "box": { "albedo": [0.2, 0.3, 0.4] } },
  "shapes": [
    { "type": "quad", "corner": [0, 0, 0], "u": [3, 0, 0], "v": [0, 3, 0], "material": "floor" },
    { "type": "quad", "corner": [3, 0, 0], "u": [0, 3, 0], "v": [0, 0, 2], "material": "wall" },
    { "type": "box", "at": [1.5, 1.5, 0], "size": [0.7, 0.7, 0.7], "material": "box" } ],
  "lights": [ { "type": "sky", "latitude_deg": 48.1, "longitude_deg": 11.6, "time": "2026-06-21T16:30:00+02:00",
                "cloudiness": 0.2, "rotation_deg": 60 } ],
  "views": { "width": 112, "height": 84, "samples": 16, "fov_deg": 70,
             "look": [ { "eye": [-1, -1, 2], "target": [1.5, 1.6, 0] }, { "eye": [-1, 3, 2.5], "target": [1.5, 1.5, 0.4] } ] } }
END
expect 0 'photographs' "$igi" synth spec.json -o scene
expect 0 "" "$igi" recover -q scene -o out --model lambert
expect 0 "" "$igi" validate -q --json out --truth scene/truth
python3 - >problems 2>&1 <<'END'
import json
truth, got = json.load(open("scene/truth/truth.json"))["regions"], json.load(open("out/materials.json"))
for name, r in got["regions"].items():
    for x, y in zip(truth[name]["albedo"], r["albedo"]):
        if not abs(y / x - 1) < .02: print(name, y, "not", x)
sky = got["lights"][0]
if sky["type"] != "sky" or not abs(sky["sun_elevation_deg"] - 44.5) < .1 or not abs(sky["sun_azimuth_deg"] - 254.9) < .2:
    print("another sun:", sky)
END
[ ! -s problems ] || fail "$(cat problems)"

# Under another sun, and under the one that the result names.
echo '{ "lights": [ { "type": "sky", "sun_elevation_deg": 20, "sun_azimuth_deg": 90 } ] }' >evening.json
expect 0 "" "$igi" relight -q out --cameras scene/transforms.json --lights evening.json --samples 2 -o evening
expect 0 "" "$igi" relight -q out --cameras scene/transforms.json --samples 2 -o same
cmp -s evening/0000.exr same/0000.exr && fail "the sun does not matter"
echo '{ "lights": [ { "type": "sky", "sun_elevation_deg": 20, "turbidity": 99 } ] }' >haze.json
expect 3 'haze.json:1: "lights\[0\].turbidity": is 99; give 1.7 to 10' \
    "$igi" relight -q out --cameras scene/transforms.json --lights haze.json -o haze
finish
