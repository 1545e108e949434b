#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the law of src/README.md: which folder may include which, and a few things beside.

  - #include "folder/..." only of folders that the table allows, of base, and of one's own
  - cli includes <igi/...> alone; headers in include/ include <igi/...> and the C library alone
  - a *_private.h is included within its own folder only
  - C++ lies in src/bridge only
  - malloc and its family are called in src/base/memory.c (and for the context itself) only
  - each source begins with its licence, and none is longer than 1000 lines
  - the top level holds what it should and nothing that a test left
  - what a page of text links to exists; README's figures are those of datasets-synthetic/RESULTS.md
"""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent
src = root / "src"
problems = []
TOP = set("""CHANGELOG.md CMakeLists.txt CMakePresets.json CONTRIBUTING.md LICENSE README.md calib
datasets-synthetic include scripts src tests""".split())


def complain(path, line, what):
    problems.append(f"{path.relative_to(root)}:{line}: {what}")


def read_table():
    """folder -> the folders that it may include."""
    allowed = {}
    for line in (src / "README.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("|") and len(cells) == 3 and re.fullmatch(r"[a-z]+", cells[0]):
            if cells[0] != "folder":
                allowed[cells[0]] = set(cells[2].split()) | {"base", cells[0]}
    return allowed


def without_comments(text):
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group())
    return re.sub(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"", blank, text, flags=re.S)


def check_includes(path, text, folder, allowed):
    for number, line in enumerate(text.splitlines(), 1):
        found = re.match(r'\s*#\s*include\s+(["<])([^">]+)[">]', line)
        if not found:
            continue
        own, name = found.group(1) == '"', found.group(2)
        if not own:
            continue
        other = name.split("/")[0] if "/" in name else folder
        if folder == "cli":
            if other != "cli":
                complain(path, number, f"cli may include <igi/...> alone, not \"{name}\"")
        elif other not in allowed:
            complain(path, number, f"\"{name}\": include as \"folder/file.h\"")
        elif other not in allowed[folder]:
            complain(path, number, f"{folder} may not include {other} (see src/README.md)")
        if name.endswith("_private.h") and other != folder:
            complain(path, number, f"\"{name}\" belongs to {other}")


def check_calls(path, text):
    if path.parent.name == "base" and path.name in ("memory.c", "context.c"):
        return
    for number, line in enumerate(without_comments(text).splitlines(), 1):
        call = re.search(r"(?<![\w.>])(malloc|calloc|realloc|strdup|aligned_alloc)\s*\(", line)
        if call and path.parent.name != "cli":
            complain(path, number, f"{call.group(1)}: allocate through igi_calloc and its kin")
        call = re.search(r"(?<![\w.>])(exit|abort|printf|puts|assert)\s*\(", line)
        if call and path.parent.name != "cli":
            complain(path, number, f"{call.group(1)}: the library neither prints nor ends the program")


def check_top():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=root, capture_output=True, text=True)
    for name in sorted({name.split("/")[0] for name in listed.stdout.split("\0") if name}):
        if name not in TOP and not name.startswith("."):
            complain(root / name, 1, "does not belong at the top level")


def check_texts():
    for path in sorted(root.glob("*.md")) + sorted(root.glob("[!b.]*/**/*.md")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", line):
                if not (path.parent / target).exists():
                    complain(path, number, f"links to {target}, which does not exist")
    known = set((root / "datasets-synthetic/RESULTS.md").read_text().splitlines())
    for number, line in enumerate((root / "README.md").read_text().splitlines(), 1):
        if re.match(r"\|.*\d\.\d", line) and line not in known:
            complain(root / "README.md", number, "this row is not in datasets-synthetic/RESULTS.md")


def main():
    allowed = read_table()
    check_top()
    check_texts()
    for path in sorted(p for p in root.glob("src/**/*") if p.suffix in (".c", ".h", ".cc")):
        folder, text = path.relative_to(src).parts[0], path.read_text()
        if folder not in allowed:
            complain(path, 1, f"folder {folder} is not in src/README.md")
            continue
        if "SPDX-License-Identifier: Apache-2.0" not in text[:200]:
            complain(path, 1, "begin with SPDX-License-Identifier: Apache-2.0")
        if text.count("\n") > 1000:
            complain(path, 1, "more than 1000 lines: split it")
        if path.suffix == ".cc" and folder != "bridge":
            complain(path, 1, "C++ belongs in src/bridge")
        check_includes(path, text, folder, allowed)
        if path.suffix != ".cc":
            check_calls(path, text)
    for path in sorted((root / "include").glob("**/*.h")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if re.match(r'\s*#\s*include\s+"', line):
                complain(path, number, "public headers include <igi/...> alone")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
