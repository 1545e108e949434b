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
mkdir merged
expect 0 '' "$igi" merge -q room/photos/0000_?.png -o merged/first.exr --response recovered \
    --save-response camera.json
expect 0 '' "$igi" calibrate -q --flat room/photos/flat_?.png -o camera.json
for first in room/photos/0*_0.png; do
    name=$(basename "$first" _0.png)
    expect 0 '' "$igi" merge -q room/photos/"${name}"_?.png -o "merged/$name.exr" \
        --response camera.json
done
rm merged/first.exr
expect 0 '' "$igi" correct -q --calibration camera.json merged/*.exr -o room/images -f
expect 0 '' "$igi" recover -q room -o out
expect 0 '' "$igi" validate -q out --truth room/truth --tolerance .03
finish
