# SPDX-License-Identifier: MIT
"""Reference curves of blasts, and what is measured on a pulse."""

import csv
import math
import sys
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import P0, friedlander  # noqa: E402

from post.blast import (  # noqa: E402
    free_air,
    free_air_range,
    measure_pulse,
    oblique_shares,
    surface,
)

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
    assert b.on_surface(math.pi) == (b.incident_overpressure, b.incident_impulse)


def test_oblique_surface_in_the_limit_of_sound():
    """Where p_r = 2 p_i a rigid surface feels p_i (1 + c): never less than the wave that passes."""
    for c in np.linspace(0, 1, 11):
        reflected, incident = oblique_shares(c)
        assert 2 * reflected + incident == pytest.approx(1 + c, rel=1e-14)


@pytest.mark.parametrize(("burst", "curves"), [("air", free_air), ("surface", surface)])
def test_oblique_surface_feels_more_the_more_it_looks_at_the_charge(burst, curves):
    low, high = free_air_range(burst)
    for z in np.geomspace(1.01 * low, 0.99 * high, 30):
        b = curves(1.0, z)
        felt = np.array([b.on_surface(angle) for angle in np.linspace(math.pi / 2, 0, 91)])
        assert (np.diff(felt, axis=0) > 0).all()
        assert felt.min(axis=0) == pytest.approx([b.incident_overpressure, b.incident_impulse])


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


def test_arrival_and_rise_of_a_smeared_front():
    t = np.linspace(0, 1e-3, 1001)
    over = np.interp(t, [0, 2e-4, 3e-4, 8e-4, 1e-3], [0, 0, PEAK, 0, -0.05 * PEAK])
    pulse = measure_pulse(t, P0 + over)
    assert pulse.arrival == pytest.approx(2.1e-4, rel=1e-6)
    assert pulse.rise_time == pytest.approx(0.8e-4, rel=1e-6)
    assert pulse.arrival + pulse.duration == pytest.approx(8e-4, rel=1e-6)
    assert pulse.impulse == pytest.approx(0.5 * PEAK * (1e-4 * 0.99 + 5e-4), rel=1e-6)


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
