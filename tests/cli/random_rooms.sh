#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Random rooms: each seed its own, the same seed the same; a table of materials or ranges; and two
# small rooms through scripts/random_rooms, whose figures must hold.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
specs=$tests/../datasets-synthetic

sed -e 's/"width": 96, "height": 72, "count": 12, "samples": 48/"width": 64, "height": 48, "count": 8, "samples": 16/' \
    "$specs/random-rooms.json" >small.json
grep -q '"count": 8, "samples": 16' small.json || fail "the spec's views are not as this test knows them"

# One room of each seed.
sed -e 's/"count": 8, "samples": 16/"count": 1, "samples": 1/' small.json >tiny.json
expect 0 "" "$igi" synth -q tiny.json -o one --seed 5
expect 0 "" "$igi" synth -q tiny.json -o same --seed 5
expect 0 "" "$igi" synth -q tiny.json -o other --seed 6
cmp -s one/scene.obj same/scene.obj || fail "the same seed gives another room"
cmp -s one/truth/truth.json same/truth/truth.json || fail "the same seed gives other materials"
cmp -s one/scene.obj other/scene.obj && fail "another seed gives the same room"

# Materials from a table: the one that is possible, everywhere.
printf 'material,r,g,b,r,g,b,alpha\nred,.5,.25,.125,.04,.05,.06,.1\nperpetual,.9,.9,.9,.2,.2,.2,.1\n' >table.csv
sed -e 's/"random": {/"random": { "table": "table.csv",/' tiny.json >table.json
expect 0 "" "$igi" synth -q table.json -o table
[ "$(grep -c '"specular": 0.05' table/truth/truth.json)" -ge 1 ] || fail "the table's lobe is nowhere"
grep -q '0\.9' table/truth/truth.json && grep -q '"specular": 0.2' table/truth/truth.json &&
    fail "a material that makes light of nothing was drawn"

# Mistakes are named.
echo 'material' >table.csv
expect 3 'table\.csv: has no possible material' "$igi" synth -q table.json -o bad
printf 'material,r\nred,.5\n' >table.csv
expect 3 'table\.csv:2: no material' "$igi" synth -q table.json -o bad
sed -e 's/"lamps": \[1, 3\]/"lamps": [1, 30]/' tiny.json >bad.json
expect 3 'bad\.json:[0-9]+: "random\.lamps": is from 1 to 30; give a range within 1 to 8' "$igi" synth -q bad.json -o bad
sed -e 's/"random": {/"materials": {}, "random": {/' tiny.json >bad.json
expect 3 '"materials": and "random" exclude each other' "$igi" synth -q bad.json -o bad
[ -e bad ] && fail "something was written"

# Two small rooms: nothing fails, no lobe is invented or missed, one of them is as it should be.
if python3 -c 'import json' 2>/dev/null; then
    expect 0 "" "$tests/../scripts/random_rooms" --igi "$igi" --spec small.json --ranges --rooms 2 \
        --csv rooms.csv
    stdout 'lobes invented on lambert regions +0 of +[1-9]'
    stdout 'lobes missed, highlight seen, rho_s >= .03 +0 of +[1-9]'
    stdout 'failures, and numbers not finite +0 of +2 '
    awk -F, '$1 == 2 && $2 == "east" { found = $6 == "ward" && $12 / $11 > .95 && $12 / $11 < 1.05 }
             END { exit !found }' rooms.csv || fail "the east wall of room 2: $(grep '^2,east' rooms.csv)"
fi

finish
