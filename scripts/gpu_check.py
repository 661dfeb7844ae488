#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compile all point physics as CUDA Fortran for the GPU: is every marked procedure device code?

usage: gpu_check.py --work DIR [-D NAME] SOURCE...

Modules that files with point physics use are compiled as well, so a file may hold host code
beside its device procedures as long as these do not call it. See cuda_fortran.py.
"""

import argparse
import os
import sys
from pathlib import Path

from cuda_fortran import Fault, compile_all, mangled, marked, missing_tools, translate


def check(args):
    names = {path: marked(path) for path in args.sources}
    keep = {}
    for path, procedures in names.items():
        if procedures:
            keep.update({mangled(path, name): f"{path}: {name}" for name in procedures})
            print(f"{path}: {len(procedures)} device procedures")
    ir = compile_all(args.sources, keep, args)
    translate(ir, args.work / "final.ptx", "-O1")
    print(f"{len(keep)} device procedures compile for the GPU{' '.join(['', *args.define])}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--work", required=True, type=Path)
    parser.add_argument("-D", dest="define", action="append", default=[])
    parser.add_argument("sources", nargs="+", type=Path)
    args = parser.parse_args()
    args.no_fma = False
    if why := missing_tools():
        print(f"skipped: {why}, so point physics is not checked for the GPU")
        sys.exit(os.environ.get("CI") == "true")
    try:
        check(args)
    except Fault as fault:
        sys.exit(f"gpu_check: {fault}")


if __name__ == "__main__":
    main()
