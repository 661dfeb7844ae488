# SPDX-License-Identifier: MIT
"""Command line: `python -m post report OUTDIR`, `view OUTDIR`, `movie OUTDIR`,
`frame OUTDIR`, `hole OUTDIR`, `compare OUTDIR OUTDIR`, `paper OUTDIR`, `material FILE`.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from post.errors import USAGE, PostError
from post.reader import Frame, Run

VIEWS = ("blast", "bodies", "cut")


def main(arguments: list[str] | None = None) -> int:
    """Run a command; its exit code."""
    options = _parser().parse_args(arguments)
    try:
        return options.command(options)
    except PostError as error:
        print(f"post: {error}", file=sys.stderr)
        return error.code


def _name() -> str:
    """What the user has typed: the command that pip and `make install` put there, or the module."""
    name = Path(sys.argv[0]).name
    return name if name == "brisance-post" else "python -m post"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=_name(), description="Look at results of Brisance.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    report = commands.add_parser("report", help="pictures, tables and one HTML page of a run")
    report.set_defaults(command=_report)
    report.add_argument("folder", metavar="OUTDIR", help="folder that a run has written")
    report.add_argument(
        "--reference",
        metavar="FILE",
        help="values to compare with (default: <job>.reference.csv in OUTDIR, here or in inputs/)",
    )
    frame = commands.add_parser("frame", help="one picture of one time")
    frame.set_defaults(command=_frame)
    frame.add_argument("folder", metavar="OUTDIR", help="folder that a run has written")
    frame.add_argument(
        "--time", type=float, metavar="T", help="time [s]; the nearest dump is drawn"
    )
    frame.add_argument("--view", choices=VIEWS, help="what is drawn (default: what the run has)")
    frame.add_argument("--body", metavar="ID", help="map of a field on the faces of this body")
    frame.add_argument(
        "--face", metavar="FACE", help="x-, x+, y-, y+, z- or z+ (default: both of the thin side)"
    )
    frame.add_argument(
        "--field", metavar="NAME", default="damage", help="such as damage, stress:xx, velocity:z"
    )
    view = commands.add_parser("view", help="a page that turns and plays in a browser")
    view.set_defaults(command=_view)
    view.add_argument("folder", metavar="OUTDIR", help="folder that a run has written")
    movie = commands.add_parser("movie", help="pressure and damage in a cut, dump after dump")
    movie.set_defaults(command=_movie)
    movie.add_argument("folder", metavar="OUTDIR", help="folder that a run has written")
    movie.add_argument("--out", metavar="FILE", help=".mp4 or .gif (default: movie.mp4 in OUTDIR)")
    movie.add_argument("--rate", type=float, default=6.0, metavar="N", help="dumps a second (6)")
    hole = commands.add_parser("hole", help="the holes in a plate that was hit")
    hole.set_defaults(command=_hole)
    hole.add_argument("folder", metavar="OUTDIR", help="folder that a run has written")
    hole.add_argument("--time", type=float, metavar="T", help="time [s] (default: the last dump)")
    hole.add_argument("--body", metavar="ID", help="a body that is a box (default: the widest)")
    compare = commands.add_parser("compare", help="several runs in one table, picture and page")
    compare.set_defaults(command=_compare)
    compare.add_argument("folders", metavar="OUTDIR", nargs="+", help="folders of runs")
    compare.add_argument(
        "--out",
        metavar="FOLDER",
        help="where the page is written (default: compare/ beside OUTDIR)",
    )
    compare.add_argument("--body", metavar="ID", help="whose faces (default: all damaged boxes)")
    compare.add_argument(
        "--time",
        type=float,
        metavar="T",
        help="time of the maps [s] (default: end of the shortest)",
    )
    paper = commands.add_parser("paper", help="the scenes of the paper beside its numbers")
    paper.set_defaults(command=_paper)
    paper.add_argument(
        "folders", metavar="OUT", nargs="+", help="folders of runs, or folders that hold some"
    )
    paper.add_argument(
        "--out", metavar="FOLDER", help="where paper.html and paper.md go (default: the first OUT)"
    )
    paper.add_argument("--markdown", metavar="FILE", help="another place for the Markdown page")
    questions = commands.add_parser("questions", help="what the paper leaves open, run by run")
    questions.set_defaults(command=_questions)
    questions.add_argument("folder", metavar="OUT", help="folder of the runs of the questions")
    questions.add_argument("--markdown", metavar="FILE", help="page (default: OUT/questions.md)")
    _add_study(commands)
    _add_certify(commands)
    material = commands.add_parser("material", help="curves of a table of `brisance mat`")
    material.set_defaults(command=_material)
    material.add_argument("files", metavar="FILE.csv", nargs="+", help="tables, to be compared")
    material.add_argument("--out", metavar="FILE.png", help="picture (default: FILE.png)")
    return parser


def _add_study(commands) -> None:
    """The command that runs a scene many times."""
    study = commands.add_parser("study", help="run a scene many times: designs, limits, diagrams")
    study.set_defaults(command=_study)
    study.add_argument("file", metavar="STUDY.toml", help="the study (docs/manual/study.md)")
    study.add_argument("--check", action="store_true", help="say what would run, run nothing")
    study.add_argument("--list", action="store_true", help="print one command a run")
    study.add_argument("--jobs", type=int, metavar="N", help="runs at once on cores")
    study.add_argument("--gpus", default="", metavar="all|0,1", help="GPUs that take long runs")
    study.add_argument("--out", metavar="FOLDER", help="default: out/study/NAME")
    study.add_argument("--stop-after", type=float, metavar="S", help="stop so many seconds later")
    study.add_argument("--retry-failed", action="store_true", help="run again what has failed")
    study.add_argument("--keep", action="store_true", help="keep dumps and checkpoints")
    study.add_argument("--brisance", metavar="FILE", help="the program")


def _add_certify(commands) -> None:
    """The command that gives the results of a scene error bars."""
    certify = commands.add_parser("certify", help="error bars of a scene by coarser partners")
    certify.set_defaults(command=_certify)
    certify.add_argument("deck", metavar="DECK", help="the scene")
    certify.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="of it")
    certify.add_argument("--out", metavar="FOLDER", help="default: out/certify/NAME")
    certify.add_argument("--fine", metavar="OUTDIR", help="a run of this deck that is there")
    certify.add_argument("--budget", default="25%", metavar="25%", help="extra cost of partners")
    certify.add_argument("--finer", action="store_true", help="run a finer partner as well")
    certify.add_argument("--hold", action="append", default=[], metavar="ID", help="keep a body")
    certify.add_argument("--results", default="", metavar="A,B", help="that shall be promised")
    certify.add_argument("--want", metavar="5%", help="error that is wanted")
    certify.add_argument("--ensemble", type=int, default=0, metavar="N", help="members by chance")
    certify.add_argument("--levels", type=int, choices=(3, 4), default=3, help="spacings")
    certify.add_argument("--jobs", type=int, default=1, metavar="N", help="runs at once")
    certify.add_argument("--backend", choices=("cpu", "gpu"), default="cpu")
    certify.add_argument("--check", action="store_true", help="say what would run, run nothing")
    certify.add_argument("--brisance", metavar="FILE", help="the program")


def _certify(options: argparse.Namespace) -> int:
    from post.certify import Options, certify  # noqa: PLC0415

    chosen = Options(
        Path(options.out) if options.out else None,
        tuple(options.set),
        _share(options.budget, "--budget"),
        options.finer,
        tuple(options.hold),
        tuple(name.strip() for name in options.results.split(",") if name.strip()),
        options.jobs,
        options.backend,
        Path(options.fine) if options.fine else None,
        _share(options.want, "--want") if options.want else math.nan,
        options.check,
        options.brisance,
        options.ensemble,
        options.levels,
    )
    return certify(options.deck, chosen)


def _share(text: str, flag: str) -> float:
    """'25%' or '0.25' as 0.25."""
    try:
        value = float(text.rstrip("% ")) * (0.01 if "%" in text else 1)
    except ValueError:
        value = math.nan
    if not 0 < value <= 10:
        raise PostError(f"{flag} {text}: must be a share such as 25%", USAGE)
    return value


def _study(options: argparse.Namespace) -> int:
    from post.study import Options, make_study  # noqa: PLC0415

    out = Path(options.out) if options.out else None
    after = math.inf if options.stop_after is None else options.stop_after
    chosen = Options(out, options.jobs, options.gpus, options.check, options.list, after,
                     options.retry_failed, options.keep, options.brisance)  # fmt: skip
    return make_study(options.file, chosen)[1]


def _report(options: argparse.Namespace) -> int:
    from post.report import make_report  # noqa: PLC0415 (slow to load)

    run = Run(options.folder)
    page, text = make_report(run, options.reference)
    print(text)
    print(f"report: {page}")
    return run.exit_code


def _view(options: argparse.Namespace) -> int:
    from post.view import make_view  # noqa: PLC0415

    run = Run(options.folder)
    run.leave_out_damaged()
    page = run.folder / "view.html"
    page.write_text(make_view(run), encoding="utf-8")
    print(f"view: {page} ({page.stat().st_size / 1e6:.1f} MB)")
    return run.exit_code


def _movie(options: argparse.Namespace) -> int:
    from post.movie import make_movie  # noqa: PLC0415

    if not 0 < options.rate <= 60 or (options.out or ".mp4")[-4:] not in (".mp4", ".gif"):
        raise PostError(
            "movie: --rate is 0 to 60 dumps a second, --out ends in .mp4 or .gif", USAGE
        )
    run = Run(options.folder)
    run.leave_out_damaged()
    path = make_movie(run, options.out and Path(options.out), options.rate)
    print(f"movie: {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return run.exit_code


def _compare(options: argparse.Namespace) -> int:
    from post.comparison import make_comparison  # noqa: PLC0415

    if len(options.folders) < 2:
        raise PostError("compare: name two folders of runs or more", USAGE)
    runs = [Run(folder) for folder in options.folders]
    out = Path(options.out) if options.out else runs[0].folder.parent / "compare"
    page, text = make_comparison(runs, out, options.body, options.time)
    print(text)
    print(f"comparison: {page}")
    codes = [run.exit_code for run in runs]
    return next((code for code in codes if code), 0)


def _paper(options: argparse.Namespace) -> int:
    from post.paper import make_paper_page  # noqa: PLC0415

    folders = [Path(folder) for folder in options.folders]
    out = Path(options.out) if options.out else folders[0]
    page, runs = make_paper_page(folders, out, options.markdown and Path(options.markdown))
    print(f"paper: {page} ({page.stat().st_size / 1e6:.1f} MB), {len(runs)} runs")
    return next((run.exit_code for run in runs if run.exit_code), 0)


def _questions(options: argparse.Namespace) -> int:
    from post.questions import make_questions_page  # noqa: PLC0415

    folder = Path(options.folder)
    page = Path(options.markdown) if options.markdown else folder / "questions.md"
    print(f"questions: {page}, {make_questions_page(folder, page)} runs")
    return 0


def _material(options: argparse.Namespace) -> int:
    from post.material import draw_material  # noqa: PLC0415

    out = Path(options.out) if options.out else None
    print(draw_material([Path(file) for file in options.files], out))
    return 0


def _frame(options: argparse.Namespace) -> int:
    from post.scene import draw_blast, draw_bodies  # noqa: PLC0415
    from post.section import draw_sheet  # noqa: PLC0415

    run = Run(options.folder)
    if options.body is not None:
        return _faces(run, options)
    if options.face is not None:
        raise PostError("--face: name the body too (--body ID)", USAGE)
    frame = _frame_of(run, options.time)
    view = options.view or _first_view(run)
    draw = {"blast": draw_blast, "bodies": draw_bodies, "cut": draw_sheet}[view]
    folder = Path(options.folder) / "report"
    folder.mkdir(exist_ok=True)
    picture = draw(run, folder, frame)
    print(f"{picture.path}: {picture.caption}")
    return 0


def _first_view(run: Run) -> str:
    """The blast in three dimensions, a cut in fewer, bodies without air."""
    frame = next((frame for frame in run.frames if frame.air_path), None)
    if frame is None:
        return "bodies" if run.frames else "cut"
    return "cut" if min(frame.air("pressure").cells) == 1 else "blast"


def _faces(run: Run, options: argparse.Namespace) -> int:
    """A field on one face of a body, or on the two across its thinnest side."""
    from post.face import draw_faces, face_map, thin_faces  # noqa: PLC0415

    frame = _solid_frame(run, options)
    faces = (options.face,) if options.face else thin_faces(run, options.body)
    maps = [face_map(run, frame, options.body, face, options.field) for face in faces]
    folder = Path(options.folder) / "report"
    folder.mkdir(exist_ok=True)
    end = f"_{options.face}" if options.face else ""
    name = f"face_{options.body}{end}_{options.field.replace(':', '_')}.png"
    picture = draw_faces(maps, folder / name)
    print(f"{picture.path}: {picture.caption}")
    return 0


def _solid_frame(run: Run, options: argparse.Namespace) -> Frame:
    """The dump of the solid nearest to --time, or the last one."""
    frames = [frame for frame in run.frames if frame.solid_path]
    if not frames:
        raise PostError(f"{options.folder}: there are no dumps of the solid")
    return _frame_of(run, options.time) or frames[-1]


def _hole(options: argparse.Namespace) -> int:
    from post.hole_picture import draw_perforation, hole_table  # noqa: PLC0415
    from post.perforation import load_plate, measure_perforation  # noqa: PLC0415
    from post.report import as_text  # noqa: PLC0415

    run = Run(options.folder)
    frame = _solid_frame(run, options)
    found = measure_perforation(load_plate(run, frame, options.body))
    print(as_text(hole_table(found)))
    folder = Path(options.folder) / "report"
    folder.mkdir(exist_ok=True)
    for picture in draw_perforation(found, folder):
        print(f"{picture.path}: {picture.caption}")
    return 0


def _frame_of(run: Run, time: float | None) -> Frame | None:
    """The frame nearest to the time that was asked for; None if none was."""
    if time is None:
        return None
    if not 0 <= time <= run.end * (1 + 1e-6):
        raise PostError(f"--time {time:g}: the run covers 0 to {run.end:g} s", USAGE)
    return run.frame_at(time)


if __name__ == "__main__":
    sys.exit(main())
