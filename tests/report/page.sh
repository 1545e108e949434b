#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# The page in a browser: no console message, no request, every image decoded, headings that sort.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

"$build/test_report" page >log 2>&1 || fail "the page was not made: $(tail -n 3 log)"
page=$work/report_test/report.html

browse "$page"
images=$(grep -c '<img ' "$page")
count=$(grep -o '<img ' "$page" | wc -l)
[ "$count" -ge 16 ] || fail "only $count images ($images lines)"
grep -q "data-images=\"$count/$count\"" dom ||
    fail "images decoded: $(grep -o 'data-images="[^"]*"' dom), not $count"
grep -q 'data-errors="0"' dom || fail "errors: $(grep -o 'data-errors="[^"]*"' dom)"
grep -qE '(src|href)="?(https?:)?//' "$page" && fail "the page asks for something outside"

grep -q 'alt=""' "$page" && fail "a picture without words"
grep -q 'alt="albedo of a &amp; ' "$page" || fail "a map's picture does not name its region"

# Every link within the page leads somewhere, of a result without comparisons and lights too.
links() {
    for id in $(grep -o 'href="#[a-z]*"' "$1" | grep -o '[a-z]*"$' | tr -d '"'); do
        grep -q "id=\"$id\"" "$1" || fail "$1: #$id leads nowhere"
    done
}
links "$page"
grep -q 'href="#views"' "$page" || fail "the contents lack the photographs"
cp -r "$work/report_test" bare
rm -rf bare/comparison bare/evidence.json bare/manifest.json
expect 0 "" "$igi" report -q bare
links bare/report.html
grep -q 'href="#views"' bare/report.html && fail "the contents name photographs that are not there"

# A click on "observed" sorts by it; a broken image is noticed.
sed 's|</body>|<script>onload=()=>{const b=[...document.querySelectorAll("th button")]\
.find(b=>b.textContent=="observed");b.click();\
document.body.dataset.order=[...document.querySelectorAll("tbody")[0].rows]\
.map(r=>r.cells[1].firstChild.textContent).join("\|")}</script></body>|' "$page" >sorted.html
browse "$work/sorted.html"
grep -q 'data-order="w.*nd|' dom || fail "order: $(grep -o 'data-order="[^"]*"' dom)"
sed 's|iVBORw0KGgo|iVBORw0KGxx|' "$page" >broken.html
browse "$work/broken.html"
grep -q "data-images=\"$count/$count\"" dom && fail "a broken image goes unnoticed"
finish
