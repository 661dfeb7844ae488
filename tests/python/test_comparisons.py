# SPDX-License-Identifier: MIT
"""The comparison with other codes: its decks are sound, its tables are what was recorded."""

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

HOME = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(HOME))

from post.blast import free_air  # noqa: E402
from studies.comparisons import (  # noqa: E402
    bricks,
    compare,
    kingery,
    mindlin,
    plate,
    programs,
    progress,
    tables,
)
from studies.comparisons.case import CASES, Quantity, Run, load_case, load_cases  # noqa: E402
from studies.comparisons.records import Record, read_histories, read_records, thinned  # noqa: E402

BRISANCE = HOME / "bin" / "brisance"


@pytest.mark.parametrize("name", [case.name for case in load_cases() if case.runs])
def test_our_decks_are_accepted(tmp_path, name):
    case = load_case(name)
    run = next(run for run in case.runs if run.program == "brisance")
    run.write(tmp_path)
    done = subprocess.run([BRISANCE, "run", "deck.nml", "--check"], cwd=tmp_path,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", CASES)
def test_records_are_complete(name):
    case = load_case(name)
    records = read_records(case)
    assert records, f"{name}: nothing is recorded"
    codes = [r.code for r in records]
    assert len(set(codes)) == len(codes)
    for r in records:
        assert r.command, f"{name}: {r.code} names no command or source"
        if r.kind in ("rerun", "recorded"):
            assert r.version, r.code
            assert r.date, r.code
            assert r.machine, r.code
            assert r.size, f"{name}: {r.code} has a speed without a size"
    assert set(read_histories(case)) <= set(codes)
    assert set(case.remarks) <= set(codes) | {run.name for run in case.runs}


def test_the_page_has_the_tables_of_what_is_recorded():
    text = (HOME / "studies/notes/comparison.md").read_text(encoding="utf-8")
    assert tables.filled(text, load_cases()) == text, "run make compare ARGS='--draw --write'"
    for name in (*CASES, "versions"):
        assert f"<!-- table: {name} -->" in text


def test_a_peer_that_is_not_there_is_skipped_by_name(monkeypatch, capsys):
    for key in ("calculix", "lammps", "openfoam"):
        gone = replace(programs.PROGRAMS[key], find=lambda: None)
        monkeypatch.setitem(programs.PROGRAMS, key, gone)
    ran = []
    monkeypatch.setattr(compare, "timed", lambda *_: ran.append(1))
    for name, title in (("plate_steel", "CalculiX"), ("taylor_bilinear", "LAMMPS"),
                        ("reflected_blast", "OpenFOAM")):  # fmt: skip
        chosen = compare.options([name, "--only", title])
        assert compare.run_case(load_case(name), chosen)
        assert f"{name}: skipped: {title} is not installed (" in capsys.readouterr().out
    assert not ran


QUANTITY = Quantity("peak", "peak", "mm")


def counted(folder, number, name="toy"):
    """A run whose program counts how often it is called, and fails for the number 0."""

    def write(place):
        (place / "n").write_text(str(number), encoding="utf-8")

    def read(place):
        return {"peak": float((place / "log.0").read_text(encoding="utf-8"))}, []

    script = folder / "toy.sh"
    script.write_text(f"#!/bin/sh\necho x >> {folder}/calls\ntest $(cat n) != 0 && cat n\n")
    script.chmod(0o755)
    return Run(name, "toy", "1 cell", write, read)


def test_runs_that_have_ended_are_kept(tmp_path, monkeypatch, capsys):
    """The same inputs and program are not run again, others are; failures do not end the rest, and
    all of it stands in the summary."""
    toy = programs.Program("Toy", lambda: tmp_path / "toy.sh", ("{}",), lambda _: "1", {}, "make")
    monkeypatch.setitem(programs.PROGRAMS, "toy", toy)
    monkeypatch.setattr(compare, "OUT", tmp_path / "out")
    case = replace(load_case("plate_steel"), name="toys", quantities=(QUANTITY,))

    def make(*arguments, numbers=(2,)):
        (tmp_path / "calls").write_text("", encoding="utf-8")
        runs = tuple(counted(tmp_path, n, f"toy {k}") for k, n in enumerate(numbers))
        now = replace(case, runs=runs)
        state = progress.Progress.of([(now, run) for run in runs])
        good = compare.run_case(now, compare.options(list(arguments)), state)
        calls = (tmp_path / "calls").read_text(encoding="utf-8").count("x")
        return good, calls, state.summary(0).splitlines()

    assert make()[1:] == (1, ["Summary: 1 run; 0 s"])
    assert make()[1:] == (0, ["Summary: 1 kept from before; 0 s"])
    assert make("--again")[1] == 1
    assert make("--turns", "3")[1] == 2  # the first is kept
    good, calls, lines = make(numbers=(0, 2, 3))
    assert not good and calls == 3
    assert lines[0] == "Summary: 2 run, 1 failed; 0 s" and "toy 0: " in lines[1]
    assert make(numbers=(0, 2, 3))[1] == 1  # what has failed is tried again
    assert "toys: toy 0: run 1, about 30 s of 30 s" in capsys.readouterr().out


def test_a_case_that_is_not_there_is_refused(capsys):
    with pytest.raises(SystemExit) as stop:
        compare.options(["plate_wood"])
    assert stop.value.code == 2
    assert "there is no case plate_wood" in capsys.readouterr().err


def test_what_a_rerun_changes_is_told():
    q = Quantity("peak", "peak", "mm", 1e3, 3, 2e-3, 0.05)
    case = replace(load_case("plate_steel"), quantities=(q,))
    old = Record("Brisance", "rerun", measures={"peak": 2e-3})
    new = Record("Brisance", "rerun", measures={"peak": 2.2e-3})
    assert tables.drift(case, old, new, 0.01) == ["peak was 2.00, is 2.20 mm"]
    assert tables.drift(case, old, old, 0.01) == []
    assert tables.missed(case, new) == ["peak: +10.0 %, wanted 5 %"]
    assert tables.missed(case, old) == []
    assert tables.cell(q, 2.2e-3) == "2.20 (+10.0 %)"


def test_the_bricks_of_calculix_are_sound():
    """Every node is there once, corners turn the right way, the load is on the upper face."""
    fem = bricks.Plate(0.1, 4, ((0.002, 1, "A"), (0.004, 2, "B")), {}, 1e-5, 1e-6)
    mesh = bricks.Mesh(fem)
    place = {}
    for line in map(mesh.node_line, mesh.nodes()):
        number, *xyz = line.split(",")
        assert int(number) not in place
        place[int(number)] = np.array(xyz, float)
    used, volume = set(), 0.0
    for _, _, nodes in mesh.elements():
        assert len(set(nodes)) == 20
        used |= set(nodes)
        x = np.array([place[n] for n in nodes])
        sides = np.array([x[1] - x[0], x[3] - x[0], x[4] - x[0]])
        volume += np.linalg.det(sides)
        assert np.linalg.det(sides) > 0
        pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
        pairs += [(0, 4), (1, 5), (2, 6), (3, 7)]
        for k, (a, b) in enumerate(pairs):
            assert x[8 + k] == pytest.approx((x[a] + x[b]) / 2)
    assert used == set(place)
    assert volume == pytest.approx(0.1**2 * 0.006)
    struck = {number for number, _, _ in mesh.struck()}
    tops = [x for x in mesh.elements() if x[0] in struck]
    assert len(tops) == 16
    assert all(place[n][2] == 0 for _, _, nodes in tops for n in nodes[4:8])


def test_a_pulse_keeps_its_impulse():
    """Trapezoids over the table of a pulse give pressure times duration, wherever it ends."""
    fem = bricks.Plate(0.1, 1, ((0.01, 1, "A"),), {"A": bricks.isotropic(1e9, 0.3, 1)}, 2e-5, 2e-6)
    text = bricks.pulse(fem, 3e6, 9e-6)
    table = text.split("TIME=TOTAL TIME\n")[1].split("*")[0].split()
    t, p = (np.array([float(x.strip(",")) for x in table[k::2]]) for k in (0, 1))
    assert np.trapezoid(p, t) == pytest.approx(27.0)


def test_the_blast_load_has_the_impulse_of_the_curves():
    step = 1e-6
    mean = kingery.load(0.168, (0.0, 0.0, 0.4), step)
    times = np.arange(0, 3e-3, step)
    wave = free_air(0.168, 0.4)
    total = sum(mean(0.0, 0.0, t) for t in times) * step
    assert total == pytest.approx(wave.reflected_impulse, rel=1e-6)
    distance = math.hypot(0.1, 0.4)
    oblique = free_air(0.168, distance).on_surface(math.acos(0.4 / distance))[1]
    assert sum(mean(0.1, 0.0, t) for t in times) * step == pytest.approx(oblique, rel=1e-6)


def test_modes_of_a_clamped_plate():
    """Thin: 35.985 (Leissa). Side of 20 thicknesses: 10.586 by elasticity in space."""
    thin = mindlin.modes(mindlin.Square(0.1, 1e-4, 200e9, 0.3, 7800.0), n=12)[0][0]
    bend = 200e9 * 1e-4**3 / (12 * (1 - 0.09))
    assert thin * 0.2**2 * math.sqrt(7800 * 1e-4 / bend) == pytest.approx(35.985, rel=2e-3)
    thick = mindlin.modes(mindlin.Square(0.1, 0.01, 200e9, 0.3, 7800.0))[0][0]
    assert thick * 0.2**2 / 0.01 * math.sqrt(7800 / 200e9) == pytest.approx(10.586, rel=1e-3)


def test_what_is_measured_on_a_history():
    history = [(k * 1e-6, math.sin(k * 1e-6 * 2e4)) for k in range(400)]
    time, top = plate.peak(history)
    assert time == pytest.approx(math.pi / 4e4, rel=1e-3)
    assert top == pytest.approx(1, rel=1e-5)
    assert plate.back(history, time) == pytest.approx(math.pi / 2e4, rel=1e-4)
    assert plate.mean(history, 0, math.pi / 2e4) == pytest.approx(2 / math.pi, rel=1e-3)
    few = thinned(history * 3)
    assert len(few) == 200
    assert (few[0], few[-1]) == (history[0], history[-1])


def test_the_clamp_acts_at_the_edge_of_the_free_span():
    """There lie the centres of the first column that is held: the third from outside."""
    for half, thickness, layers in ((0.1, 0.01, 3), (0.1, 0.01, 4), (0.125, 0.0042, 3)):
        columns, spacing, outer = plate.lattice(plate.Shape(half, thickness, layers))
        assert (columns - 3 + 0.5) * spacing == pytest.approx(half)
        assert columns * spacing == pytest.approx(outer)
        assert 0.98 * thickness / layers < spacing <= thickness / layers


def test_the_clamp_acts_behind_the_first_wide_column_that_is_held():
    columns, spacing, outer = plate.lattice(plate.Shape(0.1, 0.01, 4, 3, 0.27))
    assert (columns - 3 + 0.5 + 0.27) * spacing == pytest.approx(0.1)
    assert columns * spacing == pytest.approx(outer)
    assert spacing == pytest.approx(3 * 0.01 / 4, rel=0.04)  # whole columns
