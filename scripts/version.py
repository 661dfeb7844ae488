#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Print the source of module brz_version: what was built, by what, from which commit.

usage: version.py --version TEXT --compiler TEXT --flags TEXT --precision TEXT
                  --device-code TEXT
"""

import argparse
import subprocess
from pathlib import Path

COMMIT = 48  # characters, filled with blanks: room for a whole hash


def commit():
    """Short hash of the commit, with a + if tracked files differ from it; outside git what the file
    COMMIT of a release archive says."""
    try:
        name = subprocess.run(
            ["git", "describe", "--always", "--dirty=+", "--abbrev=12", "--exclude=*"],
            capture_output=True,
            text=True,
            check=True,
        )
    except (OSError, subprocess.CalledProcessError):
        archived = Path(__file__).parents[1] / "COMMIT"
        return archived.read_text(encoding="utf-8").strip() if archived.is_file() else "unknown"
    return name.stdout.strip()


def literal(text):
    """The text as a Fortran constant, cut into pieces that fit the line length."""
    pieces = [text[i : i + 60].replace("'", "''") for i in range(0, max(len(text), 1), 60)]
    return " &\n        //".join(f"'{piece}'" for piece in pieces)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("version", "compiler", "flags", "precision", "device-code"):
        parser.add_argument(f"--{name}", required=True)
    args = vars(parser.parse_args())
    args["commit"] = commit()
    print("! SPDX-License-Identifier: MIT")
    print("!> What was built. Written by scripts/version.py: do not edit.")
    print("module brz_version\n    implicit none\n    private")
    for name in ("version", "compiler", "flags", "precision"):
        print(f"    character(*), parameter, public :: {name} = &\n        {literal(args[name])}")
    # variables: users are not compiled again where they change
    for name, width in (("commit", COMMIT), ("device_code", len(args["device_code"]))):
        print(f"    character({width}), protected, public :: {name} = &")
        print(f"        {literal(args[name])}")
    print("end module brz_version")


if __name__ == "__main__":
    main()
