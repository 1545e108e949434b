#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# A little of scripts/fuzz: broken files never crash, hang, or pass with a NaN.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
"$tests/../scripts/fuzz" --igi "$igi" --runs 8 --keep kept >log 2>&1 || fail "$(grep -v ' runs, ' log)"
[ "$(grep -c ' runs, ' log)" -ge 16 ] || fail "kinds of files are missing: $(cat log)"
finish
