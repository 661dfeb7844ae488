# SPDX-License-Identifier: MIT
"""Bodies in air that planes of symmetry cut: a half or a quarter of the scene is the whole."""

import itertools

import numpy as np
import pytest
from test_gauges import gauges
from test_gpu import run as run_on
from test_gpu import same, stamp
from test_loads import run
from test_ranks import equal_air, go, needs_mpirun
from tiers import slow

HEAD = """\
&run t_end={t}, dimension={dimension}, energy_band=1 {planes} /
&air box={box}, cells={cells}, reconstruction='muscl', flux='hllc', integrator='ssprk2' /
&material id='s', model='linear_elastic', density=300, youngs_modulus=2e7, poisson_ratio=0.3 /
&material id='foam', model='linear_elastic', density=30, youngs_modulus=2e7, poisson_ratio=0.3 /
&interaction law='none' /
&output history_every=0, dump_every=1 /
"""
PLACES = (0.0062, 0.0347, 0.0053), (0.0161, 0.0449, 0.0142), (0.0258, 0.0047, 0.0443)


class Thing:
    """A body or hot gas: a box (low and high ends), or a ball (centre, radius)."""

    def __init__(self, *place, v=(0, 0, 0), more="", gas=False, of="s"):
        self.place, self.v, self.more, self.gas, self.of = place, v, more, gas, of

    def is_cut(self, d):
        """The plane of a direction cuts it, or lies in the middle of it."""
        return not self.place[0][d] > 0

    def inside(self):
        """A particle near the middle of it."""
        a, b = self.place
        middle = np.add(a, b) / 2 if np.ndim(b) else np.array(a)
        return ",".join(f"{x:.6g}" for x in middle + 0.00125)

    def words(self, name, signs):
        """Its group, or that of an image."""
        a, b = (np.multiply(x, signs) if np.ndim(x) else x for x in self.place)
        if np.ndim(b):
            ends = zip(np.minimum(a, b), np.maximum(a, b), strict=True)
            where = "box=" + ",  ".join(f"{x:.6g},{y:.6g}" for x, y in ends)
        else:
            where = f"shape='sphere', centre={','.join(f'{x:.6g}' for x in a)}, radius={b}"
        if self.gas:
            return f"&gas id='{name}', {where}, density=4, pressure=3e6 /\n"
        v = ",".join(f"{x:.6g}" for x in np.multiply(self.v, signs))
        more = f"{self.more}, velocity={v}"
        return f"&body id='{name}', {where}, spacing=2.5e-3, material='{self.of}' {more} /\n"


def decks(planes, things, t, dimension=2, side=20):
    """The scene as a whole, and what planes of symmetry leave of it; cells to a side."""
    for part in (False, True):
        there = [d < dimension for d in range(3)]
        box = [[-0.1, 0.1] if x else [-0.5, 0.5] for x in there]
        cells = [side if x else 1 for x in there]
        for d in ["xyz".index(p) for p in planes if part]:
            box[d][0], cells[d] = 0, side // 2
        names = ",".join(f"'{p}'" for p in planes)
        deck = HEAD.format(t=t, dimension=dimension, planes=f", symmetry={names}" if part else "",
                           box=", ".join(f"{a},{b}" for a, b in box),
                           cells=",".join(str(n) for n in cells))  # fmt: skip
        yield deck + bodies(things, "" if part else planes) + looks(things, dimension)


def bodies(things, planes):
    """The groups of all things, and of images in planes that do not cut them."""
    lines = []
    for k, thing in enumerate(things):
        sides = [(1, -1) if a in planes and not thing.is_cut(d) else (1,)
                 for d, a in enumerate("xyz")]  # fmt: skip
        for m, signs in enumerate(itertools.product(*sides)):
            lines.append(thing.words(f"t{k}{'abcdefgh'[m]}", signs))
    return "".join(lines)


