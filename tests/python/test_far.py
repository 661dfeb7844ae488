# SPDX-License-Identifier: MIT
"""Bodies far from the origin: places in dumps, planes of symmetry."""

import subprocess

import numpy as np
import pytest
from test_loads import BRISANCE

from post.reader import Run

FAR = """\
&run t_end=1e-6, backend='cpu'{symmetry} /
&material id='m', model='linear_elastic', density=7800, youngs_modulus=200e9, poisson_ratio=0.3 /
&body id='b', box={low:.3f},{high:.3f}, 0,0.02, 0,0.02, spacing=0.001, material='m',
    velocity=1,0,0 /
"""


def test_particles_far_from_the_origin_keep_their_places(tmp_path):
    """Map coordinates: 500 km away real32 knows 31 mm; dumps have places in real64."""
    deck = FAR.format(symmetry="", low=5e5, high=5e5 + 0.02)
    (tmp_path / "far.nml").write_text(deck)
    subprocess.run([BRISANCE, "run", "far.nml"], cwd=tmp_path, check=True, capture_output=True)
    frame = Run(tmp_path / "out" / "far").frames[0]
    columns = np.unique(frame.solid().points[:, 0])
    assert columns == pytest.approx(5e5 + (np.arange(20) + 0.5) * 1e-3, rel=0, abs=1e-9)
    assert np.ptp(frame.mesh("solid").points[:, 0]) == pytest.approx(0.019, abs=1e-9)


def test_a_body_far_off_a_plane_of_symmetry_is_warned_of(tmp_path):
    for low, told in ((5e5, True), (0.0, False), (0.1, False)):
        deck = FAR.format(symmetry=", symmetry='x'", low=low, high=low + 0.02)
        (tmp_path / "far.nml").write_text(deck)
        done = subprocess.run([BRISANCE, "run", "far.nml", "--check"], cwd=tmp_path, text=True,
                              capture_output=True)  # fmt: skip
        assert ("lies at x = 0" in done.stderr) == told, done.stderr
