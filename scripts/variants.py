#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the variants of hot loops on the CPU: copies of a procedure with a constant in each.

usage: variants.py FILE.f90 OUT.f90

A procedure below lines such as

    !@variant sum_stiff: stiff

is written once for each of them, under that name, with the constant in place of its first
argument: the compiler leaves out what the constant excludes, and keeps vector code. Procedures
below a bare `!@variant`, which have the same first argument, are copied with each that calls them.
Where other code calls the procedure, by its own name, the variant of the first argument is chosen.
"""

import re
import sys
from pathlib import Path

from item_heads import line_at

VARIED = re.compile(
    r"((?:^ *!>.*\n)+)((?:^ *!@variant.*\n)+)^ *((?:pure )?subroutine) (\w+)\((\w+), ((?:.*\n)+?)"
    r"^ *end subroutine \w+\n",
    re.M,
)
NAMED = re.compile(r"!@variant (\w+): (\w+)")


def copies(text, source):
    """The text with the variants in place of the procedures that have them, and line marks."""
    found = {m[4]: m for m in VARIED.finditer(text)}
    kinds = {name: dict(NAMED.findall(m[2])) for name, m in found.items()}
    helpers = [name for name in found if not kinds[name]]

    def mark(position):
        return f'# {line_at(text, position)} "{source}"\n'

    def write(match, name, kind):
        doc, head, first, body = match[1], match[3], match[5], match[6]
        body = re.sub(
            rf"integer, intent\(in\) :: {first}\b", f"integer, parameter :: {first} = {kind}", body
        )
        for one in helpers:
            body = re.sub(rf"\bcall {one}\({first}, ", f"call {one}_{kind}(", body)
        begin = mark(match.start()) + doc + mark(match.start(3))
        return f"{begin}    {head} {name}({body}    end subroutine {name}\n"

    def varied(match):
        if names := kinds[match[4]]:
            made = [write(match, name, kind) for name, kind in names.items()]
        else:
            every = {kind for names in kinds.values() for kind in names.values()}
            made = [write(match, f"{match[4]}_{kind}", kind) for kind in sorted(every)]
        return "\n".join(made) + mark(match.end())

    def choose(match):
        indent, names = match[1], kinds[match[2]]
        every = [f"case ({k})\n{indent}    call {one}({match[4]})" for one, k in names.items()]
        lines = [f"{indent}select case ({match[3]})", *every, "end select"]
        return f"\n{indent}".join(lines) + "\n" + mark(match.end())

    chosen = "|".join(name for name in found if kinds[name])
    call = re.compile(rf"^( *)call ({chosen})\((\w+), ((?:.*&\n)*.*)\)\n", re.M)
    made, done = [], 0
    changes = [(m, varied) for m in found.values()] + [(m, choose) for m in call.finditer(text)]
    for match, change in sorted(changes, key=lambda one: one[0].start()):
        made += [text[done : match.start()], change(match)]
        done = match.end()
    return "".join([*made, text[done:]])


def main():
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    first, rest = copies(source.read_text(encoding="utf-8"), source).split("\n", 1)
    note = f"!> Written by scripts/variants.py from {source}."
    target.write_text(f'{first}\n{note}\n# 2 "{source}"\n{rest}', encoding="utf-8")


if __name__ == "__main__":
    main()
