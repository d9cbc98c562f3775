#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the #include lines of every source and fails on an arrow the house forbids (CONTRIBUTING.md, "Floors").

usage: check_layers.py [ROOT]        check the tree
       check_layers.py --self-test   show that each kind of forbidden arrow is caught
"""
import pathlib
import re
import sys
import tempfile

# floor -> floors it may include (itself always)
ALLOWED = {
    "core": set(),
    "io": {"core"},
    "recon": {"core"},
    "forward": {"core"},
    "forward/leaves": {"core"},
    "fit": {"core", "forward"},
    "cli": {"core", "io", "recon", "forward", "forward/leaves", "fit"},
}
# foreign library -> the only places that may include it
HOMES = {
    "nanoflann": ["core/neighbors.cpp"],
    "pcl/": ["io/read_", "recon/preprocess.cpp"],
    "opencv2": ["recon/image/"],
    "jpeglib.h": ["io/read_jpeg.cpp"],
    "CGAL/": ["core/convex_hull.cpp", "forward/leaves/"],
    "ceres/": ["fit/", "recon/cylinder_fit.cpp", "recon/image/"],
    "CLI/": ["cli/"],
    "pugixml": ["io/read_e57.cpp"],
    "laszip/": ["io/laszip.cpp"],
    "tbb/": ["core/parallel.cpp"],
    "embree": ["forward/virtual_scan/", "forward/leaves/", "cli/report/"],
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')


def floor_of(path):
    parts = path.split("/")
    if parts[0] == "forward" and len(parts) > 2 and parts[1] == "leaves":
        return "forward/leaves"
    return parts[0]


def violations(root):
    found = []
    for floor in ("core", "io", "recon", "forward", "fit", "cli"):
        for file in sorted((root / floor).rglob("*")):
            if file.suffix not in (".h", ".cpp"):
                continue
            name = file.relative_to(root).as_posix()
            here = floor_of(name)
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                quote, target = match.groups()
                if quote == '"' and "/" in target:
                    there = floor_of(target)
                    if there not in ALLOWED:
                        found.append(f"{name}:{number}: \"{target}\" is on no floor")
                    elif there != here and there not in ALLOWED[here]:
                        found.append(f"{name}:{number}: {here} must not include {there} (\"{target}\")")
                    continue
                if quote == '"':
                    found.append(f"{name}:{number}: include from the root: \"{target}\"")
                for library, homes in HOMES.items():
                    if target.startswith(library):
                        if not any(name.startswith(home) for home in homes):
                            found.append(f"{name}:{number}: <{target}> belongs in {', '.join(homes)}")
                        elif file.suffix == ".h":
                            found.append(f"{name}:{number}: <{target}> in a header; foreign types stop at the .cpp")
    return found


def self_test():
    cases = {
        "core/a.cpp": '#include "io/read_las.h"',
        "recon/a.cpp": '#include "forward/igm/grow.h"',
        "recon/b.cpp": '#include "io/read_las.h"',
        "fit/a.cpp": '#include "recon/reconstruct.h"',
        "fit/b.cpp": '#include "forward/leaves/insert.h"',
        "forward/leaves/a.cpp": '#include "forward/igm/grow.h"',
        "forward/igm/a.cpp": '#include "cli/options.h"',
        "io/a.cpp": "#include <nanoflann.hpp>",
        "cli/a.h": "#include <CLI/CLI.hpp>",
        "core/b.cpp": '#include "tree.h"',
    }
    fine = {
        "fit/c.cpp": '#include "forward/igm/grow.h"\n#include <ceres/ceres.h>',
        "cli/b.cpp": '#include "forward/leaves/insert.h"\n#include <vector>',
        "core/neighbors.cpp": "#include <nanoflann.hpp>",
    }
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in {**cases, **fine}.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text + "\n", encoding="utf-8")
        caught = {v.split(":")[0] for v in violations(root)}
    missed, wronged = set(cases) - caught, caught & set(fine)
    for name in sorted(missed):
        print(f"not caught: {name}: {cases[name]}")
    for name in sorted(wronged):
        print(f"wrongly refused: {name}")
    return 1 if missed or wronged else 0


def main():
    if "--self-test" in sys.argv:
        return self_test()
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = violations(root)
    print("\n".join(found) if found else "layers: no forbidden include")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
