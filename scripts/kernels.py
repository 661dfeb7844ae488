#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the launches of the kernels of a family, and the kernels that are variants of a procedure.

usage: kernels.py NAME OUTDIR FILE.CUF...    (NAME_launches.f90, and NAME_variants.CUF if any)

A launch has the arguments of its kernel, behind the threads in x, y, z, with the types that they
have there: NAME_kernels_t holds the kernels of the files and launches them. A procedure on the
device with lines such as

    !@kernel march_weno3_split(128,3): 0, weno3_cells, steger_warming

is called by a kernel for each of them, with these constants in place of its first arguments and
with these bounds on a launch: `launch_PROCEDURE` launches the kernel that it is given. `march_?: 0,
?` stands for all schemes of the air that no other line names. Structures
are passed by value, but for those whose line says `!@buffer`; an array of `!@any` may be a buffer
of other numbers. Kernels whose name has a star are written by another script, models.py.
"""

import re
import sys
from pathlib import Path

from item_heads import (
    BUFFER,
    KNOWN,
    USE,
    Argument,
    at_line,
    fold,
    line_at,
    procedure,
    write,
)
from items import launches

KERNEL = re.compile(r"((?:^ *!>.*\n)+)^ *attributes\(global\)[^&\n]*?subroutine (\w+)\(", re.M)
VARIED = re.compile(
    r"((?:^ *!>.*\n)+)((?:^ *!@kernel .*\n)+)^ *attributes\(device\) subroutine (\w+)\(", re.M
)
VARIANT = re.compile(r"!@kernel ([\w*?]+)(\([\d, ]+\))?: (.*)")
PUBLIC = re.compile(r"^ *public :: ((?:[\w, ]|& *\n *&?)+)", re.M)
LINE = re.compile(
    r"^ *(\w+(?:\(\w+\))?), *(value|(?:device, *)?intent\(\w+\)) *::([^!\n]*)(?:!!?(.*))?", re.M
)

RECONSTRUCTIONS = {"first_order": "first_order"}
RECONSTRUCTIONS |= {x: f"{x}_cells" for x in ("muscl", "weno3", "weno5z")}
SOLVERS = {"split": "steger_warming", "hllc": "hllc"}


class Kernel:
    """What the head of a kernel, or of a procedure with variants, says."""

    def __init__(self, doc, name, rest, variants=()):
        rest = re.sub(r" *& *\n *&?", " ", rest[: rest.index("end subroutine")])
        self.doc, self.name, found = doc.strip(), name, {}
        for kind, how, names, comment in LINE.findall(rest):
            for one, shape in re.findall(r"(\w+)(\([^)]*\))?", names):
                tag = "@buffer" if "device" in how and not shape else ""
                intent = how.removeprefix("device, ")
                found[one] = Argument(one, shape, kind, intent, tag + comment.replace("@any", ""))
                found[one].any = "@any" in comment
        names = re.findall(r"\w+", rest[: rest.index(")")])
        self.variants = variants
        skip = len(variants[0][2].split(",")) if variants else 0
        self.given = [found[x] for x in names[skip:]]


def each_scheme(found):
    """(name, bounds, constants) of all variants: `?` stands for every scheme that is not named."""
    for name, bounds, constants in found:
        for r, cells in RECONSTRUCTIONS.items():
            for s, solver in SOLVERS.items():
                one = name.replace("?", f"{r}_{s}")
                if one == name or one not in [x[0] for x in found]:
                    yield one, bounds, constants.replace("?", f"{cells}, {solver}")


def parameters(kernel):
    """Declarations and statements of a launch: every argument is added."""
    declared, body = [], []
    for a in kernel.given:
        kind = f"type({BUFFER.get(a.kind, 'buffer_t')})" if a.in_memory else a.kind
        kind = "class(buffer_t)" if a.any else kind
        declared += [f"{kind}, intent(in) :: {a.name}{a.comment}"]
        how = "_structure({0}, storage_size({0})/8)" if a.whole else "({0})"
        body += ["call a%add" + how.format(a.name)]
    declared += ["type(error_t), intent(inout) :: err", "type(arguments_t) :: a"]
    return declared, body


def launch(number, stem, kernel):
    """A procedure that launches the kernel."""
    declared, body = parameters(kernel)
    owner, names = ["integer, intent(in) :: threads(3) !! in x, y, z"], ["threads"]
    if kernel.variants:
        owner.insert(0, "type(kernel_t), intent(in) :: kernel !! one of its variants")
        names, found = ["kernel", *names], "kernel"
    else:
        found = f"kernel({number})"
        body += [f"call find_once('{kernel.name}', {found}, err)"]
    body += [f"call launch({found}, threads, a, err)"]
    names += [*(a.name for a in kernel.given), "err"]
    head = f"subroutine launch_{kernel.name}"
    return procedure(kernel.doc, head, names, [*owner, *declared], body)


def variants(kernel):
    """The kernels that call a procedure with constants."""
    how = {True: "device, {}", False: "value"}
    declared = [f"{a.kind}, {how[a.in_memory].format(a.intent)} :: {a.end}" for a in kernel.given]
    for name, bounds, constants in kernel.variants:
        if "*" in name:
            continue
        names = [a.name for a in kernel.given]
        head = f"attributes(global) {'launch_bounds' + bounds + ' ' if bounds else ''}subroutine"
        call = fold(f"call {kernel.name}({', '.join([*constants.split(', '), *names])})")
        yield procedure(kernel.doc, f"{head} {name}", names, declared, call)


def main():
    stem, folder, plain, varied = sys.argv[1], Path(sys.argv[2]), [], []
    known, own = dict(KNOWN), {}
    places = {}
    for path, text in ((x, Path(x).read_text(encoding="utf-8")) for x in sys.argv[3:]):
        for m in KERNEL.finditer(text):
            plain += [Kernel(*m.groups(), text[m.end() :])]
            places[m[2]] = line_at(text, m.end()), path
        for m in VARIED.finditer(text):
            found = list(dict.fromkeys(each_scheme(VARIANT.findall(m[2]))))
            varied += [Kernel(m[1], m[3], text[m.end() :], found)]
            places[m[3]] = line_at(text, m.end()), path
        for owner, names in USE.findall(text):
            known |= dict.fromkeys(re.findall(r"\w+", names), owner)
        for names in PUBLIC.findall(text):
            module = re.search(r"^module (\w+)", text, re.M)[1]
            own |= dict.fromkeys(re.findall(r"\w+", names), module)
    kind, made = launches(stem, plain, launch) if plain else ([], [])
    made += [launch(0, stem, x) for x in varied]
    made = [at_line(x, *places[k.name]) for x, k in zip(made, plain + varied, strict=True)]
    source = f"cuda/{stem}*.CUF"
    write(folder / f"{stem}_launches.f90", source, known, kind, made)
    if made := [one for x in varied for one in variants(x)]:
        write(folder / f"{stem}_variants.CUF", source, known | own, [], made)


main()