def looks(things, dimension):
    """Gauges in the air and in what deforms."""
    lines = []
    for k, (x, y, z) in enumerate(PLACES):
        at = f"{x},{y},{z if dimension == 3 else 0}"
        for name in ("pressure", "density", "speed"):
            lines.append(f"&gauge id='{name}{k}', at={at}, quantity='{name}' /\n")
    for k, thing in enumerate(things):
        if thing.gas or "rigid" in thing.more:
            continue
        for name in ("velocity_x", "velocity_y", "stress_xx", "stress_yy"):
            lines.append(f"&gauge id='{name}_{k}', body='t{k}a', at={thing.inside()}, "
                         f"quantity='{name}' /\n")  # fmt: skip
    return "".join(lines)


HOT = Thing((-0.03, -0.09, -1), (0.03, -0.05, 1), gas=True)
BLASTS = [Thing((-0.09, 0.06, -1), (0.09, 0.09, 1), gas=True)]  # from both sides, in y


def box(x, y, **more):
    return Thing((x[0], y[0], -0.5), (x[1], y[1], 0.5), **more)


# What planes cut, what is in the scene, until when
SCENES = {
    # on the plane, along it: of half a cell and of one, loaded through it
    "plate of a cell": ("x", [HOT, box((-0.005, 0.005), (-0.03, 0.03))], 8e-5),
    "plate of two": ("x", [HOT, box((-0.0075, 0.0075), (-0.03, 0.03))], 8e-5),
    "rigid plate": ("x", [HOT, box((-0.005, 0.005), (-0.03, 0.03), more=", formulation='rigid'")],
                    8e-5),
    # normal to it
    "plate across": ("x", [HOT, box((-0.05, 0.05), (-0.0075, 0.0075))], 8e-5),
    # it flies along the plane: cells are uncovered and covered there
    "bullet": ("x", [HOT, box((-0.0075, 0.0075), (-0.0225, 0.0175), v=(0, 250, 0))], 8e-5),
    "rigid bullet": ("x", [HOT, box((-0.0075, 0.0075), (-0.0225, 0.0175), v=(0, 250, 0),
                                    more=", formulation='rigid'")], 8e-5),
    # two that close the gap between them, or open one
    "gap closes": ("x", [HOT, box((0.03, 0.05), (-0.0325, 0.0325), v=(-250, 0, 0))], 1.1e-4),
    # thin ones, each of which the face behind the other loads in the end
    "rigid gap closes": ("x", [HOT, box((0.02, 0.025), (-0.0325, 0.0325), v=(-250, 0, 0),
                                        more=", formulation='rigid'", of="foam")], 8e-5),
    "gap opens": ("x", [HOT, box((0.005, 0.025), (-0.0325, 0.0325), v=(250, 0, 0))], 8e-5),
    # a hole of two cells that the plane halves is not enclosed
    "hole": ("x", [HOT, box((-0.02, 0.02), (-0.03, -0.01), v=(0, 100, 0)),
                   box((-0.02, 0.02), (0.01, 0.03), v=(0, -20, 0)),
                   box((0.01, 0.02), (-0.0075, 0.0075))], 1.2e-4),
    "discs": ("x", [HOT, Thing((0.025, -0.02, 0), 0.0125, v=(-150, 100, 0)),
                    Thing((0.03, 0.035, 0), 0.0125, v=(-200, -50, 0)),
                    Thing((0.015, 0.005, 0), 0.01, v=(200, 30, 0)),
                    Thing((0, 0.07, 0), 0.015, v=(0, -200, 0)),
                    Thing((0, -0.06, 0), 0.0075, v=(0, -200, 0))], 5e-5),
    "corner": ("xy", [*BLASTS, box((-0.0075, 0.0075), (-0.0175, 0.0175))], 1.5e-4),
    "rigid disc at a corner": ("xy", [*BLASTS, Thing((0, 0, 0), 0.0175,
                                                     more=", formulation='rigid'")], 1.5e-4),
    "discs at a corner": ("xy", [*BLASTS, Thing((0.025, 0.02, 0), 0.0125, v=(-150, -100, 0)),
                                 Thing((0.0125, 0.045, 0), 0.01, v=(200, 50, 0)),
                                 Thing((0.055, 0.015, 0), 0.0125, v=(-100, 150, 0)),
                                 Thing((0, 0.075, 0), 0.015, v=(0, -200, 0)),
                                 Thing((0, 0, 0), 0.0075)], 5e-5),
}  # fmt: skip
# In three dimensions, in the corner of two planes or three
BALLS = [Thing((-0.03, -0.02, 0.04), (0.03, 0.02, 0.06), gas=True),
         Thing((0.025, 0.02, 0.02), 0.0125, v=(-150, -100, -100)),
         Thing((0.0125, 0.015, 0.05), 0.01, v=(200, 50, -100)),
         Thing((0.055, 0.015, 0.025), 0.0125, v=(-300, 150, 20)),
         Thing((0, 0.05, 0.02), 0.015, v=(0, -200, 100)),
         Thing((0, 0, 0), 0.0125)]  # fmt: skip


