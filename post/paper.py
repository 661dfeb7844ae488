# SPDX-License-Identifier: MIT
"""The scenes of the paper as one page: `python -m post paper OUT ...`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from post.comparison import crack_table
from post.document import Document, Heading, View, side_by_side
from post.errors import USAGE, PostError
from post.fragments import find_fragments, fragment_table
from post.hole_picture import draw_perforation, hole_table
from post.overlay import damaged_bodies, draw_face_comparison
from post.paper_measures import Printed, hole_of, impact, printed_numbers
from post.paper_pictures import (
    draw_curves,
    draw_fragment_speeds,
    draw_material_energies,
    draw_slab_energy,
    draw_story,
    draw_stress,
    gauge_curves,
    label_of,
    levels_of,
    reflected_level,
)
from post.paper_tables import (
    CASES,
    difference_table,
    doubt_table,
    numbers_table,
    runs_table,
    smaller,
)
from post.reader import Run
from post.style import Picture
from post.tables import Table
from post.units import show
from post.view import IN_REPORT, framed, make_view

TITLES = {
    "3.1.1": "3.1.1: an aluminium sphere through a CFRP plate at 4960 m/s",
    "3.1.2": "3.1.2: a CFRP plate under the blast of 168 g of TNT",
    "3.2.1": "3.2.1: four slabs under the blast of 0.2 kg of TNT",
    "3.2.2": "3.2.2: blast and fragments on a slab",
}
LARGEST = 19e6  # bytes of a page; what text and pictures leave is shared out among the views
ESCAPED = 20e3  # bytes by which a view grows inside another page
MAPS = (2e-4, 3e-4, 4.2e-4)  # [s] of the stress in the plate
SLAB_MAPS = (2e-4, 4e-4, 1.2e-3)


@dataclass(frozen=True)
class ViewOf(View):
    """Where the view of a case comes, once it is known how much room is left."""

    case: str = ""


@dataclass(frozen=True)
class Campaign:
    """The runs of a page by case, from coarse to fine."""

    runs: dict[str, list[Run]]  # incomplete ones first
    folder: Path  # of the pictures

    def finest(self, *cases: str) -> list[Run]:
        """The finest run of each of some cases that were run."""
        return [self.runs[case][-1] for case in cases if self.runs.get(case)]

    def every(self, *cases: str) -> list[Run]:
        """All runs of some cases."""
        return [run for case in cases for run in self.runs.get(case, [])]


def make_paper_page(
    folders: list[Path], out: Path, markdown: Path | None = None
) -> tuple[Path, list[Run]]:
    """Write `paper.html` and `paper.md` into a folder, or the Markdown to a file of its own.

    A folder may be that of a run or hold such folders. Returns the page and the runs in it.
    PostError where there is no run of the paper at all.
    """
    runs, problems = find_runs(folders)
    if not runs:
        raise PostError("none of the folders holds a scene of inputs/paper", USAGE)
    pictures = out / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    campaign = Campaign(runs, pictures)
    document = Document("The scenes of Chen et al., beside their numbers", problems=problems)
    printed = printed_numbers()
    makers = [partial(_beginning, campaign)]
    for section, parts in PARTS.items():
        rows = [one for one in printed if one.section == section]
        makers += [Heading(TITLES[section]), partial(numbers_table, campaign, rows)]
        makers += parts(campaign, rows)
    document.add_made(makers)
    document.shrink_pictures()
    wanted = sum(isinstance(one, ViewOf) for one in document.blocks)
    rest = len(document.html().encode())
    room = min(IN_REPORT, (LARGEST - rest) / max(wanted, 1))
    document.replace_made(ViewOf, partial(_view, campaign, room))
    page = out / "paper.html"
    page.write_text(document.html(), encoding="utf-8")
    target = markdown or out / "paper.md"
    images = target.parent / "figures" / target.stem
    target.write_text(document.markdown(target, images), encoding="utf-8")
    return page, campaign.every(*CASES)


def find_runs(folders: list[Path]) -> tuple[dict[str, list[Run]], list[str]]:
    """Runs of the paper by case, from coarse to fine, incomplete ones first; and what could not be
    used. Every dump is looked at, one process for a run.
    """
    places = []
    for folder in folders:
        if not folder.is_dir():
            raise PostError(f"{folder}: there is no such folder", USAGE)
        inside = sorted(path.parent for path in folder.glob("*/energy.csv"))
        places += [folder] if (folder / "energy.csv").is_file() else inside
    found: dict[str, list[Run]] = {}
    problems = []
    for run, problem in side_by_side(_sound_run, places):
        problems += [problem] if problem else []
        if run:
            found.setdefault(run.job, []).append(run)
            problems += [f"{run.folder.name}: {text}" for text in run.problems]
    for runs in found.values():
        runs.sort(key=lambda run: (not smaller(run), -min(b.spacing for b in run.deck.bodies())))
    return found, problems


def _sound_run(place: Path) -> tuple[Run | None, str]:
    """A run of the paper without its damaged dumps, or why it cannot be used."""
    try:
        run = Run(place)
        run.leave_out_damaged()
    except PostError as error:
        return None, str(error)
    if run.job not in CASES:
        return None, f"{place}: '{run.job}' is no scene of inputs/paper; left out"
    return run, ""


def _beginning(campaign: Campaign) -> list:
    missing = [case for case in CASES if case not in campaign.runs]
    return [
        "Ours beside what the paper prints. Every row says with which particles and air cells it "
        "was made; the deck of a case is inputs/paper/<case>.nml. The paper's numbers stand in "
        "post/data/paper.csv with the table or figure they come from. This page is written by "
        "`python -m post paper`, nothing in it by hand.",
        View(
            '<p class="note">Pictures have 256 colours. The views show particles on surfaces, as '
            f"many as fit into {LARGEST / 1e6:.0f} MB for the whole page, chosen at random; each "
            "says how many of how many.</p>"
        ),
        "Not run: " + ", ".join(missing) + "." if missing else "",
        runs_table(campaign),
        difference_table(campaign),
        doubt_table(campaign),
    ]


# --- the sections: what makes their blocks, in order ----------------------------------------------

Makers = Iterator[Callable | str | View]


def _impact(campaign: Campaign, printed: list[Printed]) -> Makers:
    for run in campaign.finest("hvi"):
        yield partial(_hole, run, campaign.folder)
        yield partial(draw_story, run, campaign.folder, "hvi_debris", "Plate and debris in a cut")
        for body in ("ball", "plate"):
            yield partial(_pieces, run, body)
        path = campaign.folder / "hvi_energy.png"
        yield partial(draw_material_energies, [run], path, "Energy of sphere and plate")
    yield from _views(campaign, "hvi")


def _hole(run: Run, folder: Path) -> list[Table | Picture]:
    found = hole_of(run.folder)
    return [hole_table(found), *draw_perforation(found, folder)]


def _pieces(run: Run, body: str) -> Table | None:
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    try:
        return fragment_table(find_fragments(run, frame, body), f"{body}, {label_of(run)}")
    except (PostError, AttributeError):
        return None


def _plate(campaign: Campaign, printed: list[Printed]) -> Makers:
    yield partial(_histories, campaign, campaign.every("plate"), printed, "plate")
    for run in campaign.finest("plate"):
        yield partial(draw_stress, run, "plate", MAPS, campaign.folder / "plate_stress.png")
        path = campaign.folder / "plate_energy.png"
        yield partial(draw_material_energies, [run], path, "Energy of the plate")
    yield from _damage(campaign, campaign.finest("plate"))
    yield from _views(campaign, "plate")


def _histories(campaign: Campaign, runs: list[Run], printed: list[Printed], name: str):
    ambient = runs[0].deck.ambient if runs else 0.0
    pressures = gauge_curves(runs, "A:pressure", ambient)
    away = -1.0 if name == "plate" else 1.0  # from the charge
    moves = ("displacement_peak", "displacement_late")
    speeds = ("velocity_peak",)
    panels = [
        ("Overpressure at A", "Pa", pressures,
         levels_of(printed, ("peak",)) + reflected_level(runs)),
        ("Displacement of the middle, away from the charge", "m",
         gauge_curves(runs, "mid:displacement_z", factor=away), levels_of(printed, moves)),
        ("Velocity of the middle, away from the charge", "m/s",
         gauge_curves(runs, "mid_v:velocity_z", factor=away), levels_of(printed, speeds)),
    ]  # fmt: skip
    return draw_curves(panels, campaign.folder / f"{name}_histories.png", "Load and motion")


def _slabs(campaign: Campaign, printed: list[Printed]) -> Makers:
    names = ("slab_1", "slab_2", "slab_3", "slab_4")
    runs = campaign.finest(*names)
    yield partial(_histories, campaign, runs, printed, "slabs")
    path = campaign.folder / "slabs_energy.png"
    yield partial(draw_material_energies, runs, path, "Energies by material, four scenarios")
    for run in campaign.finest("slab_2"):
        place = campaign.folder / "slab_2_stress.png"
        yield partial(draw_stress, run, "concrete", SLAB_MAPS, place)
        yield partial(draw_story, run, campaign.folder, "slab_2_story", "Scenario 2 in a cut")
    yield from _damage(campaign, runs)
    yield from _views(campaign, *names)


def _damage(campaign: Campaign, runs: list[Run]) -> Makers:
    """Damage of both faces of each damaged body, and cracks counted."""
    for body in damaged_bodies(runs) if runs else ():
        yield partial(_damage_map, runs, body, campaign.folder)


def _damage_map(runs: list[Run], body: str, folder: Path) -> list[Picture | Table]:
    names = [label_of(run) for run in runs]
    jobs = "_".join(dict.fromkeys(run.job for run in runs))
    place = folder / f"{jobs}_{body}"
    place.mkdir(exist_ok=True)
    path = folder / f"{jobs}_{body}.png"
    try:
        picture = draw_face_comparison(runs, names, body, place)
        picture.path.replace(path)
        cracks = crack_table(runs, names, body)
    except PostError as error:
        raise PostError(f"no damage map of {body}: {error}") from error
    return [Picture(path, f"Damage of {body}", picture.caption), cracks]


def _fragments(campaign: Campaign, printed: list[Printed]) -> Makers:
    names = ("fragments", "fragments_460")
    runs = campaign.finest(*names)
    levels = levels_of(printed, ("exit_speed",), "fragments_460")
    yield partial(draw_fragment_speeds, runs, campaign.folder / "fragments_speed.png", levels)
    yield partial(fragments_table, campaign)
    beside = campaign.finest("slab_2", *names)
    if runs and len(beside) > 1:
        yield "Blast alone (slab_2) beside blast with fragments: the same slab, charge and time."
        yield partial(_histories, campaign, beside, [], "beside")
        yield partial(draw_slab_energy, beside, campaign.folder / "beside_energy.png")
        yield from _damage(campaign, beside)
    path = campaign.folder / "fragments_energy.png"
    yield partial(draw_material_energies, runs, path, "Energies by material")
    for run in campaign.finest("fragments_460"):
        name = "fragments_460_story"
        yield partial(draw_story, run, campaign.folder, name, "Fragments in a cut")
        for body in ("cfrp", "concrete"):
            yield partial(_pieces, run, body)
    yield from _views(campaign, *names)


def fragments_table(campaign: Campaign) -> Table:
    """When the fragments hit, and how fast they are."""
    rows = []
    for run in campaign.every("fragments", "fragments_460"):
        for body in ("f0", "f1"):
            if f"{body}_v:velocity_z" not in run.gauges:
                continue
            time, top = impact(run, f"{body}_v")
            speed = run.gauges[f"{body}_v:velocity_z"]
            last = show(float(speed[-1]), "m/s")
            rows.append((label_of(run), body, show(top, "m/s"), show(time, "s"), last))
    note = (
        "f0 is on the axis, f1 one of the four around it. It hits when it has lost 5 % of its "
        "largest speed along z."
    )
    heads = ("run", "fragment", "largest speed before it hits", "hits at", "at the end")
    return Table("Fragments", heads, rows, note)


def _views(campaign: Campaign, *cases: str) -> Makers:
    """The finest run of each case, to turn and play: a place for it."""
    yield from (ViewOf("", case) for case in cases if campaign.runs.get(case))


def _view(campaign: Campaign, room: float, place: ViewOf) -> View:
    """The view of the finest run of a case, in so many bytes."""
    (run,) = campaign.finest(place.case)
    frame = len(framed("")) + ESCAPED
    try:
        return View(framed(make_view(run, room - frame), label_of(run)))
    except PostError as error:
        raise PostError(f"no view of {run.job}: {error}") from error


PARTS: dict[str, Callable[[Campaign, list[Printed]], Makers]] = {
    "3.1.1": _impact,
    "3.1.2": _plate,
    "3.2.1": _slabs,
    "3.2.2": _fragments,
}
