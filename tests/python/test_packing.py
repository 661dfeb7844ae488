# SPDX-License-Identifier: MIT
"""Members of a study in one run: each as it is alone, and what cannot lie beside others."""

import numpy as np
import pytest

from post import study
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


def test_members_have_their_own_end(runner, tmp_path):
    """The shorter one has a row at its end, on a straight line between those of the run."""
    short = Job(STRIP.format(pressure=60).replace("t_end = 1e-4", "t_end = 6.13e-5"), tmp_path)
    together = runner.run_all([short, *jobs(tmp_path, 60)], Slot())
    assert [one.device for one in together] == ["cpu, 2 at once"] * 2
    gauges = [Run(runner.store.place(one.key) / "out").gauges for one in together]
    assert [one.time[-1] for one in gauges] == pytest.approx([6.13e-5, 1e-4], rel=1e-12)
    own = Runner(Store(tmp_path / "other", runner.store.program)).run(short, Slot())
    alone = Run(tmp_path / "other" / "runs" / own.key / "out").gauges
    assert gauges[0]["mid:displacement_y"][-1] == pytest.approx(
        alone["mid:displacement_y"][-1], rel=2e-3
    )


def test_members_that_fly_lie_beyond_their_ways():
    """One that goes 9 m along y in its time: the others lie aside of it, or behind that way."""
    flying = complete(symmetry="'z'").replace("id = 'b'\n", "id = 'b'\n  velocity = 0, 9, 0\n")
    packed = pack([flying, complete(symmetry="'z'")])
    assert packed.axis == 0  # 4 m long, and y is 10 m with the way
    packed = pack([flying.replace("'z'", "'x', 'z'"), complete(symmetry="'x', 'z'")])
    assert packed.axis == 1 and packed.pitch == pytest.approx(20)


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
        ([complete(), complete().replace("'x'", "'z'")], "members differ in &run"),
        ([complete(symmetry="'x', 'y', 'z'")] * 2, "planes of symmetry"),
        ([complete("&solid\n region = 0, 1, 0, 1, 0, 1\n/")] * 2, "region"),
        ([complete("&interaction\n bodies = '*'\n friction = 0.1\n/"), complete()], "all bodies"),
    ],
)
def test_what_cannot_lie_beside_others_is_refused(decks, why):
    with pytest.raises(NotPackable, match=why):
        pack(decks)


# --- limits -------------------------------------------------------------------------------------

LIMIT = """[study]
deck = "strip.nml"
[parameter.end]
values = [{ends}]
unit = "ms"
set = {{ "load(p).time" = "0, x" }}
[limit]
unknown = "pressure"
low = 10
high = 100
{what}
"""
MET = """result = "mid:displacement_y peak"
target = 0.8
target_unit = "mm"
along = "end"
"""
SETS_IN = "event = 'mid:displacement_y peak < -0.8e-3'\ntolerance = 0.02"


@pytest.fixture
def find(tmp_path, monkeypatch):
    """Find limits one by one or in packs, which run on the CPU all the same: what is found, and how
    many runs were begun.
    """
    begun = []
    start = Runner._start

    def on_cpu(self, command, place, slot, lock):
        begun.append(place.name)
        return start(self, command, place, Slot(), lock)

    monkeypatch.setattr(Runner, "_start", on_cpu)
    monkeypatch.setattr(study, "_write", lambda study, out, runner, found: (found, 0))
    (tmp_path / "strip.nml").write_text(STRIP.format(pressure="{pressure}"))

    def run(text, gpu=None, out="o"):
        (tmp_path / "s.toml").write_text(text)
        monkeypatch.setattr(study, "slots_of", lambda *_: [Slot(gpu=gpu)])
        begun.clear()
        found, _ = study.make_study(tmp_path / "s.toml", study.Options(out=tmp_path / out))
        return found, list(begun)

    return run


def values(found):
    return [one.value for _, one in found.limits]


@pytest.mark.parametrize(("what", "near"), [(MET, 0.01), (SETS_IN, 0.02)])
def test_limits_in_packs_are_those_of_runs_one_by_one(find, what, near):
    text = LIMIT.format(ends="0.06, 0.1, 0.15", what=what)
    alone, singles = find(text)
    packs, runs = find(text, gpu=0, out="packed")
    assert all(one.value > 0 for _, one in alone.limits)
    assert values(packs) == pytest.approx(values(alone), rel=near)
    assert len(singles) == len(alone.outcomes) > 6
    assert len(runs) <= 4 and all(name.startswith("pack_") for name in runs)
    assert all("at once" in one.device for one in packs.outcomes)
    again, runs = find(text, gpu=0, out="packed")  # nothing runs twice
    assert values(again) == values(packs) and not runs


def test_what_is_no_result_of_a_member_runs_alone(find):
    """Energies of a pack are those of all: one run after the other, as without packs."""
    what = MET.replace("mid:displacement_y peak", "energy load_work peak").replace("0.8", "600")
    text = LIMIT.format(ends="0.1", what=what.replace('"mm"', '"J"'))
    found, runs = find(text, gpu=0)
    assert found.limits[0][1].runs and not any(name.startswith("pack_") for name in runs)


def test_results_of_members_are_packed(tmp_path):
    (tmp_path / "strip.nml").write_text(STRIP.format(pressure="{pressure}"))
    for what, packed in (
        (MET, True),
        (SETS_IN, True),
        ("event = 'rod velocity_x > 10'", True),
        ("event = 'rod residual_velocity > 10'", False),
        (MET.replace("mid:displacement_y", "energy internal"), False),
    ):
        (tmp_path / "s.toml").write_text(LIMIT.format(ends="0.1", what=what))
        assert (study.read_study(tmp_path / "s.toml").pack > 1) == packed
