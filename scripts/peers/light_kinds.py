#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""igi's path tracer against Mitsuba 3 for every kind of source: z_test.py's test, a row a kind.

    python3 scripts/peers/light_kinds.py [--samples N] [--igi build/release/igi]

A small open scene (two walls, two boxes, a lamp) is written, lit by one kind after the other. What
Mitsuba lacks is said to it in what it has: a line as 256 points, a rotationally symmetric IES profile
as a spot with a texture, an environment map with each of its pixels repeated (Mitsuba interpolates,
igi does not), a sky as the map that igi's own pictures of it give. Exit status 1 when a kind has
fewer than 99.75 % of pixels that pass. Needs mitsuba, numpy and OpenEXR from PyPI.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy as np
import OpenEXR

import z_test

BOXES = {"low": ([.4, -.6, 0], [1.1, .1, .5]), "high": ([-.9, .1, 0], [-.3, .7, 1.2])}
# walls so large that no sky is seen past them: at its pixels' edges Mitsuba interpolates
QUADS = {"floor": [[-2, -6, 0], [6, -6, 0], [6, 2, 0], [-2, 2, 0]],
         "wall": [[-2, 2, 0], [6, 2, 0], [6, 2, 3], [-2, 2, 3]],
         "side": [[-2, -6, 0], [-2, 2, 0], [-2, 2, 3], [-2, -6, 3]],
         "lamp": [[.2, .2, 2.2], [.2, .8, 2.2], [.9, .8, 2.2], [.9, .2, 2.2]]}
ALBEDOS = {"floor": [.6, .5, .4], "wall": [.7, .7, .6], "side": [.2, .5, .6], "low": [.6, .3, .2],
           "high": [.4, .45, .5]}
PROFILE = [(0, 100), (15, 90), (30, 120), (45, 60), (55, 0), (90, 0)]  # degrees from down, candela
DOWN_AT = [.3, -.2, 1.9]
MAP = (16, 8)


def lights(folder):
    """The kinds, as scene.json has them."""
    rng = np.random.default_rng(1)
    sky = rng.uniform(.05, .4, (MAP[1], MAP[0], 3)).astype(np.float32)
    sky[2, 5] = [20, 18, 15]
    OpenEXR.File({}, {"RGB": sky}).write(os.path.join(folder, "map.exr"))
    with open(os.path.join(folder, "lamp.ies"), "w", encoding="ascii") as file:
        file.write(f"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 {len(PROFILE)} 1 1 2 0 0 0\n1 1 10\n")
        file.write(" ".join(str(a) for a, _ in PROFILE) + "\n0\n")
        file.write(" ".join(str(c) for _, c in PROFILE) + "\n")
    return [{"type": "area", "region": "lamp", "radiance": [9, 8, 6]},
            {"type": "point", "position": [.2, .4, 1.8], "intensity": [3, 2, 2]},
            {"type": "spot", "position": [-.2, -1.2, 1.9], "direction": [.2, .9, -1],
             "intensity": [9, 9, 8], "cutoff_deg": 40, "beam_deg": 25},
            {"type": "line", "from": [-1, -.5, 1.7], "to": [1, .2, 1.9], "intensity": [1, 2, 1.5]},
            {"type": "directional", "direction": [-.5, .4, -1], "irradiance": [2, 2, 1.8]},
            {"type": "goniometric", "position": DOWN_AT, "profile": "lamp.ies", "scale": .05},
            {"type": "env", "image": "map.exr", "rotation_deg": 0, "scale": 1},
            {"type": "sky", "sun_elevation_deg": 40, "sun_azimuth_deg": 100, "turbidity": 3,
             "cloudiness": 1, "scale": 1},
            {"type": "ambient", "radiance": [.3, .4, .5]}]


def write_mesh(path):
    faces = dict(QUADS)
    corners, quads = [], []
    for name, (low, high) in BOXES.items():
        ends = [low, high]
        for axis in range(3):
            for side in range(2):
                a, b = (axis + 1) % 3, (axis + 2) % 3
                quad = []
                for i, k in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    p = [0, 0, 0]
                    p[axis], p[a], p[b] = ends[side][axis], ends[i][a], ends[k][b]
                    quad.append(p)
                quads.append((name, quad if side else quad[::-1]))
    quads += list(faces.items())
    with open(path, "w", encoding="ascii") as file:
        for name, quad in sorted(quads, key=lambda q: q[0]):
            file.write(f"usemtl {name}\n")
            for p in quad:
                file.write("v {} {} {}\n".format(*p))
            n = len(corners)
            corners += quad
            file.write(f"f {n + 1} {n + 2} {n + 3} {n + 4}\n")


def look_at(eye, target, up=(0, 0, 1)):
    back = np.subtract(eye, target) / np.linalg.norm(np.subtract(eye, target))
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, np.cross(back, right), back, eye
    return matrix.tolist()


def save(data, *path):
    with open(os.path.join(*path), "w", encoding="utf-8") as file:
        json.dump(data, file)


def write_scene(folder, light):
    """A scene folder with its truth, as igi and z_test read it."""
    os.makedirs(os.path.join(folder, "truth"), exist_ok=True)
    regions = {name: {"model": "lambert", "albedo": albedo, "specular": 0.0} for name, albedo in ALBEDOS.items()}
    regions["lamp"] = {"model": "lambert", "albedo": [0, 0, 0], "specular": 0.0, "emitter": True}
    save({"regions": regions, "lights": [light]}, folder, "truth", "truth.json")
    save({"igi": 1, "name": "kinds", "mesh": "scene.obj", "cameras": "transforms.json",
          "lights": [light], "regions": {"lamp": {"emitter": True}}}, folder, "scene.json")
    save({"camera_model": "OPENCV", "w": 64, "h": 48, "fl_x": 50, "fl_y": 50, "cx": 32, "cy": 24,
          "frames": [{"file_path": "images/0000.exr",
                      "transform_matrix": look_at([1.7, -3.2, 1.6], [0, .4, .6])}]},
         folder, "transforms.json")
    write_mesh(os.path.join(folder, "scene.obj"))


