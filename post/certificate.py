# SPDX-License-Identifier: MIT
"""The certificate of a run, where `certify` has left one: intervals for the report."""

from __future__ import annotations

import json
from pathlib import Path

from post.tables import Table
from post.units import show


def read_certificate(folder: Path) -> dict[str, dict]:
    """Intervals by result, from `certify/certify.json` in the folder of a run: value, half, unit,
    best, verdict, promised. Empty where there is none.
    """
    path = folder / "certify" / "certify.json"
    try:
        return json.loads(path.read_text(encoding="utf-8"))["results"]
    except (OSError, ValueError, KeyError):
        return {}


def interval_text(one: dict) -> str:
    """'18.9 ± 0.8 mm', or why nothing is promised."""
    if not one["promised"]:
        return f"no error bar: {one['verdict']}"
    return f"{show(one['value'], one['unit'], 4)} ± {show(one['half'], one['unit'], 2)}"


def certificate_table(folder: Path) -> Table:
    """All results of the certificate of a run; no rows without one."""
    known = read_certificate(folder).items()
    rows = [(name, interval_text(one), one["verdict"])
            for name, one in known if one["verdict"] != "nothing"]  # fmt: skip
    note = (
        "By coarser partners of this run (certify/certify.html): intervals that hold the value for "
        "vanishing spacing in 9 of 10. Of cells and particles, not of the model."
    )
    return Table("Error bars", ("result", "value", "verdict"), rows, note)
