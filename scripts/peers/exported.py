#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `igi export` writes, loaded and rendered by the program it is for, beside igi's own picture.

    python3 scripts/peers/exported.py OUT --program mitsuba|radiance|blender [--cameras T.json]
            [--lights L.json] [--frame N] [--samples N] [--psnr DB] [--mean FRACTION]
            [--igi build/release/igi]

Prints the ratio of the two pictures' means and the PSNR of their 4 x 4 block means, tone-mapped
(sRGB curve, the 95th percentile at .8). Exit status 1 when the PSNR is below --psnr or the means
differ by more than --mean, 77 when the program is missing. Needs numpy and OpenEXR from PyPI, and
mitsuba, pyradiance or bpy. Radiance computes six bounces; --samples is its -ad.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import OpenEXR
except ImportError as missing:
    print(f"skipped: no {missing.name} (python3 -m pip install numpy OpenEXR)")
    sys.exit(77)

FORMATS = {"mitsuba": "xml", "radiance": "rad", "blender": "glb"}


def missing_program(name):
    print(f"skipped: no {name} (python3 -m pip install {name})")
    sys.exit(77)


def read_exr(path):
    channels = OpenEXR.File(path).channels()
    for name in ("RGB", "RGBA"):
        if name in channels:
            return channels[name].pixels[..., :3].astype(np.float64)
    return np.stack([channels[name].pixels for name in "RGB"], -1).astype(np.float64)


def blocks(picture):
    height, width = (side // 4 * 4 for side in picture.shape[:2])
    return picture[:height, :width].reshape(height // 4, 4, width // 4, 4, -1).mean((1, 3))


def tone(picture, white):
    x = np.clip(picture / white * .8, 0, 1)
    return np.where(x <= .0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - .055)


def by_igi(options, one, name, work):
    out = os.path.join(work, "out")
    lights = ["--lights", options.lights] if options.lights else []
    subprocess.run([options.igi, "relight", options.out, "--cameras", one, "-q", "-o", out,
                    "--samples", str(options.samples), *lights], check=True)
    return read_exr(f"{out}/{name}.exr")


def by_mitsuba(options, path, _name, _camera):
    try:
        import mitsuba as mi
    except ImportError:
        missing_program("mitsuba")
    mi.set_variant("scalar_rgb")
    return np.array(mi.render(mi.load_file(path), spp=options.samples, seed=7))


def by_radiance(options, path, name, camera):
    try:
        import pyradiance
    except ImportError:
        missing_program("pyradiance")
    home = os.path.dirname(pyradiance.__file__)
    folder, octree = os.path.dirname(path), path + ".oct"
    environment = dict(os.environ, RAYPATH=f".:{home}/lib")

    def run(*words, output=None):
        return subprocess.run([f"{home}/bin/{words[0]}", *words[1:]], cwd=folder, check=True,
                              env=environment, stdout=output or subprocess.PIPE).stdout
    with open(octree, "wb") as file:
        run("oconv", os.path.basename(path), output=file)
    with open(path + ".hdr", "wb") as file:
        run("rpict", "-vf", f"{path}_files/{name}.vf", "-x", str(camera["w"]), "-y",
            str(camera["h"]), "-ps", "1", "-dj", ".7", "-ds", ".2", "-ab", "6", "-ad",
            str(options.samples), "-as", str(options.samples // 4), "-aa", ".15", "-ar", "64",
            octree, output=file)
    values = run("pvalue", "-h", "-H", "-df", path + ".hdr")
    return np.frombuffer(values, "<f4").reshape(int(camera["h"]), int(camera["w"]), 3)


def by_blender(options, path, _name, camera):
    try:
        import bpy
        import mathutils
    except ImportError:
        missing_program("bpy")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path, export_import_convert_lighting_mode="COMPAT")
    data = bpy.data.cameras.new("view")
    view = bpy.data.objects.new("view", data)
    scene = bpy.context.scene
    scene.collection.objects.link(view)
    scene.camera = view
    view.matrix_world = mathutils.Matrix(camera["frames"][0]["transform_matrix"])
    data.sensor_fit, data.angle = "HORIZONTAL", 2 * math.atan(camera["w"] / (2 * camera["fl_x"]))
    data.shift_x = .5 - camera.get("cx", camera["w"] / 2) / camera["w"]
    data.shift_y = (camera.get("cy", camera["h"] / 2) - camera["h"] / 2) / camera["w"]
    render = scene.render
    render.resolution_x, render.resolution_y = int(camera["w"]), int(camera["h"])
    render.engine, render.filter_size = "CYCLES", .01
    scene.cycles.samples, scene.cycles.use_denoising = options.samples, False
    scene.cycles.use_adaptive_sampling, scene.cycles.pixel_filter_type = False, "BOX"
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = 64
    scene.cycles.sample_clamp_indirect = 0
    if not scene.world:
        scene.world = bpy.data.worlds.new("dark")
        scene.world.color = (0, 0, 0)
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = path + ".exr"
    bpy.ops.render.render(write_still=True)
    return read_exr(path + ".exr")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out")
    parser.add_argument("--program", choices=FORMATS, required=True)
    parser.add_argument("--cameras")
    parser.add_argument("--lights")
    parser.add_argument("--frame", type=int, default=0)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--psnr", type=float, default=0)
    parser.add_argument("--mean", type=float, default=1e9)
    parser.add_argument("--igi", default="build/release/igi")
    options = parser.parse_args()
    cameras = options.cameras or os.path.join(options.out, "..", "transforms.json")
    with open(cameras, encoding="utf-8") as file:
        camera = json.load(file)
    camera["frames"] = [camera["frames"][options.frame]]
    name = os.path.splitext(os.path.basename(camera["frames"][0]["file_path"]))[0]
    with tempfile.TemporaryDirectory() as work:
        one, path = os.path.join(work, "one.json"), f"{work}/scene.{FORMATS[options.program]}"
        with open(one, "w", encoding="utf-8") as file:
            json.dump(camera, file)
        words = [options.igi, "export", options.out, "--to", path.rsplit(".", 1)[1], "-q", "-o", path,
                 "--cameras", one]
        words[4] = {"blender": "glb"}.get(options.program, options.program)
        subprocess.run(words + (["--lights", options.lights] if options.lights else []), check=True)
        theirs = globals()["by_" + options.program](options, path, name, camera)
        ours = by_igi(options, one, name, work)
    ratio = theirs.mean() / ours.mean()
    white = np.percentile(blocks(ours), 95)
    error = ((tone(blocks(ours), white) - tone(blocks(theirs), white)) ** 2).mean()
    psnr = -10 * np.log10(max(error, 1e-12))
    print(f"{options.out} frame {options.frame}: {options.program}/igi mean {ratio:.5f}, PSNR "
          f"{psnr:.2f} dB at {options.samples} samples")
    return 0 if psnr >= options.psnr and abs(ratio - 1) <= options.mean else 1


if __name__ == "__main__":
    sys.exit(main())
