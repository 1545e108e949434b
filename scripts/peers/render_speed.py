#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""igi's path tracer beside Mitsuba 3's, in one run: paths a second, and CPU seconds to the same error.

    python3 scripts/peers/render_speed.py SCENE [--samples N] [--igi build/release/igi]

SCENE is one that z_test.py takes. Each side renders its first frame on one thread, REPEATS times
with other seeds; its error is the mean over pixels of the variance between these pictures over the
squared pixel (with 1 % of the mean pixel's square, as relative errors are told in the field), the
same for both sides whatever their samplers do. Variance times CPU seconds does not depend on the
number of paths, so its ratio says how much longer one needs than the other. A path is one from the
camera to its end, whatever rays it takes (Mitsuba does not count rays). Loading and compiling
are left out: the smallest picture is taken and subtracted; what igi prepares before a larger picture
counts. Mitsuba has its best sampler here (multijitter; of `independent` it needs more). Needs
mitsuba, numpy and OpenEXR from PyPI; the llvm variant needs LLVM 17 or newer (Debian: libllvm19).
"""
import argparse
import json
import os
import resource
import subprocess
import sys

import numpy as np

import mitsuba_prb as prb
import z_test

REPEATS = 6


def cpu_seconds(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def relative_variance(pictures):
    """Of one picture, from several."""
    stack = np.stack(pictures)
    mean, variance = stack.mean(0).mean(-1), stack.var(0, ddof=1).mean(-1)
    return float((variance / (mean ** 2 + .01 * mean.mean() ** 2)).mean())


def measure_igi(options):
    def take(samples, seed):
        begun = cpu_seconds(resource.RUSAGE_CHILDREN)
        picture, _ = z_test.render_igi(options.igi, options.scene, 0, samples, threads=1, seed=seed)
        return picture, cpu_seconds(resource.RUSAGE_CHILDREN) - begun
    load = min(take(1, 1)[1] for _ in range(3))
    taken = [take(options.samples, seed) for seed in range(1, REPEATS + 1)]
    seconds = sum(t for _, t in taken) / REPEATS - load
    return seconds, relative_variance([p for p, _ in taken]), taken[0][0].shape[0] * taken[0][0].shape[1]


def measure_mitsuba(variant, options):
    import mitsuba as mi
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)  # or a bar runs through the answer
    if variant.startswith("llvm"):
        import drjit
        drjit.set_thread_count(1)
    scene = z_test.mitsuba_scene(mi, options.scene, 0, "multijitter")
    np.array(mi.render(scene, spp=options.samples, seed=99))  # compiles what llvm compiles
    begun = cpu_seconds(resource.RUSAGE_SELF)
    pictures = [np.array(mi.render(scene, spp=options.samples, seed=n)) for n in range(REPEATS)]
    seconds = (cpu_seconds(resource.RUSAGE_SELF) - begun) / REPEATS
    return seconds, relative_variance(pictures), pictures[0].shape[0] * pictures[0].shape[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("--samples", type=int, default=64, help="a square")
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
    prb.find_llvm()
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
    print(f"| renderer | CPU s at {options.samples} paths a pixel | million paths a CPU s | relative variance | "
          "time to equal error |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for name, seconds, variance, pixels in rows:
        print(f"| {name} | {seconds:.2f} | {pixels * options.samples / seconds / 1e6:.2f} | {variance:.5f} | "
              f"{seconds * variance / ours:.2f} |")
    return 0 if all(row[1] * row[2] >= ours for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
