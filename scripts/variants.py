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

VARIED = re.compile(
    r"((?:^ *!>.*\n)+)((?:^ *!@variant.*\n)+)^ *((?:pure )?subroutine) (\w+)\((\w+), ((?:.*\n)+?)"
    r"^ *end subroutine \w+\n",
    re.M,
)
NAMED = re.compile(r"!@variant (\w+): (\w+)")


def copies(text):
    """The text with the variants in place of the procedures that have them."""
    found = {m[4]: m for m in VARIED.finditer(text)}
    kinds = {name: dict(NAMED.findall(m[2])) for name, m in found.items()}
    helpers = [name for name in found if not kinds[name]]

    def write(match, name, kind, suffix):
        doc, head, first, body = match[1], match[3], match[5], match[6]
        body = re.sub(
            rf"integer, intent\(in\) :: {first}\b", f"integer, parameter :: {first} = {kind}", body
        )
        for one in helpers:
            body = re.sub(rf"\bcall {one}\({first}, ", f"call {one}_{suffix}(", body)
        return f"{doc}    {head} {name}({body}    end subroutine {name}\n"

    def varied(match):
        if names := kinds[match[4]]:
            made = [write(match, name, kind, kind) for name, kind in names.items()]
        else:
            every = {kind for names in kinds.values() for kind in names.values()}
            made = [write(match, f"{match[4]}_{kind}", kind, kind) for kind in sorted(every)]
        return "\n".join(made)

    def choose(match):
        indent, names = match[1], kinds[match[2]]
        every = [f"case ({k})\n{indent}    call {one}({match[4]})" for one, k in names.items()]
        return f"\n{indent}".join([f"{indent}select case ({match[3]})", *every, "end select"])

    text = VARIED.sub(varied, text)
    chosen = "|".join(name for name in found if kinds[name])
    return re.sub(rf"^( *)call ({chosen})\((\w+), ((?:.*&\n)*.*)\)$", choose, text, flags=re.M)


def main():
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    lines = copies(source.read_text(encoding="utf-8")).split("\n", 1)
    note = f"!> Written by scripts/variants.py from {source}."
    target.write_text(f"{lines[0]}\n{note}\n{lines[1]}", encoding="utf-8")


if __name__ == "__main__":
    main()
