#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is a pbrt-v4 or Radiance scene well-formed? Directives and their order, names, types and counts of
parameters, names that are defined before they are used, files that exist. Prints how many shapes there are.

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


# What pbrt-v4's own readers ask for (src/pbrt/lights.cpp, materials.cpp, film.cpp, ...), of the kinds that igi
# writes: parameter -> its types, number of values.
REAL, WHOLE, TEXT, RGB, PLACE = ("float", 1), ("integer", 1), ("string", 1), ("rgb", 3), ("point3", 3)
KINDS = {
    "Integrator": {"volpath": {"maxdepth": [WHOLE], "lightsampler": [TEXT], "regularize": [("bool", 1)]}},
    "Sampler": {"zsobol": {"pixelsamples": [WHOLE], "seed": [WHOLE], "randomization": [TEXT]}},
    "PixelFilter": {"box": {"xradius": [REAL], "yradius": [REAL]}},
    "Film": {"rgb": {"xresolution": [WHOLE], "yresolution": [WHOLE], "filename": [TEXT]}},
    "Camera": {"perspective": {"fov": [REAL], "screenwindow": [("float", 4)], "lensradius": [REAL]}},
    "Texture": {"imagemap": {"filename": [TEXT], "encoding": [TEXT], "wrap": [TEXT], "scale": [REAL]}},
    "Material": {"diffuse": {"reflectance": [RGB, ("texture", 1)]},
                 "conductor": {"reflectance": [RGB, ("texture", 1)], "roughness": [REAL],
                               "remaproughness": [("bool", 1)]},
                 "mix": {"materials": [("string", 2)], "amount": [REAL]}},
    "AreaLightSource": {"diffuse": {"L": [RGB], "scale": [REAL], "twosided": [("bool", 1)]}},
    "LightSource": {"point": {"I": [RGB], "scale": [REAL], "from": [PLACE]},
                    "spot": {"I": [RGB], "scale": [REAL], "from": [PLACE], "to": [PLACE], "coneangle": [REAL],
                             "conedeltaangle": [REAL]},
                    "distant": {"L": [RGB], "scale": [REAL], "from": [PLACE], "to": [PLACE]},
                    "infinite": {"L": [RGB], "scale": [REAL], "filename": [TEXT]}},
    "Shape": {"plymesh": {"filename": [TEXT]}}}
WORDS = {"encoding": {"linear", "sRGB"}, "wrap": {"repeat", "clamp", "black", "octahedralsphere"}}
BEFORE_WORLD = {"Integrator", "Sampler", "PixelFilter", "Film", "Camera"}
LITERALS = {"string": r'"[^"]+"', "texture": r'"[^"]+"', "bool": "true|false", "integer": r"-?\d+"}
NUMBER = r"-?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?"


def pbrt_directives(text):
    """Each directive with its words: quoted ones, numbers, [ and ]."""
    words = re.findall(r'"[^"\n]*"|\[|\]|[^\s\[\]"]+|"', re.sub(r"(?m)#.*$", "", text))
    found = []
    for word in words:
        if re.fullmatch(r"[A-Z]\w*", word):
            found.append([word])
        elif found:
            found[-1].append(word)
        else:
            refuse(f"begins with {word}")
    return found


def quoted(directive, words, at):
    if at >= len(words) or not re.fullmatch(r'"[^"]+"', words[at]):
        refuse(f"{directive}: no name in quotation marks")
    return words[at].strip('"')


def parameters(directive, words, known):
    """The parameters' values, strings without quotation marks; each of a type that `known` allows."""
    result, at = {}, 0
    while at < len(words):
        kind, _, name = quoted(directive, words, at).partition(" ")
        allowed = [count for type_, count in known.get(name, []) if type_ == kind]
        if not allowed or name in result:
            refuse(f"{directive}: parameter {words[at]}, again or not among {known}")
        if words[at + 1:at + 2] == ["["]:
            if "]" not in words[at:]:
                refuse(f"{directive}: {name}: no ]")
            end = words.index("]", at)
            values, at = words[at + 2:end], end + 1
        else:
            values, at = words[at + 1:at + 2], at + 2
        if len(values) != allowed[0] or not all(re.fullmatch(LITERALS.get(kind, NUMBER), v) for v in values):
            refuse(f"{directive}: {kind} {name}: {values}")
        values = [v.strip('"') if kind in LITERALS else float(v) for v in values]
        if kind == "rgb" and (min(values) < 0 or name == "reflectance" and max(values) > 1):
            refuse(f"{directive}: {name}: {values}")
        if name in WORDS and values[0] not in WORDS[name]:
            refuse(f"{directive}: {name}: {values}")
        result[name] = values
        result[name, "is texture"] = kind == "texture"
    return result


def check_names(directive, given, materials, textures):
    for name in given.get("materials", []):
        if name not in materials:
            refuse(f"{directive}: no material {name}")
    if given.get(("reflectance", "is texture")) and given["reflectance"][0] not in textures:
        refuse(f"{directive}: no texture {given['reflectance']}")
    if "filename" in given and directive != "Film":
        path = need_file(given["filename"][0])
        if path.endswith(".ply"):
            check_ply(path)


def check_pbrt(text):
    materials, textures, depth, shapes, world = set(), set(), 0, 0, False
    for directive, *words in pbrt_directives(text):
        if directive in BEFORE_WORLD and world or not world and directive in KINDS and directive not in BEFORE_WORLD:
            refuse(f"{directive} on the wrong side of WorldBegin")
        if directive in ("WorldBegin", "AttributeBegin", "AttributeEnd"):
            depth += (directive == "AttributeBegin") - (directive == "AttributeEnd")
            if words or depth < 0 or directive == "WorldBegin" and world:
                refuse(f"{directive} {words}")
            world |= directive == "WorldBegin"
        elif directive == "Transform":
            if len(words) != 18 or words[0] != "[" or words[-1] != "]" or \
                    not all(re.fullmatch(NUMBER, word) for word in words[1:-1]):
                refuse(f"Transform {words}")
        elif directive == "NamedMaterial":
            if quoted(directive, words, 0) not in materials or len(words) > 1:
                refuse(f"no material {words}")
        elif directive == "MakeNamedMaterial":
            name, kind = quoted(directive, words, 0), words[1:3]
            if kind[:1] != ['"string type"'] or quoted(directive, words, 2) not in KINDS["Material"]:
                refuse(f"{name}: no kind of material {kind}")
            known = KINDS["Material"][quoted(directive, words, 2)]
            check_names(directive, parameters(name, words[3:], known), materials, textures)
            materials.add(name)
        elif directive in KINDS:
            at = 2 if directive == "Texture" else 0
            if at and quoted(directive, words, 1) not in ("spectrum", "float"):
                refuse(f"{directive}: {words[1]}")
            kind = quoted(directive, words, at)
            if kind not in KINDS[directive]:
                refuse(f"{directive}: no kind {kind}")
            given = parameters(directive, words[at + 1:], KINDS[directive][kind])
            check_names(directive, given, materials, textures)
            if kind == "infinite" and "L" in given and "filename" in given:
                refuse("infinite: both L and filename")
            if directive == "Texture":
                textures.add(quoted(directive, words, 0))
            shapes += directive == "Shape"
        else:
            refuse(f"no directive {directive}")
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
