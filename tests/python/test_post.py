# SPDX-License-Identifier: MIT
"""The reader, the measurements, the pictures and the report, on made-up runs."""

import csv
import math
import sys
from decimal import Decimal
from pathlib import Path

import h5py
import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import P0, friedlander, write_run  # noqa: E402

from post.blast import free_air, measure_pulse  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.gauges import expect, list_gauges, measure  # noqa: E402
from post.reader import Run  # noqa: E402


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return Run(write_run(tmp_path_factory.mktemp("run"), rows=3000))


# --- Kingery-Bulmash -------------------------------------------------------------------------


def kb_rows():
    with (HERE / "kb_free_air_table.csv").open() as file:
        return list(csv.reader(line for line in file if not line.startswith(("#", "Z"))))


@pytest.mark.parametrize("row", kb_rows(), ids=lambda row: f"Z={row[0]}")
def test_kingery_bulmash_table(row):
    b = free_air(1.0, float(row[0]))
    kilo = [b.incident_overpressure, b.reflected_overpressure, b.arrival * 1e6, b.duration * 1e6]
    values = [v / 1e3 for v in kilo] + [b.incident_impulse, b.reflected_impulse]
    for value, text in zip(values, row[1:], strict=True):
        last_digit = 10.0 ** Decimal(text).as_tuple().exponent
        assert value == pytest.approx(float(text), rel=0, abs=0.5 * last_digit)


def test_kingery_bulmash_scales_with_the_mass():
    one, eight = free_air(1.0, 1.5), free_air(8.0, 3.0)
    assert eight.incident_overpressure == pytest.approx(one.incident_overpressure)
    assert eight.arrival == pytest.approx(2 * one.arrival)
    assert eight.reflected_impulse == pytest.approx(2 * one.reflected_impulse)


def test_oblique_surface_runs_from_reflected_to_incident():
    b = free_air(1.0, 2.0)
    assert b.on_surface(0.0) == (b.reflected_overpressure, b.reflected_impulse)
    assert b.on_surface(math.pi / 2)[0] == pytest.approx(b.incident_overpressure)


@pytest.mark.parametrize(
    ("mass", "distance", "text"),
    [(0, 1, "mass"), (1, -1, "distance"), (1, math.nan, "distance"), (1, 0.01, "outside")],
)
def test_kingery_bulmash_refuses(mass, distance, text):
    with pytest.raises(ValueError, match=text):
        free_air(mass, distance)


# --- measurements on a pulse -----------------------------------------------------------------

ARRIVAL, PEAK, DURATION, DECAY = 0.3e-3, 5e6, 0.5e-3, 1.3
IMPULSE = PEAK * DURATION * (1 / DECAY - (1 - math.exp(-DECAY)) / DECAY**2)


@pytest.mark.parametrize("samples", [200, 2000, 20000])
def test_friedlander_pulse_within_sampling(samples):
    t = np.linspace(0, 2e-3, samples)
    pulse = measure_pulse(t, P0 + friedlander(t, ARRIVAL, PEAK, DURATION, DECAY))
    dt = t[1]
    assert pulse.reached and pulse.complete
    assert pulse.arrival == pytest.approx(ARRIVAL, abs=dt)
    assert pulse.peak == pytest.approx(PEAK, rel=(DECAY + 1) * dt / DURATION)
    assert pulse.arrival + pulse.duration == pytest.approx(ARRIVAL + DURATION, abs=0.1 * dt)
    assert pulse.impulse == pytest.approx(IMPULSE, abs=PEAK * dt)
    assert pulse.rise_time < dt


def test_noise_moves_the_figures_little():
    t = np.linspace(0, 2e-3, 4000)
    noise = np.random.default_rng(3).normal(0, 0.01 * PEAK, t.size)
    pulse = measure_pulse(t, P0 + noise + friedlander(t, ARRIVAL, PEAK, DURATION, DECAY), P0)
    assert pulse.complete
    assert pulse.arrival == pytest.approx(ARRIVAL, abs=2 * t[1])
    assert pulse.peak == pytest.approx(PEAK, rel=0.05)
    assert pulse.duration == pytest.approx(DURATION, rel=0.1)
    assert pulse.impulse == pytest.approx(IMPULSE, rel=0.01)


