# SPDX-License-Identifier: MIT
"""Compile point physics and CUDA Fortran kernels for the GPU with flang and LLVM.

Point physics: procedures below a `!@cuf` line in src. Kernels: `attributes(global)` procedures in
cuda/*.CUF. Each file goes through flang for nvptx64; the IR is edited where LLVM has no code for
what flang writes, and in the air divisions and roots become those of cuda/arithmetic.ll; then
everything is linked with libdevice, what is asked for is kept and all else is dropped. What is
left must be device code: no call of the Fortran run-time library, no unresolved symbol, no module
variable, no stack array whose size is known at run time only.
"""

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
KERNEL = re.compile(
    r"^\s*attributes\(global\)\s*(?:launch_bounds\((\d+), *(\d+)\)\s*)?subroutine\s+(\w+)",
    re.I | re.M,
)
MODULE = re.compile(r"^\s*module\s+(?!procedure\b)(\w+)", re.I | re.M)
# intrinsics that the NVPTX back end cannot translate, and their names in libdevice
MATH = "exp exp2 exp10 log log2 log10 pow powi sin cos tan asin acos atan atan2 sinh cosh tanh"
LIBM = "erf erfc tgamma lgamma hypot expm1 log1p cbrt asinh acosh atanh sinh cosh tanh"
ARITHMETIC = Path("cuda/arithmetic.ll")
AIR = re.compile(r"src/air/|cuda/air")  # the files that use it
# blocks of 128 threads that a multiprocessor is to hold at least, in mixed precision: these wait
# for memory, and a few numbers in the stack cost less than a quarter of the threads
BLOCKS = {
    "solid_forces_drawn": 4,
    "solid_forces_plate": 4,
    "solid_moments_drawn": 5,
    "solid_moments_tilted": 5,
    "solid_gradients": 5,
    "solid_rows": 6,
    "update_by_hjc": 3,
    "each_pull_links": 4,
    "solid_bond_moments": 4,
}
REGISTER = {"threadidx": "tid", "blockidx": "ctaid", "blockdim": "ntid", "griddim": "nctaid"}
BUILTIN = re.compile(
    r"(?P<to>%\w+) = load i32, ptr (?:getelementptr [^@]*)?"
    r"@_QM__fortran_builtinsE__builtin_(?P<name>threadidx|blockidx|blockdim|griddim)"
    r"(?P<at>[^,\n]*(?:, i(?:32|64) \d+)*\))?, align \d+(?:, !tbaa !\d+)?"
)


class Fault(Exception):
    """Why the sources are no device code."""


def missing_tools():
    """What is not installed and must be, or ''."""
    return "" if (BIN / "flang").exists() else "flang-22 is not installed"


def run(*command):
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True, check=False)
    if done.returncode:
        raise Fault((done.stdout + done.stderr)[-3000:])
    return done.stdout + done.stderr


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


def kernels_of(path):
    """{name: launch bounds or None} of the kernels of a file."""
    if path.suffix != ".CUF":
        return {}
    found = KERNEL.findall(path.read_text(encoding="utf-8"))
    return {name.lower(): (most, least) if most else None for most, least, name in found}


def mangled(path, name):
    """Symbol of a module procedure as flang writes it."""
    return f"_QM{MODULE.search(path.read_text(encoding='utf-8'))[1].lower()}P{name}"


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


