# SPDX-License-Identifier: MIT
"""Nothing depends on units, on which axis is which and where it points, or on how fast all move:
bodies that meet, or that are loaded, driven and held.

Lengths and times, or densities and stresses, are scaled by a power of four: every result is then
the same, bit for bit, but for that factor. So a number in metres, seconds or kilograms that hides
in the code is found wherever a scene meets it. With the axes in another order or turned round sums
come in another order, and so they do with another frame: these agree to rounding.
"""

import itertools
import random

import numpy as np
import pytest
from test_gauges import gauges
from test_loads import run
from tiers import slow

AXES = "xyz"
SPACING = 5e-4
FORMS = ("corrected_hourglass", "bending", "total_lagrangian", "corrected", "uncorrected", "rigid")
METAL = """\
&material id='s', model='linear_elastic', density={d1!r}, youngs_modulus={e1!r}, poisson_ratio=0.3 /
&material id='j', model='bilinear_j2', density={d2!r}, youngs_modulus={e2!r}, poisson_ratio=0.3,
    yield_stress={y!r}, tangent_modulus={t!r} /
"""


class Frame:
    """The order of the axes and which of them is turned round, what a metre and a second are, what
    densities and stresses are in, a velocity of all bodies."""

    def __init__(self, order=(0, 1, 2), length=1.0, dense=1.0, drift=(0, 0, 0), turned=None):
        self.order, self.length, self.dense, self.drift = order, length, dense, drift
        self.sign = [-1 if a == turned else 1 for a in range(3)]

    def axis(self, a):
        return AXES[self.order.index(a)]

    def face(self, name):
        a = AXES.index(name[0])
        return f"'{self.axis(a)}{'-+'[(name[1] == '+') == (self.sign[a] > 0)]}'"

    def three(self, values, unit=1.0):
        """Components in the order of the axes."""
        return ",".join(repr(float(values[a]) * self.sign[a] * unit) for a in self.order)

    def box(self, low, high):
        ends = [sorted(float(v[a]) * self.sign[a] for v in (low, high)) for a in self.order]
        return ",".join(f"{a * self.length!r},{b * self.length!r}" for a, b in ends)


def shape(chance, frame, z):
    """A body that stands on z, as keys of &body; its middle, and where it ends."""
    x, y = chance.choice([-2, 0, 1]) * SPACING, chance.choice([-1, 0, 2]) * SPACING
    high = chance.choice([3, 4, 6]) * SPACING
    kind = chance.choice(["box", "box", "cylinder", "sphere"])
    if kind == "box":
        a, b = chance.choice([3, 4, 5]) * SPACING, chance.choice([3, 4, 6]) * SPACING
        text = f"box={frame.box([x - a, y - b, z], [x + a, y + b, z + high])}"
        return text, [x, y, z + high / 2], z + high
    radius = chance.choice([3, 4]) * SPACING
    high = 2 * radius if kind == "sphere" else max(high, 4 * SPACING)
    middle = [x, y, z + high / 2]
    text = f"shape='{kind}', centre={frame.three(middle, frame.length)}"
    text += f", radius={radius * frame.length!r}"
    if kind == "cylinder":
        text += f", axis='{frame.axis(2)}', length={high * frame.length!r}"
    return text, middle, z + high


