#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The peer: Mitsuba 3, path replay backpropagation (Vicini et al. 2021) and Adam, on the same
photographs, geometry and lights as igi.

    python3 scripts/peers/mitsuba_prb.py SCENE -o CURVE.csv [--steps N] [--rate R] [...]

SCENE is a folder with truth. Each step renders some views at reduced size, compares them with the
photographs, and moves every region's albedo (a texture where scene.json declares one) and, where the
truth has a lobe, its rho_s and alpha: the peer is told which surfaces are glossy, which igi has to
find out. CURVE.csv receives a line a step, the errors as `igi validate` defines them; `igi chart
speed --peer CURVE.csv` draws it. CPU seconds are those of the whole process, all threads, once Python
and Mitsuba are loaded: igi's, too, begin with the scene's files. Run it twice and keep the second: compiled kernels come from Dr.Jit's cache then.

Needs mitsuba, numpy and OpenEXR from PyPI, and LLVM's library, 17 or newer (Debian: libllvm19).
"""
import argparse
import csv
import glob
import json
import math
import os
import re
import sys
import time

import numpy as np

from z_test import light_plugin, load_mesh, read_exr, read_obj

FLOOR = .02          # of an albedo, in a relative error: as in src/report/validate.c
DARK = .1            # of the mean pixel, added in the weights of the loss
OLDEST_LLVM = 17     # older ones end the process: Dr.Jit 1 asks for instructions they lack
START_ALBEDO, START_SPECULAR, START_ALPHA = .5, .05, .2


def find_llvm():
    """Names the newest LLVM to Dr.Jit, which takes the first that it meets; false: none will do."""
    if "DRJIT_LIBLLVM_PATH" in os.environ:
        return True
    found = [(int(match.group(1)), path)
             for path in glob.glob("/usr/lib/*/libLLVM*.so*") + glob.glob("/usr/lib/llvm-*/lib/libLLVM*.so*")
             if (match := re.search(r"libLLVM(?:-|\.so\.)(\d+)", path))]
    if not found or max(found)[0] < OLDEST_LLVM:
        return False
    os.environ["DRJIT_LIBLLVM_PATH"] = max(found)[1]
    return True


def define_ward(mi, dr):
    """Ward's BRDF as src/README's material defines it, on both sides, with derivatives."""

    class Ward(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.albedo = props.get_texture("albedo")
            self.specular = mi.Float(props["specular"])
            self.alpha = mi.Float(props["alpha"])
            flags = (mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection
                     | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide)
            self.m_components, self.m_flags = [flags], flags

        def traverse(self, cb):
            cb.put("albedo", self.albedo, mi.ParamFlags.Differentiable)
            cb.put("specular", self.specular, mi.ParamFlags.Differentiable)
            cb.put("alpha", self.alpha, mi.ParamFlags.Differentiable)

        def lobe(self, wi, wo, h):
            """The lobe's value without rho_s."""
            a2 = dr.square(self.alpha)
            tan2 = (dr.square(h.x) + dr.square(h.y)) / dr.square(h.z)
            return dr.exp(-tan2 / a2) / (4 * dr.pi * a2 * dr.sqrt(wi.z * wo.z))

        def density(self, wi, wo, h):
            a2 = dr.square(self.alpha)
            tan2 = (dr.square(h.x) + dr.square(h.y)) / dr.square(h.z)
            glossy = dr.exp(-tan2 / a2) / (dr.pi * a2 * h.z ** 3 * 4 * dr.abs(dr.dot(wo, h)))
            return .5 * glossy + .5 * wo.z / dr.pi

        def eval_pdf(self, ctx, si, wo, active=True):
            side = dr.sign(si.wi.z)
            wi, wo = mi.Vector3f(si.wi), mi.Vector3f(wo)
            wi.z, wo.z = wi.z * side, wo.z * side
            active = mi.Bool(active) & (wi.z > 1e-4) & (wo.z > 1e-4)
            wi = dr.select(active, wi, mi.Vector3f(0, 0, 1))
            wo = dr.select(active, wo, mi.Vector3f(0, 0, 1))
            h = dr.normalize(wi + wo)
            f = self.albedo.eval(si, active) / dr.pi + self.specular * self.lobe(wi, wo, h)
            pdf = dr.detach(self.density(wi, wo, h))
            return (dr.select(active, f * wo.z, mi.Color3f(0)), dr.select(active, pdf, mi.Float(0)))

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def sample(self, ctx, si, sample1, sample2, active=True):
            side = dr.sign(si.wi.z)
            wi = mi.Vector3f(si.wi)
            wi.z *= side
            tan = dr.detach(self.alpha) * dr.sqrt(-dr.log(1 - sample2.x))
            s, c = dr.sincos(2 * dr.pi * sample2.y)
            h = dr.normalize(mi.Vector3f(tan * c, tan * s, 1))
            wo = dr.select(sample1 < .5, 2 * dr.dot(wi, h) * h - wi,
                           mi.warp.square_to_cosine_hemisphere(sample2))
            wo.z *= side
            value, pdf = self.eval_pdf(ctx, si, wo, active)
            ok = mi.Bool(active) & (pdf > 0)
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo, bs.pdf, bs.eta = wo, dr.select(ok, pdf, 0), mi.Float(1)
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            return bs, dr.select(ok, value / pdf, 0)

    mi.register_bsdf("igi_ward", Ward)


