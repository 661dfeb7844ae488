#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Turn a .pf test file into Fortran, as the preprocessor of pFUnit 4 does.

usage: pfproc.py test_x.pf test_x.F90

Only a subset of pFUnit is taken (tests/pfstub/README.md); everything else is refused with its
file and line, so that no file passes here that genuine pFUnit would read in another way.
"""

import re
import sys
from pathlib import Path

from pf_names import ModuleNames

# name of the assertion: number of positional arguments, keywords
COMPARE = (2, {"message"})
ASSERTS = {
    "asserttrue": (1, {"message"}),
    "assertfalse": (1, {"message"}),
    "assertall": (1, {"message"}),
    "assertany": (1, {"message"}),
    "assertnone": (1, {"message"}),
    "assertisnan": (1, {"message"}),
    "assertisfinite": (1, {"message"}),
    "assertequal": (2, {"message", "tolerance"}),
    "assertrelativelyequal": (2, {"message", "tolerance"}),
    "assertnotequal": COMPARE,
    "assertlessthan": COMPARE,
    "assertlessthanorequal": COMPARE,
    "assertgreaterthan": COMPARE,
    "assertgreaterthanorequal": COMPARE,
    "assertfail": (1, {"message"}),
}
MARKS = {"test", "before", "after", "disable"}
DIRECTIVE = re.compile(r"^\s*@\s*(\w+)\s*(.*?)\s*$")
SUBROUTINE = re.compile(r"^\s*subroutine\s+(\w+)\s*(?:\(\s*\))?\s*$", re.I)
ON_PROCESSES = re.compile(r"^\s*subroutine\s+(\w+)\s*\(\s*this\s*\)\s*$", re.I)
MODULE = re.compile(r"^\s*module\s+(?!procedure\b)(\w+)\s*$", re.I)
OPTION = re.compile(r"^\((ifdef|ifndef)\s*=\s*(\w+)\s*\)$", re.I)
NPES = re.compile(r"^\(npes\s*=\s*\[([\d\s,]+)\]\s*\)$", re.I)
USES_PFUNIT = re.compile(r"^\s*use\s+pfunit\s*$", re.I)
KEYWORD = re.compile(r"^(\w+)\s*=(?!=)")


class Refused(Exception):
    """Something outside the subset."""


def without_strings(line):
    """The line with character constants blanked out and the comment cut off."""
    out, quote = [], ""
    for char in line:
        if quote:
            quote = "" if char == quote else quote
            out.append("_")
        elif char in "'\"":
            quote = char
            out.append("_")
        elif char == "!":
            break
        else:
            out.append(char)
    return "".join(out), len(out) < len(line), bool(quote)


def arguments(text):
    """Top-level arguments of '(a, b(1, 2), c=d)', or None where that is not a complete list."""
    bare, comment, open_string = without_strings(text)
    if comment or open_string or not text.startswith("("):
        return None
    depth, start, found = 0, 1, []
    for place, char in enumerate(bare):
        depth += (char in "([") - (char in ")]")
        if depth == 0:
            if bare[place + 1 :].strip():
                return None
            found.append(text[start:place].strip())
            return [x for x in found if x]
        if char == "," and depth == 1:
            found.append(text[start:place].strip())
            start = place + 1
    return None


class Translator:
    """One .pf file on its way to Fortran."""

    def __init__(self, path):
        self.path = path
        self.out = []
        self.tests = []  # (name, disabled, condition, numbers of processes)
        self.fixture = {"before": "", "after": ""}
        self.module = ""
        self.mark, self.condition, self.disabled, self.npes = "", "", False, ""
        self.pfunit = False
        self.names, self.open_statement, self.opened_at = ModuleNames(), "", 0

    def run(self):
        lines = self.path.read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines, 1):
            try:
                self.line(line, number)
            except Refused as reason:
                sys.exit(f"{self.path}:{number}: {reason}")
            if fault := self.statement(line, number):
                sys.exit(f"{self.path}:{self.opened_at}: {fault}")
        if self.mark:
            sys.exit(f"{self.path}:{len(lines)}: no subroutine follows the last @{self.mark}")
        if self.module != self.path.stem.lower():
            sys.exit(f"{self.path}:1: the module must be called {self.path.stem}, as the file")
        if not self.tests:
            sys.exit(f"{self.path}:1: no @test in this file")
        if any(npes for *_, npes in self.tests) and any(self.fixture.values()):
            sys.exit(f"{self.path}:1: no @before and @after beside tests with npes")
        self.suite()
        return "\n".join(self.out) + "\n"

    def statement(self, line, number):
        """What is wrong with the names of the statement that ends on this line."""
        bare = without_strings(line)[0].strip()
        if not bare or bare.startswith(("@", "#")):
            return ""
        if not self.open_statement:
            self.opened_at = number
        self.open_statement += bare.removeprefix("&").removesuffix("&")
        if bare.endswith("&"):
            return ""
        whole, self.open_statement = self.open_statement, ""
        return self.names.clash(whole)

    def line(self, line, number):
        found = DIRECTIVE.match(line)
        bare = without_strings(line)[0]
        if not found:
            if "@" in bare:
                raise Refused("a directive must stand alone on its line")
            self.code(line, bare)
            return
        name, rest = found.group(1).lower(), found.group(2)
        if rest.endswith("&"):
            raise Refused("a directive must stand on one line, without continuation")
        if without_strings(rest)[1]:
            raise Refused("no comment may follow a directive")
        if name in MARKS:
            self.directive(name, rest)
        elif name in ASSERTS:
            self.assertion(found.group(1), rest, number)
        else:
            raise Refused(f"@{found.group(1)} is outside the subset")

    def code(self, line, bare):
        self.out.append(line)
        self.pfunit = self.pfunit or USES_PFUNIT.match(bare) is not None
        if module := MODULE.match(bare):
            if self.module:
                raise Refused("one module per file")
            self.module = module.group(1).lower()
        if not self.mark or not bare.strip():
            return
        named = (ON_PROCESSES if self.npes else SUBROUTINE).match(bare)
        if not named:
            inside = "this" if self.npes else ""
            raise Refused(f"'subroutine name({inside})' must follow @{self.mark}")
        if self.mark == "test":
            self.tests.append((named.group(1), self.disabled, self.condition, self.npes))
        else:
            self.fixture[self.mark] = named.group(1)
        self.mark, self.condition, self.disabled, self.npes = "", "", False, ""

    def directive(self, name, rest):
        if name == "disable":
            if self.mark != "test" or rest:
                raise Refused("@disable stands alone, after @test")
            self.disabled = True
        elif self.mark:
            raise Refused(f"@{name} directly after @{self.mark}")
        elif name == "test" and rest:
            option, npes = OPTION.match(rest), NPES.match(rest)
            if npes:
                if not self.pfunit:
                    raise Refused("a test with npes needs 'use pfunit'")
                self.npes = npes.group(1)
            elif option:
                self.condition = f"#{option.group(1).lower()} {option.group(2)}"
            else:
                raise Refused(
                    "of the options of @test only ifdef=NAME, ifndef=NAME and npes=[...] are known"
                )
        elif rest:
            raise Refused(f"@{name} takes no options")
        elif name != "test" and self.fixture[name]:
            raise Refused(f"a second @{name}")
        self.mark = self.mark or name
        self.out.append(f"    !@{name}{rest}")

    def assertion(self, name, rest, number):
        given = arguments(rest)
        if given is None:
            raise Refused(f"@{name}(...) must be complete and alone on its line")
        if self.mark:
            raise Refused(f"'subroutine name()' must follow @{self.mark}")
        count, allowed = ASSERTS[name.lower()]
        keywords = [KEYWORD.match(x) for x in given]
        positional = sum(k is None for k in keywords)
        for keyword in filter(None, keywords):
            if keyword.group(1).lower() not in allowed:
                raise Refused(f"@{name} takes no {keyword.group(1)}=")
        if name.lower() == "assertfail":
            positional = len(given)
        if positional != count:
            raise Refused(
                f"@{name} takes {count} argument(s), then keywords; here are {positional}"
            )
        place = f"SourceLocation('{self.path.name}', {number})"
        self.out += [
            f'#line {number} "{self.path.as_posix()}"',
            f"    call {name}({', '.join([*given, f'location={place}'])})",
            "    if (anyExceptions()) return",
            f'#line {number + 1} "{self.path.as_posix()}"',
        ]

    def suite(self):
        name = self.path.stem
        self.out += [
            f"function {name}_suite() result(suite)",
            "    use funit, only: TestSuite",
            f"    use {name}",
            "    implicit none",
            "    type(TestSuite) :: suite",
            f"    call suite%begin('{name}_suite')",
        ]
        for key in ("before", "after"):
            if self.fixture[key]:
                self.out.append(f"    call suite%set_{key}({self.fixture[key]})")
        for test, disabled, condition, npes in self.tests:
            flag = ", disabled=.true." if disabled else ""
            body = [f"    call suite%addTest('{test}', {test}{flag})"]
            if npes:
                body = [f"    call suite%addMpiTest('{test}', {test}, [{npes}]{flag})"]
            self.out += [condition, *body, "#endif"] if condition else body
        self.out.append(f"end function {name}_suite")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    text = Translator(Path(sys.argv[1])).run()
    Path(sys.argv[2]).write_text(text, encoding="utf-8")