def special_register(found):
    """A component of threadIdx and the like, which flang reads from a structure in memory."""
    offset = re.findall(r"i(?:32|64) (\d+)", found["at"] or "")
    axis = "xyz"[int(offset[-1]) // (4 if "i8, ptr" in found[0] else 1) if offset else 0]
    call = f"call i32 @llvm.nvvm.read.ptx.sreg.{REGISTER[found['name']]}.{axis}()"
    if found["name"].endswith("dim"):
        return f"{found['to']} = {call}"
    plain = f"%from0.{found['to'][1:]}"
    return f"{plain} = {call}\n  {found['to']} = add nsw i32 {plain}, 1"


def layout_of(kind, text, work):
    """Name of a derived type in the IR of a file; what defines it where that is elsewhere."""
    definition = re.compile(rf"^(%_QM\w+T{kind.lower()}) = type .*$", re.M)
    if found := definition.search(text):
        return found[1], ""
    for other in sorted(work.glob("*.ll")):
        if found := definition.search(other.read_text(encoding="utf-8")):
            needed = found[0] + "\n"
            for part in re.findall(r"%_QM\w+?T(\w+)", found[0].partition("=")[2]):
                needed += layout_of(part, text + needed, work)[1]
            return found[1], needed
    raise Fault(f"the structure {kind} is nowhere defined")


def structures_by_value(text, path, work):
    """IR whose kernels take structures with the attribute `value` as such: flang passes pointers.

    They land in the constant bank of the GPU, where instructions read them without a register.
    """
    source, extra = re.sub(r"&\s*\n\s*&?", "", path.read_text(encoding="utf-8")), "\n"
    for name in kernels_of(path):
        found = re.search(
            rf"subroutine\s+{name}\s*\(([^)]*)\)(.*?)end subroutine", source, re.I | re.S
        )
        names = [x.strip() for x in found[1].split(",")]
        types = {}
        for kind, declared in re.findall(
            r"type\((\w+)\)\s*,\s*value\s*::([^!\n]*)", found[2], re.I
        ):
            types.update({x: kind for x in re.findall(r"\w+", declared)})
        head = re.search(rf"^define void @{mangled(path, name)}\((.*)\)(?= |$)", text, re.M)
        given = re.split(r", (?=ptr|i\d+|float|double)", head[1])
        for place, argument in enumerate(names):
            if argument in types:
                kind, definition = layout_of(types[argument], text + extra, work)
                given[place] = f"ptr byval({kind}) align 8 {given[place].split()[-1]}"
                extra += definition
        text = text[: head.start(1)] + ", ".join(given) + text[head.end(1) :]
    return text + extra


def without_branches(text):
    """IR with the divisions and square roots of cuda/arithmetic.ll."""
    short = {"float": "f32", "double": "f64"}
    divide = re.compile(r"= fdiv (?:\w+ )*?(float|double) ([^,\n]+), (%[^,\n]+)")
    text = divide.sub(
        lambda m: f"= call {m[1]} @brz_divide.{short[m[1]]}({m[1]} {m[2]}, {m[1]} {m[3]})", text
    )
    text = re.sub(r"@llvm\.sqrt\.(f32|f64)\(", r"@brz_root.\1(", text)
    for kind, size in short.items():
        text += f"\ndeclare {kind} @brz_divide.{size}({kind}, {kind})"
    return text


def edited(text, path, work, mixed):
    """IR with what LLVM can translate for the GPU."""
    if AIR.match(path.as_posix()):
        text = without_branches(text)
    suffix = {"f32": "f", "f64": ""}
    pattern = rf"@llvm\.({'|'.join(MATH.split())})\.(f32|f64)(?:\.i32)?\("
    text = re.sub(pattern, lambda m: f"@__nv_{m[1]}{suffix[m[2]]}(", text)
    text = re.sub(rf"@({'|'.join(LIBM.split())})(f?)\(", r"@__nv_\1\2(", text)
    saturated = r"@llvm\.fptosi\.sat\.(i32|i64)\.(f32|f64)\("
    short = {"f32": "f", "f64": "d", "i32": "i", "i64": "ll"}
    text = re.sub(saturated, lambda m: f"@llvm.nvvm.{short[m[2]]}2{short[m[1]]}.rz(", text)
    text = BUILTIN.sub(special_register, text)
    if left := re.search(r"^ .*@_QM__fortran_builtinsE__builtin_.*$", text, re.M):
        raise Fault(f"{path}: unknown use of a CUDA variable: {left[0].strip()}")
    for register in REGISTER.values():
        text += "".join(f"\ndeclare i32 @llvm.nvvm.read.ptx.sreg.{register}.{x}()" for x in "xyz")
    text = structures_by_value(text, path, work)
    for name, bounds in kernels_of(path).items():
        most, least = (128, BLOCKS[name]) if mixed and name in BLOCKS else bounds or (0, 0)
        marks = f' "nvvm.maxntid"="{most}" "nvvm.minctasm"="{least}"' if most else ""
        head = rf"^define void (@{mangled(path, name)}\(.*\))( [^{{]*)?\{{"
        text, n = re.subn(head, rf"define ptx_kernel void \1{marks}\2{{", text, flags=re.M)
        text = aligned(text, path, name)
        if n != 1:
            raise Fault(f"{path}: kernel {name} is not in the code that flang wrote")
    return text + "\n"


def aligned(text, path, name):
    """Tell which arrays of a kernel begin at whole 16 B, as buffers do.

    The solids gather rows by wide loads; the air would only need more registers. Kernels of items
    may be given a part of a buffer, but where rows have these lengths a whole one.
    """
    head = re.search(rf"^define ptx_kernel void @{mangled(path, name)}\((.*)\)(?= |$)", text, re.M)
    given = re.split(r", (?=ptr|i\d+|float|double)", head[1])
    source = re.sub(r"&\s*\n\s*&?", "", path.read_text(encoding="utf-8"))
    found = re.search(rf"subroutine\s+{name}\s*\(([^)]*)\)(.*?)end subroutine", source, re.I | re.S)
    for place, argument in enumerate(x.strip() for x in found[1].split(",")):
        rows = re.search(rf"\b{argument}\((?:lay%wide|n_pair|n_control|n_press), \*\)", found[2])
        if name.startswith("solid_") or rows:
            given[place] = re.sub(r"\bptr\b(?! byval)", "ptr align 16", given[place])
    return text[: head.start(1)] + ", ".join(given) + text[head.end(1) :]


def compile_one(path, wanted, args):
    """IR of a file, or only its module file where it holds no device code."""
    flang = [BIN / "flang", "-fc1", *TARGET, "-x", "cuda", "-cpp", "-O3", "-fstack-arrays", "-w"]
    flang += ["-module-dir", args.work, "-I", args.work]
    flang += [f"-D{name}" for name in args.define]
    if args.no_fma:
        flang += ["-ffp-contract=off"]
    if not wanted:
        run(*flang, "-fsyntax-only", path)
        return None
    raw, out = args.work / (path.stem + ".raw"), args.work / (path.stem + ".ll")
    run(*flang, *RAW, path, "-o", raw)
    text = edited(raw.read_text(encoding="utf-8"), path, args.work, "BRZ_MIXED" in args.define)
    raw.write_text(text, encoding="utf-8")
    return raw.rename(out)  # whole when another file looks for a structure in it


def variables_of(text, keep):
    """Module variables that kept procedures read, in IR before any optimisation."""
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
    for name in re.findall(r"^@([\w.$]+) = external\b", text, re.M):
        found.append(f"{name}: a constant or variable of a module without device procedures")
    defined = {re.search(r"@([\w.$]+)\(", body)[1] for body in bodies[1:]}
    return found + [f"{keep[name]}: not in the device code" for name in keep if name not in defined]


def compile_all(sources, keep, args):
    """Optimised IR of the sources with the procedures of keep {symbol: label}, and all they need.

    args: work (folder), define (list of macros), no_fma (no contraction of a*b + c).
    """
    args.work.mkdir(parents=True, exist_ok=True)
    for old in args.work.glob("*.ll"):
        old.unlink()
    wanted = {path: path.suffix == ".CUF" or bool(marked(path)) for path in sources}
    needs, owner = {}, {}
    for path in sources:
        makes, needs[path] = scan(path)
        owner.update({module: path for module in makes})
    files = []
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for group in in_order([p for p in wanted if wanted[p]], needs, owner):
            files += pool.map(lambda path: compile_one(path, wanted[path], args), group)
    files = [f for f in files if f]
    linked, whole, final = (args.work / x for x in ("linked.bc", "whole.bc", "final.ll"))
    link = [BIN / "llvm-link", "--suppress-warnings"]
    run(*link, *files, ARITHMETIC, "-o", linked)
    run(*link, "--only-needed", linked, libdevice(), "-o", whole)
    passes = ["-passes=internalize,default<O3>", f"-internalize-public-api-list={','.join(keep)}"]
    limits = ["-inline-threshold=100000", "-unroll-threshold=2000"]
    run(BIN / "opt", *MACHINE, *passes, *limits, whole, "-S", "-o", final)
    found = [f for path in files for f in variables_of(path.read_text(encoding="utf-8"), keep)]
    found += faults_of(final.read_text(encoding="utf-8"), keep)
    if found:
        raise Fault("\n".join(found))
    return final


def translate(ir, ptx, optimise, no_fma=False):
    """Assembly of the GPU from IR.

    Without loop strength reduction, which keeps a pointer for each array of a loop in registers.
    """
    contract = "off" if no_fma else "fast"
    run(BIN / "llc", *MACHINE, optimise, "-disable-lsr", f"-fp-contract={contract}", ir, "-o", ptx)
