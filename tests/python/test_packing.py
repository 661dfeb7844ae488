# SPDX-License-Identifier: MIT
"""Members of a study in one run: each as it is alone, and what cannot lie beside others."""

import numpy as np
import pytest

from post.deck import Deck
from post.packing import NotPackable, pack
from post.reader import Run
from post.runner import Job, Program, Runner, Slot, Store, find_program

STRIP = """Half of a clamped strip of mild steel under an impulse.
&run t_end = 1e-4, dimension = 2, symmetry = 'x' /
&material id = 'm', model = 'bilinear_j2', density = 7850, youngs_modulus = 200e9
  poisson_ratio = 0.3, yield_stress = 290e6, tangent_modulus = 0.5e9 /
&body id = 'strip', box = -0.25, 0.25, -0.012, 0, 0, 1, spacing = 0.004, material = 'm'
  fix = 'x-', 'x+', fix_width = 0.05 /
&load id = 'p', body = 'strip', faces = 'y+', time = 0, 1e-4, pressure = {pressure}e6, 0 /
&gauge id = 'mid', at = 0, -0.006, 0.5, body = 'strip', quantity = 'displacement_y' /
&output history_every = 1e-5, dump_every = 1e-4 /
"""


@pytest.fixture
def runner(tmp_path):
    """A runner with a store of its own."""
    return Runner(Store(tmp_path / "store", Program(find_program())))


def jobs(tmp_path, *pressures):
    """Jobs of strips under these pressures [MPa]."""
    return [Job(STRIP.format(pressure=one), tmp_path) for one in pressures]


def test_members_are_as_they_are_alone(runner, tmp_path):
    wanted = jobs(tmp_path, 20, 40, 60)
    together = runner.run_all(wanted, Slot())
    assert [one.device for one in together] == ["cpu, 3 at once"] * 3
    gauges = [Run(runner.store.place(one.key) / "out").gauges for one in together]
    bodies = Run(runner.store.place(together[2].key) / "out").bodies
    alone = Runner(Store(tmp_path / "other", runner.store.program))
    # the last one, which moves the fastest, has the smallest step: that of all
    for k, near in ((0, 2e-3), (2, 1e-6)):
        one = alone.run(wanted[k], Slot())
        assert one.key == together[k].key
        own = Run(alone.store.place(one.key) / "out")
        moved, time = own.gauges["mid:displacement_y"], own.gauges.time
        here = np.interp(time, gauges[k].time, gauges[k]["mid:displacement_y"])
        assert np.abs(here - moved).max() < near * np.abs(moved).max()
        assert abs(moved[-1]) > 1e-5
    # and where it lies in the pack is not where its deck has it
    assert np.abs(bodies["strip:y"] - own.bodies["strip:y"]).max() < 1e-6


def test_nothing_runs_twice(runner, tmp_path):
    first = runner.run(jobs(tmp_path, 20)[0], Slot())
    found = runner.run_all(jobs(tmp_path, 20, 30, 40, 30), Slot())
    assert [one.known for one in found] == [True, False, False, True]
    assert found[0].values == first.values
    assert found[1].values == found[3].values
    assert not any(path.name.startswith("pack_") for path in runner.store.folder.rglob("*"))


def test_a_member_that_fails_takes_none_along(runner, tmp_path):
    wanted = [*jobs(tmp_path, 20, 30), Job(STRIP.format(pressure="20e3*0+4e"), tmp_path)]
    found = runner.run_all(wanted, Slot())
    assert [one.state for one in found[:2]] == ["done", "done"]
    assert found[2].state == "refused"


def complete(more="", symmetry="'x'"):
    """A complete deck as the program echoes it."""
    return f"""&run
  title = 'a' ! default
  t_end = 1.0
  symmetry = {symmetry}
/
&material
  id = 'm'
/
&body
  id = 'b'
  box = 0.0, 4.0, -0.5, 0.5, 0.0, 1.0
  fix_box = 0.0, 1.0, -1.0, 1.0, 0.0, 1.0, 3.0, 4.0, -1.0, 1.0, 0.0, 1.0
  material = 'm'
/
&load
  body = 'b'
  at = 0.0, -1.0, 0.0
/
&gauge
  id = 'g'
  body = 'b'
  at = 1.0, 0.0, 0.0
/
{more}
"""


def test_places_and_names_are_those_of_the_members():
    packed = pack([complete(), complete()])
    assert packed.axis == 1  # the shorter of those without a plane of symmetry comes first
    assert packed.pitch >= 2
    deck = Deck(packed.text)
    bodies = deck.groups("body")
    assert [one["id"] for one in bodies] == ["m0_b", "m1_b"]
    assert [one["material"] for one in bodies] == ["m0_m", "m1_m"]
    by = [packed.shift(k) for k in (0, 1)]
    assert by[1] - by[0] == packed.pitch
    assert [one["box"][2:4] for one in bodies] == [[-0.5 + d, 0.5 + d] for d in by]
    assert [one["fix_box"][8:10] for one in bodies] == [[-1 + d, 1 + d] for d in by]
    assert [one["box"][:2] for one in bodies] == [[0, 4], [0, 4]]
    assert [one["at"][1] for one in deck.groups("load")] == [-1 + d for d in by]
    assert [one["body"] for one in deck.groups("gauge")] == ["m0_b", "m1_b"]
    assert [one.get("law") for one in deck.groups("interaction")] == ["none"]


@pytest.mark.parametrize(
    ("decks", "why"),
    [
        ([complete(), complete("&air\n box = 0, 1, 0, 1, 0, 1\n/")], "members have &air"),
        ([complete(), complete().replace("t_end = 1.0", "t_end = 2.0")], "members differ in &run"),
        ([complete(symmetry="'x', 'y', 'z'")] * 2, "planes of symmetry"),
        ([complete("&solid\n region = 0, 1, 0, 1, 0, 1\n/")] * 2, "region"),
        ([complete("&interaction\n bodies = '*'\n friction = 0.1\n/"), complete()], "all bodies"),
    ],
)
def test_what_cannot_lie_beside_others_is_refused(decks, why):
    with pytest.raises(NotPackable, match=why):
        pack(decks)