def test_a_spike_of_one_sample_is_no_arrival():
    t = np.linspace(0, 2e-3, 4000)
    p = P0 + friedlander(t, ARRIVAL, PEAK, DURATION, DECAY)
    p[100] += 0.5 * PEAK
    assert measure_pulse(t, p).arrival == pytest.approx(ARRIVAL, abs=t[1])


def test_gauge_never_reached():
    t = np.linspace(0, 1e-3, 500)
    noise = np.random.default_rng(3).normal(0, 2e3, t.size)
    for p in (np.full(t.size, P0), P0 + noise):
        pulse = measure_pulse(t, p, P0)
        assert not pulse.reached and math.isnan(pulse.arrival) and math.isnan(pulse.peak)


def test_history_that_ends_inside_the_pulse():
    t = np.linspace(0, ARRIVAL + 0.4 * DURATION, 1000)
    pulse = measure_pulse(t, P0 + friedlander(t, ARRIVAL, PEAK, DURATION, DECAY))
    assert pulse.reached and not pulse.complete
    assert math.isnan(pulse.duration) and 0.3 * IMPULSE < pulse.impulse < IMPULSE
    assert "ends inside" in pulse.remark


def test_history_that_starts_inside_the_pulse():
    t = np.linspace(ARRIVAL + 0.1 * DURATION, 2e-3, 1000)
    pulse = measure_pulse(t, P0 + friedlander(t, ARRIVAL, PEAK, DURATION, DECAY), P0)
    assert pulse.reached and math.isnan(pulse.arrival) and "starts inside" in pulse.remark


@pytest.mark.parametrize(
    ("t", "p"), [([0], [1]), ([0, 1], [1, 2, 3]), ([0, 1], [1, math.nan]), ([1, 0], [1, 2])]
)
def test_bad_histories_are_refused(t, p):
    with pytest.raises(ValueError, match="histor"):
        measure_pulse(t, p)


# --- the reader ------------------------------------------------------------------------------


def test_reader_gives_the_scene(run):
    assert run.job == "demo" and run.deck.title == "Synthetic blast on a plate"
    assert run.deck.mirrors == (True, True, False) and run.deck.images == 4
    assert [g["id"] for g in run.deck.groups("gauge")] == ["A", "free", "mid", "mid_v"]
    (plate,) = run.deck.bodies()
    assert plate.id == "plate" and plate.high[0] == 0.125
    assert run.problems == [] and run.exit_code == 0
    assert run.end == pytest.approx(0.45e-3)


def test_reader_gives_histories_with_units(run):
    assert run.gauges.unit("A:pressure") == "Pa"
    assert run.gauges["A:pressure"].shape == run.gauges.time.shape == (3000,)
    assert run.energy.unit("air_outflow[kg]") == "kg"
    assert run.energy.find("air_outflow.*") == ["air_outflow[J]", "air_outflow[kg]"]
    assert run.bodies.owners() == ["plate"]
    with pytest.raises(PostError, match="no column 'B:pressure'; it has time, A:pressure"):
        run.gauges["B:pressure"]


def test_reader_gives_frames(run):
    assert [frame.number for frame in run.frames] == list(range(7))
    air = run.frames[3].air("pressure", "solid")
    assert air.field["pressure"].shape == tuple(air.cells[::-1])
    assert air.centres(0)[0] == pytest.approx(0.0056)
    solid = run.frames[-1].solid()
    assert solid.points.shape == solid.field["displacement"].shape
    assert run.frames[0].mesh("air").n_cells == np.prod(air.cells)
    assert run.frames[0].mesh("solid").n_points == len(solid.points)
    with pytest.raises(PostError, match="no field soot; it has"):
        run.frames[0].air("soot")


