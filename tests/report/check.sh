#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# The page of igi check: a card with a picture for each assumption, in a browser without a word on
# the console, every picture decoded, nothing asked for from outside.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 '' "$igi" synth -q "$tests/cli/mini.json" -o room
expect 0 '' "$igi" check -q -j 1 room -o one
expect 0 'pictures' "$igi" check -j 3 room -o three
stdout '^three/check.html: written'
cmp -s one/check.html three/check.html || fail "threads change the page"
page=$work/one/check.html
[ "$(grep -o 'class="card assumption"' "$page" | wc -l)" -eq 12 ] || fail "not twelve assumptions"
for words in 'id="view-A"' 'What to do:' 'Photographs to add' 'href="#registered"' '>panel<'; do
    grep -q "$words" "$page" || fail "the page lacks $words"
done
grep -qE '(src|href)="?(https?:)?//' "$page" && fail "the page asks for something outside"

# A lamp that is six times as bright as given: the worst comes first, and the status says it.
tr -d '\n' <room/scene.json | sed 's/"radiance": *\[[^]]*\]/"radiance": [1, 1, 1]/' >dim.json
cp -r room dim && cp dim.json dim/scene.json
expect 1 'leave its radiance out' "$igi" check -q dim -o dim.out
grep -o 'class="card assumption" id="[a-z]*"' dim.out/check.html | head -n 1 | grep -q 'lights' ||
    fail "what fails does not come first"

mkdir mine && echo hello >mine/file
expect 4 'mine' "$igi" check -q room -o mine
expect 0 '' "$igi" check -q -f room -o mine
expect 2 'holds the input' "$igi" check -q -f room -o room

browse "$page"
count=$(grep -o '<img ' "$page" | wc -l)
[ "$count" -ge 20 ] || fail "only $count pictures"
grep -q "data-images=\"$count/$count\"" dom ||
    fail "images decoded: $(grep -o 'data-images="[^"]*"' dom), not $count"
grep -q 'data-errors="0"' dom || fail "errors: $(grep -o 'data-errors="[^"]*"' dom)"
finish