def albedo_plugin(mi, textured, texels):
    if not textured:
        return {"type": "rgb", "value": [START_ALBEDO] * 3}
    start = np.full((texels, texels, 3), START_ALBEDO, np.float32)
    return {"type": "bitmap", "raw": True, "filter_type": "bilinear", "bitmap": mi.Bitmap(start)}


def region_plugins(mi, region, textured, radiance, texels):
    if radiance:
        return {"bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
                "emitter": {"type": "area", "radiance": {"type": "rgb", "value": radiance}}}
    albedo = albedo_plugin(mi, textured, texels)
    if region["model"] == "lambert":
        return {"bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": albedo}}}
    return {"bsdf": {"type": "igi_ward", "albedo": albedo, "specular": START_SPECULAR,
                     "alpha": START_ALPHA}}


def load_scene(mi, folder, manifest, truth, options):
    positions, uvs, regions = read_obj(os.path.join(folder, manifest["mesh"]))
    lit = {l["region"]: l["radiance"] for l in manifest["lights"] if l["type"] == "area"}
    scene = {"type": "scene"}
    for name, faces in regions.items():
        textured = manifest["regions"].get(name, {}).get("textured", False)
        plugins = region_plugins(mi, truth["regions"][name], textured, lit.get(name),
                                 options.texels)
        scene["mesh_" + name] = load_mesh(mi, name, positions, uvs, faces, plugins)
    for number, light in enumerate(manifest["lights"]):
        if light["type"] != "area":
            scene[f"light_{number}"] = light_plugin(mi, light)
    return mi.load_dict(scene)


