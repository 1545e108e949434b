#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# igi chart speed, its small edition: two methods with two budgets on a tiny room.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
spec=$tests/cli/mini.json

# column NAME FILE: its number; value METHOD NAME: of the method's last line in speed.csv.
column() {
    head -n 1 "$2" | tr , '\n' | grep -nx "$1" | cut -d: -f1
}
value() {
    grep "^mini,$1," charts/speed.csv | tail -n 1 | cut -d, -f"$(column "$2" charts/speed.csv)"
}
cat >peers.csv <<'END'
peer,run,scene,step,cpu_s,albedo_mean,specular,alpha,texels
other,a,mini,1,1,0.5,,,0.5
other,a,mini,2,2,0.01,,,0.2
other,a,mini,3,3,0.2,,,0.3
other,b,mini,1,4,0.1,,,0.25
END

expect 0 'speed' "$igi" chart speed --small --scenes "$spec" --peer peers.csv --cache rooms -o charts
[ "$(head -n 1 charts/speed.csv)" = "scene,method,patch_m,rays_each,target,photographs,\
albedo_mean,albedo_max,specular,alpha,texels,relit,models_right,models,parameters,rays,cpu_s,ratio,peak_mb,front" ] ||
    fail "columns: $(head -n 1 charts/speed.csv)"
[ "$(grep -c '^mini,patches,' charts/speed.csv)" -eq 2 ] || fail "not two rungs of patches"
[ "$(grep -c '^mini,direct,' charts/speed.csv)" -eq 2 ] || fail "not two rungs of direct"
for figure in albedo_mean albedo_max texels; do
    awk -v a="$(value patches $figure)" -v b="$(value direct $figure)" \
        'BEGIN { exit !(a > 0 && 10 * a < b) }' ||
        fail "$figure: patches $(value patches $figure), direct $(value direct $figure)"
done
for figure in rays parameters; do
    [ "$(value patches $figure)" -gt 0 ] || fail "no $figure"
done
awk -F, -v f="$(column front charts/speed.csv)" '$f == 1 && $2 == "patches"' charts/speed.csv |
    grep -q . || fail "patches are not on the front"

# A peer counts from when its error stays below: the best run of each time.
[ "$(cut -d, -f3,7 charts/peers.csv | tr '\n' ' ')" = \
    "albedo_mean,cpu_s 0.5,1.000 0.2,2.000 0.1,4.000 " ] ||
    fail "peers.csv: $(cat charts/peers.csv)"

# When an error is reached: at once, and by the peer at 4 s, never at 1 %.
grep -qE '^mini,0\.1,(patches|radiosity),0\.[0-9]+,other,4,[0-9.]+$' charts/reach.csv ||
    fail "reach.csv: $(cat charts/reach.csv)"
grep -qE '^mini,0\.01,patches,0\.[0-9]+,other,,$' charts/reach.csv ||
    fail "reach.csv: $(cat charts/reach.csv)"

# Each map in fewer and fewer texels, down to one albedo a region: with it the texture is lost.
size=$(column map_size charts/parsimony.csv)
error=$(column error charts/parsimony.csv)
awk -F, -v s="$size" -v e="$error" '$2 == "auto" { if ($4 == 1) best = $e; if ($s == 0) plain = $e }
    END { exit !(best > 0 && 3 * best < plain) }' charts/parsimony.csv ||
    fail "parsimony.csv: $(cat charts/parsimony.csv)"

# By itself it is the same; maps on every region are more parameters, and no better.
expect 0 'parsimony' "$igi" chart parsimony --small --scenes "$spec" --cache rooms -o spare
stdout 'spare/parsimony\.png'
cmp charts/parsimony.csv spare/parsimony.csv || fail "chart parsimony differs from chart speed's"
count=$(column parameters charts/parsimony.csv)
awk -F, -v c="$count" -v e="$error" '$4 == 1 { n = $c; best = $e }
    $2 == "maps" && !all { all = $c; worst = $e } END { exit !(all > n && worst > .9 * best) }' \
    charts/parsimony.csv || fail "parsimony.csv: $(cat charts/parsimony.csv)"

if command -v gnuplot >/dev/null; then
    for picture in speed parsimony; do
        grep -q '</svg>' charts/$picture.svg || fail "$picture.svg is no picture"
        [ -s charts/$picture.png ] || fail "no $picture.png"
    done
    grep -q 'direct' charts/speed.svg || fail "curves without names"
fi

# The same figures every time, but for the last four columns; and without gnuplot, no pictures.
columns=1-14
mkdir empty
expect 0 'gnuplot: not found' env PATH="$work/empty" "$igi" chart speed --small --scenes "$spec" \
    --cache rooms -o again
[ -s again/speed.gp ] || fail "no script"
[ ! -e again/speed.svg ] || fail "a picture without gnuplot"
cut -d, -f$columns charts/speed.csv >one
cut -d, -f$columns again/speed.csv >two
cmp one two || fail "other figures in the second run"
cmp charts/parsimony.csv again/parsimony.csv || fail "other parameters in the second run"

echo 'peer,run,scene,cpu_s' >short.csv
expect 3 'short\.csv:1: no column albedo_mean' "$igi" chart speed --small --scenes "$spec" \
    --peer short.csv -o none
printf 'peer,run,scene,cpu_s,albedo_mean,specular,alpha,texels\nx,a,mini,soon,1,,,\n' >bad.csv
expect 3 "bad\.csv:2: cpu_s 'soon'" "$igi" chart speed --small --scenes "$spec" --peer bad.csv -o none
expect 3 'nowhere' "$igi" chart speed --scenes nowhere.json -o none
[ ! -e none ] || fail "a folder after a failure"
finish
