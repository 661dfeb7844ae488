#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Build the GPU code: the kernels of cuda/*.CUF with the point physics of src, in one PTX file.

usage: gpu_build.py --work DIR --out FILE.ptx --stamp TEXT [-D NAME] [--no-fma] SOURCE...

The first line of the file carries the stamp of the sources (gpu_stamp.py), which the executable
compares with its own. Where ptxas is installed (Python package nvidia-cuda-nvcc) a kernel with a
stack frame or a register spill fails the build, and the registers of each kernel are printed.
Where flang-22 is missing, the file of that name in ptx/ (a release archive brings it along) is
taken if it is of the same sources.
Kernels whose names start with redo_ or each_cut_ may spill: they work near walls and where cells
fall back, and such cells are few.
So may the few bytes of the kernels in STACK.
"""

import argparse
import os
import re
import shutil
import sys
from pathlib import Path

import device_cache
from cuda_fortran import (
    ARITHMETIC,
    BIN,
    Fault,
    compile_all,
    kernels_of,
    mangled,
    marked,
    missing_tools,
    run,
    translate,
)

# bytes of stack that a kernel may have: the ply keeps more numbers than a thread has registers,
# and two faces more than their bound on registers, those of WENO3 only where there are products;
# the rows, those of the cosine for angles so large that none of them comes near; bonds, plates and
# tilted sums, see BLOCKS of cuda_fortran.py; curved walls in real64, which turn by two normals,
# eight numbers, and plates there three; concrete such a cosine and six numbers
STACK = {
    "update_by_hjc": 88,
    "update_by_orthotropic_ply": 112,
    "faces_muscl_hllc": 8,
    "faces_weno3_split": 48,
    "solid_rows": 40,
    "solid_forces_wall": 72,
    "solid_forces_plate": 72,
    "solid_moments_tilted": 24,
    "solid_bond_moments": 80,
    "each_pull_links": 64,
}

SHIPPED = Path("ptx")  # of a release archive


def ptxas():
    for root in [Path(sys.prefix), Path(".venv")]:
        yield from root.glob("lib/python3*/site-packages/nvidia/**/bin/ptxas")


def resources(ptx, args):
    """Print the registers of each kernel; refuse stack frames and spills."""
    tool = next(ptxas(), None)
    if not tool:
        print("ptxas is not installed: registers and spills are not checked")
        if os.environ.get("CI") == "true":
            raise Fault("ptxas is missing: run make setup")
        return
    report = run(tool, "-v", "-O3", "-arch=sm_90", ptx, "-o", args.work / "kernels.cubin")
    name, faults = "", []
    for line in report.splitlines():
        if found := re.search(r"(?:Function properties for|entry function) '?(\w+)", line):
            name = found[1]
        frame = re.search(r"(\d+) bytes stack frame, (\d+) bytes spill stores", line)
        allowed = frame and max(map(int, frame.groups())) <= STACK.get(name, 0)
        if frame and not allowed and not name.startswith(("redo_", "each_cut_")):
            faults.append(f"{name}: {line.strip()}")
        if found := re.search(r"Used (\d+) registers", line):
            print(f"{name}: {found[1]} registers")
    if faults:
        raise Fault("\n".join(faults))


def key_of(args):
    """A name for what the GPU code is made from; see device_cache."""
    wanted = [path for path in args.sources if path.suffix == ".CUF" or marked(path)]
    scripts = [device_cache.SCRIPTS / name for name in ("cuda_fortran.py", "gpu_build.py")]
    files = device_cache.files_of(args.sources, wanted)
    checked = next(ptxas(), None) is not None
    words = [args.define, args.no_fma, checked, run(BIN / "llc", "--version")]
    return device_cache.key_of([*files, ARITHMETIC, *scripts], words)


def build(args):
    kept, name = args.work.parent / "cache", f"{key_of(args)}.ptx"
    args.work.mkdir(parents=True, exist_ok=True)
    if device_cache.take(kept, name, args.work / "final.ptx"):
        print(f"{args.out}: of the same sources as before")
    else:
        compile_kernels(args)
        device_cache.keep(kept, name, args.work / "final.ptx")
    args.out.parent.mkdir(parents=True, exist_ok=True)
    text = (args.work / "final.ptx").read_text(encoding="utf-8")
    args.out.write_text(f"// {args.stamp}\n" + text, encoding="utf-8")


def compile_kernels(args):
    keep = {}
    for path in args.sources:
        keep.update({mangled(path, name): name for name in kernels_of(path)})
    if len(set(keep.values())) < len(keep):
        raise Fault("two kernels have the same name")
    ir = compile_all(args.sources, keep, args)
    text = ir.read_text(encoding="utf-8")
    for symbol, name in keep.items():
        text = re.sub(rf"@{symbol}\b", f"@{name}", text)
    ir.write_text(text, encoding="utf-8")
    ptx = args.work / "final.ptx"
    translate(ir, ptx, "-O3", args.no_fma)
    resources(ptx, args)
    print(f"{args.out}: {len(keep)} kernels")


ADVICE = """The GPU code is compiled by flang-22 and llvm-22, in Debian 12 but not in Ubuntu.
Either run `make setup` where they can be had, or take a release archive: `make dist`, run there,
puts the code of both precisions into it, and `make gpu` in its folder takes it from ptx/."""


def take_shipped(args, why):
    """Copy the GPU code of a release archive, if there is one and it is of these sources."""
    shipped = SHIPPED / args.out.name.replace("-quick", "").replace("-portable", "")
    if not shipped.is_file():
        raise Fault(f"{why}, and there is no {shipped}.\n{ADVICE}")
    with shipped.open(encoding="utf-8") as file:
        if file.readline().strip() != f"// {args.stamp}":
            raise Fault(f"{why}, and {shipped} is of other sources.\n{ADVICE}")
    if args.no_fma:
        raise Fault(f"{why}, and {shipped} has contractions: leave out FMA=off")
    args.out.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(shipped, args.out)
    print(f"{args.out}: taken from {shipped} ({why})")


def arguments(text):
    """What the command line of a builder of GPU code says; text describes the builder."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument("--work", required=True, type=Path)
    parser.add_argument("--out", required=True, type=Path)
    parser.add_argument("--stamp", required=True)
    parser.add_argument("-D", dest="define", action="append", default=[])
    parser.add_argument("--no-fma", action="store_true", help="no contraction of a*b + c")
    parser.add_argument("sources", nargs="+", type=Path)
    return parser.parse_args()


def main():
    args = arguments(__doc__)
    try:
        if why := missing_tools():
            take_shipped(args, why)
        else:
            build(args)
    except Fault as fault:
        sys.exit(f"gpu_build: {fault}")


if __name__ == "__main__":
    main()
