#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# A broad lobe on bright panelling among shadows: found, or within what is said to be open.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
expect 0 'photographs' "$igi" synth "$tests/../datasets-synthetic/slats.json" -o room
for seed in 1 2 3; do
    expect 0 "" "$igi" recover -q room -o "out$seed" --seed "$seed"
done
python3 - >problems 2>&1 <<'PY'
import json
found = 0
for seed in 1, 2, 3:
    got = json.load(open(f"out{seed}/materials.json"))["regions"]
    for name in ("floor", "plaster", "posts"):
        if got[name]["model"] != "lambert": print(name, "has a lobe with seed", seed)
    p = got["panelling"]
    found += p["model"] == "ggx"
    for x, std in zip(p["albedo"], p["albedo_std"]):
        if abs(x - .8) > 2.5 * std: print("albedo is", x, "+-", std)
    if p["model"] == "lambert":
        if 1.645 * p["specular_std"] < .03: print("the bound on specular is", 1.645 * p["specular_std"])
    elif abs(p["specular"] - .04) > 3 * p["specular_std"] or abs(p["alpha"] - .2) > 3 * p["alpha_std"]:
        print("the lobe is", p)
if found < 2: print("the lobe is found with", found, "of three seeds")
PY
[ ! -s problems ] || fail "$(cat problems)"
finish
