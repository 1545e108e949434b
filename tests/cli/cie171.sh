#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Illuminance at points: a small edition of scripts/cie171, the table of sensors, and files of lights.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 "" "$tests/../scripts/cie171" --igi "$igi" --cases 5.2,5.3,5.7,5.11 --noise 0.01 --tolerance 0.03
[ "$(grep -c '^| 5' "$out")" -eq 8 ] || fail "not eight cases: $(cat "$out")"

# As many bands as the scene has, directions of any length.
cat >dark.json <<'END'
{ "igi_synth": 1, "name": "dark", "bands": 2, "materials": { "wall": { "albedo": [0.5, 0] }, "lamp": { "emitter": true } },
  "shapes": [ { "type": "room", "size": [2, 2, 2], "floor": "wall", "ceiling": "lamp", "walls": "wall" } ],
  "lights": [ { "type": "area", "region": "lamp", "radiance": [1, 1] } ],
  "views": { "width": 4, "height": 4, "samples": 1, "look": [ { "eye": [1, 1, 1], "target": [1, 1.1, 0] } ] } }
END
expect 0 "" "$igi" synth -q dark.json -o dark
printf '# under the lamp, and facing the floor\n1 1 1.999 0 0 3\n\n1,1,0.001,0,0,-1\r\n' >sensors.txt
expect 0 "" "$igi" relight -q dark/truth --sensors sensors.txt -o lux
awk -F, 'NR == 2 && $9 > 3.13 && $9 < 3.15 && $10 > 3.13 && $10 < 3.15 { n++ }
         NR == 3 && $10 == 0 && $9 > .55 && $9 < .58 { n++ } END { exit !(n == 2 && NR == 3) }' lux/illuminance.csv ||
    fail "$(cat lux/illuminance.csv)"
expect 0 "" "$igi" relight -q dark/truth --sensors sensors.txt -o again -j 3
cmp lux/illuminance.csv again/illuminance.csv || fail "other threads, other light"
expect 2 'or --sensors' "$igi" relight dark/truth -o bad
printf '1 1 1 0 0\n' >bad.txt
expect 3 'bad.txt:1: no place and direction' "$igi" relight dark/truth --sensors bad.txt -o bad
printf '1 1 1 0 0 0\n' >bad.txt
expect 3 'bad.txt:1: the direction has no length' "$igi" relight dark/truth --sensors bad.txt -o bad
printf '1 1 1 0 0 1 5\n' >bad.txt
expect 3 'bad.txt:1: more than six' "$igi" relight dark/truth --sensors bad.txt -o bad
: >bad.txt
expect 3 'no sensor' "$igi" relight dark/truth --sensors bad.txt -o bad
[ ! -e bad ] || fail "a failure left a folder"

# A glowing ball of 10 W m^-3 sr^-1 has the intensity j V.
cat >glow.json <<'END'
{ "igi_synth": 1, "name": "glow", "materials": { "floor": { "albedo": 0 }, "glow": { "emitter": true } },
  "shapes": [ { "type": "quad", "corner": [-1, -1, -1], "u": [2, 0, 0], "v": [0, 2, 0], "material": "floor" },
              { "type": "sphere", "centre": [0, 0, 0], "radius": 0.2, "around": 96, "rings": 48, "material": "glow" } ],
  "lights": [ { "type": "volume", "region": "glow", "emission": [10, 10, 10] } ],
  "views": { "width": 4, "height": 4, "samples": 1, "look": [ { "eye": [1, 1, 1], "target": [0, 0, 0] } ] } }
END
expect 0 "" "$igi" synth -q glow.json -o glow
echo '1 0 0 -1 0 0' >at.txt
expect 0 "" "$igi" relight -q glow/truth --sensors at.txt -o ball
awk -F, 'NR == 2 { e = 10 * 4.18879 * .008; exit !($9 > .99 * e && $9 < 1.01 * e) }' ball/illuminance.csv ||
    fail "$(cat ball/illuminance.csv)"
sed 's/"glow" } \],/"glow" }, { "type": "quad", "corner": [0, 0, 0.5], "u": [1, 0, 0], "v": [0, 1, 0], "material": "glow" } ],/' glow.json >open.json
expect 3 'is open, and has no volume' "$igi" synth open.json -o open

# What a scene's lights name lies in its folder, and photometric units arrive in truth.json.
mkdir lamps other
printf '%s\n' IESNA:LM-63-2002 TILT=NONE '1 1000 1 2 1 1 2 0 0 0' '1 1 10' '0 180' '0' '20 20' >lamps/lamp.ies
printf 'nm,power\n400,1\n700,2\n' >lamps/warm.csv
cp lamps/lamp.ies other
python3 - <<'END'
import json
def save(name, spec):
    with open(name, "w") as f: json.dump(spec, f)
spec = json.load(open("dark.json"))
del spec["bands"]
spec["materials"]["wall"]["albedo"] = {"hsv": [0, 0, 0.735357]}
lamp = {"type": "goniometric", "position": [1, 1, 1.5], "profile": "lamps/lamp.ies"}
area = {"type": "area", "region": "lamp", "luminance_cd_m2": 179}
spec["relit"] = [{"lights": [dict(lamp, scale=2)]}]
spec["lights"] = [dict(area, spectrum="lamps/warm.csv"), dict(lamp, scale=1)]
save("lit.json", spec)
spec["lights"] = [area, dict(lamp, scale=1), dict(lamp, profile="other/lamp.ies", scale=1)]
save("clash.json", spec)
END
expect 0 "" "$igi" synth -q lit.json -o lit
expect 3 'the name of another light.s file' "$igi" synth clash.json -o clash
rm -r lamps
for file in lit/lamp.ies lit/warm.csv lit/relit/lamp.ies; do [ -s $file ] || fail "$file is missing"; done
expect 0 "" "$igi" relight -q lit/truth --sensors sensors.txt -o own
expect 0 "" "$igi" relight -q lit/truth --sensors sensors.txt --lights lit/relit/lights.json -o relit
expect 0 "" "$igi" recover -q lit -o out --model lambert --dry-run
grep -A1 '"albedo"' lit/truth/truth.json | grep -q '0.5000' || fail "no grey of a half: $(cat lit/truth/truth.json)"
awk -F, 'NR == 2 { exit !($7 > 179 * 3.13 && $7 < 179 * 3.15) }' own/illuminance.csv || fail "$(cat own/illuminance.csv)"
finish
