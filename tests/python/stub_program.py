#!/usr/bin/env -S python3 -IS
# SPDX-License-Identifier: MIT
"""Stands for the program where a test is about studies alone: a formula of the deck's numbers.

It knows `--version`, `run DECK --check --echo FILE` and `run DECK --out DIR`. The deck is one group
&run with x, y, fail, wait and perhaps an &air with n cells; the gauge `mid` goes to x**1.5 * y
(1 + 1/n) and stays there. A run with `fail` cells or less fails. STUB_LOG names a file that gets a
line for each run that was begun. Member `seed` is 1 + jitter seed times as large. A run with
checkpoint_every leaves a checkpoint, and --branch FILE wants one; USR2 ends one with code 75.
"""

import math
import os
import re
import signal
import sys
import time
from pathlib import Path

DEFAULTS = {"t_end": "1.0", "x": "1.0", "y": "1.0", "fail": "0", "wait": "0.0",
            "jitter": "0.0", "seed": "1"}  # fmt: skip


def main(args):
    """The exit code."""
    if args[0] == "--version":
        print(os.environ.get("STUB_VERSION", "Stub 1.0 (abc)"))
        return 0
    text = Path(args[1]).read_text(encoding="utf-8")
    values = DEFAULTS | dict(re.findall(r"(\w+)\s*=\s*([-+.\de]+)", text.split("&output")[0]))
    sets = [args[i + 1] for i, a in enumerate(args) if a == "--set"]
    values |= dict(one.split(".", 1)[1].split("=") for one in sets)
    cells = float(values["cells"].split(",")[0]) if "cells" in values else 0.0
    unknown = set(values) - set(DEFAULTS) - {"cells", "history_every", "box", "checkpoint_every"}
    if unknown:
        print(f"deck.nml:1: unknown key {unknown.pop()}", file=sys.stderr)
        return 2
    numbers = {key: float(values[key]) for key in DEFAULTS}
    echo = "&run\n" + "".join(f"  {k} = {numbers[k]!r}\n" for k in DEFAULTS) + "/\n"
    if cells:
        echo += f"&air\n  box = 0.0, 1.0, 0.0, 1.0, 0.0, 1.0\n  cells = {cells:.0f}, 1, 1\n/\n"
    if "--check" in args:
        Path(args[args.index("--echo") + 1]).write_text(echo, encoding="utf-8")
        print("time         about 1.0 s of one core, 0.5 s on 2 here, if all is active")
        return 0
    signal.signal(signal.SIGUSR2, lambda *_: sys.exit(75))
    if log := os.environ.get("STUB_LOG"):
        with Path(log).open("a", encoding="utf-8") as file:
            file.write(echo.replace("\n", " ") + "\n")
    out = Path(args[args.index("--out") + 1])
    out.mkdir(parents=True, exist_ok=True)
    if "--branch" in args and not Path(args[args.index("--branch") + 1]).is_file():
        print("no checkpoint to branch off", file=sys.stderr)
        return 4
    if "checkpoint_every" in values:
        (out / "chk_000007.h5").write_text("state", encoding="utf-8")
    time.sleep(numbers["wait"])
    if numbers["fail"] > cells:
        print("the energy is out of its band", file=sys.stderr)
        return 3
    gauge = "&gauge\n  id = 'mid'\n  body = 'p'\n  quantity = 'displacement_y'\n/\n"
    (out / "deck.echo.nml").write_text(echo + gauge, encoding="utf-8")
    size = numbers["x"] ** 1.5 * numbers["y"] * (1 + (1 / cells if cells else 0))
    size *= 1 + numbers["jitter"] * numbers["seed"]
    rows = [f"{t / 100},{-size * math.sin(math.pi / 2 * min(t / 20, 1.0))!r}" for t in range(101)]
    text = "time[s],mid:displacement_y[m]\n" + "\n".join(rows) + "\n"
    (out / "gauges.csv").write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