def write_small(folder, **options):
    return write_run(folder, **{"nx": 4, "frames": 2, "rows": 30, "spacing": 0.0125, **options})


def test_reader_names_what_is_missing(tmp_path):
    with pytest.raises(PostError, match="no such folder") as error:
        Run(tmp_path / "nowhere")
    assert error.value.code == 2
    with pytest.raises(PostError, match="no results") as error:
        Run(tmp_path)
    assert error.value.code == 4
    folder = write_small(tmp_path / "a")
    (folder / "gauges.csv").unlink()
    assert "gauges.csv is missing" in Run(folder).problems
    (folder / "air_00001.vtkhdf").unlink()
    with pytest.raises(PostError, match=r"air_00001\.vtkhdf, which is missing"):
        Run(folder)


def test_reader_takes_the_deck_from_a_dump(tmp_path):
    folder = write_small(tmp_path / "a")
    (folder / "demo.echo.nml").unlink()
    assert Run(folder).deck.title == "Synthetic blast on a plate"


def test_reader_refuses_other_layouts_and_damage(tmp_path):
    folder = write_small(tmp_path / "a")
    with h5py.File(folder / "solid_00001.vtkhdf", "a") as file:
        file["brisance"].attrs["schema"] = [99]
    with pytest.raises(PostError, match="has layout 99") as error:
        Run(folder)
    assert error.value.code == 4
    (folder / "solid_00001.vtkhdf").write_bytes(b"not HDF5")
    with pytest.raises(PostError, match="damaged or not HDF5"):
        Run(folder)


def test_reader_reports_what_is_not_finite(tmp_path):
    folder = write_small(tmp_path / "a")
    with h5py.File(folder / "air_00001.vtkhdf", "a") as file:
        file["VTKHDF/CellData/pressure"][0, 0, 0] = np.nan
    text = (folder / "energy.csv").read_text().splitlines()
    cells = text[7].split(",")
    cells[5] = "NaN"
    text[7] = ",".join(cells)
    (folder / "energy.csv").write_text("\n".join(text) + "\n1e-3,2.0")  # and a row cut short
    run = Run(folder)
    assert run.exit_code == 3 and len(run.energy) == 30
    assert any("'solid_kinetic' is not finite" in text for text in run.problems)
    assert any("air_00001.vtkhdf: 'pressure' is not finite" in text for text in run.problems)


def test_reader_says_that_a_run_ended_early(tmp_path):
    folder = write_small(tmp_path / "a")
    deck = folder / "demo.echo.nml"
    deck.write_text(deck.read_text().replace("t_end = 0.00045", "t_end = 0.001"))
    assert any("before t_end = 0.001 s" in text for text in Run(folder).problems)


# --- gauges and what theory expects ------------------------------------------------------------


def test_gauge_on_the_plate_gets_reflected_values(run):
    gauge = list_gauges(run)[0]
    expected = expect(run.deck, gauge)
    assert expected.reflected and expected.distance == pytest.approx(0.4)
    assert expected.peak == pytest.approx(12.2e6, rel=0.01)
    assert expected.blast.arrival == pytest.approx(0.1625e-3, rel=0.001)
    assert expected.impulse == pytest.approx(474, rel=0.002)
    assert measure(run, gauge).peak == pytest.approx(6.8e6, rel=0.01)


def test_gauge_in_free_air_gets_incident_values(run):
    gauge = list_gauges(run)[1]
    expected = expect(run.deck, gauge)
    assert not expected.reflected and expected.distance == pytest.approx(0.2)
    assert expected.peak == expected.blast.incident_overpressure


def test_gauge_behind_the_plate_gets_no_reference(run):
    gauge = list_gauges(run)[0]
    hidden = type(gauge)("B", "B:pressure", "pressure", "Pa", np.array([0, 0, -0.03]))
    assert expect(run.deck, hidden) is None