def sensor(mi, cameras, frames, reduce):
    """All the frames' cameras in one film, side by side."""
    flip = np.diag([-1.0, 1.0, -1.0, 1.0])  # OpenGL looks along -Z, Mitsuba along +Z with +X left
    w, h = int(cameras["w"]), int(cameras["h"])
    film = {"type": "hdrfilm", "width": w // reduce, "height": h // reduce, "pixel_format": "rgb",
            "rfilter": {"type": "box"}}
    batch = {"type": "batch", "film": {**film, "width": len(frames) * (w // reduce)},
             "sampler": {"type": "independent", "sample_count": 4}}
    for i, frame in enumerate(frames):
        matrix = np.array(frame["transform_matrix"]) @ flip
        batch[f"view_{i}"] = {
            "type": "perspective", "fov": 2 * math.degrees(math.atan(w / (2 * cameras["fl_x"]))),
            "fov_axis": "x", "near_clip": 1e-3, "far_clip": 1e4, "film": film,
            "principal_point_offset_x": cameras["cx"] / w - .5,
            "principal_point_offset_y": cameras["cy"] / h - .5,
            "to_world": mi.ScalarTransform4f(matrix.tolist())}
    return mi.load_dict(batch)


def reduced(path, n):
    image = read_exr(path)
    h, w = image.shape[0] // n, image.shape[1] // n
    return image[:h * n, :w * n].reshape(h, n, w, n, 3).mean((1, 3))


class Judge:
    """Errors against truth, as `igi validate` defines them."""

    def __init__(self, folder, truth, keys):
        self.truth, self.keys, self.maps, self.touched = truth, keys, {}, {}
        self.cpu_s = 0  # what judging took, which is not the peer's
        for name, key in keys.items():
            region = truth["regions"][name]
            if region.get("texture"):
                self.maps[name] = read_exr(os.path.join(folder, "truth", region["texture"]))

    def touch(self, slopes):
        """A texel that some gradient reached counts as seen."""
        began = time.process_time()
        for name in self.maps:
            gradient = np.array(slopes[self.keys[name]["albedo"]])
            if gradient.ndim == 3:
                hit = (gradient != 0).any(-1)
                self.touched[name] = self.touched.get(name, False) | hit
        self.cpu_s += time.process_time() - began

    def albedo(self, name, value):
        """Region error, median texel error or None."""
        want = np.array(self.truth["regions"][name]["albedo"])
        if name not in self.maps or value.ndim < 3:
            got = value.ravel() if value.size == 3 else value.reshape(-1, 3).mean(0)
            return np.mean(np.abs(got - want) / np.maximum(want, FLOOR)), None
        target = self.maps[name]
        rows = np.arange(target.shape[0]) * value.shape[0] // target.shape[0]
        columns = np.arange(target.shape[1]) * value.shape[1] // target.shape[1]
        at = np.ix_(rows, columns)
        seen = self.touched[name][at] if name in self.touched else np.ones(target.shape[:2], bool)
        got, want = value[at][seen], target[seen]
        texels = np.median(np.abs(got - want) / np.maximum(want, FLOOR))
        got, want = got.mean(0), want.mean(0)
        return np.mean(np.abs(got - want) / np.maximum(want, FLOOR)), texels

    def errors(self, params):
        began = time.process_time()
        albedo, specular, alpha, texels = [], [], [], []
        for name, keys in self.keys.items():
            region = self.truth["regions"][name]
            error, texel = self.albedo(name, np.array(params[keys["albedo"]]))
            albedo.append(error)
            if texel is not None:
                texels.append(texel)
            if "specular" in keys:
                specular.append(abs(params[keys["specular"]][0] / region["specular"] - 1))
                alpha.append(abs(params[keys["alpha"]][0] / region["alpha"] - 1))

        def mean(x):
            return f"{np.mean(x):.6g}" if x else ""
        self.cpu_s += time.process_time() - began
        return [mean(albedo), f"{max(albedo):.6g}", mean(specular), mean(alpha), mean(texels)]


def parameter_keys(params, truth, names):
    """Region -> its parameters' names in Mitsuba's tree."""
    keys = {}
    for key in params.keys():
        for name in names:
            if not key.startswith("mesh_" + name + ".") and not key.startswith(name + "."):
                continue
            last = key.rsplit(".", 1)[1]
            if key.endswith(("reflectance.value", "reflectance.data", "albedo.value",
                             "albedo.data")):
                keys.setdefault(name, {})["albedo"] = key
            elif last in ("specular", "alpha"):
                keys.setdefault(name, {})[last] = key
    return keys


def gradient_function(mi, dr, options, params):
    """Gradient of the loss; recorded once and replayed where Dr.Jit can (not with a BRDF written in
    Python), which halves a step's time."""
    integrator = mi.load_dict({"type": "prb", "max_depth": options.depth, "rr_depth": 4})

    @dr.freeze
    def gradient(scene, values, view, target, weight, seeds):
        for key, value in values.items():
            dr.enable_grad(value)
            params[key] = value
        params.update()
        with dr.suspend_grad():
            image = integrator.render(scene, sensor=view, seed=seeds[0], spp=options.spp)
        # of mean(weight (image - target)^2); other paths than the image's, or it would be biased
        slope = (image - target) * weight
        integrator.render_backward(scene, params, slope, sensor=view, seed=seeds[1],
                                   spp=options.spp)
        return {key: dr.grad(value) for key, value in values.items()}

    return gradient


def optimise(mi, dr, options, scene, groups, params, keys, judge, write):
    adam = mi.ad.Adam(lr=options.rate)
    ranges, pace = {}, {}
    for region in keys.values():
        for kind, key in region.items():
            adam[key] = params[key]
            ranges[key] = (.02, .6) if kind == "alpha" else (.001, .995)
            share = options.lobes if kind != "albedo" else options.texture if np.array(
                params[key]).ndim == 3 else 1
            pace[key] = options.rate * share
    dr.set_flag(dr.JitFlag.KernelFreezing, not any("alpha" in region for region in keys.values()))
    gradient = gradient_function(mi, dr, options, params)
    paths = 0
    for step in range(options.steps):
        fallen = options.fall ** (step / max(1, options.steps - 1))
        adam.set_learning_rate({key: rate * fallen for key, rate in pace.items()})
        view, target, weight = groups[step % len(groups)]
        values = {key: type(adam[key])(dr.detach(adam[key])) for key in ranges}
        seeds = mi.UInt32(2 * step), mi.UInt32(2 * step + 1)
        slopes = gradient(scene, values, view, target, weight, seeds)
        judge.touch(slopes)
        for key in ranges:  # a path along the horizon may overflow
            dr.set_grad(adam[key], dr.select(dr.isfinite(slopes[key]), slopes[key], 0))
        adam.step()
        for key, (low, high) in ranges.items():
            adam[key] = dr.clip(adam[key], low, high)
        dr.eval({key: adam[key] for key in ranges})
        dr.sync_thread()
        paths += options.spp * int(np.prod(target.shape[:2]))
        write([step + 1, f"{time.process_time() - judge.cpu_s:.3f}", paths] + judge.errors(adam))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True, help="CSV, a line a step")
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--rate", type=float, default=.08, help="Adam's, at the beginning")
    parser.add_argument("--fall", type=float, default=.05, help="and at the end, as a share of it")
    parser.add_argument("--lobes", type=float, default=.2, help="rate of rho_s and alpha, a share")
    parser.add_argument("--texture", type=float, default=.25, help="rate of texels, a share")
    parser.add_argument("--spp", type=int, default=4)
    parser.add_argument("--views", type=int, default=8, help="a step")
    parser.add_argument("--reduce", type=int, default=8, help="pixels of a photograph along one")
    parser.add_argument("--depth", type=int, default=16, help="longest path")
    parser.add_argument("--texels", type=int, default=64, help="along a texture")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def main():
    options = arguments()
    if not find_llvm():
        print(f"skipped: no LLVM {OLDEST_LLVM} or newer (Debian: libllvm19)")
        return 77
    try:
        import drjit as dr
        import mitsuba as mi
        mi.set_variant("llvm_ad_rgb")
        dr.set_thread_count(options.threads)
    except (ImportError, RuntimeError) as error:
        print(f"skipped: Mitsuba does not run here ({error}); python3 -m pip install mitsuba")
        return 77
    define_ward(mi, dr)
    started = time.process_time()

    def load(*names):
        with open(os.path.join(options.scene, *names), encoding="utf-8") as file:
            return json.load(file)
    manifest, truth = load("scene.json"), load("truth", "truth.json")
    cameras = load(manifest["cameras"])
    lamps = {l.get("region") for l in manifest["lights"]}
    scene = load_scene(mi, options.scene, manifest, truth, options)
    params = mi.traverse(scene)
    names = [name for name in truth["regions"] if name not in lamps]
    keys = parameter_keys(params, truth, names)
    frames = list(cameras["frames"])
    np.random.default_rng(options.seed).shuffle(frames)
    groups = []
    for begin in range(0, len(frames) - options.views + 1, options.views):
        some = frames[begin:begin + options.views]
        target = np.concatenate([reduced(os.path.join(options.scene, f["file_path"]),
                                         options.reduce) for f in some], 1)
        weight = 1 / (target + DARK * target.mean()) ** 2
        groups.append((sensor(mi, cameras, some, options.reduce),
                       mi.TensorXf(target.astype(np.float32)),
                       mi.TensorXf(weight.astype(np.float32))))
    judge = Judge(options.scene, truth, keys)
    judge.cpu_s = started  # so is what loading Mitsuba took
    with open(options.output, "w", encoding="utf-8", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["peer", "run", "scene", "step", "cpu_s", "paths", "albedo_mean", "albedo_max",
                      "specular", "alpha", "texels"])
        run = f"{options.spp} spp x {options.steps}"
        optimise(mi, dr, options, scene, groups, params, keys, judge,
                 lambda row: out.writerow(["Mitsuba 3 prb", run, manifest["name"]] + row))
    return 0


if __name__ == "__main__":
    sys.exit(main())
