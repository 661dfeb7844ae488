# SPDX-License-Identifier: MIT
"""Rules that bond nothing are told of; what they name meets by contact."""

import re

import pytest
from test_run import history, run

DECK = """\
&run t_end=1e-6, dimension={dimension} /
&material id='s', preset='steel_4340' /
&body id='a', box=0.001,0.005, 0,0.003, 0,0.003, spacing=5e-4, material='s' /
&body id='b', box={left},{right}, 0,0.003, 0,0.003, spacing=5e-4, material='s', velocity=-900,0,0 /
&body id='c', box=0.001,0.005, 0.003,0.005, 0,0.003, spacing=5e-4, material='s' /
&interaction {bodies} law='{law}' /
{last}
"""


def warnings(tmp_path, gap, **other):
    usual = {"bodies": "bodies='a','b',", "dimension": 2, "law": "bonded", "last": ""}
    deck = DECK.format(**{**usual, **other}, left=0.005 + gap, right=0.009 + gap)
    (tmp_path / "scene.nml").write_text(deck)
    done = run("run", "scene.nml", "--check", cwd=tmp_path)
    assert "a+b" in done.stdout
    return done.stderr


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("gap", [0, 4e-4, 8e-4, 4e-3])
def test_a_rule_that_bonds_nothing_is_told_of(gap, dimension, tmp_path):
    words = warnings(tmp_path, gap, dimension=dimension)
    assert ("it bonds nothing" in words) == (gap > 5e-4)
    if gap <= 5e-4:
        return
    assert words.startswith("scene.nml:6: &interaction: warning: ")
    apart, reach = (float(x) for x in re.findall(r"(\S+) m(?: or more apart|;)", words))
    assert gap + 5e-4 == pytest.approx(apart, rel=1e-5)
    assert 2 * 5e-4 < reach < 2.8 * 5e-4


def test_one_bond_of_a_rule_is_enough(tmp_path):
    """Of several pairs one that is near; a rule that another one covers says nothing."""
    assert "it bonds nothing" not in warnings(tmp_path, 4e-3, bodies="")
    covered = "&interaction law='contact' /"
    assert "it bonds nothing" not in warnings(tmp_path, 4e-3, last=covered)
    assert "it bonds nothing" not in warnings(tmp_path, 4e-3, law="contact")


def test_what_was_not_bonded_meets_by_contact(tmp_path):
    warnings(tmp_path, 8e-4)
    done = run("run", "scene.nml", "--out", "out", "--set", "output.history_every=0", cwd=tmp_path)
    assert done.stderr.count("it bonds nothing") == 1
    assert history(tmp_path / "out" / "energy.csv")["contact[J]"].max() > 0


ROUND = """\
&run t_end=1e-6, dimension=2 /
&material id='s', preset='steel_4340' /
&body id='ball', shape='sphere', centre=0,0,0, radius=0.003, spacing=5e-4, material='s' /
&body id='block', box={at},0.006, {at},0.006, 0,1, spacing=5e-4, material='s' /
&interaction bodies='ball','block', law='bonded' /
"""


@pytest.mark.parametrize("at, told", [(0.0029, True), (0.0023, False)])
def test_the_particles_count_where_boxes_overlap(at, told, tmp_path):
    """The corner of a block beside a ball, within the box around the ball."""
    (tmp_path / "scene.nml").write_text(ROUND.format(at=at))
    done = run("run", "scene.nml", "--check", cwd=tmp_path)
    assert ("it bonds nothing" in done.stderr) == told