def compare(planes, whole, part, closed=True):
    """Gauges alike, sums those of the parts, and diagnostics that close."""
    seen = gauges(part)
    for name, column in gauges(whole).items():  # what rounding makes grows in strong blasts
        assert abs(seen[name] - column).max() <= 1e-8 * abs(column).max(), name
    most = abs(whole["energy"]["air_internal[J]"]).max()
    for name, column in whole["energy"].items():
        if not name.endswith("[J]"):
            continue
        got = 2 ** len(planes) * part["energy"][name]
        own = most
        if name in ("air_stored[J]", "air_work[J]", "load_work[J]"):
            own = max(abs(column).max(), 1e-9 * most)  # (nothing moves: rounding)
        # work of loads is what is left of nearly equal parts
        bound = 1e-8 if "work" in name else 1e-9
        assert abs(got - column).max() <= bound * own, name
    for name in ("mass_error[-]", "momentum_error[-]") if closed else ():
        assert abs(part["energy"][name]).max() < 1e-12


@pytest.mark.parametrize("name", SCENES)
def test_bodies_in_air_on_planes_of_symmetry(tmp_path, name):
    planes, things, t = SCENES[name]
    compare(planes, *(run(tmp_path, deck) for deck in decks(planes, things, t)))


def test_the_coupling_of_the_paper_on_a_plane(tmp_path):
    planes, things, t = SCENES["bullet"]
    paper = "&coupling scheme='paper' /\n"
    tables = [run(tmp_path, deck + paper) for deck in decks(planes, things, t)]
    compare(planes, *tables, closed=False)  # that coupling loses gas


@pytest.mark.parametrize("planes", ["xy", "xyz"])
def test_balls_in_the_corner_of_planes(tmp_path, planes):
    compare(planes, *(run(tmp_path, deck) for deck in decks(planes, BALLS, 5e-5, 3)))


@needs_mpirun
@pytest.mark.parametrize("numbers", [(0, 3), slow((0, 2, 4))])
@pytest.mark.parametrize("name", ["gap closes", "discs at a corner"])
def test_several_processes_share_what_planes_cut(tmp_path, name, numbers):
    planes, things, t = SCENES[name]
    *_, part = decks(planes, things, t / 2, side=60)
    for n in numbers:
        go(n, part, tmp_path, out=f"out{n}")
        alone, together = (tmp_path / f"out{m}" for m in (0, n))
        assert (alone / "gauges.csv").read_text() == (together / "gauges.csv").read_text(), n
        equal_air(alone, together)


@pytest.mark.parametrize("name", ["plate of two", "gap closes", "discs at a corner"])
def test_a_gpu_sees_the_same_behind_planes(tmp_path, name):
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n", encoding="utf-8")
    *_, part = decks(*SCENES[name])
    (tmp_path / "c.nml").write_text(part, encoding="utf-8")
    for backend in ("cpu", "gpu"):
        done = run_on(tmp_path, "c.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
    same("gpu", "cpu", tmp_path)
