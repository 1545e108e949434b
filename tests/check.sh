# SPDX-License-Identifier: Apache-2.0
#
# For tests that are scripts: each is called with the program's path as $1 and the build's tests
# folder as $2, and works in an empty folder of its own.
# shellcheck shell=sh disable=SC2034
set -u
igi=$1
build=$2
tests=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
out=$work/.out
err=$work/.err
trap 'chmod -R u+rwx "$work" 2>/dev/null; rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail() {
    echo "FAIL: $*"
    failures=$((failures + 1))
}

# expect STATUS PATTERN COMMAND...: the exit status, and an extended regular expression that the
# command's stderr matches ("" : stderr is empty). stdout is left in $out, stderr in $err.
expect() {
    want=$1 pattern=$2
    shift 2
    "$@" >"$out" 2>"$err" </dev/null
    got=$?
    [ "$got" -eq "$want" ] || fail "exit status $got, not $want: $*: $(head -n 3 "$err")"
    if [ -z "$pattern" ]; then
        [ ! -s "$err" ] || fail "words on stderr: $*: $(head -n 3 "$err")"
    else
        grep -qE -e "$pattern" "$err" || fail "stderr lacks '$pattern': $*: $(cat "$err")"
    fi
}

# stdout PATTERN: the last command's stdout matches.
stdout() {
    grep -qE -e "$1" "$out" || fail "stdout lacks '$1': $(head -n 5 "$out")"
}

# browse PAGE: the document that a browser makes of it, in `dom`. Its console must be silent.
# Without a browser the test ends here.
browse() {
    browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
        [ "$failures" -eq 0 ] && skip "no chromium"
        finish
    }
    "$browser" --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run \
        --user-data-dir="$work/profile" --enable-logging=stderr --virtual-time-budget=8000 \
        --dump-dom "file://$1" >dom 2>console || fail "the browser failed: $(tail -n 3 console)"
    grep CONSOLE console && fail "the console of $1 is not silent"
}

skip() {
    echo "skipped: $*"
    exit 77
}

finish() {
    [ "$failures" -eq 0 ] || exit 1
    echo "ok"
    exit 0
}
