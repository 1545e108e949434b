#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Scenes with something wrong: the sentence, the exit status, and nothing written.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
edit=$build/edit_exr
"$igi" synth -q "$tests/cli/mini.json" -o room || fail "no room"

# A fresh copy of the room as `bad`.
fresh() {
    rm -rf bad bad.out
    cp -r room bad
}

# refused STATUS PATTERN: recovery says so and writes nothing.
refused() {
    expect "$1" "$2" "$igi" recover -q bad -o bad.out
    [ -z "$(find . -maxdepth 1 -name 'bad.out*')" ] || fail "$2: something was written"
    [ ! -s "$out" ] || fail "$2: words on stdout"
}

# passes PATTERN: recovery ends well, and materials.json warns so ("": no matter).
passes() {
    expect 0 "" "$igi" recover -q bad -o bad.out
    [ -z "$1" ] || grep -qE -e "$1" bad.out/materials.json || fail "no warning '$1' in materials.json"
    grep -qE '[[ ]-?(nan|inf)\b' bad.out/materials.json && fail "$1: not a number in materials.json"
    return 0
}

# Images.
fresh; rm bad/images/0002.exr
refused 3 'images/0002\.exr'
fresh; head -c 4000 room/images/0002.exr >bad/images/0002.exr
refused 3 'images/0002\.exr'
fresh; : >bad/images/0002.exr
refused 3 'images/0002\.exr'
fresh; echo 'not a picture' >bad/images/0002.exr
refused 3 'images/0002\.exr'
fresh; "$edit" bad/images/0002.exr crop
refused 3 'images/0002\.exr.*63x48.*64'
fresh; "$edit" bad/images/0002.exr bands 5
refused 3 'images/000[02]\.exr.*bands'
for value in nan inf -1; do
    fresh; "$edit" bad/images/0002.exr fill $value 1400
    refused 3 'images/0002\.exr.*pixels are negative, infinite or not a number'
    fresh; "$edit" bad/images/0002.exr fill $value 4
    passes '0002.* 4 pixels are negative, infinite or not a number'
done
fresh; cp bad/images/0002.exr bad/images/stray.exr
expect 0 'images/stray\.exr: no camera took it; it is not used' "$igi" recover bad --dry-run
# A photograph whose data window is a part of its display window: what lies outside nobody saw.
fresh; python3 - <<'E3' || fail "images/0002.exr has no display window"
import json, struct
path = "bad/images/0002.exr"
exr = open(path, "rb").read()
at = exr.index(b"displayWindow\0box2i\0") + 24
assert struct.unpack("<4i", exr[at:at + 16]) == (0, 0, 63, 47)
open(path, "wb").write(exr[:at] + struct.pack("<4i", -16, -8, 95, 79) + exr[at + 16:])
t = json.load(open("bad/transforms.json"))
t["frames"][2].update(w=112, h=88, cx=t["cx"] + 16, cy=t["cy"] + 8)
json.dump(t, open("bad/transforms.json", "w"))
E3
passes ''
"$igi" recover -q room -o whole.out || fail "the room as it was"
python3 - <<'E4' || fail "what lies outside the data window counts"
import json
got, want = (json.load(open(p + ".out/materials.json")) for p in ("bad", "whole"))
assert got["warnings"] == want["warnings"], got["warnings"]
off = [abs(a - b) for r in want["regions"] for a, b in zip(got["regions"][r]["albedo"], want["regions"][r]["albedo"])]
assert max(off) < .005, max(off)
E4

# Cameras.
fresh; sed -i 's/"transform_matrix"/"transfrom_matrix"/' bad/transforms.json
refused 3 'bad/transforms\.json:[0-9]+: .*trans'
fresh; python3 - <<'E2'
import json
t = json.load(open("bad/transforms.json"))
t["frames"] = t["frames"][:1]
json.dump(t, open("bad/transforms.json", "w"))
E2
passes ''
fresh; python3 - <<'E2'
import json
t = json.load(open("bad/transforms.json"))
for row in range(3):
    t["frames"][1]["transform_matrix"][row][3] = [1.2, 1.9, 0.4][row]
json.dump(t, open("bad/transforms.json", "w"))
E2
expect 3 '0001.*(wall|surface|inside|outside|back)' "$igi" recover -q bad -o bad.out
fresh; python3 - <<'E2'
import json
t = json.load(open("bad/transforms.json"))
for frame in t["frames"]:
    for row in range(3):
        frame["transform_matrix"][row][3] += 1000
json.dump(t, open("bad/transforms.json", "w"))
E2
expect 3 '000[0-9].*' "$igi" recover -q bad -o bad.out

# The mesh.
fresh; sed -i '0,/^f .*/s//f 1 2 99999/' bad/scene.obj
refused 3 'bad/scene\.obj:[0-9]+: '
fresh; printf 'v 0 0 zero\n' >bad/scene.obj
refused 3 'bad/scene\.obj:1: '
fresh; : >bad/scene.obj
refused 3 'bad/scene\.obj'
fresh; printf 'v 0 0 0\nv 3 0 0\nv 0 3 0\nusemtl floor\nf 1 2 3\n' >bad/scene.obj
sed -i 's/"lights": \[/"lights": [], "xlights": [/' bad/scene.json
refused 3 'xlights'
fresh; printf 'v 0 0 0\nv 0 0 0\nv 0 0 0\nusemtl floor\nf 1 2 3\n' >bad/scene.obj
refused 3 'bad/scene\.(obj|json)'
fresh; printf 'v 9 9 9\nv 9 9 9\nv 9 9 9\nusemtl floor\nf -1 -2 -3\n' >>bad/scene.obj
passes ''
fresh; printf 'v 90 90 9\nv 91 90 9\nv 90 91 9\nusemtl attic\nf -1 -2 -3\n' >>bad/scene.obj
passes '(no photograph|not seen|unseen)'

turn() { # turns the triangles of region $1 around
    awk -v region="$1" '$1 == "usemtl" { on = $2 == region }
        on && $1 == "f" { t = $3; $3 = $4; $4 = t } { print }' room/scene.obj >bad/scene.obj
}
fresh; turn panel
refused 3 "bad.*region 'panel' is a lamp.*its back.*turn its triangles"
fresh; turn box # every surface but a lamp reflects on both sides
passes ''

# What can be read and cannot be meant: a mesh in centimetres, no light.
fresh; awk '$1 == "v" { print "v", 100 * $2, 100 * $3, 100 * $4; next } { print }' room/scene.obj >bad/scene.obj
passes 'in centimetres. export it in metres'
fresh; python3 - <<'E2'
import json
s = json.load(open("bad/scene.json"))
s["lights"], s["regions"] = [], {}
json.dump(s, open("bad/scene.json", "w"))
E2
passes 'lists no light'

# scene.json.
fresh; echo '{' >bad/scene.json
refused 3 'bad/scene\.json:[0-9]+: '
fresh; sed -i 's/"name"/"nmae"/' bad/scene.json
refused 3 'bad/scene\.json:[0-9]+: .*nmae'
fresh; sed -i 's/"region": "panel"/"region": "pannel"/' bad/scene.json
refused 3 'bad/scene\.json:[0-9]+: .*pannel'
fresh; sed -i 's/"scene.obj"/"scene.ob"/' bad/scene.json
refused 3 'bad/scene\.json:[0-9]+: .*scene\.ob'
finish
