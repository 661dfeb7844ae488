#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the make rules that follow from `use`, `module`, `submodule` and `include` in Fortran.

usage: depend.py --objects DIR --modules DIR [--external NAME,...] SOURCE... > depend.mk

The object of a/b.f90 is DIR/a/b.o. An object depends on the module files that it uses. A module
file depends on its object through an empty recipe, so make looks at the module file again after
the compilation: gfortran leaves it alone when the interface did not change, and then the users
of the module are not compiled again. An included file lies beside the one that includes it.
"""

import argparse
import re
import sys
from pathlib import Path

USE = re.compile(
    r"^\s*(?:block;\s*)?use\s*(?:,\s*(?P<nature>\w+)\s*)?(?:::)?\s*\b(?P<name>[a-z]\w*)", re.I
)
MODULE = re.compile(
    r"^\s*module\s+(?!(?:procedure|subroutine|function)\b)([a-z]\w*)\s*(?:!.*)?$", re.I
)
INCLUDE = re.compile(r"^\s*include '([^']+)'", re.I | re.M)
SUBMODULE = re.compile(r"^\s*submodule\s*\(\s*(\w+)(?:\s*:\s*(\w+))?\s*\)\s*(\w+)", re.I)
INTRINSIC = {"iso_c_binding", "iso_fortran_env", "ieee_arithmetic", "ieee_exceptions"}
INTRINSIC |= {"ieee_features", "omp_lib"}


def scan(path):
    """Module files that a source makes, and {module file: line number} of those it needs."""
    makes, needs = [], {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if found := SUBMODULE.match(line):
            ancestor, parent, name = (x and x.lower() for x in found.groups())
            needs.setdefault(f"{ancestor}@{parent}.smod" if parent else f"{ancestor}.smod", number)
            makes.append(f"{ancestor}@{name}.smod")
        elif found := MODULE.match(line):
            makes.append(found.group(1).lower() + ".mod")
        elif found := USE.match(line):
            name = found["name"].lower()
            if name not in INTRINSIC and (found["nature"] or "").lower() != "intrinsic":
                needs.setdefault(name + ".mod", number)
    return makes, needs


def included(path):
    """Files that a source includes."""
    found = INCLUDE.findall(path.read_text(encoding="utf-8"))
    return sorted({path.with_name(name).as_posix() for name in found})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--objects", required=True)
    parser.add_argument("--modules", required=True)
    parser.add_argument("--external", default="", help="modules that come from elsewhere")
    parser.add_argument("--strip", default="", help="leading folder to leave out of object names")
    parser.add_argument("sources", nargs="+", type=Path)
    args = parser.parse_args()
    external = {name + ".mod" for name in args.external.split(",")}

    owner, needs_of, faults = {}, {}, []
    for path in args.sources:
        makes, needs_of[path] = scan(path)
        for name in makes:
            if name in owner:
                faults.append(f"{path}: {name} is made by {owner[name]} already")
            owner[name] = path
            if name.endswith(".mod"):
                owner.setdefault(name[:-3] + "smod", path)

    rules = []
    for path, needs in needs_of.items():
        inside = included(path)
        for name, number in needs.items():
            if name in external or owner.get(name) == path:
                continue
            if name not in owner:
                faults.append(f"{path}:{number}: no source makes {name}")
            inside.append(f"{args.modules}/{name}")
        rules.append(f"{object_of(path, args)}: {' '.join(inside)}".rstrip())
    used = {name for needs in needs_of.values() for name in needs}
    rules += [
        f"{args.modules}/{n}: {object_of(owner[n], args)} ;" for n in sorted(owner) if n in used
    ]
    if faults:
        sys.exit("\n".join(faults))
    print("\n".join(rules))


def object_of(path, args):
    text = path.as_posix().removeprefix(args.strip)
    return f"{args.objects}/{Path(text).with_suffix('.o').as_posix()}"


if __name__ == "__main__":
    main()
