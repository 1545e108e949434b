#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# A scene for other programs: what is written, whether it is well-formed, and what Mitsuba makes of it.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 "" "$igi" synth -q "$tests/cli/mini.json" -o room
sed 's/"walls": {/"walls": { "model": "ward", "specular": 0.1, "alpha": 0.2,/
     s/"floor": {/"floor": { "model": "ggx", "specular": 0.05, "alpha": 0.1,/' \
    "$tests/cli/mini.json" >glossy.json
expect 0 "" "$igi" synth -q glossy.json -o glossy
cat >lights.json <<'END'
{ "lights": [ { "type": "area", "region": "panel", "radiance": [1, 2, 3] },
  { "type": "point", "position": [1, 1, 1], "intensity": [1, 1, 1] },
  { "type": "spot", "position": [2, 2, 2], "direction": [0, 0, -1], "intensity": [1, 1, 1], "cutoff_deg": 30, "beam_deg": 20 },
  { "type": "line", "from": [0.1, 0.1, 2], "to": [2, 0.1, 2], "intensity": [1, 1, 1] },
  { "type": "directional", "direction": [0, 1, -1], "irradiance": [1, 1, 1] },
  { "type": "env", "image": "room/images/0001.exr" },
  { "type": "ambient", "radiance": [0.1, 0.1, 0.1] } ] }
END

expect 2 'where to\?' "$igi" export room/truth --to glb
expect 2 'for whom\?' "$igi" export room/truth -o room.glb
expect 2 'must be one of' "$igi" export room/truth --to fbx -o room.fbx
expect 3 'neither materials' "$igi" export room --to obj -o room.obj
expect 0 "" "$igi" export -q room/truth --to glb -o made/for/it/room.glb
[ -s made/for/it/room.glb ] || fail "no file in the folder that was missing"
expect 4 'cannot be written .Not a directory' "$igi" export room/truth --to glb -o made/for/it/room.glb/room.glb
for format in glb obj mitsuba pbrt radiance; do
    expect 0 "" "$igi" export -q glossy/truth --to $format -o room.$format
    [ -s room.$format ] || fail "$format: nothing was written"
    expect 0 "" "$igi" export -q glossy/truth --to $format -o again.$format
    sed "s/again\.$format/room.$format/g" again.$format | cmp -s - room.$format ||
        fail "$format: differs from run to run"
done
[ -e room.glb_files ] && fail "glb needs no folder"
[ -s room.obj_files/floor.png ] || fail "obj: no texture"
grep -q '^usemtl floor' room.obj || fail "obj: no region"
[ -z "$(find . -name '*.part*')" ] || fail "left behind: $(find . -name '*.part*')"
expect 4 'files that igi did not write' sh -c \
    "mkdir own.obj_files; echo >own.obj_files/mine; exec $igi export -q room/truth --to obj -o own.obj"

expect 0 'no line lights' "$igi" export room/truth --to pbrt -o lit.pbrt --lights lights.json
expect 0 'no line lights' "$igi" export room/truth --to radiance -o lit.rad --lights lights.json
expect 0 'no lights but glowing surfaces: 6 lights' \
    "$igi" export room/truth --to obj -o lit.obj --lights lights.json
mv room.radiance room.rad && mv room.radiance_files room.rad_files && sed -i 's/room\.radiance_/room.rad_/g' room.rad
for scene in room.pbrt lit.pbrt room.rad lit.rad; do
    expect 0 "" python3 "$tests/cli/scene_syntax.py" $scene
    stdout '^[1-9][0-9]* shapes'
done
# The reader of pbrt's syntax would have noticed: each of these spoils one word.
for spoil in 's/"float fov"/"integer fov"/' 's/"float fov" 90/"float fov" "90"/' 's/"rgb I"/"rgb L"/' \
    's/"bool remaproughness" false/"bool remaproughness" 0/' 's/"string materials"/"texture materials"/' \
    's/^NamedMaterial "surface/NamedMaterial "face/' 's/"integer xresolution" [0-9]*/&.5/' \
    's/^WorldBegin/WorldBegun/' '/^AttributeEnd/d' 's/^Film/# Film\nWorldBegin\nFilm/' 's/"linear"/"gamma"/' \
    's/^Shape "plymesh" "string filename" "/&no/' 's/"rgb reflectance" \[ 0/&1 1 /' 's/"float amount" /&[ /'; do
    cat room.pbrt >spoilt.pbrt && grep '^LightSource' lit.pbrt >>spoilt.pbrt
    expect 0 "" python3 "$tests/cli/scene_syntax.py" spoilt.pbrt
    sed -i "$spoil" spoilt.pbrt
    expect 1 'spoilt\.pbrt: ' python3 "$tests/cli/scene_syntax.py" spoilt.pbrt
done

# Mitsuba's picture and ours: the lambert room alike; ggx and ward within what the mapping costs.
compare() {
    python3 "$tests/../scripts/peers/exported.py" "$@" --program mitsuba --igi "$igi" --frame 2 >"$out" 2>"$err"
    status=$?
    cat "$out"
    [ $status -eq 0 ] || [ $status -eq 77 ] || fail "Mitsuba: $*: $(cat "$out" "$err")"
}
compare room/truth --samples 64 --psnr 42 --mean 0.005
compare glossy/truth --samples 64 --psnr 34 --mean 0.04
finish
