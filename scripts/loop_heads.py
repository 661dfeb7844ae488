# SPDX-License-Identifier: MIT
"""What the head of a loop body says, and how a module around loop bodies is written.

For the scripts that write Fortran. What they write has lines such as
`# 12 "src/air/step/face_loop_bodies.f90"`: the compiler and gdb speak of that line of the source.
"""

import re
import sys
from pathlib import Path
from textwrap import wrap

LOOP_BODY = re.compile(
    r"((?:^ *!>.*\n)+)^ *!@loop_body *(.*)\n^ *!@cuf.*\n^ *pure subroutine (\w+)", re.M
)
LINE = re.compile(r"^ *(\w+(?:\(\w+\))?), *(intent\(\w+\)) *::([^!\n]*)(?:!!?(.*))?", re.M)
USE = re.compile(r"^ *use (\w+), only: ((?:[\w, ]|& *\n *&?)+)", re.M)
BUFFER = {"real(rk)": "reals_t", "real(dp)": "doubles_t", "integer(int8)": "bytes_t"}
BUFFER |= {"integer": "integers_t", "integer(int32)": "integers_t"}
TALLY = {"count": "+", "sum": "+", "least": "min", "most": "max", "exact": ""}
KNOWN = {"worth_threads": "brz_threads", "tally_threads": "brz_tallies", "dp": "brz_kinds"}
KNOWN |= dict.fromkeys(["find_once", "kernel_t", "launch"], "brz_device")
EXACT = ["widen", "open_sums", "add_terms", "close_sums", "scale_t", "limbs"]
KNOWN |= {"ranks_t": "brz_ranks", "int64": "brz_kinds"} | dict.fromkeys(EXACT, "brz_exact_sum")
KNOWN |= {"tally_exactly": "brz_tallies", "gpu_exact_t": "brz_gpu_exact_sum"}
KNOWN |= dict.fromkeys(["on_device", "one_on_device"], "brz_present_table")
KNOWN |= dict.fromkeys(["begin_counts", "read_counts"], "brz_gpu_counts")
KNOWN |= {"exact_for": "brz_gpu_exact_sum"}
KNOWN |= {"fix_layout": "brz_link_layout", "error_t": "brz_errors"} | dict.fromkeys(
    [*BUFFER.values(), "buffer_t", "arguments_t"], "brz_buffers"
)


class Argument:
    """One argument of a loop body: its declaration, and where it lies."""

    def __init__(self, name, shape, kind, intent, comment=""):
        tag = re.match(r"@(\w+) *", comment)
        self.name, self.kind, self.intent = name, kind, intent
        self.tally = tag[1] if tag and tag[1] in TALLY else ""
        self.in_memory = bool(tag or shape) and not self.tally
        self.whole = kind.startswith("type") and not self.in_memory  # a structure by value
        comment = re.sub("^@(buffer)?", "", comment.strip())
        self.comment = f" !! {comment}" if comment else ""
        self.end = name + shape + self.comment
        size = int(shape.strip("()")) if self.tally and shape else 0
        self.elements = [f"{name}({k + 1})" for k in range(size)] or [name]


class LoopBody:
    """What the head of a loop body says."""

    def __init__(self, doc, clauses, name, rest):
        self.doc, self.name = doc.strip(), name
        self.clauses = clauses or "if(n >= worth_threads) schedule(static)"
        rest, found = re.sub(r" *& *\n *&?", " ", rest[: rest.index("end subroutine")]), {}
        for kind, intent, names, comment in LINE.findall(rest):
            for one, shape in re.findall(r"(\w+)(\([^)]*\))?", names):
                found[one] = Argument(one, shape, kind, intent, comment)
        names = re.findall(r"\w+", rest[: rest.index(")")])
        self.index, *self.rest = (found[x] for x in names)
        self.names = names
        self.call = self.call_of({})
        self.exact = [a for a in self.rest if a.tally == "exact"]
        self.call_for_term = self.call_of({a.name: "term" for a in self.exact})
        self.n = "n" + self.index.comment
        self.counts = [a.name for a in self.rest if a.tally == "count"]
        self.sums = [x for a in self.rest if a.tally not in ("", "count") for x in a.elements]
        # a kernel is given all but sums and counts, which lie in two buffers
        self.given = [a for a in self.rest if not a.tally]
        if self.exact:
            self.given += [Argument("pass", "", "integer", "intent(in)")]
            self.given += [Argument("up", "(2, *)", "real(dp)", "intent(in)")]
        buffers = [("sums", "(tally_threads, *)", "real(dp)", self.sums)]
        buffers += [("counts", "(*)", "integer", self.counts)]
        self.given += [Argument(*b[:3], "intent(inout)") for b in buffers if b[3]]

    def call_of(self, other):
        """The call of the loop body, with other names for some arguments."""
        return fold(f"call {self.name}({', '.join(other.get(x, x) for x in self.names)})")


def fold(text, mark=""):
    """A statement in lines that are short enough."""
    lines = [("    " if k and not mark else "") + x for k, x in enumerate(wrap(text, 84))]
    return [mark + x + " &" for x in lines[:-1]] + [mark + lines[-1]]


def line_at(text, position):
    """Number of the line of a text that a position is in."""
    return text.count("\n", 0, position) + 1


def marked(lines, source):
    """Lines of code, given as (number of a line of the source or None, text), with line marks. What
    a statement goes on with, and lines without a number, count on from the line before."""
    expected, goes_on = None, False
    for number, text in lines:
        if number and text and number != expected and not goes_on:
            yield f'# {number} "{source}"'
            expected = number
        yield text
        expected = expected and expected + 1
        goes_on = text.rstrip().endswith("&")


def at_line(lines, number, source):
    """Lines of code, each statement with the mark of one line of the source."""
    return list(marked([(None if x.startswith("!") else number, x) for x in lines], source))


def inner(lines):
    return ["    " + x if x and not x.startswith("# ") else x for x in lines]


def procedure(doc, head, names, declared, body):
    lines = [*fold(f"{head}({', '.join(names)})"), *inner([*declared, "", *body])]
    return ["", *(x.strip() for x in doc.split("\n")), *lines, "end " + head.split(") ")[-1]]


def write(path, source, known, kind, procedures):
    """A module, with `use` lines for the known names in it."""
    code = [*inner(kind), "contains", *inner(x for one in procedures for x in one)]
    words = {x for line in code for x in re.findall(r"\w+", re.split("!!|!>", line)[0])}
    words, uses = words & set(known), []
    for owner in sorted({known[x] for x in words}):
        names = ", ".join(sorted(x for x in words if known[x] == owner))
        uses += fold(f"use {owner}, only: {names}")
    # the kernels and loops; of launches the type, and those that it does not have
    text = "\n".join(code)
    head = re.compile(r"^ *(?:attributes\(global\).*)?subroutine (\w+)\(|end type (\w+)", re.M)
    names = [x or y for x, y in head.findall(text) if y or f"=> {x}" not in text]
    public = ", ".join(names + [x[:-2] for x in names if x.endswith("_kernels_t")])
    uses += ["implicit none", "private", *fold(f"public :: {public}")]
    script = Path(sys.argv[0]).name
    lines = ["! SPDX-License-Identifier: MIT", f"!> Written by scripts/{script} from {source}."]
    lines += [f"module brz_{path.stem}", *inner(uses), "", *code, f"end module brz_{path.stem}"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
