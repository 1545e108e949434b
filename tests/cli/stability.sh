#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# The small edition of the stability chart: its tables, and what they must say.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
datasets=$tests/../datasets-synthetic

# value COLUMN SWEEP SEVERITY: of stability.csv.
value() {
    awk -F, -v column="$1" -v sweep="$2" -v severity="$3" '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == column) at = i }
        $1 == sweep && $3 == severity { print $at }' out/stability.csv
}

# below COLUMN SWEEP SEVERITY LIMIT
below() {
    got=$(value "$1" "$2" "$3")
    awk -v x="$got" -v limit="$4" 'BEGIN { exit !(x != "" && x + 0 <= limit + 0) }' ||
        fail "$2 at $3: $1 is '$got', more than $4"
}

flagged() {
    [ "$(value flagged "$1" "$2")" = "$(value cases "$1" "$2")" ] ||
        fail "$1 at $2: $(value flagged "$1" "$2") of $(value cases "$1" "$2") flagged"
}

small=$datasets/sweeps/rooms/small.json
expect 0 'trials' "$igi" chart stability --small --datasets "$datasets" --scenes "$small" \
    --cache rooms -o out
stdout '^unperturbed: '
stdout 'cases; silent failures: '
stdout '^| corrupted-images, upside-down images 1 of 12: photographs found by name | >= 100 % | 100 % | PASS |'
for file in cases.csv intervals.csv stability.csv stability.gp wanted.csv manifest.json; do
    [ -s "out/$file" ] || fail "out/$file is missing"
done
[ ! -e out/scratch ] || fail "left behind: out/scratch"

# What works goes on working, and what fails is said.
below albedo unperturbed 0 0.005
below albedo corrupted-images 1 0.006
flagged corrupted-images 1
flagged corrupted-images 3
below albedo clipped-highlights 32 0.006
flagged clipped-highlights 2
below albedo exposure-drift 0.01 0.012
flagged exposure-drift 0.2
below albedo exposure-drift 0.2 0.05
flagged misregistered-cameras 4
[ "$(value flagged unperturbed 0)" = 0 ] || fail "a sound room is doubted"
grep -q '^corrupted-images,1,.*image [0-9]*: contradicts' out/cases.csv ||
    fail "the corrupted image is not named"
grep -q '^<=0.01,0,1,"silent failures, of all cases"' out/wanted.csv || fail "wanted.csv: $(cat out/wanted.csv)"
grep -q '^unperturbed,0,"small.json",1,"floor",albedo 0,0.4[0-9]*,0.45,' out/intervals.csv ||
    fail "intervals.csv: $(head -3 out/intervals.csv)"
silent=$(awk -F, 'NR > 1 { n += $8 } END { print n }' out/stability.csv)
[ "$silent" = 0 ] || fail "silent failures: $silent"

# The same bytes for any number of threads.
expect 0 "" "$igi" chart stability -q --small --datasets "$datasets" --scenes "$small" \
    --cache rooms -o again -j 3 --sweeps clipped-highlights
grep -E '^(sweep|unperturbed|clipped-highlights),' out/cases.csv >few.csv
cmp -s few.csv again/cases.csv || fail "cases.csv: $(diff few.csv again/cases.csv)"

# A sweep is a file: another severity of another kind, without a line of code.
cat >mine.json <<'END'
{ "igi_sweep": 1, "name": "mine", "about": "a test", "axis": { "label": "stated times" },
  "base": ["small.json"], "perturb": { "kind": "light-power", "way": "area" }, "severities": [2] }
END
cp "$small" .
expect 0 "" "$igi" chart stability -q --small --cache rooms -o mine --sweeps mine.json
grep -q '^mine,2,' mine/cases.csv || fail "no such case: $(cat mine/cases.csv)"
sed 's/light-power/light-powder/' mine.json >wrong.json
expect 3 'wrong\.json:.*no perturbation is "light-powder"' "$igi" chart stability -q -o wrong \
    --sweeps wrong.json
expect 3 'nothing\.json' "$igi" chart stability -q -o wrong --sweeps nothing
expect 2 'there are speed, parsimony and stability' "$igi" chart sped -o wrong
[ ! -e wrong ] || fail "a failure leaves a folder"
finish
