#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Format Fortran sources with fprettify, or show what it would change.

usage: format.py [--check] FILE...

Texts found good stand in build/log/formatted by their sums, and are not looked at again.

fprettify settles indentation and white space. Only the indentation of continuation lines is left
as it was written, relative to the first line of the statement: fprettify aligns them with
brackets and shifts the statement to the left where that does not fit.
"""

import difflib
import hashlib
import io
import logging
import re
import sys
from importlib.metadata import version
from pathlib import Path

import fprettify

GOOD = Path(__file__).parents[1] / "build/log/formatted"  # sums of texts that are as they should be
CONTINUED = re.compile(r"^(?:[^'\"!]|'[^']*'|\"[^\"]*\")*&\s*(?:!.*)?$")
TIGHT = re.compile(r",\.not\.")  # fprettify eats the blank before .not.


def indent_of(line):
    return len(line) - len(line.lstrip())


def formatted(text, name):
    """The text as fprettify wants it, continuation lines at their own indentation."""
    out = io.StringIO()
    fprettify.reformat_ffile(
        io.StringIO(text), out, indent_size=4, llength=1000, whitespace=2, orig_filename=name
    )
    old, new = text.splitlines(), [TIGHT.sub(", .not.", x) for x in out.getvalue().splitlines()]
    if len(old) != len(new):
        return "\n".join(new) + "\n"
    continued, shift = False, 0
    for place, line in enumerate(old):
        comment = line.lstrip().startswith("!") and not line.lstrip().startswith("!$")
        if continued and line.strip() and not comment:
            new[place] = " " * max(indent_of(line) + shift, 0) + new[place].lstrip()
        elif not comment:
            shift = indent_of(new[place]) - indent_of(line)
        if not comment and line.strip() and not line.lstrip().startswith("#"):
            continued = bool(CONTINUED.match(line))
    return "\n".join(new) + "\n"


def sum_of(text, judge):
    """The sum of a text and of who judges it."""
    return hashlib.sha256(f"{judge}\0{text}".encode()).hexdigest()


def main():
    check = "--check" in sys.argv
    logging.disable(logging.CRITICAL)
    changed = 0
    good = set(GOOD.read_text(encoding="utf-8").split()) if GOOD.exists() else set()
    known = len(good)
    judge = Path(__file__).read_text(encoding="utf-8") + version("fprettify")
    for name in sys.argv[1:]:
        if name == "--check":
            continue
        text = Path(name).read_text(encoding="utf-8")
        key = sum_of(text, judge)
        if key in good:
            continue
        better = formatted(text, name)
        if better == text:
            good.add(key)
            continue
        changed += 1
        if check:
            pair = text.splitlines(keepends=True), better.splitlines(keepends=True)
            sys.stdout.writelines(difflib.unified_diff(*pair, name, "make format"))
        else:
            Path(name).write_text(better, encoding="utf-8")
    if len(good) > known:
        GOOD.parent.mkdir(parents=True, exist_ok=True)
        GOOD.write_text("\n".join(sorted(good)) + "\n", encoding="utf-8")
    if check and changed:
        sys.exit(f"{changed} file(s) not formatted: run make format")


if __name__ == "__main__":
    main()
