#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Build the GPU code with nvfortran, a route that is untried: docs/evidence/performance.md.

usage: gpu_nvfortran.py --work DIR --out FILE.ptx --stamp TEXT [-D NAME] [--no-fma] SOURCE...

The same sources as for flang go into one file, in the order of their modules, so that nvfortran
needs no device linker. It keeps the PTX, in which kernels are called module_kernel_; they get
their plain names, which the program looks for. NVFORTRAN names another compiler.
"""

import os
import re
import shutil
import subprocess
import sys

from cuda_fortran import MODULE, in_order, kernels_of, marked
from depend import scan
from gpu_build import arguments

FLAGS = ["-cuda", "-gpu=cc80,keepptx", "-cpp", "-O3"]


def whole(sources):
    """Text of all files that hold device code or modules that it uses, each after what it uses."""
    needs, owner = {}, {}
    for path in sources:
        makes, needs[path] = scan(path)
        owner.update({module: path for module in makes})
    wanted = [p for p in sources if p.suffix == ".CUF" or marked(p)]
    order = [path for group in in_order(wanted, needs, owner) for path in group]
    return "".join(path.read_text(encoding="utf-8") for path in order)


def plain_names(ptx, sources):
    """PTX whose kernels have the names of the sources."""
    for path in sources:
        for name in kernels_of(path):
            module = MODULE.search(path.read_text(encoding="utf-8"))[1].lower()
            ptx, n = re.subn(rf"\b{module}_{name}_\b", name, ptx)
            if not n:
                sys.exit(f"gpu_nvfortran: the PTX has no kernel {module}_{name}_")
    return ptx


def main():
    args = arguments(__doc__)
    compiler = os.environ.get("NVFORTRAN", "nvfortran")
    if not shutil.which(compiler):
        sys.exit(f"gpu_nvfortran: {compiler} is not installed (NVIDIA HPC SDK)")
    shutil.rmtree(args.work, ignore_errors=True)
    args.work.mkdir(parents=True)
    source = args.work / "kernels.CUF"
    source.write_text(whole(args.sources), encoding="utf-8")
    flags = FLAGS + [f"-D{name}" for name in args.define] + (["-Mnofma"] if args.no_fma else [])
    subprocess.run([compiler, *flags, "-c", source.name], cwd=args.work, check=True)
    made = sorted(args.work.glob("*.ptx"))
    if len(made) != 1:
        sys.exit(f"gpu_nvfortran: expected one PTX file in {args.work}, found {len(made)}")
    ptx = plain_names(made[0].read_text(encoding="utf-8"), args.sources)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    args.out.write_text(f"// {args.stamp}\n{ptx}", encoding="utf-8")
    print(f"{args.out}: built with {compiler}")


if __name__ == "__main__":
    main()
