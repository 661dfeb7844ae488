# SPDX-License-Identifier: MIT
"""Gauges of what a material model keeps, against dumps and on the GPU."""

import h5py
import numpy as np
import pytest
from test_gauges import gauges
from test_gpu import follows_the_cpu
from test_loads import run

HISTORY = {
    "concrete_48": ("damage_hjc", "damage_tension", "plastic_strain"),
    "cfrp_ud": ("damage_fibre_tension", "damage_matrix_cracking", "damage_delamination"),
}


@pytest.mark.parametrize("preset", HISTORY)
def test_what_a_model_keeps_is_measured(tmp_path, preset):
    """Gauges of the history of a material are the numbers of the last dump, on the GPU too."""
    names = [*HISTORY[preset], "damage"]
    deck = f"""\
&run t_end=6e-6 /
&material id='m', preset='{preset}' /
&body id='b', box=0,0.02, 0,0.004, 0,0.004, spacing=1e-3, material='m', fix='x-' /
&motion id='drawn', body='b', box=0.017,0.02, 0,1, 0,1, time=0,1e-6, velocity=0,0,0, 300,200,0 /
&output dump_every=3e-6, history_every=3e-6 /
"""
    for name in names:
        deck += f"&gauge id='{name}', body='b', at=0.0135,0.0015,0.0015, quantity='{name}' /\n"
    (tmp_path / "deck.nml").write_text(deck)
    rows = gauges(run(tmp_path, deck))
    assert rows["damage"][-1] > 0.1, "nothing broke"
    out = tmp_path / "out" / "load"
    with h5py.File(sorted(out.glob("solid*.vtkhdf"))[-1]) as file:
        data = file["VTKHDF/PointData"]
        start = file["VTKHDF/Points"][:] - data["displacement"][:]
        at = np.abs(start - [0.0135, 0.0015, 0.0015]).max(axis=1).argmin()
        for name in names:
            assert rows[name][-1] == pytest.approx(data[name][at], rel=1e-6), name
    follows_the_cpu(out, tmp_path)
