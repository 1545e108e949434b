#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is a pbrt-v4 or Radiance scene well-formed? Tokens, counts of arguments, names that are defined
before they are used, files that exist. Prints how many shapes there are.

    scene_syntax.py FILE.pbrt|FILE.rad
"""
import os
import re
import struct
import sys

folder = os.path.dirname(os.path.abspath(sys.argv[1]))


def refuse(what):
    sys.exit(f"{sys.argv[1]}: {what}")


def need_file(name):
    path = os.path.join(folder, name.strip('"'))
    if not os.path.isfile(path):
        refuse(f"no file {name}")
    return path


def check_ply(path):
    """Every index within the vertices, and nothing behind the last face."""
    with open(path, "rb") as file:
        data = file.read()
    head, _, body = data.partition(b"end_header\n")
    vertices, faces = (int(n) for n in re.findall(rb"element \w+ (\d+)", head))
    size = 4 * head.count(b"property float")
    body = body[vertices * size:]
    if len(body) != faces * 13:
        refuse(f"{path}: {len(body)} bytes of {faces} faces")
    for face in struct.iter_unpack("<B3i", body):
        if face[0] != 3 or max(face[1:]) >= vertices:
            refuse(f"{path}: a face {face}")


COUNTS = {"float": 1, "integer": 1, "bool": 1, "string": 1, "texture": 1, "rgb": 3, "point3": 3}
WITHOUT_TYPE = {"WorldBegin", "AttributeBegin", "AttributeEnd", "Transform"}
TYPES = {"Integrator": {"volpath"}, "Sampler": {"zsobol"}, "PixelFilter": {"box"}, "Film": {"rgb"},
         "Camera": {"perspective"}, "Texture": None, "MakeNamedMaterial": None,
         "NamedMaterial": None, "Material": {"diffuse"}, "AreaLightSource": {"diffuse"},
         "LightSource": {"point", "spot", "distant", "infinite"}, "Shape": {"plymesh"}}


def pbrt_directives(text):
    """Each directive with its strings and numbers, lists flattened between [ and ]."""
    words = re.findall(r'"[^"\n]*"|\[|\]|[^\s\[\]"]+', re.sub(r"(?m)#.*$", "", text))
    found = []
    for word in words:
        if re.fullmatch(r"[A-Z]\w*", word):
            found.append([word])
        elif found:
            found[-1].append(word)
        else:
            refuse(f"begins with {word}")
    return found


def parameters(directive, words):
    result, at = {}, 0
    while at < len(words):
        declared = words[at].strip('"').split()
        if len(declared) != 2 or declared[0] not in COUNTS:
            refuse(f"{directive}: parameter {words[at]}")
        if words[at + 1] == "[":
            end = words.index("]", at)
            values, at = words[at + 2:end], end + 1
        else:
            values, at = [words[at + 1]], at + 2
        if not values or len(values) % COUNTS[declared[0]]:
            refuse(f"{directive}: {declared} has {len(values)} values")
        if declared[0] in ("float", "integer", "rgb", "point3"):
            values = [float(value) for value in values]
        result[declared[1]] = values
    return result


def check_pbrt(text):
    materials, textures, depth, shapes, world = set(), set(), 0, 0, False
    for directive, *words in pbrt_directives(text):
        if directive in WITHOUT_TYPE:
            depth += (directive == "AttributeBegin") - (directive == "AttributeEnd")
            world |= directive == "WorldBegin"
            if directive == "Transform" and len(words) != 18:
                refuse("Transform: not 16 numbers")
            continue
        if directive not in TYPES:
            refuse(f"no directive {directive}")
        kind = words[0].strip('"')
        if TYPES[directive] and kind not in TYPES[directive]:
            refuse(f"{directive}: no type {kind}")
        given = parameters(directive, words[3 if directive == "Texture" else 1:])
        if directive == "Texture":
            textures.add(kind)
        if directive == "MakeNamedMaterial":
            for name in given.get("materials", []):
                if name.strip('"') not in materials:
                    refuse(f"{kind}: no material {name}")
            materials.add(kind)
        if directive == "NamedMaterial" and kind not in materials:
            refuse(f"no material {kind}")
        if directive == "MakeNamedMaterial" and "reflectance" in given:
            value = given["reflectance"]
            if isinstance(value[0], str) and value[0].strip('"') not in textures:
                refuse(f"no texture {value}")
            if not isinstance(value[0], str) and not 0 <= min(value) <= max(value) <= 1:
                refuse(f"{kind}: reflectance {value}")
        if "filename" in given and directive != "Film":
            path = need_file(given["filename"][0])
            if path.endswith(".ply"):
                check_ply(path)
        shapes += directive == "Shape"
    if depth or not world:
        refuse("AttributeBegin and AttributeEnd do not pair, or there is no WorldBegin")
    return shapes


REALS = {"plastic": 5, "light": 3, "glow": 4, "spotlight": 7, "polygon": None, "sphere": 4,
         "source": 4, "colorpict": None}
SHAPES = {"polygon", "sphere", "source"}


def check_radiance(text):
    words = re.findall(r'"[^"\n]*"|\S+', re.sub(r"(?m)#.*$", "", text))
    names, shapes, at = {"void"}, 0, 0
    while at < len(words):
        modifier, kind, name = words[at:at + 3]
        if kind not in REALS or modifier not in names:
            refuse(f"{modifier} {kind} {name}")
        strings = int(words[at + 3])
        at += 4
        texts, integers = words[at:at + strings], int(words[at + strings])
        at += strings + 1
        count = int(words[at])
        numbers = [float(word) for word in words[at + 1:at + 1 + count]]
        at += 1 + count
        if integers or len(numbers) != count or (REALS[kind] and count != REALS[kind]):
            refuse(f"{kind} {name}: {count} numbers")
        if kind == "polygon" and count % 3 or kind == "plastic" and not 0 <= numbers[3] < 1:
            refuse(f"{kind} {name}: {numbers}")
        if kind == "colorpict":
            need_file(texts[3])
            with open(need_file(texts[4]), encoding="ascii") as file:
                functions = file.read()
            if not all(f"\n{call} =" in functions for call in texts[5:]):
                refuse(f"{name}: {texts}")
        if kind in SHAPES:
            shapes += 1
        else:
            names.add(name)
    return shapes


with open(sys.argv[1], encoding="utf-8") as scene:
    content = scene.read()
print(check_pbrt(content) if sys.argv[1].endswith(".pbrt") else check_radiance(content), "shapes")
