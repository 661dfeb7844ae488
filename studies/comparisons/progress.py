# SPDX-License-Identifier: MIT
"""How far a comparison is: a line for each run with an estimate, and a summary at the end."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

from studies.comparisons.case import Case, Run
from studies.comparisons.records import read_records

UNKNOWN, SLOW = 30.0, 300.0  # [s] of a run that no record tells the time of


def estimate(case: Case, run: Run) -> float:
    """Seconds of one core, as recorded."""
    found = next((r.core_s for r in read_records(case) if r.code == run.name), None)
    return found or (SLOW if run.slow else UNKNOWN)


def clock(seconds: float) -> str:
    """'47 s', '12 min', '1 h 20 min'."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02} min"


@dataclass
class Progress:
    """Of all runs that are to be made."""

    left: dict[tuple[str, str], float]  # estimates [s] by case and run, in all turns
    number: int = 0
    started: float = field(default_factory=time.monotonic)
    wall: float = 0.0  # of the runs made
    told: float = 0.0  # estimates of the same
    counts: dict[str, int] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, plan: list[tuple[Case, Run]], turns: int = 1) -> Progress:
        return cls({(case.name, run.name): turns * estimate(case, run) for case, run in plan})

    def begin(self, case: Case, run: Run) -> None:
        """Say which run comes, how long it will take, and what is left with it."""
        pace = self.wall / self.told if self.told > 0 else 1.0
        own = estimate(case, run) * pace
        self.number += 1
        left = clock(sum(self.left.values()) * pace)
        print(
            f"{case.name}: {run.name}: run {self.number}, about {clock(own)} of {left}", flush=True
        )

    def end(self, case: Case, run: Run, how: str, wall: float = 0.0) -> None:
        """How a run has ended: 'run', 'kept' (it was run before) or 'failed'."""
        told = estimate(case, run)
        key = (case.name, run.name)
        self.left[key] = max(0.0, self.left.get(key, 0.0) - told)
        self.counts[how] = self.counts.get(how, 0) + 1
        if how == "run":
            self.wall += wall
            self.told += told

    def remark(self, text: str) -> None:
        """Print something now and in the summary."""
        print(text, flush=True)
        self.remarks.append(text)

    def summary(self, skipped: int) -> str:
        """What was done, and everything that is not as recorded."""
        words = {"run": "run", "kept": "kept from before", "failed": "failed"}
        parts = [f"{self.counts[how]} {word}" for how, word in words.items() if how in self.counts]
        parts += [f"{skipped} skipped"] if skipped else []
        lines = [f"Summary: {', '.join(parts) or 'nothing to run'}; "
                 f"{clock(time.monotonic() - self.started)}"]  # fmt: skip
        return "\n".join([*lines, *(f"  {text}" for text in self.remarks)])
