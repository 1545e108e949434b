#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# A sky is mirrored as it is, not as if it were of one brightness: a glossy floor under it has its lobe.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
for seed in 1 2 3; do
    expect 0 "" "$igi" synth -q "$tests/cli/sky_lobe.json" -o yard --seed $seed
    expect 0 "" "$igi" recover -q yard -o out --force --seed $seed
    python3 - "$seed" <<'PY' || fail "seed $seed: the floor is not what it is"
import json, sys
floor = json.load(open("out/materials.json"))["regions"]["floor"]
true = [0.4, 0.3, 0.2]
assert floor["model"] == "ward", floor
assert all(abs(got / want - 1) < .02 for got, want in zip(floor["albedo"], true)), floor["albedo"]
for what, want in (("specular", 0.12), ("alpha", 0.15)):
    off = abs(floor[what] - want)
    assert off < .05 * want and off < 3 * floor[what + "_std"], (what, floor)
PY
    if grep -q "strays over the photographs\|image 0" out/materials.json; then fail "seed $seed: an image is blamed"; fi
done
finish
