#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# check_exports.sh BUILD: what the shared library exports is what include/ marks IGI_API, no more
# and no less.
set -eu
cd "$(dirname "$0")/.."
build=${1:-build/release}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

nm -D --defined-only "$build/libigi.so" | awk '$2 ~ /[TDBR]/ {print $3}' | sort >"$work/exported"
# A declaration may run over lines: the name is the word before the first parenthesis or semicolon.
cat include/igi/*.h | grep -v '^#define' | tr '\n' ' ' | grep -oE '(^|[^E]) IGI_API [^;(]*[(;]' |
    grep -oE '[a-z_0-9]+ *[(;]$' | tr -d ' (;' | sort -u >"$work/declared"
if ! diff "$work/declared" "$work/exported" >"$work/difference"; then
    echo "exports: < declared IGI_API in include/ but not exported; > exported but not declared:" >&2
    cat "$work/difference" >&2
    exit 1
fi
