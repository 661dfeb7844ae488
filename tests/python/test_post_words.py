# SPDX-License-Identifier: MIT
"""Words and units of the report: rounding is 0, loads are no air, layers of steel are no plies."""

import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from test_perforation import DECK, Made  # noqa: E402
from test_post_pictures import write_scene  # noqa: E402

from post.balance import balance_table, body_table, totals_table  # noqa: E402
from post.deck import Deck  # noqa: E402
from post.deflection import displacement_table  # noqa: E402
from post.history import read_history  # noqa: E402
from post.hole_picture import hole_table  # noqa: E402
from post.perforation import load_plate, measure_perforation  # noqa: E402
from post.reader import Run  # noqa: E402
from post.style import new_figure, plt, pressure_bar, pressure_colours  # noqa: E402
from post.tables import as_text  # noqa: E402
from post.units import show, show_point  # noqa: E402


def test_rounding_is_nothing():
    assert (show(1.95e-310, "-"), show(8.33e-17, "m"), show(-1e-16, "m/s")) == ("0", "0 m", "0 m/s")
    assert (show(8.3e-8, "m"), show(2e-12, "J")) == ("83.0 nm", "0.00200 nJ")


def test_lengths_have_the_unit_of_their_scene():
    assert show_point(np.array([0, 0.0125, 0.4])) == "(0, 12.5, 400) mm"
    assert show_point(np.array([0, 16.0, 0.4])) == "(0, 16, 0.4) m"


@pytest.mark.parametrize(("top", "unit"), [(2.5e5, "kPa"), (2.5e6, "MPa")])
def test_pressures_have_the_unit_of_their_range(top, unit):
    figure, axis = new_figure()
    bar = pressure_bar(figure, pressure_colours(101325.0, top), axis)
    assert bar.ax.get_ylabel() == f"pressure [{unit}]"
    plt.close(figure)


def test_columns_of_older_versions_have_their_present_names(tmp_path):
    path = tmp_path / "energy.csv"
    path.write_text("time[s],air_mass[kg],held_cells[-]\n0,1,2\n")
    history = read_history(path)
    names = ["time", "air_mass", "limited_cells"]
    assert history.names == names
    assert [history[name][0] for name in names] == [0, 1, 2]


def write_histories(run, air):
    """Energies of a body that a load or the air has moved."""
    if air:
        deck = run.folder / "scene.echo.nml"
        deck.write_text(deck.read_text() + "&air box = 0, 1, 0, 1, 0, 1, cells = 4, 4, 4 /\n")
    columns = ("time[s]", "solid_kinetic[J]", "load_work[J]", "mass_error[-]", "momentum_error[-]",
               "air_internal[J]", "coupling[J]")  # fmt: skip
    rows = ["0,0,0,0,0,0,0", "1e-4,1,1,0,0,0,0"]
    (run.folder / "energy.csv").write_text("\n".join([",".join(columns), *rows]) + "\n")
    names = "time[s],slab:load_work[J],slab:damage_mean[-]"
    (run.folder / "bodies.csv").write_text(names + "\n0,0,0\n1e-4,1,1.95e-310\n")
    return Run(run.folder)


def test_a_scene_without_air_has_loads(tmp_path):
    for air in (False, True):
        run = write_histories(write_scene(tmp_path / str(air)), air)
        text = "".join(as_text(f(run)) for f in (balance_table, totals_table, body_table))
        note = balance_table(run).note
        for words in ("mass of the air", "work of the air on the bodies", "first order"):
            assert (words in text) == air
        assert ("work of the loads on the bodies" in text) == (not air)
        assert ("work of the air" in note) == air and "e-310" not in text


def test_steel_has_no_fibres(tmp_path, monkeypatch):
    """A plate of metal beside one of plies, whose fields all particles have."""
    made = Made()
    made.fling(made.within(3e-3))
    made.broken |= made.within(4e-3)
    plies = as_text(hole_table(made.measure(tmp_path / "plies")))
    assert "broken fibres away too" in plies and "in the widest ply" in plies
    monkeypatch.setattr("test_perforation.DECK", DECK.replace("orthotropic_ply", "johnson_cook"))
    run = made.run(tmp_path / "steel")
    plate = load_plate(run, run.frames[-1])
    found = measure_perforation(plate)
    steel = as_text(hole_table(found))
    assert "fibre" not in steel and "ply" not in steel
    assert "failed particles away too" in steel and "in the widest layer" in steel
    assert found.widest.through.pushed.diameter > 7.5e-3 > found.widest.through.seen.diameter


def test_a_point_with_a_gauge_is_given_once(tmp_path):
    """The middle of a plate by its dumps is left out where a gauge records it along the normal."""
    run = write_scene(tmp_path, times=(5e-5, 1e-4), rise=10.0)
    gauge = "&gauge id = '{id}', body = 'slab', at = {at}, quantity = 'displacement_{axis}' /\n"
    heads = [row[0] for row in displacement_table(run).rows]
    assert "slab, middle" in heads and "slab, farthest" in heads
    cases = ("0, 0, 0.03", "z", False), ("0, 0, 0", "x", True), ("0.1, 0, 0", "z", True)
    for at, axis, given in cases:
        run.deck = Deck(run.deck.text.split("&gauge")[0] + gauge.format(id="mid", at=at, axis=axis))
        text = f"time[s],mid:displacement_{axis}[m]\n0,0\n1e-4,1e-3\n"
        (tmp_path / "gauges.csv").write_text(text)
        again = Run(tmp_path)
        again.deck = run.deck
        heads = [row[0] for row in displacement_table(again).rows]
        assert f"mid ({axis})" in heads and ("slab, middle" in heads) == given
