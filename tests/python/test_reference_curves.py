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
from test_results import SHOT, Range  # noqa: E402

from post.compare import compare  # noqa: E402
from post.deck import Deck  # noqa: E402
from post.designs import Parameter  # noqa: E402
from post.fragment_reference import draw_fragments, fragment_rows, fragment_shots  # noqa: E402
from post.limits import Found  # noqa: E402
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
from post.runner import Outcome  # noqa: E402
from post.study import Results  # noqa: E402
from post.study_page import Page, _shots_of_limits  # noqa: E402
from post.study_pictures import draw_limits, draw_search  # noqa: E402

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


FRAGMENT = """
&run t_end = 1e-4, symmetry = 'x', 'y' /
&material id = 'hard', model = 'linear_elastic', density = 7838, youngs_modulus = 204e9,
  poisson_ratio = 0.33 /
&material id = 'mild', model = 'cowper_symonds', density = 7850, youngs_modulus = 200e9,
  poisson_ratio = 0.3, yield_stress = 250e6 /
&body id = 'plate', box = -0.03,0.03, -0.03,0.03, -0.006,0, spacing = 1e-3, material = 'mild' /
&body id = 'shard', shape = 'cylinder', axis = 'z', centre = 0,0,0.007, radius = 6e-3,
  length = 0.014, spacing = 1e-3, material = 'hard', velocity = 0,0,-600 /
"""
MASS, AREA = math.pi * 6e-3**2 * 0.014 * 7838, math.pi * 6e-3**2


def test_thor_is_for_compact_steel_on_mild_steel():
    (one,) = fragment_shots(Deck(FRAGMENT))
    assert (one.mass, one.area, one.thickness, one.angle) == pytest.approx((MASS, AREA, 6e-3, 0))
    assert one.residual(600.0) == thor(600.0, MASS, AREA, 6e-3)
    assert one.limit == thor_limit(MASS, AREA, 6e-3)
    oblique = FRAGMENT.replace("0,0,-600", "-300,0,-300").replace("0,0,0.007", "0.008,0,0.009")
    (one,) = fragment_shots(Deck(oblique))
    assert one.angle == pytest.approx(math.pi / 4)
    assert one.area == pytest.approx((AREA + 12e-3 * 0.014) / math.sqrt(2))
    cube = "box = 0,6e-3, 0,6e-3, 0.001,0.013, spacing"  # a quarter: 12 mm wide
    (one,) = fragment_shots(Deck(FRAGMENT.replace("radius = 6e-3", cube.removesuffix(", spacing"))
                                 .replace("'cylinder'", "'box'")))  # fmt: skip
    assert (one.mass, one.area) == pytest.approx((7838 * 12e-3**3, 12e-3**2))
    ball = FRAGMENT.replace("'cylinder'", "'sphere'")
    (one,) = fragment_shots(Deck(ball))
    assert (one.mass, one.area) == pytest.approx((7838 * 4 / 3 * math.pi * 6e-3**3, AREA))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("7838", "2700"),  # no steel
        ("250e6", "500e6"),  # no mild steel
        ("length = 0.014", "length = 0.04"),  # a rod
        ("radius = 6e-3", "radius = 6e-3, inner_radius = 2e-3"),
        ("radius = 6e-3", "radius = 13e-3"),  # 58 g
        ("&run", "&run dimension = 2,"),
        ("0,0,-600", "0,0,0"),
    ],
)
def test_thor_is_not_for_others(old, new):
    assert fragment_shots(Deck(FRAGMENT)) and not fragment_shots(Deck(FRAGMENT.replace(old, new)))


def test_the_report_has_thor_beside_a_shot(tmp_path):
    """A rod that is a compact cube behind a plate of mild steel: row and picture."""
    law = "density = 7850, youngs_modulus = 200e9, poisson_ratio = 0.3, yield_stress = 250e6"
    deck = SHOT.replace("model = 'bilinear_j2'", f"model = 'bilinear_j2', {law}")
    made = Range()
    made.deck = deck
    run = made.run(tmp_path / "out")
    (row,) = fragment_rows(run)
    mass, area = 7850 * 6e-3 * 6e-3 * 12e-3, 36e-6
    assert row.measured == pytest.approx(500) and row.gauge == "rod"
    assert row.reference == pytest.approx(float(thor(800.0, mass, area, 4e-3)))
    assert "from memory" in row.source and "limit" in row.source
    picture = draw_fragments(run, tmp_path)
    assert picture.path.is_file() and "Project THOR" in picture.caption
    assert "not verified" in picture.caption and "500 m/s are left" in picture.caption
    made = Range(fallen=0.006)  # still in the plate
    made.deck = deck
    run = made.run(tmp_path / "inside")
    assert math.isnan(fragment_rows(run)[0].measured)
    assert "neither through nor at rest" in draw_fragments(run, tmp_path).caption


def test_limits_of_studies_have_thor_where_the_unknown_is_the_speed(tmp_path):
    """Two limits: of the speed, and of a number that is none; the last run of each has its deck."""
    outcomes = []
    for k, speed in enumerate((300, 600, 300, 600)):
        out = tmp_path / "runs" / f"run{k}" / "out"
        out.mkdir(parents=True)
        (out / "a.echo.nml").write_text(FRAGMENT.replace("-600", f"-{speed}"))
        save(out / "bodies.csv", {"time[s]": np.array([0.0, 1e-4])})
        left = {"shard residual_velocity": 200.0} if speed == 600 else {}
        outcomes.append(Outcome(f"run{k}", "done", values=left, units=dict.fromkeys(left, "m/s")))
    fast, other = (Found(430.0, 300.0 * f, 600.0 * f, [(300.0 * f, 0.0), (600.0 * f, 1.0)])
                   for f in (1, 0.1))  # fmt: skip
    found = Results(outcomes=outcomes, limits=[({"x": 1.0}, fast), ({"x": 2.0}, other)])
    shots = _shots_of_limits(Page(None, tmp_path, found))
    assert shots[0].limit == thor_limit(MASS, AREA, 6e-3) and shots[1] is None
    speed, x = Parameter("speed", "m/s"), Parameter("x", "m")
    asked = ("shard residual_velocity", 0.0, "m/s", None, shots[0])
    for picture in (
        draw_search(speed, fast, outcomes[:2], asked, tmp_path),
        draw_search(speed, fast, outcomes[:2], ("shard velocity_z", *asked[1:]), tmp_path),
        draw_limits(x, speed, found.limits, shots, tmp_path),
    ):
        assert picture.path.stat().st_size > 10_000
