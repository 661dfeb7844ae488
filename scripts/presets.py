#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Print the source of module brz_preset_files: the texts of all preset files.

usage: presets.py FILE...      (inputs/presets/NAME.nml)
"""

import argparse
from pathlib import Path

HEAD = """! SPDX-License-Identifier: MIT
!> The preset files as texts. Written by scripts/presets.py: do not edit.
module brz_preset_files
    implicit none
    private
    public :: preset_text

    integer, parameter, public :: n_presets = {n}
    character(32), parameter, public :: preset_names(n_presets) = [character(32) :: {names}]
"""
MIDDLE = """
contains

    subroutine preset_text(i, text)
        integer, intent(in) :: i !! place in preset_names
        character(:), allocatable, intent(out) :: text

        text = ''
        select case (i)"""
TAIL = """        end select
    end subroutine preset_text

    pure function joined(lines) result(text)
        character(*), intent(in) :: lines(:)
        character(:), allocatable :: text
        integer :: k

        text = ''
        do k = 1, size(lines)
            text = text//trim(lines(k))//new_line('a')
        end do
    end function joined
end module brz_preset_files"""
PIECE = 60  # characters of a text in a line of the source


def literal(line):
    """A line as a literal, folded so that no line of the source is too long."""
    pieces = [line[k : k + PIECE].replace("'", "''") for k in range(0, len(line), PIECE)]
    return "'" + "&\n        &".join(pieces) + "'"


def constant(number, lines):
    """The lines of a file as a constant: a statement for each line takes minutes to optimise."""
    width = max(len(line) for line in lines)
    rows = ", &\n        ".join(literal(line) for line in lines)
    head = f"    character({width}), parameter :: text_{number}({len(lines)}) = "
    return f"{head}[character({width}) :: &\n        {rows}]"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", type=Path)
    files = sorted(parser.parse_args().files)
    names = ", &\n        ".join(f"'{path.stem}'" for path in files)
    print(HEAD.format(n=len(files), names=f"&\n        {names}" if names else ""))
    for i, path in enumerate(files, 1):
        print(constant(i, path.read_text(encoding="utf-8").splitlines()))
    print(MIDDLE)
    for i in range(1, len(files) + 1):
        print(f"        case ({i})\n            text = joined(text_{i})")
    print(TAIL)


if __name__ == "__main__":
    main()
