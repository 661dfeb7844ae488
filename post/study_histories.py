# SPDX-License-Identifier: MIT
"""Histories of all runs of a study in one file, `histories.h5`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from post.errors import PostError
from post.history import read_history
from post.runner import Outcome, Store

TIMES = 256  # of each history


def write_histories(path: Path, store: Store, outcomes: list[Outcome]) -> list[str]:
    """One group for each column of the gauges: `value` and `time`, points x 256 times evenly from
    the beginning to the end of each run, not a number for runs without results. Names of the
    groups; no file without any.
    """
    import h5py  # noqa: PLC0415 (slow to load)

    rows = {}
    for k, one in enumerate(outcomes):
        if not one.done:
            continue
        try:
            rows[k] = read_history(store.place(one.key) / "out" / "gauges.csv")
        except PostError:
            continue  # a run without gauges
    names = list(dict.fromkeys(name for row in rows.values() for name in row.names[1:]))
    if not names:
        return []
    draft = path.with_suffix(".part")
    with h5py.File(draft, "w") as file:
        for name in names:
            time, value = np.full((2, len(outcomes), TIMES), np.nan)
            units = [row.unit(name) for row in rows.values() if name in row]
            for k, row in rows.items():
                if name in row:
                    time[k] = np.linspace(row.time[0], row.time[-1], TIMES)
                    value[k] = np.interp(time[k], row.time, row[name])
            group = file.create_group(name)
            for what, data, unit in (("time", time, "s"), ("value", value, units[0])):
                made = group.create_dataset(what, data=data, compression="gzip")
                made.attrs["unit"] = unit
    draft.replace(path)
    return names
