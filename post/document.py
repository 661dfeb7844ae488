# SPDX-License-Identifier: MIT
"""A page made of headings, texts, tables and pictures, written as HTML and as Markdown."""

from __future__ import annotations

import multiprocessing
import os
import textwrap
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from html import escape
from pathlib import Path

from PIL import Image

from post.errors import PostError
from post.page import PAGE, html_picture, html_problems, html_table
from post.style import Picture
from post.tables import Table

COLUMNS = 118  # of prose in Markdown
COLOURS = 256  # of pictures beside Markdown pages, which are kept small


@dataclass(frozen=True)
class Heading:
    """A heading above a part of a page."""

    text: str


@dataclass(frozen=True)
class View:
    """What only a browser can show; a Markdown page leaves it out."""

    html: str


@dataclass
class Document:
    """A page: its blocks are headings, texts, tables, pictures and views, in their order."""

    title: str
    blocks: list[Heading | str | Table | Picture | View] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    def add(self, *blocks) -> None:
        """Put blocks at the end; those that are None or empty tables are left out."""
        self.blocks += [
            one for one in blocks if one and not (isinstance(one, Table) and not one.rows)
        ]

    def add_made(self, makers: list, workers: int | None = None) -> None:
        """Add blocks, and what functions among `makers` return, in order: a block, several or none.

        Functions run in `workers` processes (default: one for each core), so all that they change
        but files is lost. A PostError leaves its block out and is told above the page.
        """
        for blocks, problem in _make_all(makers, workers):
            self.add(*blocks)
            self.problems += [problem] if problem else []

    def replace_made(self, kind: type, maker, workers: int | None = None) -> None:
        """Put what `maker` makes of each block of a kind in its place, as in `add_made`."""
        places = [k for k, one in enumerate(self.blocks) if isinstance(one, kind)]
        made = _make_all([partial(maker, self.blocks[k]) for k in places], workers)
        for k, (blocks, problem) in reversed(list(zip(places, made, strict=True))):
            self.blocks[k : k + 1] = blocks
            self.problems += [problem] if problem else []

    def shrink_pictures(self) -> None:
        """Write the pictures anew with fewer colours: a quarter of the size."""
        for one in self.blocks:
            if isinstance(one, Picture):
                write_small(one.path, one.path)

    def html(self) -> str:
        """The page, which needs no other file."""
        parts = [html_problems(self.problems), *map(_as_html, self.blocks)]
        return PAGE.format(title=escape(self.title), body="\n".join(parts))

    def markdown(self, page: Path, pictures: Path) -> str:
        """The page as Markdown; its pictures are written into a folder, with fewer colours."""
        pictures.mkdir(parents=True, exist_ok=True)
        parts = [f"# {self.title}"]
        for text in self.problems:
            parts.append(_wrapped(f"Please note: {text}"))
        for one in self.blocks:
            if isinstance(one, Picture):
                target = pictures / one.path.name
                write_small(one.path, target)
                link = Path(os.path.relpath(target, page.parent)).as_posix()
                parts += [f"![{one.title}]({link})", f"{_wrapped(one.caption)}"]
            elif not isinstance(one, View):
                parts.append(_as_markdown(one))
        return "\n\n".join(parts) + "\n"


_makers: list = []  # of the call that goes on: processes inherit them


def _make_all(makers: list, workers: int | None) -> list[tuple[list, str]]:
    _makers[:] = makers
    try:
        return side_by_side(_make, range(len(makers)), workers)
    finally:
        _makers.clear()


def side_by_side(function, values, workers: int | None = None) -> list:
    """What a function of a module makes of each value, in order; values and results are pickled.

    It runs in `workers` processes (default: one for each core), for which this one is copied.
    """
    values = list(values)
    workers = min(workers or len(os.sched_getaffinity(0)), len(values))
    if workers < 2:
        return [function(value) for value in values]
    context = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        return list(pool.map(function, values))


def _make(number: int) -> tuple[list, str]:
    """Blocks of one maker, and what went wrong."""
    try:
        made = _makers[number]() if callable(_makers[number]) else _makers[number]
    except PostError as error:
        return [], str(error)
    return (list(made) if isinstance(made, list | tuple) else [made]), ""


def write_small(path: Path, target: Path) -> None:
    """A picture with few colours, the rare ones of scales and curves among them."""
    with Image.open(path) as image:
        few = image.convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=0)
        few.save(target, optimize=True)


def _as_html(one) -> str:
    if isinstance(one, Heading):
        return f'<h1 style="margin-top:2.2em">{escape(one.text)}</h1>'
    if isinstance(one, Table):
        return html_table(one)
    if isinstance(one, Picture):
        return html_picture(one)
    return one.html if isinstance(one, View) else f"<p>{escape(one)}</p>"


def _as_markdown(one) -> str:
    if isinstance(one, Heading):
        return f"## {one.text}"
    if isinstance(one, str):
        return _wrapped(one)
    rows = [_row(one.heads), _row(("---",) * len(one.heads)), *map(_row, one.rows)]
    parts = [f"### {one.title}", "\n".join(rows), *([_wrapped(one.note)] if one.note else [])]
    return "\n\n".join(parts)


def _row(cells: tuple[str, ...]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _wrapped(text: str) -> str:
    return textwrap.fill(text, COLUMNS, break_long_words=False, break_on_hyphens=False)
