# SPDX-License-Identifier: MIT
"""Pictures of what was recorded: histories beside accuracy against core-seconds."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from post.style import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, RED
from studies.comparisons import tables
from studies.comparisons.case import Case
from studies.comparisons.records import Record, read_histories, read_records

COLOURS = {
    "Brisance": RED,
    "CalculiX": BLUE,
    "OpenRadioss": GREEN,
    "LAMMPS": ORANGE,
    "OpenFOAM": PURPLE,
}
MARKS = {"Brisance": "o", "CalculiX": "s", "OpenRadioss": "D", "LAMMPS": "^", "OpenFOAM": "v"}
DASHES = ("-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)))


def family(name: str) -> str:
    return next((code for code in COLOURS if name.startswith(code)), "")


def draw(case: Case, path: Path) -> None:
    """The picture of a case; nothing where nothing is recorded."""
    records, histories = read_records(case), read_histories(case)
    if case.exact:
        histories["exact"] = case.exact()
    timed = [r for r in records if r.core_s and first(case, r) is not None]
    if not records or not (histories or timed):
        return
    panels = [bool(histories), bool(timed)]
    ratios = [1.45 if kind == 0 else 1 for kind in range(2) if panels[kind]]
    fig, axes = plt.subplots(1, sum(panels), figsize=(10 if all(panels) else 6.2, 3.9),
                             width_ratios=ratios, squeeze=False)  # fmt: skip
    axes = list(axes[0])
    if histories:
        draw_histories(axes.pop(0), case, histories)
    if timed:
        draw_cost(axes.pop(0), case, timed)
    fig.suptitle(f"{case.mark}: {case.title}", x=0.01, ha="left", fontweight="bold", fontsize=11)
    fig.savefig(path, dpi=130)
    plt.close(fig)


def draw_histories(ax, case: Case, histories: dict) -> None:
    seen: dict[str, int] = {}
    for name, points in histories.items():
        code = family(name)
        k = seen[code] = seen.get(code, -1) + 1
        exact = not code
        ax.plot(
            [t * case.scales[0] for t, _ in points],
            [v * case.scales[1] for _, v in points],
            color=INK if exact else COLOURS[code],
            ls=case.lines.get(name, DASHES[k % len(DASHES)]),
            lw=2.6 if exact else 1.5,
            alpha=0.35 if exact else 1,
            zorder=1 if exact else 3 if code == "Brisance" else 2,
            label=name,
        )
    ax.set_xlabel(case.axes[0])
    ax.set_ylabel(case.axes[1])
    ax.margins(x=0)
    ax.legend(fontsize=7.5)


def plain_log(axis, low: float, high: float) -> None:
    """Plain numbers on a logarithmic axis, more of them where it is short."""
    axis.set_major_locator(LogLocator(subs=(1,) if high / low > 300 else (1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def offs(case: Case, record: Record) -> dict[str, float]:
    """Deviations in % by quantity."""
    found = {q.label: tables.deviation(q, record.measures.get(q.key)) for q in case.quantities}
    return {label: 100 * off for label, off in found.items() if off is not None}


def draw_cost(ax, case: Case, records: list[Record]) -> None:
    """The first quantity of each run against its core-seconds; the band of the reference."""
    quantity = next(q for q in case.quantities if q.reference)
    records = [r for r in records if first(case, r) is not None]
    if quantity.tolerance:
        bound = 100 * quantity.tolerance
        ax.axhspan(-bound, bound, color="#e7ecef", zorder=0)
    ax.axhline(0, color=GREY, lw=0.8)
    ordered = sorted(records, key=lambda r: offs(case, r).get(quantity.label, 0.0))
    for place, r in enumerate(ordered):
        off = offs(case, r).get(quantity.label)
        if off is None:
            continue
        code = family(r.code)
        fill = "white" if r.kind == "recorded" else COLOURS.get(code, INK)
        ax.plot(r.core_s, off, MARKS.get(code, "x"), color=COLOURS.get(code, INK), mfc=fill, ms=7)
        ax.annotate(r.code.replace(f"{code}, ", "").replace(f"{code} ", ""), (r.core_s, off),
                    xytext=(-6 if place % 2 else 6, 0), ha="right" if place % 2 else "left",
                    va="center", textcoords="offset points", fontsize=6.5,
                    color=COLOURS.get(code, INK))  # fmt: skip
    ax.set_xscale("log")
    times = [r.core_s for r in records]
    low, high = min(times), max(times)
    room = max(4.0, (high / low) ** 0.45)
    ax.set_xlim(low / room, high * room)
    plain_log(ax.xaxis, low / room, high * room)
    ax.margins(y=0.2)
    ax.set_xlabel("core-seconds (open: recorded elsewhere)")
    ax.set_ylabel(f"{quantity.label}, off the reference [%]")


def first(case: Case, record: Record) -> float | None:
    """Deviation in % of the first quantity that has a reference."""
    quantity = next((q for q in case.quantities if q.reference), None)
    return offs(case, record).get(quantity.label) if quantity else None


def overview(cases: list[Case], path: Path) -> None:
    """Every case in a line: how far each code is off, and its core-seconds over ours."""
    lines = [(case, read_records(case)) for case in cases]
    lines = [(case, [r for r in rs if first(case, r) is not None]) for case, rs in lines]
    lines = [(case, rs) for case, rs in lines if rs]
    if not lines:
        return
    fig, axes = plt.subplots(1, 2, figsize=(10, 0.42 * len(lines) + 1.5), sharey=True)
    for row, (case, records) in enumerate(reversed(lines)):
        ours = [r.core_s for r in records if family(r.code) == "Brisance" and r.core_s]
        for r in records:
            code = family(r.code)
            style = {"color": COLOURS.get(code, INK), "ms": 6, "ls": "none", "alpha": 0.85,
                     "mfc": "white" if r.kind == "recorded" else COLOURS.get(code, INK),
                     "marker": MARKS.get(code, "x")}  # fmt: skip
            axes[0].plot(first(case, r), row, **style)
            if r.core_s and ours:
                axes[1].plot(r.core_s / min(ours), row, **style)
    axes[0].set_yticks(range(len(lines)), [f"{c.mark}  {c.title}" for c, _ in reversed(lines)],
                       fontsize=8)  # fmt: skip
    axes[0].axvline(0, color=GREY, lw=0.8)
    axes[0].set_xlabel("first quantity off its reference [%]")
    axes[1].axvline(1, color=GREY, lw=0.8)
    axes[1].set_xscale("log")
    plain_log(axes[1].xaxis, *axes[1].get_xlim())
    axes[1].set_xlabel("core-seconds over Brisance's quickest run")
    handles = [plt.Line2D([], [], color=c, marker=MARKS[n], ls="none", label=n)
               for n, c in COLOURS.items()]  # fmt: skip
    handles.append(
        plt.Line2D([], [], color=INK, marker="x", ls="none", label="published, experiment")
    )
    fig.legend(handles=handles, loc="outside lower center", ncols=6, fontsize=8)
    fig.savefig(path, dpi=130)
    plt.close(fig)
