#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Lights whose power the manifest leaves out, and that no photograph shows: solved with the albedos,
# with standard deviations that hold the truth, or named with what they cannot be told apart from.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
spec=$tests/cli/powers.json

# Leaves the lights' values out of a scene's manifest; or compares with them.
cat >lights.py <<'END'
import json, sys
VALUES = ("radiance", "intensity", "irradiance", "scale")
def load(path): return json.load(open(path))
def strip(source, target):
    m = load(source)
    for l in m["lights"]:
        for k in VALUES: l.pop(k, None)
    json.dump(m, open(target, "w"))
def value(l): return next((l[k] for k in VALUES if k in l), None)
def std(l): return next((l[k + "_std"] for k in VALUES if k + "_std" in l), None)
def spec(source, target, lights):
    m = load(source)
    m["lights"] = lights
    json.dump(m, open(target, "w"))
END

expect 0 'photographs' "$igi" synth "$spec" -o room
python3 - <<'END'
from lights import *
strip("room/scene.json", "room/unknown.json")
END
expect 0 "" "$igi" recover -q room/unknown.json --model lambert -o out -j 2
python3 - >problems 2>&1 <<'END'
from lights import *
truth, got = load("room/scene.json")["lights"], load("out/materials.json")
for i, (t, g) in enumerate(zip(truth[:3], got["lights"])):
    for b, (x, y, s) in enumerate(zip(value(t), value(g), std(g))):
        if not abs(y - x) < 3 * s: print(f"light {i} band {b}: {y} +- {s}, not {x}")
        if not abs(y - x) < .04 * x or not s < .06 * x: print(f"light {i} band {b}: {y} +- {s} is too far from {x}")
if value(got["lights"][3]) is not None: print("a power was invented")
if not any("lights[3]" in w and "lights nothing" in w for w in got["warnings"]): print("lights[3] is not named", got["warnings"])
regions, albedos = got["regions"], load("room/truth/truth.json")["regions"]
for name in ("floor", "ceiling", "walls", "box"):
    for x, y, s in zip(albedos[name]["albedo"], regions[name]["albedo"], regions[name]["albedo_std"]):
        if not abs(y - x) < 3 * s + .003 * x or not abs(y - x) < .04 * x: print(f"{name}: {y} +- {s}, not {x}")
END
[ ! -s problems ] || fail "$(cat problems)"
cp -r out once
expect 0 "" "$igi" recover -q room/unknown.json --model lambert -o out -j 7
cmp once/materials.json out/materials.json || fail "other threads, other powers"
expect 1 'lights\[0\]: its value is not given' "$igi" recover room/unknown.json --method direct -o direct

# Two lights at one place: their sum is known, and each is named with the other.
python3 - "$spec" <<'END'
from lights import *
lights = load(sys.argv[1])["lights"]
twin = dict(lights[1], intensity=[1, 1.5, 3])
spec(sys.argv[1], "twins.json", [lights[0], lights[1], twin])
END
expect 0 "" "$igi" synth -q twins.json -o twins
python3 - <<'END'
from lights import *
strip("twins/scene.json", "twins/unknown.json")
END
expect 0 "" "$igi" recover -q twins/unknown.json --model lambert -o out
python3 - >problems 2>&1 <<'END'
from lights import *
truth, got = load("twins/scene.json")["lights"], load("out/materials.json")
t1, t2, g1, g2 = (value(l) for l in (truth[1], truth[2], got["lights"][1], got["lights"][2]))
for b in range(3):
    if not abs((g1[b] + g2[b]) / (t1[b] + t2[b]) - 1) < .03: print("the sum is wrong", g1, g2)
    if not std(got["lights"][1])[b] > .5 * g1[b]: print("sure of what nobody can know", got["lights"])
for a, b in ((1, 2), (2, 1)):
    if not any(w.startswith(f"lights[{a}]") and f"hardly be told from lights[{b}]" in w for w in got["warnings"]):
        print("not named:", got["warnings"])
END
[ ! -s problems ] || fail "$(cat problems)"

# Nothing but unknown lights over two surfaces that hardly light each other: strength and albedo.
cat >open.json <<'END'
{ "igi_synth": 1, "name": "open",
  "materials": { "floor": { "albedo": [0.45, 0.35, 0.25] }, "step": { "albedo": [0.2, 0.3, 0.4] } },
  "shapes": [
    { "type": "quad", "corner": [0, 0, 0], "u": [3, 0, 0], "v": [0, 3, 0], "material": "floor" },
    { "type": "quad", "corner": [3, 0, 0.5], "u": [2, 0, 0], "v": [0, 3, 0], "material": "step" } ],
  "lights": [ { "type": "directional", "direction": [0.3, 0.2, -0.9], "irradiance": [3, 3, 3] },
              { "type": "ambient", "radiance": [0.3, 0.3, 0.4] } ],
  "views": { "width": 80, "height": 60, "samples": 16, "fov_deg": 80,
             "look": [ { "eye": [1.5, 1.5, 3], "target": [1.5, 1.6, 0] }, { "eye": [3, 1, 3], "target": [2.5, 1.6, 0] } ] } }
END
expect 0 "" "$igi" synth -q open.json -o open
python3 - <<'END'
from lights import *
strip("open/scene.json", "open/unknown.json")
END
expect 0 "" "$igi" recover -q open/unknown.json --model lambert -o out
python3 - >problems 2>&1 <<'END'
from lights import *
got = load("out/materials.json")
w = got["warnings"]
if not any(x.startswith("lights[0]") and "against the albedo of 'floor'" in x for x in w): print("not named:", w)
for name, r in got["regions"].items():
    if not r["albedo_std"][0] > .3 * r["albedo"][0]: print("sure of", name, r["albedo"], r["albedo_std"])
END
[ ! -s problems ] || fail "$(cat problems)"
finish
