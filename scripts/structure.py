#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Check the house rules that no other linter knows.

usage: structure.py ROOT      (ROOT holds src/, tests/, ...)

Layers: base < parallel < deck < materials < {air, solid} < coupling < {cpu, gpu} < output < step
< main; a file uses only its own folder and what is to the left. Sub-folders are rooms, ordered in
ROOMS: within its folder a file uses only its own room and what is to the left. Point physics (files
with `!@cuf`) uses only base, plain data and other point physics; a material model may describe
itself to the deck as well. Sizes: files 600 lines, procedures 80, lines of kernels (cuda/*.CUF) 100
columns (fortitude sees to those of the rest) and of what is included (*.inc), arguments 12, which
kernels, loop bodies and what these call in their file (`*_loop_bodies.f90`, below a `!@cuf` line)
may exceed: they take arrays.
Twins have one name: what src/cpu does in x.f90, src/gpu does in gpu_x.f90 or cuda in x.CUF,
and a file gpu_x.f90 is the twin of an x.f90; ALONE names what one backend has alone. Also: the
licence line, the module name, `use` with `only`; no name of a type stands for two. Files and
functions in Python, C and shell obey the sizes, too, and so do the Makefile, its recipes and other
files of code. Lines of *.md files have at most 120 columns, rows of tables excepted. The state of
the solids is built in layers; USERS says how many files of src and tests may use each.
"""

import ast
import re
import sys
from itertools import chain
from pathlib import Path

LAYERS = [
    {"base"},
    {"parallel"},
    {"device"},
    {"deck"},
    {"materials"},
    {"air", "solid"},
    {"coupling"},
]
LAYERS += [{"cpu", "gpu"}, {"driver"}, {"output"}, {"step"}, {"main"}]
# "." are files beside the rooms; docs/manual/extending.md says what is in each
ROOMS = {
    "deck": "keys read check",
    "materials": ". driver",
    "air": "grid scheme boundary blast1d blast2d step",
    "solid": "state sph contact cohesive rigid bodies loads motion parallel",
    "step": "backend step check run",
}
RANK = {name: rank for rank, names in enumerate(LAYERS) for name in names}
MAX_FILE, MAX_PROCEDURE, MAX_ARGUMENTS = 600, 80, 12
MAX_CODE, MAX_PROSE = 100, 120
PYTHON = ("scripts", "post", "tests", "studies")
OTHERS = ("Makefile", "*.mk", "*.sh", "*.c", "*.ll", "*.html", "*.js", "*.css")
# vector code of the CPU, whose kernels are cut in another way; what a GPU alone has to be told
ALONE = {"cpu": "air_activity air_lines air_riemann air_split air_sweep coupling_paper"}
ALONE["cpu"] += " solid_artificial solid_gradient_sums solid_lanes solid_pair_sums solid_tilts"
ALONE["gpu"] = "common peers solid_bodies solid_copy solid_layout solid_lists"
ALONE["gpu"] += " solid_load solid_tiles"
# a field of a layer concerns all that use it, so those who need less of the state take less
USERS = {"solid_state": 59, "interacting_bodies": 59, "listed_bodies": 69, "bodies": 79}
LICENCE = "SPDX-License-Identifier: MIT"

USE = re.compile(r"^\s*use\b\s*(?:,\s*\w+\s*::\s*|::\s*|\s)(\w+)\s*(.*)$", re.I)
MODULE = re.compile(r"^\s*module\s+(?!procedure\b)(\w+)\s*$", re.I)
BEGIN = re.compile(
    r"^\s*(?!end\b)(?:[\w(),=*: ]+?\s)??(subroutine|function)\s+(\w+)\s*(?:\(([^)]*)\))?", re.I
)
TYPE = re.compile(r"^\s*type\b(?:\s*,[^:]*::|\s*::|\s)\s*(\w+)\s*$", re.I)
# of C and shell; of JavaScript
OPENS = re.compile(r"(\w.*\) *)?\{$|(async )?function .*\{|const \w+ = .*=> \{$")
END = re.compile(r"^\s*end\s*(?:subroutine|function)\b", re.I)
INTERFACE = re.compile(r"^\s*(end\s+|abstract\s+)?interface\b", re.I)


def statements(text):
    """(line number, statement) with comments cut off and continuation lines joined."""
    whole, start = "", 0
    for number, line in enumerate(text.splitlines(), 1):
        bare = re.sub(r"'[^']*'|\"[^\"]*\"", lambda m: "_" * len(m[0]), line).split("!")[0].rstrip()
        if not bare.strip() or bare.lstrip().startswith("#"):
            continue
        start = start or number
        whole += bare.strip().removeprefix("&").removesuffix("&") + " "
        if not bare.endswith("&"):
            yield start, number, whole.strip()
            whole, start = "", 0


class Source:
    """One Fortran file: what it is called, uses and holds."""

    def __init__(self, path, root):
        self.path = path
        self.name = path.relative_to(root)
        text = path.read_text(encoding="utf-8")
        self.lines = text.splitlines()
        self.items = set()
        if path.suffix == ".CUF":
            self.items |= set(re.findall(r"\b(?:subroutine|function) (\w+)", text))
        if path.stem.endswith("_loop_bodies"):
            self.items |= set(re.findall(r"!@cuf.*\n +pure (?:subroutine|function) (\w+)", text))
        self.marked = any(line.lstrip().startswith("!@cuf") for line in self.lines)
        self.statements = list(statements(text))
        self.plain = not any(s.lower() == "contains" for _, _, s in self.statements)
        self.uses, self.modules, self.types, self.faults = {}, [], {}, []
        parts = self.name.parts
        self.layer = "main" if len(parts) == 2 else parts[1]
        self.room = "/".join(parts[2:-1]) or "."
        self.in_src = parts[0] == "src"
        for first, _, statement in self.statements:
            if found := MODULE.match(statement):
                self.modules.append(found[1].lower())
            elif found := TYPE.match(statement):
                self.types[found[1].lower()] = first
            elif found := USE.match(statement):
                self.uses.setdefault(found[1].lower(), first)
                if "only" not in found[2].lower() and found[1].lower() not in ("funit", "pfunit"):
                    self.fault(first, f"use {found[1]} without only")

    def fault(self, line, text):
        self.faults.append(f"{self.name}:{line}: {text}")

    def check_sizes(self):
        if not self.lines or LICENCE not in self.lines[0]:
            self.fault(1, f"the first line must be '! {LICENCE}'")
        if len(self.lines) > MAX_FILE:
            self.fault(1, f"{len(self.lines)} lines; at most {MAX_FILE}")
        if self.path.suffix in (".CUF", ".inc"):
            for number, line in enumerate(self.lines, 1):
                if len(line) > MAX_CODE:
                    self.fault(number, f"{len(line)} columns; at most {MAX_CODE}")
        self.check_procedures()

    def check_procedures(self):
        opened, in_interface = [], False
        for first, last, statement in self.statements:
            if found := INTERFACE.match(statement):
                in_interface = "end" not in (found[1] or "").lower()
            elif END.match(statement) and opened:
                name, start = opened.pop()
                if last - start + 1 > MAX_PROCEDURE:
                    self.fault(
                        start, f"{name} has {last - start + 1} lines; at most {MAX_PROCEDURE}"
                    )
            elif not in_interface and (found := BEGIN.match(statement)):
                opened.append((found[2], first))
                count = len([a for a in (found[3] or "").split(",") if a.strip()])
                if count > MAX_ARGUMENTS and found[2] not in self.items:
                    self.fault(first, f"{found[2]} has {count} arguments; at most {MAX_ARGUMENTS}")
            elif in_interface and END.match(statement):
                continue

    def check_layers(self, owner):
        stem = self.path.stem.lower()
        whole = self.layer != "main" and self.path.suffix != ".inc"
        if whole and self.modules != [f"brz_{stem}"]:
            self.fault(1, f"the file must hold module brz_{stem} alone")
        if self.layer not in RANK:
            self.fault(1, f"src/{self.layer} is no layer")
            return
        for module, line in self.uses.items():
            other = owner.get(module) or owner.get(
                re.sub("_(loops|launches)$", "_loop_bodies", module)
            )
            if other is None or other is self:
                continue
            if RANK[other.layer] > RANK[self.layer] or (
                other.layer != self.layer and RANK[other.layer] == RANK[self.layer]
            ):
                self.fault(line, f"{self.layer} must not use {module} of {other.layer}")
            free = other.layer == "base" or other.marked or other.plain
            if self.marked and not free and self.layer != "materials":
                self.fault(line, f"point physics must not use {module}: it holds host code")
            if other.layer == self.layer:
                self.check_order(line, module, other.room)

    def check_order(self, line, module, room):
        """Fault a use of a module in a room to the right of its own."""
        rooms = ROOMS.get(self.layer, ".").split()
        if {room, self.room} <= set(rooms) and rooms.index(room) > rooms.index(self.room):
            self.fault(
                line,
                f"{self.room} must not use {module} of {room} (src/{self.layer}: "
                f"{' < '.join(rooms)}): move what it needs down to {self.room}, in a file of its "
                f"own, or this file up to {room}",
            )


def wrong_rooms(sources):
    """Files in no room of their folder, where that has some."""
    inside = [s for s in sources if s.in_src and s.layer in RANK]
    roomed = {s.layer for s in inside if s.room != "."}
    for source in inside:
        rooms = ROOMS.get(source.layer, ".").split()
        if source.layer in roomed and source.room not in rooms:
            place = f"src/{source.layer}" + f"/{source.room}" * (source.room != ".")
            yield f"{source.name}:1: {place} is no room; src/{source.layer} has {', '.join(rooms)}"


def lone_twins(root):
    """Files of src/cpu and src/gpu that lack the twin that their name promises."""
    every = {p.stem for p in root.glob("src/**/*.f90")}
    kernels = {p.stem for p in root.glob("cuda/*.CUF")}
    there = {
        "cpu": {p.stem for p in root.glob("src/cpu/**/*.f90")},
        "gpu": {p.stem[4:] for p in root.glob("src/gpu/**/gpu_*.f90")},
    }
    twins = {"cpu": kernels | {x[4:] for x in every if x.startswith("gpu_")}, "gpu": every}
    for backend, names in there.items():
        alone = set(ALONE[backend].split())
        for name in sorted(names - twins[backend] - alone):
            yield f"src/{backend}: {name} has no twin of its name (structure.py: ALONE)"
        for name in sorted(alone & names & twins[backend]):
            yield f"scripts/structure.py: {name} is not alone in src/{backend}"


def common_state(sources):
    """Modules that more files of src and tests use than USERS allows."""
    for name, most in USERS.items():
        users = [s for s in sources if f"brz_{name}" in s.uses and s.name.parts[0] != "studies"]
        if len(users) > most:
            yield (
                f"{users[-1].name}:{users[-1].uses[f'brz_{name}']}: {len(users)} files use "
                f"brz_{name}; at most {most}: take a layer below it (src/README.md, The state of "
                "the solids), or the components that are needed"
            )


def homonyms(sources):
    """Names of types that stand for two things."""
    first = {}
    for source in sources:
        for name, line in source.types.items():
            if (other := first.setdefault(name, source)) is not source:
                yield f"{source.name}:{line}: {name} is a type of {other.name} already"


def long_prose(root):
    """Lines of the pages that are too long and no rows of a table."""
    pages = [p for d in (".", "docs/**", "src", "tests/**") for p in root.glob(f"{d}/*.md")]
    for page in sorted(pages):
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            if len(line) > MAX_PROSE and not line.startswith("|"):
                place = f"{page.relative_to(root)}:{number}"
                yield f"{place}: {len(line)} columns; at most {MAX_PROSE}"


def long_python(root):
    """Files and functions in Python that are too long."""
    for path in sorted(p for d in PYTHON for p in (root / d).rglob("*.py")):
        text, name = path.read_text(encoding="utf-8"), path.relative_to(root)
        if (n := len(text.splitlines())) > MAX_FILE:
            yield f"{name}:1: {n} lines; at most {MAX_FILE}"
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                n = node.end_lineno - node.lineno + 1
                if n > MAX_PROCEDURE:
                    place = f"{name}:{node.lineno}: {node.name}"
                    yield f"{place} has {n} lines; at most {MAX_PROCEDURE}"


def long_others(root):
    """Files in other languages that are too long, their functions, and recipes of make."""
    folders = [root.glob(f"{d}/**/{kind}") for d in (*PYTHON, "src", "cuda") for kind in OTHERS]
    for path in sorted({*(p for kind in OTHERS for p in root.glob(kind)), *chain(*folders)}):
        lines, begin, recipe = path.read_text(encoding="utf-8").splitlines(), 0, 0
        if len(lines) > MAX_FILE:
            yield f"{path.relative_to(root)}:1: {len(lines)} lines; at most {MAX_FILE}"
        for number, line in enumerate(lines, 1):
            recipe = recipe + 1 if line.startswith("\t") and path.suffix in ("", ".mk") else 0
            if recipe == MAX_PROCEDURE + 1:
                place = f"{path.relative_to(root)}:{number - MAX_PROCEDURE}"
                yield f"{place}: a recipe of more than {MAX_PROCEDURE} lines"
            if OPENS.match(line):
                begin = number
            elif line.startswith("}") and begin:
                if (n := number - begin + 1) > MAX_PROCEDURE:
                    place = f"{path.relative_to(root)}:{begin}"
                    yield f"{place}: a function of {n} lines; at most {MAX_PROCEDURE}"
                begin = 0


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    files = [p for d in ("src", "tests", "studies", "cuda") for p in sorted((root / d).rglob("*"))]
    sources = [
        Source(p, root) for p in files if p.suffix in (".f90", ".F90", ".pf", ".CUF", ".inc")
    ]
    owner = {m: s for s in sources if s.in_src for m in s.modules}
    for source in sources:
        source.check_sizes()
        if source.in_src:
            source.check_layers(owner)
    faults = [fault for source in sources for fault in source.faults]
    faults += [*long_prose(root), *long_python(root), *long_others(root), *lone_twins(root)]
    faults += [*homonyms(sources), *wrong_rooms(sources), *common_state(sources)]
    for path in sorted((root / "scripts").glob("*")) + sorted(root.glob("post/**/*.py")):
        if path.suffix in (".py", ".sh"):
            head = path.read_text(encoding="utf-8").splitlines()[:2]
            if not any(LICENCE in line for line in head):
                faults.append(f"{path.relative_to(root)}:1: no line '# {LICENCE}'")
    if faults:
        sys.exit("\n".join(faults))
    print(f"{len(sources)} Fortran files keep the rules of the house")


if __name__ == "__main__":
    main()
