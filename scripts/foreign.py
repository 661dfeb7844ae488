#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write what Fortran must know of the functions of a C library that is opened at run time.

usage: foreign.py FILE.f90 OUT.f90

A line of the file such as

    !@foreign cuMemAlloc_v2 cu_allocate(out address, size bytes)

names a function of the library, what it is called here, and its arguments by kind: by value, `out`
by reference, `in` and `inout` arrays. All return an int. A procedure pointer for each takes the
place of the lines; `find_functions(library)` sets them all. A line goes on behind `&` with `!@`.
"""

import re
import sys
from pathlib import Path

from item_heads import line_at

LINE = re.compile(r"^ *!@foreign (\w+) (\w+)\(([^)]*)\)\n", re.M)
KINDS = {"int": "integer(c_int)", "size": "integer(c_size_t)", "address": "integer(c_intptr_t)"}
KINDS |= {"byte": "integer(c_signed_char)", "float": "real(c_float)", "pointer": "type(c_ptr)"}
KINDS |= {"text": "character(kind=c_char)", "handle": "type(ipc_handle_t)"}


def interface(name, given):
    """The abstract interface of one function."""
    declared, arguments = [], []
    given = re.sub(r"& *\n *!@", "", given)
    for number, words in enumerate(x.split() for x in given.split(",") if x.strip()):
        how = f"intent({words.pop(0)})" if words[0] in ("in", "inout", "out") else "value"
        shape = "(*)" if how.startswith("intent(in") else ""
        arguments.append(f"a{number}")
        declared.append(f"            {KINDS[words[0]]}, {how} :: a{number}{shape}")
    head = f"        integer(c_int) function {name}_i({', '.join(arguments)}) bind(c)"
    return [head, "            import", *declared, f"        end function {name}_i"]


def main():
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    text = source.read_text(encoding="utf-8")
    functions = LINE.findall(text)
    kinds = ["    abstract interface"]
    pointers, find = [], ["", "    subroutine find_functions(library)"]
    find += ["        type(library_t), intent(inout) :: library", ""]
    for c, name, given in functions:
        kinds += interface(name, given)
        pointers += [
            f"    procedure({name}_i), pointer, protected, public, save :: {name} => null()"
        ]
        find += [f"        call c_f_procpointer(library%function('{c}'), {name})"]
    kinds += ["    end interface"]
    find += ["    end subroutine find_functions"]
    first, last = text.index("    !@foreign"), [m.end() for m in LINE.finditer(text)][-1]
    declared = "\n".join([*kinds, *pointers]) + "\n"
    resume = f'# {line_at(text, last)} "{source}"\n'
    body = text[:first] + declared + resume + text[last:]
    begin = "\ncontains\n"
    after = f'\n# {line_at(text, text.index(begin) + len(begin))} "{source}"\n'
    body = body.replace(begin, begin + "\n".join(find) + after, 1)
    head, rest = body.split("\n", 1)
    note = f"!> Written by scripts/foreign.py from {source}."
    target.write_text(f'{head}\n{note}\n# 2 "{source}"\n{rest}', encoding="utf-8")


if __name__ == "__main__":
    main()
