#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# The same bytes for any number of threads where lobes are fitted, and where rays look into the
# photographs. recover.sh has the room without lobes.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
cat >glossy.json <<END
{
  "igi_synth": 1,
  "name": "glossy",
  "materials": {
    "floor": { "albedo": [0.4, 0.35, 0.3], "model": "ward", "specular": 0.15, "alpha": 0.12 },
    "walls": { "albedo": [0.6, 0.6, 0.55] },
    "lamp": { "emitter": true }
  },
  "shapes": [
    { "type": "room", "size": [3, 3, 2.5], "floor": "floor", "ceiling": "walls", "walls": "walls" },
    { "type": "sphere", "centre": [1.5, 1.5, 2], "radius": 0.15, "around": 16, "rings": 8,
      "material": "lamp" }
  ],
  "lights": [ { "type": "area", "region": "lamp", "radiance": [60, 60, 60] } ],
  "views": { "width": 96, "height": 72, "count": 8, "samples": 32, "fov_deg": 80 }
}
END

# same_bytes FOLDER OTHER: whatever materials are made of.
same_bytes() {
    (cd "$1" && find . -name '*.exr' -o -name 'materials.json' -o -name '*.glb') >names
    [ "$(wc -l <names)" -ge 6 ] || fail "$1 holds only $(cat names)"
    while read -r name; do
        cmp -s "$1/$name" "$2/$name" || fail "$name differs between $1 and $2"
    done <names
}

expect 0 "" "$igi" synth -q glossy.json -o room
for threads in 1 2 7; do
    expect 0 "" "$igi" recover -q room -o "out$threads" -j "$threads"
    expect 0 "" "$igi" recover -q room -o "photos$threads" -j "$threads" --method gather \
        --gather-from photos
done
grep -q '"model": "ward"' out1/materials.json || fail "the floor's lobe was not found"
expect 0 "" "$igi" validate -q out1 --truth room/truth --tolerance 0.03
for threads in 2 7; do
    same_bytes out1 "out$threads"
    same_bytes photos1 "photos$threads"
done
grep -q '"gather-from": "photos"' photos1/manifest.json || fail "the manifest lacks --gather-from"
for way in rays hemicube closed; do
    expect 0 "" "$igi" recover -q room -o "$way" --method radiosity --form-factors "$way"
done
cmp -s rays/materials.json hemicube/materials.json && fail "--form-factors changes nothing"
expect 2 "must be one of patches.photos" "$igi" recover room -o none --gather-from walls
finish
