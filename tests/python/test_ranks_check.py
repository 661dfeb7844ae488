# SPDX-License-Identifier: MIT
"""What a check says that processes get is what they have when a run begins."""

import re

import pytest
from test_ranks import needs_mpirun, start
from test_ranks_bodies import BODIES, MEETING
from test_ranks_coupled import pelted
from test_ranks_glue import GLUED
from test_ranks_total import MET

SCENES = {"apart": BODIES, "meeting": MEETING, "total": MET, "glued": GLUED.format(every=0),
          "in air": pelted(1)}  # fmt: skip


@needs_mpirun
@pytest.mark.parametrize("n", [2, 4])
@pytest.mark.parametrize("scene", SCENES)
def test_a_check_counts_what_a_run_has(scene, n, tmp_path):
    (tmp_path / "deck.nml").write_text(SCENES[scene])
    check = start(0, "run", "deck.nml", "--check", "--ranks", str(n), cwd=tmp_path)
    assert check.returncode == 0, check.stderr
    own, ghosts = counts(r"(\d+) particles of its own, (\d+) of neighbours", check.stdout)
    assert len(own) == n
    assert max(ghosts) > 0
    done = start(n, "run", "deck.nml", "--set", "run.max_steps=1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    share, least, most = re.search(
        r"the most particles over the mean ([\d.]+), and (\d+) to (\d+) of neighbours", done.stdout
    ).groups()
    assert abs(float(share) - max(own) * n / sum(own)) < 0.006
    assert (int(least), int(most)) == (min(ghosts), max(ghosts))
    if scene == "in air":
        (copies,) = counts(r"(\d+) particles in its window", check.stdout)
        said = re.search(r"(\d+) to (\d+) copies for the air", done.stdout).groups()
        assert tuple(map(int, said)) == (min(copies), max(copies))


def counts(pattern, words):
    found = re.findall(pattern, words)
    rows = [row if isinstance(row, tuple) else (row,) for row in found]
    return [[int(word) for word in column] for column in zip(*rows, strict=True)]
