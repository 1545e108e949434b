#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""igi's path tracer beside Mitsuba 3's, in one run: CPU seconds to the same error.

    python3 scripts/peers/render_speed.py SCENE [--samples N] [--igi build/release/igi]

SCENE is one that z_test.py takes (lambert; area, point, spot or directional lights). Each side
renders its first frame, on one thread; its error is the mean relative variance of a pixel, told
from independent batches; variance times CPU seconds does not depend on the number of paths, so its
ratio says how much longer one needs than the other. Loading and compiling are left out: a first
small picture is taken and subtracted. Needs mitsuba, numpy and OpenEXR from PyPI; the llvm variant
needs an LLVM that it gets on with (libllvm19 does; DRJIT_LIBLLVM_PATH names another).
"""
import argparse
import json
import os
import resource
import subprocess
import sys

import numpy as np

import z_test

BATCHES = 4  # as igi does


def cpu_seconds(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def relative_variance(mean, variance):
    bright = mean.mean(-1) > 1e-3 * mean.mean()  # a black pixel has no relative error
    return float(np.median((variance.mean(-1) / mean.mean(-1).clip(1e-12) ** 2)[bright]))


def measure_igi(options):
    begun = cpu_seconds(resource.RUSAGE_CHILDREN)
    z_test.render_igi(options.igi, options.scene, 0, BATCHES, threads=1)
    small = cpu_seconds(resource.RUSAGE_CHILDREN)
    mean, variance = z_test.render_igi(options.igi, options.scene, 0, options.samples, threads=1)
    seconds = cpu_seconds(resource.RUSAGE_CHILDREN) - small - (small - begun)
    paths = options.samples - BATCHES
    # what was subtracted had paths, too: the rest is that of `paths` alone
    return seconds / paths, relative_variance(mean, variance) * options.samples


def measure_mitsuba(variant, options):
    import mitsuba as mi
    mi.set_variant(variant)
    if variant.startswith("llvm"):
        import drjit
        drjit.set_thread_count(1)
    scene = z_test.mitsuba_scene(mi, options.scene, 0, "multijitter")
    each = max(1, options.samples // BATCHES)
    np.array(mi.render(scene, spp=each, seed=99))  # compiles what llvm compiles
    begun = cpu_seconds(resource.RUSAGE_SELF)
    stack = np.stack([np.array(mi.render(scene, spp=each, seed=n)) for n in range(BATCHES)])
    seconds = cpu_seconds(resource.RUSAGE_SELF) - begun
    variance = stack.var(0, ddof=1)
    return seconds / (each * BATCHES), relative_variance(stack.mean(0), variance) * each


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("--samples", type=int, default=128)
    parser.add_argument("--igi", default="build/release/igi")
    parser.add_argument("--variant", help="measure this variant of mitsuba alone")
    options = parser.parse_args()
    try:
        import mitsuba as mi
    except ImportError:
        print("skipped: no mitsuba (python3 -m pip install mitsuba)")
        return 77
    if hasattr(os, "sched_setaffinity"):  # one thread each, also where a variant has no say
        os.sched_setaffinity(0, {sorted(os.sched_getaffinity(0))[0]})
    if options.variant:
        print(json.dumps(measure_mitsuba(options.variant, options)))
        return 0
    rows = [("igi", *measure_igi(options))]
    for variant in ("scalar_rgb", "llvm_ad_rgb"):
        # a process each: an LLVM that is too old ends it
        done = subprocess.run([sys.executable, __file__, *sys.argv[1:], "--variant", variant],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            print(f"{variant}: not to be had here: {(done.stderr.strip() or 'it ended').splitlines()[0]}")
        else:
            rows.append((f"mitsuba {mi.__version__} {variant}", *json.loads(done.stdout.splitlines()[-1])))
    ours = rows[0][1] * rows[0][2]
    print("| renderer | CPU s a path per pixel | relative variance of one path | time to equal error |")
    print("| --- | ---: | ---: | ---: |")
    for name, seconds, variance in rows:
        print(f"| {name} | {seconds:.4f} | {variance:.3f} | {seconds * variance / ours:.2f} |")
    return 0 if all(s * v >= ours for _, s, v in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