def map_of_sky(igi, folder, size=512):
    """What igi's cameras see of the sky, turned to the six sides, as a latitude-longitude map."""
    sides = [([1, 0, 0], [0, 0, 1]), ([-1, 0, 0], [0, 0, 1]), ([0, 1, 0], [0, 0, 1]),
             ([0, -1, 0], [0, 0, 1]), ([0, 0, 1], [0, 1, 0]), ([0, 0, -1], [0, 1, 0])]
    frames = [{"file_path": f"images/{n}.exr", "transform_matrix": look_at([0, 0, 50], np.add([0, 0, 50], d), up)}
              for n, (d, up) in enumerate(sides)]
    save({"camera_model": "OPENCV", "w": size, "h": size, "fl_x": size / 2, "fl_y": size / 2,
          "cx": size / 2, "cy": size / 2, "frames": frames}, folder, "sides.json")
    out = os.path.join(folder, "sides")
    subprocess.run([igi, "relight", os.path.join(folder, "truth"), "--cameras",
                    os.path.join(folder, "sides.json"), "--samples", "1", "-q", "-o", out], check=True)
    rows, columns = np.mgrid[0:size, 0:2 * size]
    theta, phi = math.pi * (rows + .5) / size, math.pi - 2 * math.pi * (columns + .5) / (2 * size)
    d = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    result = np.zeros((size, 2 * size, 3), np.float32)
    for n, frame in enumerate(frames):
        local = d @ np.array(frame["transform_matrix"])[:3, :3]
        x, y = local[..., 0] / -local[..., 2], local[..., 1] / -local[..., 2]
        inside = (local[..., 2] < 0) & (abs(x) <= 1) & (abs(y) <= 1)
        at = lambda t: np.clip(((t + 1) * size / 2).astype(int), 0, size - 1)
        picture = z_test.read_exr(os.path.join(out, f"{n}.exr"))
        result[inside] = picture[at(-y[inside]), at(x[inside])]
    return result


def environment(mi, texels):
    # igi: the middle column is +X, +Z up; Mitsuba: the middle column is +Z, +Y up
    turn = [[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    return {"type": "envmap", "bitmap": mi.Bitmap(texels), "to_world": mi.ScalarTransform4f(turn)}


def profile_spot(mi, scale, size=1024, cutoff=60):
    """The profile as the texture of a spot that looks down; scalar, so grey."""
    edge = math.tan(math.radians(cutoff))
    at = (np.arange(size) + .5) / size * 2 - 1
    angle = np.degrees(np.arctan(edge * np.hypot(at[:, None], at[None, :])))
    candela = np.interp(angle, *zip(*PROFILE)).astype(np.float32)
    transform = mi.ScalarTransform4f().look_at(origin=DOWN_AT, target=[*DOWN_AT[:2], 0], up=[0, 1, 0])
    return {"type": "spot", "to_world": transform, "cutoff_angle": cutoff, "beam_width": cutoff - .01,
            "intensity": {"type": "rgb", "value": scale},
            "texture": {"type": "bitmap", "raw": True, "bitmap": mi.Bitmap(np.repeat(candela[..., None], 3, 2)),
                        "wrap_mode": "clamp"}}


def peers_of(mi, light, folder, igi):
    """The light in Mitsuba's words; None: z_test.py knows it."""
    kind = light["type"]
    if kind == "ambient":
        return [{"type": "constant", "radiance": {"type": "rgb", "value": light["radiance"]}}]
    if kind == "env":
        fine = z_test.read_exr(os.path.join(folder, "map.exr")).astype(np.float32)
        return [environment(mi, fine.repeat(64, 0).repeat(64, 1))]
    if kind == "sky":
        return [environment(mi, map_of_sky(igi, folder))]
    if kind == "goniometric":
        return [profile_spot(mi, light["scale"])]
    if kind == "line":
        a, b, count = np.array(light["from"]), np.array(light["to"]), 256
        power = (np.array(light["intensity"]) * np.linalg.norm(b - a) / count).tolist()
        return [{"type": "point", "position": (a + (b - a) * (k + .5) / count).tolist(),
                 "intensity": {"type": "rgb", "value": power}} for k in range(count)]
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--igi", default="build/release/igi")
    parser.add_argument("--kind", help="this alone")
    options = parser.parse_args()
    try:
        import mitsuba as mi
    except ImportError:
        print("skipped: no mitsuba (python3 -m pip install mitsuba)")
        return 77
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    failed = False
    print("| light | pixels that pass | mean of z | standard deviation of z | ratio of means |")
    print("| --- | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as folder:
        for light in lights(folder):
            if options.kind and options.kind != light["type"]:
                continue
            write_scene(folder, light)
            ours = z_test.render_igi(options.igi, folder, 0, options.samples)
            scene = z_test.mitsuba_scene(mi, folder, 0, lights=peers_of(mi, light, folder, options.igi))
            row = z_test.judge(*ours, *z_test.render_mitsuba(mi, scene, options.samples))
            failed |= row["passed"] < .9975
            print(f"| {light['type']} | {100 * row['passed']:.3f} % | {row['mean']:+.3f} | "
                  f"{row['deviation']:.3f} | {row['ratio']:.5f} |", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
