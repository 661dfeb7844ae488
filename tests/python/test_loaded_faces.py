# SPDX-License-Identifier: MIT
"""The stress of the material at loaded faces: brz_face_stress."""

import h5py
import numpy as np
import pytest
from notes import note
from test_loads import run
from tiers import slow


# The outermost layer of a block that is pressed slowly from both sides meets the pressure, in all
# formulations, as do those below: half of it without the stress of loaded faces (brz_face_stress).
@pytest.mark.parametrize(("dimension", "form"), [
    (n, form) if n == 2 or form == "bending" else slow(n, form)
    for n in (1, 2, 3)
    for form in ("bending", "corrected_hourglass", "corrected", "total_lagrangian")
])  # fmt: skip
def test_the_stress_at_a_loaded_face_meets_the_pressure(tmp_path, dimension, form):
    layers = (12, 10, 6)[dimension - 1]
    side = layers * 1e-3
    box = [0, side] * dimension + [0, 1] * (3 - dimension)
    deck = f"""\
&run t_end=2.2e-4, dimension={dimension} /
&material id='s', model='linear_elastic', density=2000, youngs_modulus=10e9, poisson_ratio=0.2 /
&body id='b', box={", ".join(map(str, box))}, spacing=1e-3, material='s', formulation='{form}' /
&load id='p', body='b', faces='x+', 'x-', time=0, 1e-4, 1, pressure=0, 1e6, 1e6 /
&output dump_every=2e-6 /
"""
    tables = run(tmp_path, deck)
    assert abs(tables["energy"]["error[-]"][-1]) < 1e-2
    stress = []
    for path in sorted((tmp_path / "out" / "load").glob("solid_*.vtkhdf"))[60:]:
        with h5py.File(path) as file:
            x = np.array(file["VTKHDF/Points"])[:, 0]
            s = np.array(file["VTKHDF/PointData/stress"]).reshape(len(x), -1)[:, 0]
        layer = np.floor(x / 1e-3).astype(int)
        stress.append([s[layer == k].mean() for k in range(layers)])
    pressed = -np.mean(stress, axis=0) / 1e6
    for layer, value in enumerate(pressed[:3], 1):
        note(f"loaded_face_{dimension}_{form}_{layer}", value)
    assert pressed[0] == pytest.approx(1, abs=0.03)
    assert pressed[1:] == pytest.approx(np.ones(layers - 1), abs=0.055)
