#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# The whole chain against truth: a room as a camera would have delivered it (tone curve, 30 %
# vignetting, barrel distortion, noise, 12 bits, brackets), and back to albedo. A small room with
# few rays; what is left is mostly their noise.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

cat >spec.json <<'JSON'
{ "igi_synth": 1, "name": "closet",
  "materials": { "floor": { "albedo": 0.5 }, "ceiling": { "albedo": 0.7 },
                 "walls": { "albedo": [0.6, 0.4, 0.3] }, "lamp": { "emitter": true } },
  "shapes": [ { "type": "room", "size": [4, 4, 3], "floor": "floor", "ceiling": "ceiling",
                "walls": "walls",
                "panels": [ { "from": [1.5, 1.5], "to": [2.5, 2.5], "material": "lamp" } ] } ],
  "lights": [ { "type": "area", "region": "lamp", "radiance": [10, 9, 8] } ],
  "views": { "width": 160, "height": 120, "count": 8, "samples": 12, "fov_deg": 78 } }
JSON
expect 0 'photographs' "$igi" synth spec.json --photos -o room
stdout 'merge and correct photos'
[ "$(find room/photos -name '0*_?.png' | wc -l)" -eq 40 ] || fail "not 8 brackets of 5"
[ -z "$(ls room/images)" ] || fail "images/ is not left to igi merge"
grep -q '"radiance"' room/scene.json && fail "the lamp's radiance is in a unit no camera knows"

cp room/photos/lens.json camera.json
expect 0 '' "$igi" merge -q room/photos/0000_?.png -o merged/first.exr --response recovered \
    --save-response camera.json
expect 0 '' "$igi" calibrate -q --flat room/photos/flat_?.png -o camera.json

# The same by the manifest: recovery merges and corrects by itself.
cp -r room keys
sed 's|"mesh"|"calibration": "../camera.json", "brackets": "photos/brackets.json", &|' \
    room/scene.json >keys/scene.json
expect 0 '' "$igi" recover -q keys -o by_keys
grep -q '"file": "keys/photos/0003_4.png"' by_keys/manifest.json || fail "a photograph is unnamed"
for first in room/photos/0*_0.png; do
    name=$(basename "$first" _0.png)
    expect 0 '' "$igi" merge -q room/photos/"${name}"_?.png -o "merged/$name.exr" \
        --response camera.json
done
rm merged/first.exr
expect 0 '' "$igi" correct -q --calibration camera.json merged/*.exr -o room/images -f
expect 0 '' "$igi" recover -q room -o out
cmp out/materials.json by_keys/materials.json || fail "the manifest's keys give another result"
expect 0 '' "$igi" validate -q out --truth room/truth --tolerance .01
python3 - <<'PYTHON' || fail "error bars do not hold what the recovered response is off by"
import json
assert 1e-3 < json.load(open("camera.json"))["response"]["std"] < .02
got = json.load(open("out/materials.json"))["regions"]
for name, truth in json.load(open("room/truth/truth.json"))["regions"].items():
    if name == "lamp":
        continue
    for x, want, std in zip(got[name]["albedo"], truth["albedo"], got[name]["albedo_std"]):
        assert abs(x - want) < 2.5 * std, (name, x, want, std)  # without the response's part: 4.6
PYTHON

# Vignetting from the overlaps of the same brackets, by the lens and the response, beside the flat
# field's.
expect 0 '' "$igi" calibrate -q --overlap keys -o overlap.json
python3 - camera.json overlap.json <<'PYTHON' || fail "overlaps tell another vignetting"
import json, sys
flat, overlap = (json.load(open(path))["vignetting"] for path in sys.argv[1:])
def V(v, x, y):
    r2 = ((x - v["centre"][0])**2 + (y - v["centre"][1])**2) / (80**2 + 60**2)
    return 1 + r2 * (v["k"][0] + r2 * (v["k"][1] + r2 * v["k"][2]))
ratios = [V(overlap, x, y) / V(flat, x, y) for x in range(0, 161, 16) for y in range(0, 121, 12)]
mean = sum(ratios) / len(ratios)
rms = (sum((r / mean - 1)**2 for r in ratios) / len(ratios))**.5
print(f"overlap against flat field: rms {rms:.4f}")
assert rms < .01 and V(flat, 0, 0) < .85, rms
PYTHON

# What is wrong with the list is said with its line, before the long work.
list() {
    printf '%s\n' "$1" >keys/photos/brackets.json
}
list '{ "igi": 1,
  "images": { "0000": [ "0000_0.png", "nowhere.png" ] } }'
expect 3 'photos/brackets.json:2: "images.0000\[1\]": no readable file' "$igi" recover keys -o no
list '{ "igi": 1, "images": { "0000": [ { "file": "flat_0.png", "second": 1 } ] } }'
expect 3 'did you mean "seconds"' "$igi" recover keys -o no
list '{ "igi": 1, "images": { "0000": [ { "file": "flat_0.png", "seconds": 0 } ] } }'
expect 3 'give a number above 0' "$igi" recover keys -o no
list '{ "igi": 1, "images": { "0000": [ "0000_0.png" ], "images/0000.exr": [ "0000_1.png" ] } }'
expect 3 'names the frame 0000 a second time' "$igi" recover keys -o no
list '{ "igi": 1, "images": { "0000": [ "0000_0.png" ] } }'
expect 3 'no exposures for the image "0001"' "$igi" recover keys -o no
list '{ "igi": 1, "response": "log", "images": { } }'
expect 3 'give "linear" or "srgb"' "$igi" recover keys -o no
sed 's|"w": *160|"w": 80|' camera.json >half.json
sed 's|../camera.json|../half.json|' keys/scene.json >other.json && mv other.json keys/scene.json
cp room/photos/brackets.json keys/photos/brackets.json
expect 3 'half.json: it is for 80 x 120 pixels' "$igi" recover keys --dry-run
expect 3 'half.json: it is for 80 x 120 pixels, and image 0000 has 160 x 120' \
    "$igi" recover keys -o no
finish
