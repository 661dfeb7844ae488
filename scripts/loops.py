#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the loops, kernels and launches around loop bodies, and launches of hand-written kernels.

src/README.md says what a loop body is.

usage: loops.py OUTDIR NAME_loop_bodies.f90    (NAME_loops.f90, NAME_kernels.CUF, NAME_launches.f90)
       loops.py OUTDIR NAME FILE.CUF...  (NAME_launches.f90, and NAME_variants.CUF if any)

A launch of a hand-written kernel has the arguments of its kernel, behind the threads in x, y, z,
with the types that they have there: NAME_kernels_t holds the kernels of the files and launches
them. A procedure on the device with lines such as

    !@kernel march_weno3_split(128,3): 0, weno3_cells, steger_warming

is called by a kernel for each of them, with these constants in place of its first arguments and
with these bounds on a launch: `launch_PROCEDURE` launches the kernel that it is given. `march_?:
0, ?` stands for all schemes of the air that no other line names. Structures are passed by value,
but for those whose line says `!@buffer`; an array of `!@any` may be a buffer of other numbers.
Kernels whose name has a star are written by another script, models.py.
"""

import re
import sys
from pathlib import Path

from loop_heads import (
    BUFFER,
    KNOWN,
    LOOP_BODY,
    TALLY,
    USE,
    Argument,
    LoopBody,
    at_line,
    fold,
    inner,
    line_at,
    procedure,
    write,
)

KERNEL = re.compile(r"((?:^ *!>.*\n)+)^ *attributes\(global\)[^&\n]*?subroutine (\w+)\(", re.M)
VARIED = re.compile(
    r"((?:^ *!>.*\n)+)((?:^ *!@kernel .*\n)+)^ *attributes\(device\) subroutine (\w+)\(", re.M
)
VARIANT = re.compile(r"!@kernel ([\w*?]+)(\([\d, ]+\))?: (.*)")
PUBLIC = re.compile(r"^ *public :: ((?:[\w, ]|& *\n *&?)+)", re.M)
GIVEN = re.compile(
    r"^ *(\w+(?:\(\w+\))?), *(value|(?:device, *)?intent\(\w+\)) *::([^!\n]*)(?:!!?(.*))?", re.M
)

RECONSTRUCTIONS = {"first_order": "first_order"}
RECONSTRUCTIONS |= {x: f"{x}_cells" for x in ("muscl", "weno3", "weno5z")}
SOLVERS = {"split": "steger_warming", "hllc": "hllc"}


def loop(loop_body):
    """The loop body for 1..n on the CPU; real numbers are summed in order, by one thread."""
    i = loop_body.index
    tallies = [f"reduction({TALLY[a.tally]}:{a.name})" for a in loop_body.rest if a.tally]
    body = fold(" ".join(["parallel do", loop_body.clauses, *tallies]), "!$omp ")
    body *= not any(a.tally == "sum" for a in loop_body.rest)
    body += [f"do {i.name} = 1, n", *inner(loop_body.call), "end do"]
    declared = [f"integer, intent(in) :: {loop_body.n}"]
    declared += [f"{a.kind}, {a.intent} :: {a.end}" for a in loop_body.rest] + [
        f"integer :: {i.name}"
    ]
    names = ["n", *(a.name for a in loop_body.rest)]
    return procedure(loop_body.doc, f"subroutine each_{loop_body.name}", names, declared, body)


def exact_loop(loop_body):
    """The same where terms are summed over all processes, in any order: brz_exact_sum."""
    i, total = loop_body.index.name, loop_body.exact[0]
    size = total.end.split("(")[1].split(")")[0]
    declared = [f"integer, intent(in) :: {loop_body.n}", "type(ranks_t), intent(in) :: ranks"]
    kinds = [(a, "intent(out)" if a is total else a.intent) for a in loop_body.rest]
    declared += [f"{a.kind}, {intent} :: {a.end}" for a, intent in kinds]
    declared += [f"type(scale_t) :: scales({size})", f"integer(int64) :: limb(limbs, {size})"]
    declared += [f"real(dp) :: term({size}), largest({size})", f"integer :: {i}"]
    body = []
    passes = [("largest", "max", "widen(term, largest)", "open_sums(ranks, largest, scales)")]
    end = f"close_sums(ranks, scales, limb, {total.name})"
    passes += [("limb", "+", "add_terms(scales, term, limb)", end)]
    for found, how, look, close in passes:
        clauses = f"parallel do {loop_body.clauses} private(term) reduction({how}:{found})"
        inside = inner(["term = 0", *loop_body.call_for_term, f"call {look}"])
        body += [f"{found} = 0", *fold(clauses, "!$omp "), f"do {i} = 1, n", *inside, "end do"]
        body += [f"call {close}"]
    names = ["n", "ranks", *(a.name for a in loop_body.rest)]
    return procedure(loop_body.doc, f"subroutine each_{loop_body.name}", names, declared, body)


def dispatch(stem, loop_body):
    """The loop on the CPU, or the kernel on the GPU with the copies of the arrays there."""
    exact, named = loop_body.exact, {a.name: a for a in loop_body.rest}
    names = ["n", *(["ranks"] if exact else []), *(a.name for a in loop_body.rest)]
    declared = ["logical, intent(in) :: on_gpu !! arrays are in the present table"]
    declared += [f"integer, intent(in) :: {loop_body.n}"]
    declared += ["type(ranks_t), intent(in) :: ranks"] if exact else []
    kinds = [(a, "intent(out)" if a in exact else a.intent) for a in loop_body.rest]
    declared += [f"{a.kind}, {intent} :: {a.end}" for a, intent in kinds]
    declared += (
        ["type(doubles_t), intent(in) :: sums !! where a GPU adds up and keeps them"]
        if loop_body.sums and not exact
        else []
    )
    declared += ["type(error_t), intent(inout) :: err"]
    declared += [f"integer :: counted({len(loop_body.counts)})"] if loop_body.counts else []
    given = ["n"]
    for a in loop_body.given:
        if a.name not in named:
            continue
        kind = BUFFER.get(a.kind, "buffer_t")
        where = "on_device" if "(" in a.end.split("!")[0] else "one_on_device"
        given.append(f"{kind}({where}({a.name}))" if a.in_memory else a.name)
    if exact:
        given.append("exact")
        declared += ["type(gpu_exact_t), pointer :: exact"]
    elif loop_body.sums:
        given.append("sums")
    if loop_body.counts:
        given.append("begin_counts(err)")
    body = ["if (.not. on_gpu) then"]
    body += ["    " + x for x in fold(f"call each_{loop_body.name}({', '.join(names)})")]
    body += ["    return", "end if"]
    body += ["exact => exact_for(ranks, err)"] if exact else []
    body += fold(f"call {stem}_kernels%{loop_body.name}({', '.join([*given, 'err'])})")
    body += [f"{exact[0].name} = exact%total(:{len(loop_body.sums)})"] if exact else []
    body += ["call read_counts(counted, err)"] if loop_body.counts else []
    body += [f"{x} = {x} + counted({k})" for k, x in enumerate(loop_body.counts, 1)]
    if loop_body.sums and not exact:
        names.append("sums")
    return procedure(
        loop_body.doc,
        f"subroutine for_each_{loop_body.name}",
        ["on_gpu", *names, "err"],
        declared,
        body,
    )


def fixed(loop_body):
    """The layouts that a loop body gets, and a copy of each whose numbers the compiler knows."""
    return {a.name: f"own_{a.name}" for a in loop_body.rest if a.kind == "type(link_layout_t)"}


def kernel(loop_body):
    """The loop body for 1..n on the GPU: a thread each; a fixed number where numbers are summed."""
    i, step, own = loop_body.index, "(blockIdx%x - 1)*blockDim%x + threadIdx%x", fixed(loop_body)
    declared, how = [f"integer, value :: {loop_body.n}"], ("value", "device, {}")
    declared += [
        f"{a.kind}, {how[a.in_memory].format(a.intent)} :: {a.end}" for a in loop_body.given
    ]
    if loop_body.exact:
        return exact_kernel(loop_body, declared, step)
    declared += [f"{a.kind} :: {a.end}" for a in loop_body.rest if a.tally]
    declared += [f"type(link_layout_t) :: {name}" for name in own.values()]
    declared += [
        f"integer :: {i.name}" + ", t" * bool(loop_body.sums) + ", old" * bool(loop_body.counts)
    ]
    begin = [f"{x} = sums(t, {k})" for k, x in enumerate(loop_body.sums, 1)]
    begin += [f"{x} = 0" for x in loop_body.counts]
    begin += [f"call fix_layout({name}, {copy})" for name, copy in own.items()]
    end = [f"sums(t, {k}) = {x}" for k, x in enumerate(loop_body.sums, 1)]
    add = "if ({0} > 0) old = atomicadd(counts({1}), {0})"
    end += [add.format(x, k) for k, x in enumerate(loop_body.counts, 1)]
    if loop_body.sums:
        body = [f"t = {step}", "if (t > tally_threads) return", *begin]
        body += [
            f"do {i.name} = t, n, tally_threads",
            *inner(loop_body.call_of(own)),
            "end do",
            *end,
        ]
    else:
        call = loop_body.call_of(own)
        body = [f"{i.name} = {step}", f"if ({i.name} > n) return", *begin, *call, *end]
    head, names = (
        f"attributes(global) subroutine each_{loop_body.name}",
        [a.name for a in loop_body.given],
    )
    return procedure(loop_body.doc, head, ["n", *names], declared, body)


def exact_kernel(loop_body, declared, step):
    """The same where terms are summed exactly: one of the two passes over them."""
    i, size = loop_body.index.name, len(loop_body.sums)
    declared += [f"real(dp) :: term({size}), tally({3 * size})", f"integer :: {i}, slot, t"]
    head, names = (
        f"attributes(global) subroutine each_{loop_body.name}",
        [a.name for a in loop_body.given],
    )
    look = [f"do slot = 1, {size}", "    term(slot) = 0", "end do", *loop_body.call_for_term]
    look += [f"call tally_exactly(pass, {size}, up, term, tally)"]
    body = [f"t = {step}", "if (t > tally_threads) return"]
    body += [f"do slot = 1, {3 * size}", "    tally(slot) = 0", "end do"]
    body += [f"do {i} = t, n, tally_threads", *inner(look), "end do"]
    body += [f"do slot = 1, {3 * size}", "    sums(t, slot) = tally(slot)", "end do"]
    return procedure(loop_body.doc, head, ["n", *names], declared, body)


def launch(number, stem, loop_body):
    """A procedure that launches the kernel, with arguments of the types that this takes."""
    declared, body = [f"integer, intent(in) :: {loop_body.n}"], ["call a%add(n)"]
    for a in loop_body.given[: -3 if loop_body.exact else None]:
        kind = f"type({BUFFER.get(a.kind, 'buffer_t')})" if a.in_memory else a.kind
        declared += [f"{kind}, intent(in) :: {a.name}{a.comment}"]
        how = "_structure({0}, storage_size({0})/8)" if a.whole else "({0})"
        body += ["call a%add" + how.format(a.name)]
    names = ["n", *(a.name for a in loop_body.given), "err"]
    if loop_body.exact:
        names[-4:] = ["sums", "err"]
        declared += ["type(gpu_exact_t), intent(inout) :: sums"]
    declared += ["type(error_t), intent(inout) :: err", "type(arguments_t) :: a"]
    threads = "tally_threads" if loop_body.sums else "n"
    run = [f"call find_once('each_{loop_body.name}', kernel({number}), err)"]
    run += [f"call launch(kernel({number}), [{threads}, 1, 1], a, err)"]
    if loop_body.exact:
        declared += ["integer :: pass"]
        body = ["a = arguments_t()", *body, "call a%add(pass)", "call a%add(sums%up)"]
        body += ["call a%add(sums%sums)", *run, f"call sums%end(pass, {len(loop_body.sums)}, err)"]
        body, run = ["do pass = 0, 1", *inner(body), "end do"], []
    body += run
    return procedure(loop_body.doc, f"subroutine launch_{loop_body.name}", names, declared, body)


def launches(stem, loop_bodies, launch):
    """The type whose procedures launch the kernels of a file, one of it, and these procedures."""
    kind = [f"type :: {stem}_kernels_t", "contains"]
    kind += [f"    procedure, nopass :: {x.name} => launch_{x.name}" for x in loop_bodies]
    kind += [f"end type {stem}_kernels_t", f"type({stem}_kernels_t) :: {stem}_kernels"]
    kind += [f"type(kernel_t) :: kernel({len(loop_bodies)})", ""]
    return kind, [launch(k, stem, x) for k, x in enumerate(loop_bodies, 1)]


def around_bodies(folder, source):
    """Loops, kernels and launches of a file of loop bodies."""
    text, stem = source.read_text(encoding="utf-8"), source.stem.removesuffix("_loop_bodies")
    loop_bodies = [LoopBody(*m.groups(), text[m.end() :]) for m in LOOP_BODY.finditer(text)]
    lines = [line_at(text, m.end()) for m in LOOP_BODY.finditer(text)]
    known = dict(KNOWN)
    for owner, names in USE.findall(text):
        known |= dict.fromkeys(re.findall(r"\w+", names), owner)
    kind, made = launches(stem, loop_bodies, launch)
    made = [at_line(one, n, source) for one, n in zip(made, lines, strict=True)]
    write(folder / f"{stem}_launches.f90", source, known, kind, made)
    known |= {x.name: f"brz_{source.stem}" for x in loop_bodies}
    every = [exact_loop(x) if x.exact else loop(x) for x in loop_bodies]
    every += [dispatch(stem, x) for x in loop_bodies]
    every = [at_line(one, n, source) for one, n in zip(every, [*lines, *lines], strict=True)]
    known[f"{stem}_kernels"] = f"brz_{stem}_launches"
    write(folder / f"{stem}_loops.f90", source, known, [], every)
    write(folder / f"{stem}_kernels.CUF", source, known, [], [kernel(x) for x in loop_bodies])


class Kernel:
    """What the head of a kernel, or of a procedure with variants, says."""

    def __init__(self, doc, name, rest, variants=()):
        rest = re.sub(r" *& *\n *&?", " ", rest[: rest.index("end subroutine")])
        self.doc, self.name, found = doc.strip(), name, {}
        for kind, how, names, comment in GIVEN.findall(rest):
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


def launch_kernel(number, stem, kernel):
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


def of_kernels(folder, stem, files):
    """Launches of the kernels of a family, and the variants of its procedures."""
    plain, varied = [], []
    known, own = dict(KNOWN), {}
    places = {}
    for path, text in ((x, Path(x).read_text(encoding="utf-8")) for x in files):
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
    kind, made = launches(stem, plain, launch_kernel) if plain else ([], [])
    made += [launch_kernel(0, stem, x) for x in varied]
    made = [at_line(x, *places[k.name]) for x, k in zip(made, plain + varied, strict=True)]
    source = f"cuda/{stem}*.CUF"
    write(folder / f"{stem}_launches.f90", source, known, kind, made)
    if made := [one for x in varied for one in variants(x)]:
        write(folder / f"{stem}_variants.CUF", source, known | own, [], made)


def main():
    folder, first, *files = Path(sys.argv[1]), *sys.argv[2:]
    if files:
        of_kernels(folder, first, files)
    else:
        around_bodies(folder, Path(first))


if __name__ == "__main__":
    main()
