#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""igi's path tracer against Mitsuba 3 on the same scene: a Z-test of every pixel.

    python3 scripts/peers/z_test.py SCENE [--frame N] [--samples N] [--igi build/release/igi]

SCENE is a folder with truth (as `igi synth` writes it) whose materials are lambert and whose lights are
area, point, spot or directional: what Mitsuba has under the same definition (light_kinds.py goes
through all kinds). Needs mitsuba, numpy and
OpenEXR from PyPI. Both sides give a mean and the variance of that mean; a pixel passes when the
difference, in units of its standard deviation, is below the two-sided threshold of significance
.01 after Sidak's correction for the number of tests. Exit status 1 when fewer than 99.75 % pass.
"""
import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

import numpy as np
import OpenEXR


def read_exr(path):
    channels = OpenEXR.File(path).channels()
    if "RGB" in channels:
        return channels["RGB"].pixels.astype(np.float64)
    return np.stack([channels[name].pixels for name in "RGB"], -1).astype(np.float64)


def read_obj(path):
    """Positions, texture coordinates and, for each region, its corners (v, vt)."""
    positions, uvs, regions, faces = [], [], {}, None
    with open(path, encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                positions.append([float(w) for w in words[1:4]])
            elif words[0] == "vt":
                uvs.append([float(w) for w in words[1:3]])
            elif words[0] == "usemtl":
                faces = regions.setdefault(words[1], [])
            elif words[0] == "f":
                corners = [[int(n) if n else 0 for n in (w + "/").split("/")[:2]] for w in words[1:]]
                for k in range(1, len(corners) - 1):
                    faces.append([corners[0], corners[k], corners[k + 1]])
    return np.array(positions), np.array(uvs), regions


def load_mesh(mi, name, positions, uvs, faces, plugins):
    """A Mitsuba mesh with one vertex for each corner: flat normals, no sharing."""
    textured = faces[0][0][1] != 0
    count = 3 * len(faces)
    props = mi.Properties()
    for key, plugin in plugins.items():
        props[key] = mi.load_dict(plugin)
    mesh = mi.Mesh(name, count, len(faces), has_vertex_texcoords=textured, props=props)
    params = mi.traverse(mesh)
    corners = np.array([c for face in faces for c in face])
    params["vertex_positions"] = positions[corners[:, 0] - 1].astype(np.float32).ravel()
    params["faces"] = np.arange(count, dtype=np.uint32)
    if textured:
        flipped = uvs[corners[:, 1] - 1] * [1, -1] + [0, 1]  # Mitsuba's row 0 is v = 0
        params["vertex_texcoords"] = flipped.astype(np.float32).ravel()
    params.update()
    return mesh


def light_plugin(mi, light):
    if light["type"] == "point":
        return {"type": "point", "position": light["position"],
                "intensity": {"type": "rgb", "value": light["intensity"]}}
    if light["type"] == "directional":
        return {"type": "directional", "direction": light["direction"],
                "irradiance": {"type": "rgb", "value": light["irradiance"]}}
    if light["type"] == "spot":
        at, direction = np.array(light["position"]), np.array(light["direction"])
        up = [0, 1, 0] if abs(direction[2]) > .9 * np.linalg.norm(direction) else [0, 0, 1]
        transform = mi.ScalarTransform4f().look_at(origin=at.tolist(),
                                                   target=(at + direction).tolist(), up=up)
        return {"type": "spot", "to_world": transform, "cutoff_angle": light["cutoff_deg"],
                "beam_width": light.get("beam_deg", light["cutoff_deg"]),
                "intensity": {"type": "rgb", "value": light["intensity"]}}
    sys.exit(f"z_test: lights of type {light['type']} are not compared")


def mitsuba_scene(mi, folder, frame, sampler="independent", lights=None):
    """`lights`: emitters that stand for those of the scene without a surface."""
    with open(os.path.join(folder, "truth", "truth.json"), encoding="utf-8") as file:
        truth = json.load(file)
    with open(os.path.join(folder, "transforms.json"), encoding="utf-8") as file:
        cameras = json.load(file)
    positions, uvs, regions = read_obj(os.path.join(folder, "scene.obj"))
    lit = {l["region"]: l["radiance"] for l in truth["lights"] if l["type"] == "area"}
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": 64, "rr_depth": 5,
                                             "hide_emitters": False}}
    for name, faces in regions.items():
        region = truth["regions"][name]
        plugins = {"bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}}
        if name in lit:
            plugins["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": lit[name]}}
        elif region["model"] != "lambert":
            sys.exit(f"z_test: {name} is {region['model']}; Mitsuba has no such definition")
        else:
            reflectance = {"type": "rgb", "value": region["albedo"]}
            if region.get("texture"):
                texels = read_exr(os.path.join(folder, "truth", region["texture"]))
                reflectance = {"type": "bitmap", "raw": True, "filter_type": "bilinear",
                               "bitmap": mi.Bitmap(texels.astype(np.float32)),
                               "wrap_mode": "repeat" if region.get("uv_wrap") else "clamp"}
            plugins["bsdf"] = {"type": "twosided",
                               "bsdf": {"type": "diffuse", "reflectance": reflectance}}
        scene["mesh_" + name] = load_mesh(mi, name, positions, uvs, faces, plugins)
    if lights is None:
        lights = [light_plugin(mi, light) for light in truth["lights"] if light["type"] != "area"]
    for number, light in enumerate(lights):
        scene[f"light_{number}"] = light
    matrix = np.array(cameras["frames"][frame]["transform_matrix"])
    flip = np.diag([-1.0, 1.0, -1.0, 1.0])  # OpenGL looks along -Z, Mitsuba along +Z with +X left
    fov = 2 * math.degrees(math.atan(cameras["w"] / (2 * cameras["fl_x"])))
    scene["sensor"] = {
        "type": "perspective", "fov": fov, "fov_axis": "x", "near_clip": 1e-3, "far_clip": 1e4,
        "to_world": mi.ScalarTransform4f((matrix @ flip).tolist()),
        "film": {"type": "hdrfilm", "width": int(cameras["w"]), "height": int(cameras["h"]),
                 "pixel_format": "rgb", "rfilter": {"type": "box"}},
        "sampler": {"type": sampler, "sample_count": 64}}
    return mi.load_dict(scene)


def render_mitsuba(mi, scene, samples, batches=16):
    """Mean and its variance from independent batches."""
    each = max(1, samples // batches)
    stack = np.stack([np.array(mi.render(scene, spp=each, seed=seed + 1)) for seed in range(batches)])
    return stack.mean(0), stack.var(0, ddof=1) / batches


def render_igi(program, folder, frame, samples, threads=0, seed=1):
    with open(os.path.join(folder, "transforms.json"), encoding="utf-8") as file:
        cameras = json.load(file)
    name = os.path.splitext(os.path.basename(cameras["frames"][frame]["file_path"]))[0]
    cameras["frames"] = [cameras["frames"][frame]]
    with tempfile.TemporaryDirectory() as work:
        one, out = os.path.join(work, "one.json"), os.path.join(work, "out")
        with open(one, "w", encoding="utf-8") as file:
            json.dump(cameras, file)
        subprocess.run([program, "relight", os.path.join(folder, "truth"), "--cameras", one,
                        "--samples", str(samples), "--variance", "-q", "-o", out,
                        "--threads", str(threads), "--seed", str(seed)], check=True)
        return read_exr(f"{out}/{name}.exr"), read_exr(f"{out}/{name}.variance.exr")


def judge(ours, our_variance, theirs, their_variance):
    variance = our_variance + their_variance
    difference = ours - theirs
    exact = variance <= 0
    z = np.where(exact, 0, difference / np.sqrt(np.where(exact, 1, variance)))
    exact_ok = np.abs(difference) <= 1e-4 * np.maximum(np.abs(theirs), 1e-6)
    significance = 1 - (1 - .01) ** (1 / z.size)
    threshold = statistics.NormalDist().inv_cdf(1 - significance / 2)
    passed = np.where(exact, exact_ok, np.abs(z) < threshold).all(-1)
    inner = z[~exact]
    return {"passed": passed.mean(), "pixels": passed.size, "threshold": threshold,
            "mean": inner.mean(), "deviation": inner.std(), "ratio": ours.mean() / theirs.mean()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("--frame", type=int, default=0)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--igi", default="build/release/igi")
    options = parser.parse_args()
    try:
        import mitsuba as mi
    except ImportError:
        print("skipped: no mitsuba (python3 -m pip install mitsuba)")
        return 77
    mi.set_variant("llvm_ad_rgb" if "llvm_ad_rgb" in mi.variants() and os.environ.get("IGI_LLVM")
                   else "scalar_rgb")
    ours, our_variance = render_igi(options.igi, options.scene, options.frame, options.samples)
    scene = mitsuba_scene(mi, options.scene, options.frame)
    theirs, their_variance = render_mitsuba(mi, scene, options.samples)
    row = judge(ours, our_variance, theirs, their_variance)
    print(f"{options.scene} frame {options.frame}: {100 * row['passed']:.3f} % of {row['pixels']} "
          f"pixels pass |z| < {row['threshold']:.2f}; z has mean {row['mean']:+.3f}, "
          f"standard deviation {row['deviation']:.3f}; mean ratio {row['ratio']:.5f}")
    return 0 if row["passed"] >= .9975 else 1


if __name__ == "__main__":
    sys.exit(main())
