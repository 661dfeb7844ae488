# SPDX-License-Identifier: MIT
"""Tables of what was recorded, for the terminal and for studies/notes/comparison.md."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

from studies.comparisons.case import Case, Quantity
from studies.comparisons.records import Record, read_records

WIDTH = 118  # of prose in the page


def deviation(quantity: Quantity, value: float | None) -> float | None:
    """(value - reference)/reference; None without either."""
    if value is None or not quantity.reference:
        return None
    return (value - quantity.reference) / quantity.reference


def cell(quantity: Quantity, value: float | None) -> str:
    """'18.54 (-1.9 %)'."""
    if value is None:
        return ""
    off = deviation(quantity, value)
    return quantity.shown(value) + ("" if off is None else f" ({100 * off:+.1f} %)")


def seconds(record: Record) -> str:
    if record.core_s is None:
        return ""
    return f"{record.core_s:.0f}" if record.core_s >= 99.5 else f"{record.core_s:#.2g}".rstrip(".")


def one_line(case: Case, record: Record) -> str:
    parts = [f"{q.label} {cell(q, record.measures.get(q.key))} {q.unit}" for q in case.quantities]
    return f"{record.code}: {'; '.join(parts)}; {seconds(record)} core-s"


def drift(case: Case, old: Record | None, new: Record, bound: float) -> list[str]:
    """What a rerun gives that its record has not."""
    lines = []
    for q in case.quantities if old else ():
        a, b = old.measures.get(q.key), new.measures.get(q.key)
        if a and b is not None and abs(b - a) > bound * abs(a):
            lines.append(f"{q.label} was {q.shown(a)}, is {q.shown(b)} {q.unit}")
    return lines


def missed(case: Case, record: Record) -> list[str]:
    """Quantities of a run of Brisance that are out of their tolerance."""
    lines = []
    for q in case.quantities if record.code.startswith("Brisance") else ():
        off = deviation(q, record.measures.get(q.key))
        if off is not None and q.tolerance is not None and abs(off) > q.tolerance:
            lines.append(f"{q.label}: {100 * off:+.1f} %, wanted {100 * q.tolerance:g} %")
    return lines


def rows(case: Case) -> list[list[str]]:
    """Cells of the table of a case, the heads first."""
    heads = ["code", "size", *(f"{q.label} [{q.unit}]" for q in case.quantities)]
    table = [[*heads, "core-s", "how", "remark"]]
    for r in read_records(case):
        values = [cell(q, r.measures.get(q.key)) for q in case.quantities]
        remark = case.remarks.get(r.code, "")
        table.append([r.code, r.size, *values, seconds(r), r.kind, remark])
    if any(q.reference for q in case.quantities):
        wanted = []
        for q in case.quantities:
            bound = f" +- {100 * q.tolerance:g} %" if q.tolerance else ""
            wanted.append(f"{q.shown(q.reference)}{bound}" if q.reference else "")
        table.append([f"*reference: {case.reference}*", "", *wanted, "", "", ""])
    return table


def markdown(case: Case) -> str:
    """Title, setting, table and text of a case."""
    head, *body = rows(case)
    setting = textwrap.fill(case.setting, WIDTH)
    lines = [f"### {case.mark}: {case.title}", "", setting, "", _line(head)]
    lines += ["|" + "---|" * len(head), *map(_line, body)]
    if case.text:
        lines += ["", textwrap.fill(case.text, WIDTH, break_long_words=False)]
    return "\n".join(lines)


def _line(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def versions(cases: list[Case]) -> str:
    """Which versions, on which machines, on which days the records are of."""
    found = {}
    for case in cases:
        for r in read_records(case):
            if r.kind in ("rerun", "recorded"):
                key = (r.code.split(",")[0].split(" ")[0], r.version, r.machine)
                found.setdefault(key, set()).add(r.date)
    lines = ["| code | version | machine | recorded |", "|---|---|---|---|"]
    for (code, version, machine), days in sorted(found.items()):
        lines.append(_line([code, version, machine, ", ".join(sorted(days))]))
    return "\n".join(lines)


def write_page(page: Path, cases: list[Case]) -> None:
    """Put the tables between the marks `<!-- NAME -->` and `<!-- end -->` of a page."""
    page.write_text(filled(page.read_text(encoding="utf-8"), cases), encoding="utf-8")


def filled(text: str, cases: list[Case]) -> str:
    """A page with the tables of today."""
    parts = {case.name: markdown(case) for case in cases} | {"versions": versions(cases)}

    def fill(found: re.Match) -> str:
        name = found[1]
        return f"<!-- table: {name} -->\n{parts[name]}\n<!-- end -->"

    return re.sub(r"<!-- table: (\w+) -->.*?<!-- end -->", fill, text, flags=re.DOTALL)
