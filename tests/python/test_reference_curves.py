# SPDX-License-Identifier: MIT
"""Reference curves against their own definitions, and where the report shows them."""

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import save  # noqa: E402

from post.compare import compare  # noqa: E402
from post.plate_reference import plate_references  # noqa: E402
from post.reader import Run  # noqa: E402
from post.reference_curves import (  # noqa: E402
    ClampedPlate,
    constants,
    fit_limit,
    lambert_jonas,
    nurick_martin,
    recht_ipson,
    thor,
    thor_limit,
)

SQUARE = ClampedPlate(1.6e-3, 7850, 290e6, sides=(0.089, 0.089))


def test_nurick_martin_by_hand():
    """89 x 89 x 1.6 mm, 12 N s, 7850 kg/m3, 290 MPa: phi 17.45, 8.66 thicknesses."""
    found = nurick_martin(12, SQUARE)
    phi = 12 / (2 * 1.6e-3**2 * 0.089 * math.sqrt(7850 * 290e6))
    assert found.phi == pytest.approx(phi) == pytest.approx(17.45, rel=1e-3)
    assert found.deflection == pytest.approx((0.480 * 17.454 + 0.277) * 1.6e-3, rel=1e-3)
    assert found.in_range and found.scatter == 1.6e-3
    assert not nurick_martin(40, SQUARE).in_range
    # a disc as wide as a square, at one impulse per area, has the same phi and bends a little less
    disc = replace(SQUARE, sides=None, radius=0.0445)
    there = nurick_martin(12 / 0.089**2 * math.pi * 0.0445**2, disc)
    assert there.phi == pytest.approx(found.phi)
    assert 0.85 < there.deflection / found.deflection < 0.92


@pytest.mark.parametrize(
    "wrong", [{"yield_stress": -1.0}, {"sides": None}, {"thickness": math.nan}]
)
def test_nurick_martin_refuses(wrong):
    with pytest.raises(ValueError, match="must be positive"):
        nurick_martin(1.0, replace(SQUARE, **wrong))


def test_recht_ipson_keeps_momentum_and_energy():
    """A free plug that takes the speed of the projectile: what momentum leaves over is spent, and
    the work of the shear is what it is at the limit.
    """
    mass, plug, limit = 0.197, 0.0296, 184.5
    for v in (190.0, 250.0, 400.0):
        left = float(recht_ipson(v, limit, mass, plug))
        fused = 0.5 * mass * plug / (mass + plug) * v**2  # a collision without a spring
        shear = 0.5 * mass * v**2 - fused - 0.5 * (mass + plug) * left**2
        assert shear == pytest.approx(0.5 * mass**2 / (mass + plug) * limit**2)
    assert recht_ipson([100.0, 184.5], limit, mass).tolist() == [0, 0]
    assert recht_ipson(1e5, limit, mass) == pytest.approx(1e5, rel=1e-5)


@pytest.mark.parametrize("parameters", [1, 2, 3])
def test_the_fit_finds_the_limit(parameters):
    a, p = (1.0, 0.83, 0.83)[parameters - 1], (2.0, 2.0, 2.4)[parameters - 1]
    v = np.array([188.0, 201.0, 226.0, 290.0, 410.0])
    found = fit_limit(v, lambert_jonas(v, 183.0, a, p), [150.0, 181.0], parameters)
    assert (found.limit, found.a, found.p) == pytest.approx((183.0, a, p), rel=1e-3)
    assert found.rms < 0.05
    with pytest.raises(ValueError, match="as many shots"):
        fit_limit([200.0], [80.0], parameters=2)


def test_shots_that_stopped_bound_the_limit():
    v = np.array([188.0, 201.0, 226.0, 290.0])
    low = fit_limit(v, lambert_jonas(v, 180.0, 1.0, 2.0), parameters=1).limit
    assert fit_limit(v, lambert_jonas(v, 180.0, 1.0, 2.0), [185.0] * 8, 1).limit > low + 2


def test_every_curve_has_a_source():
    for name in ("nurick_martin", "recht_ipson", "lambert_jonas"):
        assert constants(name)["source"] and constants(name)["verified"]


DECK = """
&run title = 'A clamped plate', t_end = 2e-3, symmetry = 'x', 'y' /
&material id = 'm', model = 'bilinear_j2', density = 7850, yield_stress = 290e6 /
&body id = 'plate', box = -0.0505,0.0505, -0.0505,0.0505, -0.0016,0, spacing = 4e-4,
      material = 'm', fix = 'sides', fix_width = 0.006 /
&load id = 'p', body = 'plate', faces = 'z+', time = 0,1e-5, pressure = {0},0 /
&gauge id = 'mid', at = 0,0,-0.0008, body = 'plate', quantity = 'displacement_z' /
"""


def test_the_report_has_the_line_where_it_applies(tmp_path):
    for name, pressure in (("plate", 303e6), ("soft", 3e6)):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "plate.echo.nml").write_text(DECK.format(pressure))
        t = np.linspace(0, 2e-3, 500)
        move = -14e-3 * np.sin(0.5 * np.pi * np.clip(t / 1e-4, 0, 1))
        save(folder / "gauges.csv", {"time[s]": t, "mid:displacement_z[m]": move})
    (line,) = plate_references(Run(tmp_path / "plate"))
    impulse = 0.5 * 303e6 * 1e-5 * 0.089**2
    assert line.value == pytest.approx(nurick_martin(impulse, SQUARE).deflection)
    (row,) = compare(Run(tmp_path / "plate"), [line])
    assert row.quantity == "permanent set" and row.measured == pytest.approx(14e-3, rel=1e-3)
    assert plate_references(Run(tmp_path / "soft")) == []  # hardly bends: out of range


def test_thor_is_its_hand_calculation():
    """A .50 fragment simulator, 12.57 mm, 207 grains, on 10 mm: 1909.6 ft/s are lost at 1 km/s."""
    shot = {"mass": 207 * 6.479891e-5, "area": math.pi / 4 * 12.57e-3**2, "thickness": 10e-3}
    assert thor(1000.0, **shot) == pytest.approx(418, abs=1)
    limit = thor_limit(**shot)
    assert limit == pytest.approx(576, abs=1)
    assert thor([0.99 * limit, limit, 1.01 * limit], **shot) == pytest.approx([0, 0, 5.7], abs=0.1)
    assert thor_limit(**shot, angle=math.pi / 4) == pytest.approx(
        limit * math.sqrt(2) ** (1.262 / 0.981), rel=1e-9
    )
    thin = shot | {"thickness": 5e-3}
    assert thor_limit(**thin) == pytest.approx(limit * 0.5 ** (0.889 / 0.981), rel=1e-9)
    for wrong in ({"mass": 0.0}, {"thickness": -1.0}, {"angle": math.pi / 2}):
        with pytest.raises(ValueError, match="THOR"):
            thor(500.0, **shot | wrong)