def scene(seed, frame):
    """Four bodies above each other that close up, in every third scene without air."""
    chance, unit, dense = random.Random(seed), frame.length, frame.dense
    text = f"&run t_end={3e-5 * unit!r}, max_steps=80 /\n"
    text += METAL.format(d1=7800 * dense, e1=2e11 * dense, d2=2700 * dense, e2=7e10 * dense,
                         y=3e8 * dense, t=1e9 * dense)  # fmt: skip
    if seed % 3:
        cells = ",".join(str([16, 14, 12][a]) for a in frame.order)
        text += f"&air box={frame.box([-0.016, -0.014, -0.012], [0.016, 0.014, 0.012])}"
        text += f", cells={cells}, density={1.2 * dense!r}, pressure={1e5 * dense!r} /\n"
        text += f"&gas id='hot', density={3 * dense!r}, pressure={5e8 * dense!r}, box="
        text += frame.box([-0.016, -0.014, -0.012], [0.016, 0.014, -0.009]) + " /\n"
    z = -0.008
    for body in "abcd":
        keys, middle, z = shape(chance, frame, z)
        form = chance.choice(FORMS if body == "c" else FORMS[:5])
        close = 150 if body in "ab" else -150
        speed = [chance.uniform(-30, 30), chance.uniform(-30, 30), close]
        keys += f", spacing={SPACING * unit!r}, material='{chance.choice('sj')}'"
        keys += f", formulation='{form}'"
        if form == "corrected_hourglass" and chance.random() < 0.5:
            keys += ", variable_h=.true."
        speed = [v + d for v, d in zip(speed, frame.drift, strict=True)]
        text += f"&body id='{body}', {keys}, velocity={frame.three(speed)} /\n"
        at = frame.three([m + 0.2 * SPACING for m in middle], unit)
        for a in range(3):
            text += f"&gauge id='v{a}_{body}', body='{body}', at={at},"
            text += f" quantity='velocity_{frame.axis(a)}' /\n"
        if form != "rigid":
            text += f"&gauge id='vm_{body}', body='{body}', at={at}, quantity='von_mises' /\n"
        z += 1.5e-4
    shared = chance.choice(["", ", shared_pressure=.true."])
    return text + f"&interaction law='contact', friction=0.3, damping=0.5{shared} /\n"


def columns(folder, text, frame):
    """Gauges in the units and the order of the first frame, of bodies without their drift."""
    found = gauges(run(folder, text))
    units = {"t": frame.length, "v": 1.0, "f": frame.length**2 * frame.dense}
    for name in found:
        if name.startswith("vm"):
            found[name] = found[name] / frame.dense
        else:
            found[name] = found[name] / units[name[0]]
        if name[1].isdigit():
            found[name] = found[name] * frame.sign[int(name[1])] - frame.drift[int(name[1])]
    return found


def largest_difference(one, other):
    """Of all columns, over what is largest in columns of its kind."""
    assert one.keys() == other.keys()
    most = {kind: max(abs(c).max() for n, c in one.items() if n[:2].strip("012") == kind)
            for kind in {n[:2].strip("012") for n in one}}  # fmt: skip
    return max(abs(one[n] - other[n]).max() / most[n[:2].strip("012")] for n in one)


def agree(folder, text_in, orders, blast=False):
    """Units leave the bits, or all but the last where there is a blast, whose curves are in
    logarithms and for the air that there is; the order of the axes and where they point leave all
    but the last."""
    here = columns(folder, text_in(Frame()), Frame())
    assert any(np.ptp(column) > 1 for name, column in here.items() if name.startswith("v0"))
    for frame in (Frame(length=2.0**-8), Frame(length=2.0**10), Frame(dense=2.0**-6)):
        if blast and frame.dense != 1:
            continue
        most = largest_difference(here, columns(folder, text_in(frame), frame))
        assert most <= (1e-11 if blast else 0)
    frames = [Frame(order) for order in orders] + [Frame(turned=a) for a in range(3)]
    for frame in frames:
        assert largest_difference(here, columns(folder, text_in(frame), frame)) < 1e-10
    return here


@pytest.mark.parametrize("seed", [1, slow(2), slow(3), slow(5), slow(7)])
def test_units_and_axes_do_not_matter(tmp_path, seed):
    orders = list(itertools.permutations(range(3)))[1:4]
    here = agree(tmp_path, lambda frame: scene(seed, frame), orders)
    if seed % 3 == 0:  # without air
        frame = Frame(drift=(64, -128, 256))
        moving = columns(tmp_path, scene(seed, frame), frame)
        assert largest_difference(here, moving) < 1e-9


