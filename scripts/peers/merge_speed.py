#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""igi merge beside OpenCV's merging: CPU seconds and memory, each in a process of its own.

usage: scripts/peers/merge_speed.py [--quick] LIST|IMAGE...

LIST, IMAGE: 8-bit photographs with EXIF, or a list of them. Both read the files, recover the response
and merge on one thread; OpenCV (Python's cv2) by Debevec, and by Robertson, which takes fifteen times
as long (--quick: without). Memory is the most that was resident, in bytes a pixel, and what of it goes
beyond the result (igi's: radiance, variances, a mask; OpenCV's: radiance) for each exposure.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parent.parent.parent
igi = root / "build/release/igi"
PEER = """
import cv2, sys, numpy as np
cv2.setNumThreads(1)
way, out, times = sys.argv[1], sys.argv[2], [float(t) for t in sys.argv[3].split(",")]
times = np.array(times, np.float32)
images = [cv2.imread(path) for path in sys.argv[4:]]
curve = getattr(cv2, "createCalibrate" + way)().process(images, times)
cv2.imwrite(out, getattr(cv2, "createMerge" + way)().process(images, times, curve))
"""


def measure(command):
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        sys.exit(f"failed: {' '.join(map(str, command[:4]))} ...")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    import json
    arguments = [a for a in sys.argv[1:] if a != "--quick"]
    ways = ("Debevec",) if "--quick" in sys.argv else ("Debevec", "Robertson")
    source = ["--list", arguments[0]] if arguments[0].endswith(".txt") else arguments
    with tempfile.TemporaryDirectory() as folder:
        ours = [igi, "merge", *source, "-o", f"{folder}/a.exr", "--response", "recovered", "-q",
                "--threads", "1"]
        said = json.loads(subprocess.run([*map(str, ours), "--json"], capture_output=True,
                                         text=True, check=True).stdout)
        pixels = said["width"] * said["height"]
        files = [e["file"] for e in said["exposures"]]
        times = ",".join(str(e["stated"]) for e in said["exposures"])
        rows = [("igi", 7 * 4, *measure([*map(str, ours)]))]
        for way in ways:
            rows.append((f"OpenCV, {way}", 3 * 4, *measure(
                [sys.executable, "-c", PEER, way, f"{folder}/b.hdr", times, *files])))
    print(f"{len(files)} photographs of {pixels / 1e6:.2f} million pixels")
    print("| | CPU s | of igi's | MB | bytes a pixel | beyond the result, a pixel and exposure |\n"
          "| --- | ---: | ---: | ---: | ---: | ---: |")
    for name, result, cpu, memory in rows:
        beyond = (memory / pixels - result) / len(files)
        print(f"| {name} | {cpu:.2f} | {cpu / rows[0][2]:.2f} | {memory / 1e6:.0f} |"
              f" {memory / pixels:.1f} | {beyond:.1f} |")


main()
