# SPDX-License-Identifier: MIT
"""The certificate of a study: error bars of one run at the middle of its ranges, for all its rows.

What the cells leave open is told where it is known: half widths over the natural scale, of the
results that are promised there.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from post.certify import Certificate, Options, certify_job, natural_scale
from post.errors import PostError
from post.runner import STOPPED, Job, Outcome
from post.study_file import Study
from post.study_table import Column, result_names


class Centre:
    """The certificate at the middle, or why there is none."""

    def __init__(self, found: Certificate | None = None, note: str = "", stopped: bool = False):
        self.note, self.stopped = note, stopped
        rows = found.rows if found is not None else []
        self.shares = {row.name: row.interval.half / row.scale for row in rows
                       if row.interval.promised and row.scale > 0}  # fmt: skip

    def share(self, name: str) -> float:
        """Half width of a result over its natural scale; not a number where none is promised."""
        return self.shares.get(name, math.nan)

    def columns(self, study: Study, outcomes: list[Outcome]) -> list[Column]:
        """'U:' columns: half widths in the unit of each result, of each row."""
        found = []
        for name in result_names(study, outcomes):
            if name not in self.shares:
                continue
            unit = next((o.units[name] for o in outcomes if name in o.units), "-")
            values = [self.share(name) * natural_scale(one, name) if name in one.values
                      else math.nan for one in outcomes]  # fmt: skip
            about = "half width by the certificate at the middle of the ranges"
            found.append(Column(f"U:{name}", unit, about, values))
        return found

    def sentence(self, names: list[str]) -> str:
        """'By cells, at the middle of the ranges: mid:displacement_z peak +-1.2 %.'."""
        told = [f"{n} +-{100 * self.shares[n]:.2g} %" for n in names if n in self.shares]
        more = [n for n in names if n not in self.shares]
        if not self.shares and self.note:
            return self.note
        text = f"By cells, at the middle of the ranges: {', '.join(told) or 'nothing promised'}"
        return text + (f"; not promised: {', '.join(more)}." if more and told else ".")


def certify_centre(study: Study, middle: dict, out: Path, jobs: int, program: Path) -> Centre:
    """Run the certificate of a point into `certify/` beside the table."""
    job = study.whole(middle)
    options = Options(out=out / "certify", jobs=jobs, program=str(program))
    try:
        code, found = certify_job(study.deck, Job(job.text, job.home, job.sets), options.out,
                                  options)  # fmt: skip
    except PostError as error:
        note = f"no certificate: {error}"
        print(f"note: {note}", file=sys.stderr)
        return Centre(note=note)
    return Centre(found, stopped=code == STOPPED)
