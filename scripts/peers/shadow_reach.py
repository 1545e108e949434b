#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How much light of a scene's lamps Mitsuba's shadow rays let past what stands close before them.

    python3 scripts/peers/shadow_reach.py SCENE [--points 2000] [--samples 64]

Mitsuba 3 ends a shadow ray short of the lamp by a share of its length (math.ShadowEpsilon, 8.9e-4: 2.7 mm
at three metres), so that a grid some millimetres before a lamp hides less of it than it should. Points on
the scene's surfaces that face into the room are drawn at random; for each lamp the direct light that
reaches them is summed with rays that end at the lamp and with rays that end where
Mitsuba's do. Prints a row a lamp. Needs mitsuba and numpy, and LLVM as in mitsuba_prb.py.
"""
import argparse
import json
import os
import sys

import numpy as np

import mitsuba_prb
from z_test import read_obj

CLOSE = 1e-5  # of a ray's length
OFF = 1e-5    # metres from the surface on which a ray begins


def triangles_of(positions, faces):
    return positions[np.array([[corner[0] - 1 for corner in face] for face in faces])]


def points_on(rng, triangles, count):
    """Points, spread evenly, and the normals there."""
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    chosen = rng.choice(len(area), count, p=area / area.sum())
    u, v = np.sqrt(rng.random(count)), rng.random(count)
    t = triangles[chosen]
    at = (1 - u)[:, None] * t[:, 0] + (u * (1 - v))[:, None] * t[:, 1] + (u * v)[:, None] * t[:, 2]
    return at, cross[chosen] / (2 * area[chosen])[:, None], area.sum()


def load_rays(mi, positions, regions):
    """A function: how far each ray goes before it meets something."""
    parts = {"type": "scene"}
    for name, faces in regions.items():
        index = np.array([[corner[0] - 1 for corner in face] for face in faces], np.uint32)
        mesh = mi.Mesh(name, len(positions), len(index))
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = positions.astype(np.float32).ravel()
        parameters["faces"] = index.ravel()
        parameters.update()
        parts["mesh_" + name] = mesh
    scene = mi.load_dict(parts)

    def trace(origins, directions):
        ray = mi.Ray3f(mi.Point3f(origins.T.astype(np.float32)), mi.Vector3f(directions.T.astype(np.float32)))
        return np.array(scene.ray_intersect_preliminary(ray, False).t)
    return trace


def measure(rng, trace, epsilon, lamp, surfaces, options):
    """Direct light that reaches the points: unhindered, past what stands between, as Mitsuba has it."""
    at, normals, _ = points_on(rng, surfaces, options.points)
    at, normals = at.repeat(options.samples, 0), normals.repeat(options.samples, 0)
    on_lamp, lamp_normals, area = points_on(rng, lamp, len(at))
    way = on_lamp - at
    far = np.linalg.norm(way, axis=1)
    way /= far[:, None]
    weight = np.clip((way * normals).sum(1), 0, None) * np.clip(-(way * lamp_normals).sum(1), 0, None) * area / far ** 2
    kept = weight > 0
    weight, far = weight[kept], far[kept]
    met = trace((at + OFF * normals)[kept], way[kept])
    return np.array([weight.sum()] + [weight[met > far * (1 - short)].sum() for short in (CLOSE, epsilon)])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("--points", type=int, default=2000)
    parser.add_argument("--samples", type=int, default=64)
    options = parser.parse_args()
    if not mitsuba_prb.find_llvm():
        print("skipped: no LLVM that Mitsuba can use (Debian: libllvm19)")
        return 77
    try:
        import mitsuba as mi
    except ImportError:
        print("skipped: no mitsuba (python3 -m pip install mitsuba)")
        return 77
    mi.set_variant("llvm_ad_rgb")
    with open(os.path.join(options.scene, "scene.json"), encoding="utf-8") as file:
        manifest = json.load(file)
    positions, _, regions = read_obj(os.path.join(options.scene, manifest["mesh"]))
    lamps = [light["region"] for light in manifest["lights"] if light["type"] == "area"]
    surfaces = np.concatenate([triangles_of(positions, faces) for name, faces in regions.items() if name not in lamps])
    epsilon = float(mi.math.ShadowEpsilon)
    for name in lamps:
        trace = load_rays(mi, positions, {other: faces for other, faces in regions.items() if other != name})
        lamp = triangles_of(positions, regions[name])
        everything, exact, short = measure(np.random.default_rng(1), trace, epsilon, lamp, surfaces, options)
        print(f"{name}: {100 * exact / everything:.1f} % of its light passes what stands before it, "
              f"{100 * short / everything:.1f} % by Mitsuba's shadow rays: {100 * (short / exact - 1):+.2f} %")
    return 0


if __name__ == "__main__":
    sys.exit(main())
