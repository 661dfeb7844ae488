# SPDX-License-Identifier: MIT
"""Bodies in one and two dimensions in air: stresses and motion do not depend on how deep it is."""

import numpy as np
import pytest
from test_gauges import gauges
from test_gpu import follows_the_cpu
from test_loads import run

# a bonded pair that strikes what is held, a block with lengths of its own, strips that stretch and
# bend, each in a formulation of its own
PLANE = """\
&run t_end=6e-6, dimension=2 /
&air box=-0.02,0.03, -0.02,0.02, {lo},{hi}, cells=25,20,1 /
&material id='s', model='linear_elastic', density=7800, youngs_modulus=2e11, poisson_ratio=0.3 /
&material id='al', preset='al2024_paper' /
&body id='a', box=0,0.005, -0.003,0.003, -1,1, spacing=5e-4, material='s', velocity=10,0,0 /
&body id='b', box=0.005,0.01, -0.003,0.003, -1,1, spacing=5e-4, material='al',
    formulation='corrected', fix='x+', fix_layers=1 /
&body id='c', box=0.005,0.01, 0.0031,0.006, -1,1, spacing=5e-4, material='s', velocity=0,-100,0,
    formulation='corrected', variable_h=.true. /
&body id='d', box=-0.01,0.01, 0.011,0.0125, -1,1, spacing=5e-4, material='al', fix='x-',
    velocity=0,20,0 /
&body id='e', box=-0.01,-0.002, 0.014,0.016, -1,1, spacing=5e-4, material='s', fix='x-',
    formulation='bending', velocity=0,20,0 /
&body id='f', box=-0.01,-0.002, -0.016,-0.014, -1,1, spacing=5e-4, material='s', fix='x-',
    formulation='total_lagrangian', velocity=0,20,0 /
&body id='g', box=0.002,0.01, -0.016,-0.014, -1,1, spacing=5e-4, material='s', fix='x-',
    formulation='uncorrected', artificial_stress='gray', velocity=20,0,0 /
&interaction bodies='b','c', law='contact' /
&interaction bodies='a','b', law='bonded' /
&gauge id='sb', at=0.007,0,0, quantity='stress_xx', body='b' /
&gauge id='sc', at=0.007,0.004,0, quantity='stress_yy', body='c' /
&gauge id='vc', at=0.007,0.005,0, quantity='velocity_y', body='c' /
&gauge id='sd', at=-0.008,0.0123,0, quantity='stress_xx', body='d' /
&gauge id='se', at=-0.008,0.0157,0, quantity='stress_xx', body='e' /
&gauge id='sf', at=-0.008,-0.0157,0, quantity='stress_xx', body='f' /
&gauge id='sg', at=0.004,-0.015,0, quantity='stress_xx', body='g' /
"""
# a blast on concrete, a ply and a rigid ball: pairs that rub, share their sums, are glued
MEETS = """\
&run t_end=1e-5, dimension=2 /
&air box=-0.02,0.03, -0.02,0.02, {lo},{hi}, cells=25,20,1 /
&gas id='hot', box=-0.02,-0.01, -0.02,0.02, -9,9, density=3, pressure=5e6 /
&material id='al', preset='al2024_paper' /
&material id='hjc', preset='concrete_48' /
&material id='cfrp', preset='cfrp_ud' /
&body id='a', box=0,0.004, -0.003,0.003, -1,1, spacing=5e-4, material='al', velocity=60,20,0 /
&body id='b', box=0.0041,0.01, -0.003,0.003, -1,1, spacing=5e-4, material='hjc', fix='x+' /
&body id='c', box=0,0.004, 0.0031,0.006, -1,1, spacing=5e-4, material='cfrp' /
&body id='d', box=0.004,0.01, 0.0031,0.006, -1,1, spacing=5e-4, material='al', fix='x+' /
&body id='e', shape='sphere', centre=0.002,-0.0052,0, radius=0.002, spacing=5e-4, material='al',
    formulation='rigid', velocity=0,40,0 /
&interaction bodies='a','b', law='contact', friction=0.3, damping=0.5 /
&interaction bodies='a','c', law='contact', shared_pressure=.true. /
&interaction bodies='a','e', law='contact', friction=0.2 /
&interaction bodies='b','d', law='none' /
&interaction bodies='c','d', law='cohesive', tensile_strength=3e7, shear_strength=4e7, gi=200,
    gii=500 /
&gauge id='pa', at=0.002,0.001,0, quantity='pressure', body='a' /
&gauge id='pb', at=0.006,0.001,0, quantity='pressure', body='b' /
&gauge id='pc', at=0.002,0.0045,0, quantity='pressure', body='c' /
&gauge id='vd', at=0.006,0.0045,0, quantity='velocity_x', body='d' /
&gauge id='ve', at=0.002,-0.0052,0, quantity='velocity_y', body='e' /
"""
LINE = """\
&run t_end=6e-6, dimension=1 /
&air box=-0.02,0.03, {lo},{hi}, 0,1, cells=50,1,1 /
&material id='s', model='linear_elastic', density=7800, youngs_modulus=2e11, poisson_ratio=0.3 /
&body id='a', box=0,0.01, -1,1, -1,1, spacing=5e-4, material='s', velocity=10,0,0, fix='x+',
    fix_layers=1 /
&gauge id='s', at=0.007,0,0, quantity='stress_xx', body='a' /
&gauge id='v', at=0.001,0,0, quantity='velocity_x', body='a' /
"""


@pytest.mark.parametrize("deck", [PLANE, MEETS, LINE], ids=["plane", "meets", "line"])
def test_depth_changes_nothing(tmp_path, deck):
    """All volumes and forces go with the depth, by a power of two: nothing else knows of it."""
    found = {}
    for depth in (1, 1 / 64, 8):
        folder = tmp_path / str(depth)
        folder.mkdir()
        text = deck.format(lo=-depth / 2, hi=depth / 2)
        (folder / "deck.nml").write_text(text)
        found[depth] = gauges(run(folder, text))
        if depth < 1:
            follows_the_cpu(folder / "out" / "load", folder)
    for name, column in found[1].items():
        most = abs(column).max()
        assert most > 0, name
        for depth in (1 / 64, 8):
            assert np.allclose(found[depth][name], column, rtol=0, atol=1e-9 * most), name
