# SPDX-License-Identifier: MIT
"""A table of texts, for the terminal and for the report."""

from __future__ import annotations

from dataclasses import dataclass

Row = tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """Heads and rows of texts; numbers are formatted already."""

    title: str
    heads: Row
    rows: list[Row]
    note: str = ""


def as_text(table: Table) -> str:
    """A table for the terminal, columns aligned, the note left out."""
    rows = [table.heads, *table.rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(table.heads))]
    lines = ["  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)) for row in rows]
    rule = "  ".join("-" * width for width in widths)
    return "\n".join([table.title, lines[0].rstrip(), rule, *(x.rstrip() for x in lines[1:]), ""])
