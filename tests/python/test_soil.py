# SPDX-License-Identifier: MIT
"""Soil that is struck: the elastic wave and the slower one of the cone behind it."""

import numpy as np
import pytest
from notes import note
from test_gauges import gauges
from test_gpu import follows_the_cpu
from test_loads import run

DENSITY, YOUNG, POISSON, COHESION, ANGLE = 1900, 60e6, 0.2, 50e3, np.radians(25)
DECK = """\
&run t_end=4e-3, dimension=1 /
&material id='clay', model='drucker_prager', density=1900, youngs_modulus=60e6, poisson_ratio=0.2,
    cohesion=50e3, friction_angle=25 /
&body id='b', box=0,1, 0,1, 0,1, spacing=5e-3, material='clay', motion_time=0,1,
    motion_velocity=2,0,0, 2,0,0, fix_box=0,0.02, 0,1, 0,1 /
&gauge id='s', body='b', at=0.2,0,0, quantity='stress_xx' /
&gauge id='q', body='b', at=0.2,0,0, quantity='von_mises' /
&gauge id='p', body='b', at=0.2,0,0, quantity='pressure' /
&gauge id='e', body='b', at=0.2,0,0, quantity='plastic_strain' /
&gauge id='far', body='b', at=0.6,0,0, quantity='velocity_x' /
&output history_every=1e-5, dump_every=1 /
"""


def test_waves_in_soil(tmp_path):
    """Stress of a piston, sY + rho c (v - vY) with c of the cone, and the speed of both fronts."""
    (tmp_path / "deck.nml").write_text(DECK)
    tables = run(tmp_path, DECK)
    g, time = gauges(tables), tables["gauges"]["time[s]"]
    bulk, shear = YOUNG / 3 / (1 - 2 * POISSON), YOUNG / 2 / (1 + POISSON)
    slope = 6 * np.sin(ANGLE) / (3 - np.sin(ANGLE))
    base = 6 * COHESION * np.cos(ANGLE) / (3 - np.sin(ANGLE))
    elastic = np.sqrt((bulk + 4 * shear / 3) / DENSITY)
    cone = np.sqrt(bulk * (1 + 2 * slope / 3) / DENSITY)
    yields = base / (2 * shear / bulk - slope)  # pressure at which the elastic path meets the cone
    first = yields * (1 + 4 * shear / 3 / bulk)  # stress of the elastic wave
    exact = first + DENSITY * cone * (2 - first / DENSITY / elastic)
    assert g["q"][-1] == pytest.approx(base + slope * g["p"][-1], rel=1e-3)
    assert g["e"][-1] > 1e-3
    note("soil_stress", -g["s"][-1] / exact)
    assert -g["s"][-1] == pytest.approx(exact, rel=0.03)
    half = [first / DENSITY / elastic / 2, (first / DENSITY / elastic + 2) / 2]
    arrivals = [time[np.argmax(g["far"] > v)] for v in half]
    for at, c in zip(arrivals, (elastic, cone), strict=True):
        assert (0.6 - 0.02) / at == pytest.approx(c, rel=0.03)
    follows_the_cpu(tmp_path / "out" / "load", tmp_path)
