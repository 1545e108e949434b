#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# A ceiling that no photograph shows is a guess, and the light it sends is one, too: the error bars of
# all that it reaches know of it.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
expect 0 'photographs' "$igi" synth "$tests/cli/unseen.json" -o room
expect 0 "" "$igi" recover -q room -o out
python3 - >problems 2>&1 <<'PY'
import json
got = json.load(open("out/materials.json"))["regions"]
true = {k: v["albedo"] for k, v in json.load(open("room/truth/truth.json"))["regions"].items()}
if got["ceiling"]["observed"] or not got["ceiling"]["warnings"]: print("the ceiling is seen:", got["ceiling"])
for name in ("floor", "walls", "box"):
    for x, std, y in zip(got[name]["albedo"], got[name]["albedo_std"], true[name]):
        if abs(x - y) > 2 * std: print(name, "is", x, "+-", std, "not", y)
        if not .01 < std / y < .1: print(name, "is said to be open by", std / y)
PY
[ ! -s problems ] || fail "$(cat problems)"

# The other methods say that theirs do not.
for method in gather radiosity yu99; do
    expect 0 "" "$igi" recover -q room -o "$method" --method "$method"
    grep -q "the light that it sends is a guess, and the error bars of --method $method" \
        "$method/materials.json" || fail "$method: $(grep -A4 '"warnings"' "$method/materials.json")"
done
expect 0 "" "$igi" recover -q room -o direct --method direct
grep -q 'takes light from other surfaces for albedo' direct/materials.json || fail "direct says nothing"
! grep -q 'the light that it sends is a guess' out/materials.json || fail "patches disowns its error bars"
finish