def loaded(form, blast, frame):
    """A block that is held and pressed, a ball that is driven against it, another block below of
    which an edge is moved; histories, a blast, gravity and a force."""
    unit, dense = frame.length, frame.dense
    text = f"&run t_end={4e-6 * unit!r}, max_steps=60 /\n"
    text += METAL.format(d1=7800 * dense, e1=2e11 * dense, d2=2700 * dense, e2=7e10 * dense,
                         y=3e8 * dense, t=1e9 * dense)  # fmt: skip

    def body(name, keys, speed=(0, 0, 0), key="velocity"):
        return f"&body id='{name}', {keys}, spacing={2 * SPACING * unit!r}, {key}=" + (
            f"{frame.three(speed)} /\n"
        )

    d = 2 * SPACING
    held = f"fix={frame.face('x-')}, fix_layers=1"
    text += body("a", f"box={frame.box([-3 * d, -2 * d, 0], [d, 3 * d, 4 * d])}, material='j', "
                 f"formulation='{form}', {held}")  # fmt: skip
    ball = f"shape='sphere', centre={frame.three([0, 0, 6.53 * d], unit)}, radius="
    text += body("b", f"{ball}{2.5 * d * unit!r}, material='s', formulation='rigid', motion_time=0",
                 [20, 10, -60], "motion_velocity")  # fmt: skip
    text += body("c", f"box={frame.box([-3 * d, -2 * d, -4.03 * d], [2 * d, 3 * d, -0.03 * d])}, "
                 f"material='s', formulation='{form}'", [5, -8, 30])  # fmt: skip
    text += f"&motion id='m', body='c', box={frame.box([d, -1, -1], [1, 1, 1])}, axes="
    text += f"'{frame.axis(1)}', velocity={frame.three([0, -40, 0])} /\n"
    text += f"&load body='a', faces={frame.face('x+')},{frame.face('y-')}, "
    text += f"time=0,{3e-6 * unit!r}, pressure={4e8 * dense!r},{1e7 * dense!r} /\n"
    text += f"&load body='c', force={frame.three([3e3, -1e3, 2e3], unit**2 * dense)} /\n"
    text += f"&load body='a', acceleration={frame.three([1e6, 2e6, -3e6], 1 / unit)} /\n"
    if blast:
        text += f"&load body='c', faces={frame.face('z-')},{frame.face('y+')}, "
        text += f"mass={1e-3 * unit**3!r}, at={frame.three([0.01, -0.02, -0.04], unit)}, "
        text += f"detonation_time={-1.3e-5 * unit!r} /\n"
    at = frame.three([-0.3 * d, 0.6 * d, 1.4 * d], unit)
    below = frame.three([-0.3 * d, 0.6 * d, -1.4 * d], unit)
    for a in range(3):
        for name, place in (("a", at), ("c", below)):
            text += f"&gauge id='v{a}_{name}', body='{name}', at={place},"
            text += f" quantity='velocity_{frame.axis(a)}' /\n"
        for kind in ("reaction", "contact", "load"):
            text += f"&gauge id='f{a}_{kind}', body='a', quantity='{kind}_{frame.axis(a)}' /\n"
    text += f"&gauge id='vm_a', body='a', at={at}, quantity='von_mises' /\n"
    return text + "&interaction law='contact', friction=0.3, damping=0.5 /\n"


@pytest.mark.parametrize("form", ["bending", "corrected_hourglass", "total_lagrangian"])
@pytest.mark.parametrize("blast", [True, False])
def test_loads_do_not_depend_on_units_and_axes(tmp_path, form, blast):
    orders = [(1, 2, 0), (0, 2, 1), (2, 1, 0)]
    agree(tmp_path, lambda frame: loaded(form, blast, frame), orders, blast)
