#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write what a GPU has of a structure: its arrays as buffers, and how they get there.

usage: mirror.py NAME.f90 GPU_NAME.f90

The line `!@mirror` stands above a type such as cohesive_t. The GPU gets gpu_cohesive_t, with the
whole numbers of the type and a buffer for each array of numbers or structures, under their names,
and `put_cohesive`. Arrays that begin with element 0, as their comment says, begin there with 1.
"""

import re
import sys
from pathlib import Path

from item_heads import BUFFER, at_line, fold, line_at

TYPE = re.compile(r"^ *!@mirror\n *type :: (\w+)_t\n(.*?)^ *end type", re.M | re.S)
ARRAY = re.compile(r"^ *([\w()]+), allocatable :: (\w+)\([:, ]*\)(?: *!! *\((.*?0:\w+)\))?", re.M)
NUMBER = re.compile(r"^ *(integer :: [^!\n]*[^! \n])", re.M)


def main():
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    whole = source.read_text(encoding="utf-8")
    found = TYPE.search(whole)
    name, text = found.groups()
    numbers = NUMBER.findall(text)
    arrays = [x for x in ARRAY.findall(text) if x[0] in BUFFER or x[0].startswith("type")]
    kinds = {x: BUFFER.get(kind, "buffer_t") for kind, x, _ in arrays}
    lines = [
        f"!> Written by scripts/mirror.py from {source}.",
        f"module brz_gpu_{source.stem}",
        f"    use brz_{source.stem}, only: {name}_t",
        f"    use brz_buffers, only: {', '.join(sorted(set(kinds.values())))}",
        "    use brz_device, only: put_buffer",
        "    use brz_errors, only: error_t",
        "    use brz_kinds, only: int64",
        "    implicit none",
        "    private",
        f"    public :: gpu_{name}_t, put_{name}",
        f"    type :: gpu_{name}_t",
        *(f"        {x}" for x in numbers),
        *(f"        type({kind}) :: {x}" for x, kind in kinds.items()),
        f"    end type gpu_{name}_t",
        "contains",
        f"    subroutine put_{name}(host, gpu, err)",
        f"        type({name}_t), intent(in) :: host",
        f"        type(gpu_{name}_t), intent(inout) :: gpu",
        "        type(error_t), intent(inout) :: err",
        *(f"        gpu%{x} = host%{x}" for y in numbers for x in re.findall(r"(\w+) =", y)),
    ]
    for _, x, nil in arrays:
        part = f"host%{x}" + ("(" + ":, " * nil.count(",") + "1:)" if nil else "")
        size = f"size({part})*(storage_size({part})/8_int64)"
        call = f"if (allocated(host%{x})) call put_buffer({part}, gpu%{x}, {size}, err)"
        lines += [f"        {one}" for one in fold(call)]
    lines += [f"    end subroutine put_{name}", f"end module brz_gpu_{source.stem}"]
    lines[1:] = at_line(lines[1:], line_at(whole, found.start(1)), source)
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
