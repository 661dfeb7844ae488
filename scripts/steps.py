#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the steps of the GPU from those of the CPU: lists of operations that stand once.

usage: steps.py NAME_steps.f90 GPU_NAME_steps.f90

A file of steps calls items, loop by loop, and helpers. What it names lies under the same names on
the GPU: `air`, `c` and `p` are then a gpu_air_t, a gpu_coupling_t and a seen_t, with buffers for
arrays. A call of an item becomes a launch of its kernel, and every call also hands on the error. An
item that sums or counts says behind its call what holds that on the GPU: `!@gpu book_low
count_over`, a column of the books and the first count; counts are then read. Statements for the CPU
alone end in `!@cpu`, those for the GPU alone are comments that begin with `!@gpu`. `!@host`
says that a procedure runs on the host for both.

In files of the solids, which hand on `solid`, the GPU has `gpu` besides: the arrays that it has
under the same names are read there, and all that is associated but `body`. `!@gpu x => y` behind a
call says what stands in place of an argument. Procedures that are not handed `solid` run on the
host for both. Files of the air in src/air and src/step hand on `air` in the same way; walls are on
the GPU those of `gpu`. Where src/cpu has operations of the air, src/gpu has them by the same names.
"""

import re
import sys
from pathlib import Path

from item_heads import BUFFER, ITEM, Item, fold, marked

CALL = re.compile(r"^(.*?)\bcall ([\w%]+)\((.*)\)$")
HEAD = re.compile(r"^subroutine (\w+)\((.*)\)$")
ARRAY = re.compile(r"^([\w()]+), intent\(\w+\) :: (\w+)\(:.*\)$")
TAGS = re.compile(r"!@gpu ((?:book|count)_.*)")
KNOWN = {"gpu_solid_t": "brz_gpu_solid_state"}
KNOWN |= dict.fromkeys(["gpu_places_t", "gpu_marks_t"], "brz_gpu_places")
KNOWN |= {"clear_buffer": "brz_device"}
KNOWN |= dict.fromkeys(["gpu_air_t", "mark_near_walls"], "brz_gpu_air_state")
KNOWN |= {"take_found": "brz_gpu_air_operations"}
KNOWN |= {"from": "brz_buffers", "error_t": "brz_errors", "several": "brz_ranks"}
KNOWN |= dict.fromkeys(BUFFER.values(), "brz_buffers")
KNOWN |= dict.fromkeys(
    ["book_at", "count_at", "put_carriers", "read_counts", "seen_t"], "brz_gpu_coupling_state"
)
CHANGES = [(r"\bmodule brz_(\w+)", r"module brz_gpu_\1"), (r", running_sum\b", "")]
CHANGES += [
    (r"use brz_(air|coupling)_state, only: (\w+_t)$", r"use brz_gpu_\1_state, only: gpu_\2")
]
CHANGES += [(r"type\((air|coupling)_t\)", r"type(gpu_\1_t)")]
CHANGES += [(r"use brz_(lists|parcels|\w+_steps)\b", r"use brz_gpu_\1")]
CHANGES += [("type.solid_t.", "type(seen_t)"), ("type.marks_t.", "type(gpu_marks_t)")]
CHANGES += [("type.parcels_t.", "type(gpu_places_t)"), (r"\brows_t\b", "gpu_rows_t")]
# what gpu_solid_t has as solid_t has it, for files of the solids
ON_GPU = "n|wide|step_[dpt]|x|x_ref|x_built|v|a|load|work|moved|grip|mass|energy|damage|stress"
ON_GPU += "|face_stress|pair|fixed|id|owed"
OF_SOLIDS = [(r"\ballocated\(solid%(load|grip|owed)\)", r"gpu%\1%address /= 0")]
OF_SOLIDS += [(r"\bjoined_of\(solid%links\)", "gpu%links%joined")]
OF_SOLIDS += [(r"\bhomes_of\(solid, b\)", "homes_of(gpu, solid, b)")]
OF_SOLIDS += [(r"\bglue_of\(solid\)", "gpu%cohesive%push")]
OF_SOLIDS += [(r"\bnodes_of\(solid\)", "gpu%cohesive%row")]
OF_SOLIDS += [(r"\b(load|grip)_of\(solid\)", r"gpu%\1"), (rf"\bsolid%({ON_GPU})\b", r"gpu%\1")]
OF_SOLIDS += [(r"\b(?!body\b)(\w+) => solid%", r"\1 => gpu%"), (r"\((?::, )?1:\)", "")]
OF_AIR = [
    (r"\bair%(u|outside|grid|edge|leaving)\b", r"gpu%\1"),
    (r"\bair%(reached|awake)\b", r"gpu%bricks%\1"),
]
OF_AIR += [(r"\bair%part%(reached|awake)\b", r"gpu%bricks%near_\1")]
OF_AIR += [(r"\bair%part%own\b", "gpu%bricks%own")]
OF_AIR += [("^type.wall_t.*", ""), (r", wall\b(?!%)", ""), (r"\bwall%", "gpu%walls%")]
OWN = [(r"\bmodule brz_(\w+)", r"module brz_gpu_\1")]
OWN += [(r"use brz_(\w+_(?:steps|operations))\b", r"use brz_gpu_\1")]
OWNED = {"solid": OF_SOLIDS + OWN, "air": OF_AIR + OWN}


def statements(text):
    """(number of the line, indent, statement, comment) with continued lines joined."""
    whole, begin, first = "", 0, 1
    for number, line in enumerate(text.splitlines(), 1):
        bare, mark, comment = line.partition("!")
        if not whole:
            begin, first = len(line) - len(line.lstrip()), number
        whole += bare.strip().removesuffix("&") + " "
        if not bare.rstrip().endswith("&"):
            yield first, begin, " ".join(whole.split()), mark + comment
            whole = ""


def arguments(text):
    """What stands between the commas outside brackets."""
    depth, parts = 0, [""]
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [x.strip() for x in parts]


def launch(family, item, given, comment, c):
    """A launch in place of the loop over an item, and the count that it leaves."""
    tags = comment.partition("!@gpu")[2].split()
    other = dict(re.findall(r"(\S+) => ([\w%]+)", comment))
    given = [other.get(x, x) for x in given]
    given = [re.sub(r"^(c%\w+)\((\w+):\)$", r"from(\1, int(\2, int64))", x) for x in given]
    pairs = list(zip(given[2 if item.exact else 1 :], item.rest, strict=True))
    kept = [given[0], *(re.sub("^c%carrier$", r"\g<0>_there", x) for x, a in pairs if not a.tally)]
    if item.exact:
        return [
            f"call {family}_kernels%{item.name}({', '.join([*kept, f'{c}%exact', 'err'])})",
            f"{given[-1]} = {c}%exact%total(:{len(item.sums)})",
        ]
    counted = [x for x, a in pairs if a.tally == "count"]
    if item.sums:
        kept.append(f"book_at(c, {tags[0]})")
    if counted:
        kept.append(f"count_at(c, {tags[-1]})")
    made = [f"call {family}_kernels%{item.name}({', '.join([*kept, 'err'])})"]
    if counted:
        made.append(f"call read_counts(c, {tags[-1]}, err, {', '.join(counted)})")
    return made


def called(code, comment, items, owner):
    """Statements in place of one, which may be a call."""
    if not code and comment.startswith("!@gpu "):
        code = comment.removeprefix("!@gpu ")
        return [re.sub(r"(call .*[^(])\)$", r"\1, err)", code)]
    if comment.startswith("!@host") or not (found := CALL.match(code)):
        return [code]
    before, name, given = found.groups()
    if name.startswith("each_"):
        first, *more = launch(*items[name[5:]], arguments(given), comment, "gpu" if owner else "c")
        return [before + first, *more]
    if owner:
        handed_on, given = arguments(given)[0] == owner, given.removesuffix(", err")
        handed_on = handed_on and "%" not in name
        return [f"{before}call {name}(gpu, {given}, err)" if handed_on else code]
    if name == "running_sum":
        x, n, *total = arguments(given)
        x = re.sub(r"^(.*)\((\d+):\)$", r"from(\1, \2_int64)", x)
        holder = re.search(r"(\w+)%", x)[1]
        return [f"{before}call {holder}%common%running_sum({', '.join([x, n, 'err', *total])})"]
    return [f"{before}call {name}({given}, err)"]


def uses(code, tags, families):
    """Modules that the GPU needs besides."""
    known = {x: KNOWN[x] for x in set(re.findall(r"\w+", code)) & set(KNOWN)}
    known |= dict.fromkeys(tags, "brz_gpu_coupling_state")
    known |= {f"{x}_kernels": f"brz_{x}_launches" for x in families}
    known |= {"int64": "brz_kinds"} if "_int64" in code else {}
    for owner in sorted(set(known.values())):
        yield f"use {owner}, only: {', '.join(sorted(x for x in known if known[x] == owner))}"


def changed(code, owner):
    """A statement with the names of the GPU."""
    if owner:
        for old, new in OWNED[owner]:
            code = re.sub(old, new, code)
        head = rf"^subroutine (\w+)\(({owner}.*?)(, err)?\)$"
        return re.sub(head, r"subroutine \1(gpu, \2, err)", code)
    if (array := ARRAY.match(code)) and array[1] in BUFFER:
        code = f"type({BUFFER[array[1]]}), intent(in) :: {array[2]}"
    for old, new in CHANGES:
        code = re.sub(old, new, code)
    return HEAD.sub(r"subroutine \1(\2, err)", code)


def translated(text, items, owner):
    """(number of the line, indent, statement, comment) of the module for the GPU."""
    opened, lines = False, []
    for number, indent, code, comment in statements(text):
        if re.match(r"use brz_\w+_loops", code) or comment.startswith("!@cpu"):
            continue
        if opened and owner and code == "type(error_t), intent(inout) :: err":
            continue
        if opened and owner and code.startswith(f"type({owner}_t)"):
            lines.append((number, 8, f"type(gpu_{owner}_t), intent(inout) :: gpu", ""))
        if opened and "intent(" not in code and not comment:
            lines.append((number, 8, "type(error_t), intent(inout) :: err", ""))
        if "intent(" not in code and not comment:
            opened = False
        opened = opened or bool(HEAD.match(code))
        new = changed(code, owner)
        if code and not new:
            continue
        for one in called(new, comment, items, owner):
            lines.append((number, indent, one, "" if comment.startswith("!@") else comment))
    code = "\n".join(x for _, _, x, _ in lines)
    tags = [] if owner else {x for line in TAGS.findall(text) for x in line.split()}
    families = set(re.findall(r"(?<!%)\b(\w+)_kernels%", code))
    at = next(k for k, line in enumerate(lines) if line[2] == "implicit none")
    more = [(lines[at][0], 4, x, "") for x in uses(code, tags, families)]
    return [*lines[:at], *more, *lines[at:]]


def main():
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    items = {}
    for path in [*Path("src").glob("**/*_items.f90"), *source.parent.glob("*_items.f90")]:
        text = path.read_text(encoding="utf-8")
        for m in ITEM.finditer(text):
            family = path.stem.removesuffix("_items")
            items[m[3]] = family, Item(*m.groups(), text[m.end() :])
    lines = []
    owners = {"solid": "solid", "air": "air", "step": "air"}
    owner = next((owners[x] for x in source.parts if x in owners), "")
    owner = "solid" if source.name.startswith("solid_") else owner
    text = source.read_text(encoding="utf-8")
    for number, indent, code, comment in translated(text, items, owner):
        every = fold(code) if code else [""]
        every[-1] += f" {comment}" if code else comment
        lines += [(number if code else None, (" " * indent + x).rstrip()) for x in every]
    lines.insert(1, (None, f"!> Written by scripts/steps.py from {source}."))
    target.write_text("\n".join(marked(lines, source)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
