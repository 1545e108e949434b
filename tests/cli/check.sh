#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# igi check: the table, JSON, exit statuses, and the same bytes for any number of threads.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 '' "$igi" synth -q "$tests/cli/mini.json" -o room
expect 0 'observe' "$igi" check room
stdout '^lights +holds'
stdout '^energy +holds'
stdout '^closed +holds'
stdout '^floor +[0-9.]+ % +[1-6] '
stdout '^mini: '
expect 0 '' "$igi" check -q room
[ ! -s "$out" ] || fail "--quiet speaks"
expect 0 '' "$igi" check -q --json -j 1 room
cp "$out" one.json
expect 0 '' "$igi" check -q --json -j 3 room
cmp -s "$out" one.json || fail "threads change what is found"
python3 - <<'PY' || fail "the JSON is not as documented"
import json
c = json.load(open("one.json"))
assert c["igi"] == 1 and c["scene"] == "mini" and c["verdict"] in ("holds", "doubtful")
assert len(c["assumptions"]) == 12 and len(c["photographs"]) == 6 and len(c["lights"]) == 1
for a in c["assumptions"]:
    assert a["verdict"] in ("holds", "doubtful", "fails") and a["finding"]
    assert (a["remedy"] is None) == (a["verdict"] == "holds"), a
assert 0 < c["regions"]["box"]["observed"] <= 1
assert 0 < c["regions"]["box"]["seen_once"] < c["regions"]["box"]["observed"]
assert c["regions"]["panel"]["emitter"]
PY

# A lamp that the photographs show brighter than scene.json has it.
sed 's/"radiance": *\[[^]]*\]/"radiance": [1, 1, 1]/' room/scene.json >dim.json
grep -q '"radiance": \[1, 1, 1\]' dim.json || tr -d '\n' <room/scene.json |
    sed 's/"radiance": *\[[^]]*\]/"radiance": [1, 1, 1]/' >dim.json
cp -r room dim && cp dim.json dim/scene.json
expect 1 "show 'panel' 6 times as bright as given; leave" "$igi" check -q dim
expect 3 'nowhere' "$igi" check -q nowhere
expect 2 'needed' "$igi" check
finish
