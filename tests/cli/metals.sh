#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Metals mirror in a colour: gold and copper have a specular coefficient of each band, varnish and steel
# one for all; evidence, validation, the page and exports say the same.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
expect 0 "" "$igi" synth -q "$tests/cli/metals.json" -o room
expect 0 "" "$igi" recover -q room -o out
python3 - <<'PY' || fail "the metals are not what they are"
import json
got = json.load(open("out/materials.json"))["regions"]
true = json.load(open("room/truth/truth.json"))["regions"]
evidence = json.load(open("out/evidence.json"))["regions"]
assert got["gold"]["model"] == "ggx", got["gold"]
for name, within in (("gold", .06), ("copper", .15)):  # copper mirrors less of the lamp
    m = got[name]
    assert m["model"] != "lambert" and m["albedo"] == [0, 0, 0], (name, m)
    for g, s, want in zip(m["specular_rgb"], m["specular_rgb_std"], true[name]["specular_rgb"]):
        assert abs(g / want - 1) < within and abs(g - want) < 3 * s, (name, m)
    for g, want in zip(m["specular_rgb"], true[name]["specular_rgb"]):  # the colour is known better
        assert abs(g / m["specular"] / (want / true[name]["specular"]) - 1) < .04, (name, m)
    assert evidence[name]["parameters"] == 7, evidence[name]
    last = evidence[name]["tried"][-1]
    assert last["coloured"] and last["colour_gain"] > 100, last
for name in ("varnish", "steel"):
    assert got[name]["model"] != "lambert" and got[name]["specular_rgb"] is None, (name, got[name])
    assert "specular_rgb_std" not in got[name], got[name]
assert abs(got["varnish"]["specular"] / .08 - 1) < .05, got["varnish"]
PY
expect 0 "" "$igi" validate -q out --truth room/truth --json
python3 - "$out" <<'PY' || fail "igi validate does not see the colours"
import json, sys
regions = json.load(open(sys.argv[1]))["regions"]
assert regions["gold"]["coloured"] == [True, True] and regions["steel"]["coloured"] == [False, False]
assert all(abs(z) < 3 for z in regions["gold"]["specular_rgb_z"]), regions["gold"]
assert regions["steel"]["specular_rgb_z"] == [None] * 3, regions["steel"]
PY
grep -q 'in each band it has a strength of its own' out/report.html || fail "the page does not say that lobes are coloured"
expect 0 "" "$igi" export out --to glb -q -o room.glb
grep -qa specularColorFactor room.glb || fail "the export has no colour of lobes"
finish
