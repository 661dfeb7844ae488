#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Build a CUDA driver that runs the kernels on the CPU, to test the GPU path where there is none.

usage: gpu_emulate.py --work DIR --out DIR/libcuda.so.1 [-D NAME] SOURCE...

The kernels of cuda/*.CUF are translated to plain Fortran: the CUDA attributes go, scalars are
passed by reference, and threadIdx and the like come from a module. That is exact because the
kernels use no shared memory, no barrier and no atomic operation but the addition of integers.
Everything is compiled once more for a shared library, without contraction of a*b + c, beside
tests/gpu/emulator.c.
"""

import argparse
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import device_cache
from cuda_fortran import MODULE, in_order, kernels_of
from depend import scan

# (fewer instructions for each thread: variables of threads at fixed places, calls that bind here)
BOTH = ["-O2", "-w", "-fPIC", "-fopenmp", "-ftls-model=initial-exec", "-fno-semantic-interposition"]
FLAGS = [*BOTH, "-std=f2018", "-march=native", "-ffp-contract=off"]
HERE = Path("tests/gpu")


def translated(text):
    """Plain Fortran from CUDA Fortran, and [(kernel, symbol, letters of its arguments)]."""
    table, module = [], MODULE.search(text)[1].lower()
    head = re.compile(
        r"attributes\(global\)\s*(?:launch_bounds\([^)]*\)\s*)?(subroutine\s+(\w+)\s*\()", re.I
    )

    def head_of(found):
        rest = text[found.end() :]
        names = re.sub(r"&\s*\n\s*&?", "", rest[: rest.index(")")])
        body = rest[: rest.lower().index("end subroutine")]
        values = " ".join(re.findall(r",\s*value\s*::([^!\n]*)", body, re.I))
        scalars = set(re.findall(r"\w+", values))
        letters = "".join("s" if n.strip() in scalars else "a" for n in names.split(","))
        name = found[2].lower()
        table.append((name, f"__{module}_MOD_{name}", letters))
        return found[1]

    text = head.sub(head_of, text)
    text = re.sub(r",\s*(?:device|value)\b", "", text, flags=re.I)
    text = re.sub(r"attributes\(device\)\s*", "pure ", text, flags=re.I)
    names = "use emulated_cuda, only: threadIdx, blockIdx, blockDim, gridDim, atomicadd"
    return re.sub(r"^(\s*module\s+\w+\s*)$", rf"\1\n    {names}", text, count=1, flags=re.M), table


def compile_all(paths, args):
    """Objects of the sources that the kernels need, in order."""
    needs, owner = {}, {}
    for path in paths:
        makes, needs[path] = scan(path)
        owner.update({module: path for module in makes})
    kernels = [p for p in paths if p.suffix == ".CUF"]
    table, objects = [], []
    compiler = ["gfortran", *FLAGS, "-cpp", *(f"-D{d}" for d in args.define), f"-J{args.work}"]

    def one(path):
        source = path
        if path in kernels:
            text, found = translated(path.read_text(encoding="utf-8"))
            source = args.work / (path.stem + "_kernels.f90")
            source.write_text(text, encoding="utf-8")
            table.extend(found)
        made = args.work / (str(path).replace("/", "_") + ".o")
        subprocess.run([*compiler, "-c", source, "-o", made], check=True)
        objects.append(made)

    one(HERE / "emulated_cuda.f90")
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for group in in_order(kernels, needs, owner):
            list(pool.map(one, group))
    return objects, table


def table_source(table):
    """C: for each kernel a function that runs a block of threads, and the table of kernels."""
    lines = ['#include "emulator.h"']
    for name, symbol, letters in table:
        arguments = ", ".join(f"p[{i}]" for i in range(len(letters)))
        lines += [f"extern void {symbol}();", f"static void run_{name}(void **p, const int *b) {{"]
        lines += [f"    EACH_THREAD(b) {symbol}({arguments});", "}"]
    lines += ["const struct kernel kernels[] = {"]
    lines += [f'    {{"{name}", run_{name}, "{letters}"}},' for name, _, letters in table]
    return "\n".join([*lines, "    {0, 0, 0}};", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--work", required=True, type=Path)
    parser.add_argument("--out", required=True, type=Path)
    parser.add_argument("-D", dest="define", action="append", default=[])
    parser.add_argument("sources", nargs="+", type=Path)
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    kept, name = args.work.parent / "cache", f"{key_of(args)}.so"
    if device_cache.take(kept, name, args.out):
        print(f"{args.out}: of the same sources as before")
        return
    build(args)
    device_cache.keep(kept, name, args.out)


def key_of(args):
    """A name for what the emulator is made from; see device_cache."""
    wanted = [path for path in args.sources if path.suffix == ".CUF"]
    scripts = [device_cache.SCRIPTS / name for name in ("cuda_fortran.py", "gpu_emulate.py")]
    files = [*device_cache.files_of(args.sources, wanted), *sorted(HERE.glob("emul*")), *scripts]
    version = subprocess.run(["gfortran", "--version"], capture_output=True, check=True).stdout
    return device_cache.key_of(files, [args.define, version])


def build(args):
    args.out.parent.mkdir(parents=True, exist_ok=True)
    objects, table = compile_all(args.sources, args)
    named = [name for path in args.sources for name in kernels_of(path)]
    if len(expected := set(named)) < len(named):
        twice = sorted({name for name in named if named.count(name) > 1})
        sys.exit(f"gpu_emulate: two kernels have the same name: {twice}")
    if missing := expected - {name for name, _, _ in table}:
        sys.exit(f"gpu_emulate: kernels not translated: {missing}")
    listing = args.work / "kernels.c"
    listing.write_text(table_source(table), encoding="utf-8")
    link = ["gcc", *BOTH, "-shared", f"-I{HERE}", HERE / "emulator.c", listing]
    link += [*objects, "-o", args.out, "-lgfortran", "-lm"]
    subprocess.run(link, check=True)
    print(f"{args.out}: {len(table)} kernels on the CPU")


if __name__ == "__main__":
    main()
