#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Help, versions, and mistakes on the command line.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

expect 0 "" "$igi"
stdout '^usage: igi COMMAND'
[ "$(wc -l <"$out")" -le 23 ] || fail "igi alone says more than a screen"
cp "$out" overview
expect 0 "" "$igi" help
cmp -s overview "$out" || fail "igi and igi help differ"
expect 0 "" "$igi" --help
expect 0 "" "$igi" -h
expect 0 "" "$igi" --version
stdout '^igi [0-9]+\.[0-9]+\.[0-9]+$'

for command in $("$igi" | sed -n 's/^  igi \([a-z]*\) .*/\1/p'); do
    expect 0 "" "$igi" help "$command"
    stdout "^usage: igi $command"
    stdout '^example: igi'
    stdout '--threads N .*\[0\]'
    [ "$(sed -n '/^options:/,$p' "$out" | wc -L)" -le 92 ] || fail "help $command: long lines"
    cp "$out" help
    expect 0 "" "$igi" "$command" --help
    cmp -s help "$out" || fail "help $command and $command --help differ"
    expect 0 "" "$igi" "$command" -h
    expect 2 'there is no such option; see igi help' "$igi" "$command" --no-such-thing
done

expect 2 "did you mean 'recover'" "$igi" recovr
expect 2 'there is no such command' "$igi" frobnicate
expect 2 'there is no such command' "$igi" help frobnicate
expect 2 'did you mean --json' "$igi" recover --jsn x
expect 2 'did you mean --threads' "$igi" recover --thread=2 x
expect 2 'there is no such option' "$igi" recover -x
expect 2 'there is no such option' "$igi" report --method a b
expect 2 'its value is missing: N' "$igi" recover x --threads
expect 2 'takes no value' "$igi" recover x --json=yes
expect 2 "--threads 'two'.*must be a number" "$igi" recover x --threads two
expect 2 'must be a whole number' "$igi" recover x -j 1.5
expect 2 'out of range: N from 0 to 256' "$igi" recover x -j999
expect 2 'must be a number' "$igi" recover x --target-error nan
expect 2 'out of range' "$igi" recover x --seed -1
expect 2 'must be one of patches' "$igi" recover x --method guess
expect 2 'must be one of' "$igi" recover x --method patch
expect 2 '0 arguments given, 1 needed' "$igi" recover
expect 2 '2 arguments given, 1 needed' "$igi" recover a b
expect 2 'where to\?' "$igi" recover x
expect 2 '--gather-from photos is for --method gather' "$igi" recover x -n --gather-from photos
expect 2 '--form-factors is for --method radiosity' "$igi" recover x -n --form-factors closed
expect 2 'against what\?' "$igi" validate x
[ "$(wc -l <"$err")" -eq 1 ] || fail "a mistake is told twice: $(cat "$err")"
expect 2 "did you mean 'speed'" "$igi" chart sped -o x

# Where the input is wrong: status 3, the file, and nothing written.
mkdir empty
expect 3 'nowhere' "$igi" recover nowhere -o out
expect 3 'empty: no scene\.json in it' "$igi" recover -o out empty
expect 3 'materials\.json' "$igi" validate empty --truth empty
expect 3 'materials\.json' "$igi" report empty
mkdir result && echo '{}' >result/materials.json
expect 3 "result: is a result of igi recover; give the scene's folder" "$igi" check result
echo '{ "igi": 1 }' >no_spec.json
expect 3 'no_spec\.json: no spec of a room' "$igi" synth no_spec.json -o out
echo '{ "igi": 1, "mesch": "x" }' >empty/scene.json
expect 3 'empty/scene\.json:1: .*mesch' "$igi" recover empty -o out
expect 3 'scene\.json' "$igi" recover empty -n
for left in out*; do
    [ "$left" = out ] || [ "$left" = "out*" ] || fail "left behind: $left"
done
[ "$(cat "$out")" = "" ] || fail "words on stdout of a failure"

# A result that cannot be delivered is no success.
if [ -w /dev/full ]; then
    "$igi" help >/dev/full 2>/dev/null && fail "a full disk under stdout goes unnoticed"
fi
finish
