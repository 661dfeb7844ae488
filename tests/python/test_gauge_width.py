# SPDX-License-Identifier: MIT
"""A gauge with a width is the mean of gauges at the points of its box: in the grid, and while the
blast is computed along its radius or in the plane of its axis.
"""

import itertools

import numpy as np
import pytest
from test_loads import BLOCK, run
from test_run import run as refused

CASES = {  # deck, middle and sides of the box, points along each side, those that count
    "start 1d": ("""\
&run t_end=1.5e-4, symmetry='x','y','z' /
&air box=0,0.4, 0,0.4, 0,0.4, cells=16,16,16, bc='symmetry','outflow','symmetry','outflow',
    'symmetry','outflow' /
&charge id='c', mass=0.05, at=0,0,0, start='1d' /
""", (0.2, 0.1, 0.0), (0.05, 0.025, 0.05), (3, 2, 3), lambda p: p[2] >= 0),
    "spherical": ("""\
&run t_end=2e-4 /
&air geometry='spherical' /
&charge id='c', mass=0.05, at=0,0,0 /
""", (0.3, 0.0, 0.0), (0.1, 0.0, 0.02), (8, 1, 8), lambda p: True),
    "axial": ("""\
&run t_end=1e-4 /
&air geometry='axial', floor=-0.1 /
&charge id='c', mass=0.05, at=0,0,0, shape='cylinder', axis='z', aspect=1 /
""", (0.1, 0.0, -0.1), (0.05, 0.05, 0.1), (8, 8, 8), lambda p: p[2] >= -0.1),
}  # fmt: skip


def points(middle, sides, n):
    """Middles of equal parts of a box."""
    rows = [m + s * ((np.arange(k) + 0.5) / k - 0.5)
            for m, s, k in zip(middle, sides, n, strict=True)]  # fmt: skip
    return list(itertools.product(*rows))


@pytest.mark.parametrize("case", CASES)
def test_the_mean_is_that_of_its_points(tmp_path, case):
    deck, middle, sides, n, counts = CASES[case]
    inside = [p for p in points(middle, sides, n) if counts(p)]
    place, width = (",".join(map(repr, x)) for x in (middle, sides))
    for what in ("pressure", "speed"):
        deck += f"&gauge id='w_{what}', at={place}, width={width}, quantity='{what}' /\n"
        for k, p in enumerate(inside):
            at = ",".join(repr(float(x)) for x in p)
            deck += f"&gauge id='p{k}_{what}', at={at}, quantity='{what}' /\n"
    table = run(tmp_path, deck + "&output history_every=0, dump_every=1 /\n")["gauges"]
    for what, unit in (("pressure", "Pa"), ("speed", "m/s")):
        alone = [table[f"p{k}_{what}:{what}[{unit}]"] for k in range(len(inside))]
        mean = np.mean(alone, axis=0)
        assert table[f"w_{what}:{what}[{unit}]"] == pytest.approx(mean, rel=1e-12)
        assert np.ptp(alone, axis=0).max() > 0.05 * mean.max()


@pytest.mark.parametrize(("line", "words"), [
    ("body='b', quantity='strain', at=0,0,0, to=0.01,0,0, width=0.1", "no mean of strain"),
    ("body='b', quantity='moment_x', at=0,0,0, width=0.1", "no mean of moment_x"),
    ("body='b', quantity='speed', at=0,0,0, width=0.1,0.2", "one side for all, or three"),
    ("body='b', quantity='speed', at=0,0,0, width=-1", "width"),
])  # fmt: skip
def test_widths_that_are_refused(tmp_path, line, words):
    deck = "&run t_end=1e-6 /\n" + BLOCK.format(dx=1e-3, form="auto")
    (tmp_path / "bad.nml").write_text(deck + f"&gauge id='g', {line} /\n")
    assert words in refused("run", "bad.nml", "--check", cwd=tmp_path, code=2).stderr


def test_a_plane_blast_has_no_box(tmp_path):
    deck = "&run t_end=1e-4 /\n&air geometry='planar' /\n&charge id='c', mass=1, at=0,0,0 /\n"
    (tmp_path / "bad.nml").write_text(deck + "&gauge id='g', at=1,0,0, width=0.1 /\n")
    told = refused("run", "bad.nml", "--check", cwd=tmp_path, code=2).stderr
    assert "knows the distance alone" in told
