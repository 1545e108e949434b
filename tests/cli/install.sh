#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# What `cmake --install` puts down is enough for a program of somebody else's.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
! grep -q "^IGI_SANITIZE:STRING=." "$build/../CMakeCache.txt" ||
    skip "a sanitizer wants to be in the program that loads the library"
command -v pkg-config >/dev/null || skip "no pkg-config"
expect 0 "" cmake --install "$build/.." --prefix "$work/usr"
for file in bin/igi include/igi/igi.h share/man/man1/igi.1 \
    share/bash-completion/completions/igi share/doc/igi/FORMATS.md; do
    [ -s "usr/$file" ] || fail "$file is not installed"
done
PKG_CONFIG_PATH=$(dirname "$(find usr -name igi.pc)")
LD_LIBRARY_PATH=$(dirname "$(find usr -name 'libigi.so')")
export PKG_CONFIG_PATH LD_LIBRARY_PATH

cat >program.c <<'E2'
#include <igi/igi.h>
#include <stdio.h>
int main(int argc, char **argv)
{
    igi_context *ctx = NULL;
    igi_scene *scene = NULL;
    if (argc < 2 || igi_context_create(NULL, &ctx) != IGI_OK) return 1;
    igi_status status = igi_scene_load(ctx, argv[1], &scene);
    if (status != IGI_OK) fprintf(stderr, "%s\n", igi_context_message(ctx));
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    return (int)status;
}
E2
# shellcheck disable=SC2046 # flags are words
expect 0 "" cc -std=c11 -Wall -Wextra -Wpedantic -Werror program.c -o program \
    $(pkg-config --define-variable=prefix="$work/usr" --cflags --libs igi)
expect 3 'nowhere' ./program nowhere
expect 0 "" usr/bin/igi --version
for header in usr/include/igi/*.h; do # each stands by itself, in C and in C++
    printf '#include "%s"\nint x;\n' "$work/$header" >one.c
    cp one.c one.cc
    expect 0 "" cc -std=c11 -Wall -Wextra -Wpedantic -Werror -Iusr/include -c one.c
    expect 0 "" c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror -Iusr/include -c one.cc
done

# The completion lists commands and options.
bash -c '. usr/share/bash-completion/completions/igi; PATH=$PWD/usr/bin:$PATH
COMP_WORDS=(igi re) COMP_CWORD=1; _igi; echo "${COMPREPLY[@]}"
COMP_WORDS=(igi recover --th) COMP_CWORD=2; _igi; echo "${COMPREPLY[@]}"' >completed 2>&1
grep -q '^register recover report relight$' completed || fail "completion: $(cat completed)"
grep -q '^--threads$' completed || fail "completion: $(cat completed)"
finish
