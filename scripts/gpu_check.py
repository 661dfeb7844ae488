#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compile all point physics (procedures below a `!@cuf` line) as CUDA Fortran for the GPU.

usage: gpu_check.py --work DIR [-D NAME] SOURCE...

Each file with such procedures goes through flang for nvptx64. Then everything is linked with
libdevice, every marked procedure is kept, all else is dropped, and what is left must be device
code: no call of the Fortran run-time library, no unresolved symbol, no module variable, no stack
array whose size is known at run time only. Modules that these files use are compiled as well,
so a file may hold host code beside its device procedures as long as these do not call it.
"""

import argparse
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from depend import scan

BIN = Path("/usr/lib/llvm-22/bin")
TARGET = ["-triple", "nvptx64-nvidia-cuda", "-target-cpu", "sm_80"]
MACHINE = ["-mtriple=nvptx64-nvidia-cuda", "-mcpu=sm_80"]
RAW = ["-mllvm", "-opt-bisect-limit=0", "-mllvm", "-opt-bisect-verbose=0", "-emit-llvm"]
MARK = re.compile(r"^\s*!@cuf\b\s*(.*)$", re.I)
HEAD = re.compile(r"^\s*(?:pure|elemental)\b.*?\b(?:subroutine|function)\s+(\w+)", re.I)
MODULE = re.compile(r"^\s*module\s+(?!procedure\b)(\w+)", re.I | re.M)
# intrinsics that the NVPTX back end cannot translate, and their names in libdevice
MATH = "exp exp2 exp10 log log2 log10 pow powi sin cos tan asin acos atan atan2 sinh cosh tanh"
LIBM = "erf erfc tgamma lgamma hypot expm1 log1p cbrt asinh acosh atanh sinh cosh tanh"


class Fault(Exception):
    """Why the check fails."""


def run(*command):
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True, check=False)
    if done.returncode:
        raise Fault((done.stdout + done.stderr)[-3000:])
    return done.stdout


def marked(path):
    """Names of the device procedures of a file."""
    names, waiting = [], 0
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if waiting:
            head = HEAD.match(line)
            if not head:
                raise Fault(f"{path}:{number}: a pure procedure must follow the !@cuf line")
            names.append(head.group(1).lower())
            waiting = 0
        elif found := MARK.match(line):
            if found.group(1).replace(" ", "") != "attributes(host,device)&":
                raise Fault(f"{path}:{number}: write '!@cuf attributes(host,device) &'")
            waiting = number
    return names


def in_order(wanted, needs, owner):
    """Levels of files: each level uses only earlier ones."""
    level = {}

    def depth(path):
        if path not in level:
            level[path] = 0
            used = [owner[m] for m in needs[path] if m in owner and owner[m] != path]
            level[path] = 1 + max(map(depth, used), default=0)
        return level[path]

    for path in wanted:
        depth(path)
    groups = {}
    for path, number in level.items():
        groups.setdefault(number, []).append(path)
    return [sorted(groups[n]) for n in sorted(groups)]


def edited(text):
    """IR with calls of libdevice for the mathematics."""
    suffix = {"f32": "f", "f64": ""}
    pattern = rf"@llvm\.({'|'.join(MATH.split())})\.(f32|f64)(?:\.i32)?\("
    text = re.sub(pattern, lambda m: f"@__nv_{m[1]}{suffix[m[2]]}(", text)
    text = re.sub(rf"@({'|'.join(LIBM.split())})(f?)\(", r"@__nv_\1\2(", text)
    saturated = r"@llvm\.fptosi\.sat\.(i32|i64)\.(f32|f64)\("
    short = {"f32": "f", "f64": "d", "i32": "i", "i64": "ll"}
    return re.sub(saturated, lambda m: f"@llvm.nvvm.{short[m[2]]}2{short[m[1]]}.rz(", text)


def compile_one(path, names, args):
    """IR of a file, or only its module file where it holds no device procedure."""
    flang = [BIN / "flang", "-fc1", *TARGET, "-x", "cuda", "-cpp", "-O3", "-fstack-arrays", "-w"]
    flang += ["-module-dir", args.work, "-I", args.work, *(f"-D{name}" for name in args.define)]
    if not names:
        run(*flang, "-fsyntax-only", path)
        return None
    out = args.work / (path.stem + ".ll")
    run(*flang, *RAW, path, "-o", out)
    out.write_text(edited(out.read_text(encoding="utf-8")), encoding="utf-8")
    return out


def variables_of(text, keep):
    """Module variables that device procedures read, in IR before any optimisation."""
    variables = set(re.findall(r"^@(_QM\w+) = (?:\w+ )*?global\b", text, re.M))
    found = []
    for body in re.split(r"^define ", text, flags=re.M)[1:]:
        name = re.search(r"@([\w.$]+)\(", body)[1]
        used = sorted(set(re.findall(r"@(_QM\w+)", body)) & variables) if name in keep else []
        found += [f"{keep[name]}: module variable {v}" for v in used]
    return found


def libdevice():
    for root in [Path(sys.prefix), Path(".venv")]:
        for found in root.glob("lib/python3*/site-packages/nvidia/**/libdevice*.bc"):
            return found
    raise Fault("libdevice is missing: run make setup")


def faults_of(text, keep):
    """What is no device code in the optimised IR."""
    found = []
    bodies = re.split(r"^define ", text, flags=re.M)
    outside = set(re.findall(r"^declare .*?@([\w.$]+)\(", text, re.M))
    outside = {name for name in outside if not name.startswith("llvm.")}
    for body in bodies[1:]:
        name = re.search(r"@([\w.$]+)\(", body)[1]
        label = keep.get(name, name)
        for other in sorted(set(re.findall(r"@([\w.$]+)", body)) & outside):
            kind = "run-time library call" if other.startswith("_Fortran") else "unresolved symbol"
            found.append(f"{label}: {kind} {other}")
        if re.search(r"\balloca [^\n]*?, i\d+ %", body):
            found.append(f"{label}: stack array of run-time size")
    defined = {re.search(r"@([\w.$]+)\(", body)[1] for body in bodies[1:]}
    return found + [f"{keep[name]}: not in the device code" for name in keep if name not in defined]


def check(args):
    names = {path: marked(path) for path in args.sources}
    needs, owner = {}, {}
    for path in args.sources:
        makes, needs[path] = scan(path)
        owner.update({module: path for module in makes})
    files = []
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for group in in_order([p for p in names if names[p]], needs, owner):
            files += pool.map(lambda path: compile_one(path, names[path], args), group)
    keep = {}
    for path, procedures in names.items():
        if procedures:
            module = MODULE.search(path.read_text(encoding="utf-8"))[1].lower()
            keep.update({f"_QM{module}P{name}": f"{path}: {name}" for name in procedures})
            print(f"{path}: {len(procedures)} device procedures")
    linked, whole, final = (args.work / x for x in ("linked.bc", "whole.bc", "final.ll"))
    link = [BIN / "llvm-link", "--suppress-warnings"]
    run(*link, *filter(None, files), "-o", linked)
    run(*link, "--only-needed", linked, libdevice(), "-o", whole)
    passes = ["-passes=internalize,default<O3>", f"-internalize-public-api-list={','.join(keep)}"]
    run(BIN / "opt", *MACHINE, *passes, whole, "-S", "-o", final)
    found = [f for path in filter(None, files) for f in variables_of(path.read_text(), keep)]
    found += faults_of(final.read_text(encoding="utf-8"), keep)
    if found:
        raise Fault("\n".join(found))
    run(BIN / "llc", *MACHINE, "-O1", final, "-o", args.work / "final.ptx")
    print(f"{len(keep)} device procedures compile for the GPU{' '.join(['', *args.define])}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--work", required=True, type=Path)
    parser.add_argument("-D", dest="define", action="append", default=[])
    parser.add_argument("sources", nargs="+", type=Path)
    args = parser.parse_args()
    if not (BIN / "flang").exists():
        print("skipped: flang-22 is not installed, so point physics is not checked for the GPU")
        sys.exit(os.environ.get("CI") == "true")
    args.work.mkdir(parents=True, exist_ok=True)
    try:
        check(args)
    except Fault as fault:
        sys.exit(f"gpu_check: {fault}")


if __name__ == "__main__":
    main()
