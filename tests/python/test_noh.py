# SPDX-License-Identifier: MIT
"""Cold gas that meets a wall (Noh 1987), in one dimension: which schemes converge, and what
`--check` says of the one that does not."""

import subprocess

import numpy as np
import pytest
from test_loads import BRISANCE

from post.reader import Run

NOH = """\
&run t_end=0.9, dimension=1, backend='cpu' /
&air box=0,1, 0,1, 0,1, cells={cells},1,1, gamma=1.6666666666666667, density=1, pressure=1e-6,
    bc='wall','outflow','outflow','outflow','outflow','outflow',
    reconstruction='{reconstruction}', flux='{flux}', integrator='ssprk3' /
&gas id='g', box=0,1, 0,1, 0,1, density=1, pressure=1e-6, velocity=-1,0,0 /
&output dump_every=0.9 /
"""


def error(folder, cells, reconstruction, flux):
    """Mean error of the density at t = 0.9, where the shock is at 0.3 and four times the density
    behind it; what the run warns of."""
    text = NOH.format(cells=cells, reconstruction=reconstruction, flux=flux)
    (folder / "noh.nml").write_text(text)
    done = subprocess.run([BRISANCE, "run", "noh.nml", "--replace"], cwd=folder, check=True,
                          capture_output=True, text=True)  # fmt: skip
    air = Run(folder / "out" / "noh").frames[-1].air("density")
    exact = np.where(air.centres(0) < 0.3, 4.0, 1.0)
    return np.abs(air.field["density"].ravel() - exact).mean(), done.stderr


@pytest.mark.parametrize(
    ("reconstruction", "flux", "converges"),
    [("weno5z", "steger_warming", 0.55), ("muscl", "hllc", 0.65), ("weno5z", "hllc", None)],
)
def test_noh(tmp_path, reconstruction, flux, converges):
    """Twice the cells: about half of the error of the shock; WENO5-Z with HLLC rings behind it."""
    (coarse, said), (fine, _) = (error(tmp_path, n, reconstruction, flux) for n in (100, 200))
    if converges:
        assert fine < converges * coarse < converges * 0.02 and "rings" not in said
    else:
        assert fine > 0.8 * coarse and "weno5z with hllc rings" in said


def test_smooth_gas_is_not_warned_of(tmp_path):
    text = NOH.format(cells=100, reconstruction="weno5z", flux="hllc")
    text = text.replace("pressure=1e-6, velocity=-1,0,0", "pressure=1.1e-6")
    (tmp_path / "noh.nml").write_text(text)
    done = subprocess.run([BRISANCE, "run", "noh.nml", "--check"], cwd=tmp_path,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0 and not done.stderr and "sound" in done.stdout
