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

contains

    subroutine preset_text(i, text)
        integer, intent(in) :: i !! place in preset_names
        character(:), allocatable, intent(out) :: text
        character(*), parameter :: lf = new_line('a')

        text = ''
        select case (i)"""
TAIL = """        end select
    end subroutine preset_text
end module brz_preset_files"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", type=Path)
    files = sorted(parser.parse_args().files)
    names = ", &\n        ".join(f"'{path.stem}'" for path in files)
    print(HEAD.format(n=len(files), names=f"&\n        {names}" if names else ""))
    for i, path in enumerate(files, 1):
        print(f"        case ({i})")
        for line in path.read_text(encoding="utf-8").splitlines():
            for k in range(0, len(line), 60):
                print(
                    f"            text = text//'{line[k : k + 60].replace(chr(39), 2 * chr(39))}'"
                )
            print("            text = text//lf")
    print(TAIL)


if __name__ == "__main__":
    main()
