#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# format.sh [--check]: clang-format 14 over every C source (another version formats otherwise).
set -eu
cd "$(dirname "$0")/.."
tool=$(command -v clang-format-14 || command -v clang-format) || {
    echo "format: clang-format 14 is missing; scripts/setup installs it" >&2
    exit 4
}
case $("$tool" --version) in
*" version 14."*) ;;
*) echo "format: $tool is not version 14" >&2; exit 4 ;;
esac
files=$(find include src tests -name '*.[ch]' -o -name '*.cc' | sort)
if [ "${1:-}" = "--check" ]; then
    # shellcheck disable=SC2086 # names have no blanks
    "$tool" --dry-run --Werror $files >/dev/null 2>&1 && exit 0
    for file in $files; do
        "$tool" --dry-run --Werror "$file" >/dev/null 2>&1 || echo "$file: run scripts/format.sh" >&2
    done
    exit 1
fi
# shellcheck disable=SC2086
"$tool" -i $files
