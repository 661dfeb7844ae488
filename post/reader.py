# SPDX-License-Identifier: MIT
"""The one reader of what a run leaves in its folder: deck, histories and dumps.

`run = Run("out/demo")`, then

- `run.gauges["A:pressure"]` in Pa, one value per time of `run.gauges.time`;
- `run.frames[-1].air().field["pressure"]`, [nz, ny, nx];
- `run.frames[-1].solid().field["damage"]`, [n];
- `run.problems`: what is not as it should be, as sentences.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

from post.deck import Deck
from post.errors import INPUT_OUTPUT, NUMERICAL, USAGE, DamagedError, PostError
from post.history import History, read_history
from post.soundness import not_finite_in, zeros_in

SCHEMA = 1  # newest layout of the HDF5 files that this reader knows
SEEN = {"air": ("pressure",), "solid": ("displacement", "damage")}  # what pictures need
HISTORIES = ("energy", "gauges", "bodies")


@dataclass(frozen=True)
class AirGrid:
    """The air at one time. Arrays are [nz, ny, nx], vectors [nz, ny, nx, 3], one value per cell."""

    time: float  # [s]
    low: np.ndarray  # (3) lower corner [m]
    spacing: np.ndarray  # (3) sides of a cell [m]
    cells: np.ndarray  # (3) number of cells along x, y, z
    field: dict[str, np.ndarray]

    def centres(self, axis: int) -> np.ndarray:
        """Coordinates of the cell centres along an axis [m]."""
        return self.low[axis] + (np.arange(self.cells[axis]) + 0.5) * self.spacing[axis]


@dataclass(frozen=True)
class Particles:
    """The solid at one time: points (n, 3) [m], fields (n) or (n, components)."""

    time: float  # [s]
    points: np.ndarray
    field: dict[str, np.ndarray]

    @property
    def known(self) -> np.ndarray:
        """Whether places and displacements, if they were read, are finite, shape (n)."""
        known = np.isfinite(self.points).all(axis=1)
        if "displacement" in self.field:
            known &= np.isfinite(self.field["displacement"]).all(axis=1)
        return known


@dataclass(frozen=True)
class Frame:
    """The dumps of one time; a path is None where the scene has no air or no solid."""

    number: int
    time: float  # [s]
    air_path: Path | None
    solid_path: Path | None

    def air(self, *names: str) -> AirGrid:
        """The air with the named fields, or with all. PostError if it cannot be read."""
        with _open(self.air_path, "air") as file:
            root = file["VTKHDF"]
            extent = np.asarray(root.attrs["WholeExtent"])
            points = extent[1::2] - extent[0::2]
            spacing = np.asarray(root.attrs["Spacing"], float)
            low = np.asarray(root.attrs["Origin"], float) - 0.5 * spacing * (points == 0)
            field = _fields(root, "CellData", names, self.air_path)
        cells = np.maximum(points, 1)
        return AirGrid(self.time, low, spacing, cells, field)

    def solid(self, *names: str, lacking: bool = False) -> Particles:
        """The particles with the named fields, or with all. PostError if it cannot be read.

        With `lacking`, names that the dump does not have are left out.
        """
        with _open(self.solid_path, "solid") as file:
            root = file["VTKHDF"]
            points = root["Points"][()].astype(float)
            if lacking:
                names = tuple(name for name in names if name in root["PointData"])
            field = _fields(root, "PointData", names, self.solid_path)
        return Particles(self.time, points, field)

    def field_data(self, *names: str) -> dict[str, np.ndarray] | None:
        """Data of the whole dump of the solid, text as `str`; None where one is not there."""
        with _open(self.solid_path, "solid") as file:
            group = file["VTKHDF/FieldData"]
            if any(name not in group for name in names):
                return None
            text = {k: h5py.check_string_dtype(group[k].dtype) for k in names}
            return {k: (group[k].asstr() if text[k] else group[k])[()] for k in names}

    def unit_of(self, kind: str, name: str) -> str:
        """Unit of a field of the dump 'air' or 'solid', '-' where the dump does not say."""
        path, place = (
            (self.air_path, "CellData") if kind == "air" else (self.solid_path, "PointData")
        )
        with _open(path, kind) as file:
            unit = file["VTKHDF"][place][name].attrs.get("units", b"-")
        return unit.decode() if isinstance(unit, bytes) else str(unit)

    def mesh(self, kind: str):
        """The dump 'air' or 'solid' as pyvista reads it."""
        import pyvista  # noqa: PLC0415 (takes a second, and only pictures need it)

        path = self.air_path if kind == "air" else self.solid_path
        if path is None:
            raise PostError(f"frame {self.number} has no dump of the {kind}")
        with _open(path, kind):
            return pyvista.read(path)


class Run:
    """The output folder of a run."""

    def __init__(self, folder: str | Path):
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise PostError(f"{self.folder}: there is no such folder", USAGE)
        self._history: dict[str, History] = {}
        for name in HISTORIES:
            path = self.folder / f"{name}.csv"
            if path.is_file():
                self._history[name] = read_history(path)
        self.frames = _list_frames(self.folder)
        if not self._history and not self.frames:
            raise PostError(f"{self.folder}: holds no results of a run (no dumps, no histories)")
        self.damaged: list[str] = []  # dumps that were left out, one sentence for each
        self._wild: list[str] = []
        self._notes: list[str] = []
        self.about = self._read_about()
        self.deck = self._read_deck()
        self.job = str(self.about.get("job") or self._echo_name() or self.folder.name)

    def history(self, name: str) -> History | None:
        """History 'energy', 'gauges' or 'bodies'; None where the run has not written it."""
        return self._history.get(name)

    @property
    def energy(self) -> History:
        """Totals of energy, mass and momentum."""
        return self._needed("energy")

    @property
    def gauges(self) -> History:
        """Histories of the gauges."""
        return self._needed("gauges")

    @property
    def bodies(self) -> History:
        """Totals of each body."""
        return self._needed("bodies")

    @property
    def end(self) -> float:
        """Last time of which there are results [s]."""
        times = [h.time[-1] for h in self._history.values() if len(h)]
        times += [frame.time for frame in self.frames]
        return float(max(times, default=0.0))

    def frame_at(self, time: float) -> Frame:
        """The frame nearest to a time [s]. PostError without frames."""
        if not self.frames:
            raise PostError(f"{self.folder}: there are no dumps")
        return min(self.frames, key=lambda frame: abs(frame.time - time))

    @cached_property
    def not_finite(self) -> list[str]:
        """Values that are not finite, one sentence per history column or dump field."""
        found = []
        for history in self._history.values():
            for name in history.names:
                bad = ~np.isfinite(history[name])
                if bad.any():
                    when = history.time[np.argmax(bad)]
                    found.append(f"{history.path.name}: '{name}' is not finite at t = {when:g} s")
        if self.frames:
            found += not_finite_in(self.frames[-1])
        return list(dict.fromkeys(found + self._wild))

    @cached_property
    def problems(self) -> list[str]:
        """What is not as it should be, as sentences for the user."""
        found = self.not_finite + self.damaged + self._notes
        for name in HISTORIES:
            if name not in self._history and name in self._expected():
                found.append(f"{name}.csv is missing")
            elif name in self._history and not len(self._history[name]):
                found.append(f"{name}.csv has no rows yet")
        if not self.frames and not self.radial:
            found.append("there are no dumps, so nothing can be rendered")
        t_end = self.deck.get("run", "t_end")
        if t_end is not None and self.end < float(t_end) * (1 - 1e-6):
            found.append(f"the run ended at t = {self.end:g} s, before t_end = {float(t_end):g} s")
        return found

    @property
    def exit_code(self) -> int:
        """0, or the code of the worst thing that was found in the results."""
        return NUMERICAL if self.not_finite else INPUT_OUTPUT if self.damaged else 0

    def leave_out_damaged(self) -> None:
        """Look at every dump: those that cannot be read, or that hold zeros, are left out of
        `frames` and named in `damaged`; values that are not finite become problems.
        """
        sound = []
        for frame in self.frames:
            try:
                faults = zeros_in(frame)
                self._wild += not_finite_in(frame, SEEN)
            except DamagedError as error:
                faults = [str(error)]
            self.damaged += [f"{fault}; it is left out" for fault in faults]
            sound += [] if faults else [frame]
        self.frames = sound
        self.__dict__.pop("not_finite", None)  # found again when asked for
        self.__dict__.pop("problems", None)

    @property
    def radial(self) -> bool:
        """Whether it is a run along the radius of a charge: gauges and profiles alone."""
        return str(self.deck.get("air", "geometry", "cartesian")) != "cartesian"

    def _expected(self) -> set[str]:
        """Histories that a run with this deck writes."""
        if self.radial:
            return {"gauges"} if self.deck.groups("gauge") else set()
        expected = {"energy"}
        if self.deck.groups("gauge"):
            expected.add("gauges")
        if self.deck.groups("body"):
            expected.add("bodies")
        return expected

    def _needed(self, name: str) -> History:
        if name not in self._history:
            raise PostError(f"{self.folder / (name + '.csv')}: is missing")
        return self._history[name]

    def _echoes(self) -> list[Path]:
        return sorted(self.folder.glob("*.echo.nml"))

    def _echo_name(self) -> str:
        echoes = self._echoes()
        return echoes[0].name.removesuffix(".echo.nml") if len(echoes) == 1 else ""

    def _read_about(self) -> dict:
        """Attributes of the last dump that can be read: version, commit, deck, schema and so on."""
        for frame in reversed(self.frames):
            try:
                with _open(frame.solid_path or frame.air_path, "dump") as file:
                    return _about(file)
            except DamagedError as error:
                fault = error
        if self.frames:
            raise fault
        return {}

    def _read_deck(self) -> Deck:
        """The complete deck, from the echo of this run, or else from a dump."""
        echoes = self._echoes()
        own = self.folder / f"{self.about.get('job', '')}.echo.nml"
        if own in echoes:
            echoes = [own]
        if len(echoes) == 1:
            try:
                text = echoes[0].read_text(encoding="utf-8", errors="replace")
                return Deck(text, str(echoes[0]))
            except (OSError, PostError) as error:
                if not self.about.get("deck"):
                    raise PostError(f"{echoes[0]}: cannot be read: {error}", USAGE) from error
                self._notes.append(f"{echoes[0].name} cannot be read: the deck is that of a dump")
        if self.about.get("deck"):
            return Deck(self.about["deck"], "the deck in the dumps")
        if echoes:
            names = ", ".join(path.name for path in echoes)
            raise PostError(f"{self.folder}: holds more than one deck ({names})", USAGE)
        raise PostError(f"{self.folder}: the deck of the run (<job>.echo.nml) is missing")


def _list_frames(folder: Path) -> list[Frame]:
    """All dumps in the order of time, from the series files or else from the names."""
    air, solid = (_list_series(folder, kind) for kind in ("air", "solid"))
    frames = []
    for number in sorted(air.keys() | solid.keys()):
        a, s = air.get(number), solid.get(number)
        frames.append(Frame(number, (a or s)[1], a and a[0], s and s[0]))
    return sorted(frames, key=lambda frame: frame.time)


def _list_series(folder: Path, kind: str) -> dict[int, tuple[Path, float]]:
    """Number of a dump: (path, time [s])."""
    series = folder / f"{kind}.vtkhdf.series"
    found = {}
    if series.is_file():
        try:
            files = json.loads(series.read_text())["files"]
            entries = [(folder / item["name"], float(item["time"])) for item in files]
        except (ValueError, KeyError, TypeError) as error:
            raise PostError(f"{series}: is not a series file: {error}") from error
        for path, _ in entries:
            if not path.is_file():
                raise PostError(f"{series}: names {path.name}, which is missing")
    else:
        entries = [(path, None) for path in sorted(folder.glob(f"{kind}_*.vtkhdf"))]
    for place, (path, time) in enumerate(entries):
        digits = re.fullmatch(rf"{kind}_(\d+)\.vtkhdf", path.name)
        number = int(digits[1]) if digits else place
        found[number] = (path, _time_of(path, kind) if time is None else time)
    return found


def _time_of(path: Path, kind: str) -> float:
    with _open(path, kind) as file:
        return float(np.ravel(file["VTKHDF/FieldData/time"])[0])


@contextmanager
def _open(path: Path | None, kind: str) -> Iterator[h5py.File]:
    """Open a dump and check that it is one of ours; what is missing in it is a PostError."""
    if path is None:
        raise PostError(f"this run has no dumps of the {kind}")
    try:
        with h5py.File(path) as file:
            about = _about(file)
            if "VTKHDF" not in file or "schema" not in about:
                raise PostError(f"{path}: is not a dump of Brisance")
            if int(about["schema"]) > SCHEMA:
                raise PostError(
                    f"{path}: has layout {about['schema']}, this reader knows up to {SCHEMA}; use "
                    f"the post-processing of the version that wrote it ({about.get('version')})"
                )
            _check_parts(file, path)
            yield file
    except (KeyError, OSError) as error:
        raise DamagedError(f"{path}: is damaged or not HDF5: {error}") from error


def _check_parts(file: h5py.File, path: Path) -> None:
    """A dump of several processes names its parts; one that is missing would read as zeros."""
    parts = set()
    for item in file["VTKHDF"].get("CellData", {}).values():
        if item.is_virtual:
            parts |= {path.parent / source.file_name for source in item.virtual_sources()}
    for part in sorted(parts):
        if not part.is_file():
            raise PostError(f"{path}: its part {part.name} is missing; bring it back beside it")
        with h5py.File(part):
            pass


def _about(file: h5py.File) -> dict:
    """Attributes of the group /brisance as Python values."""
    if "brisance" not in file:
        return {}
    about = {}
    for key, value in file["brisance"].attrs.items():
        one = np.ravel(value)[0] if np.size(value) == 1 else value
        about[key] = one.decode("utf-8", "replace") if isinstance(one, bytes) else one
    return about


def _fields(root: h5py.Group, place: str, names: tuple, path: Path) -> dict[str, np.ndarray]:
    """The named fields of a dump, or all of them."""
    group = root[place]
    missing = [name for name in names if name not in group]
    if missing:
        raise PostError(f"{path}: has no field {', '.join(missing)}; it has {', '.join(group)}")
    return {name: group[name][()] for name in (names or group)}
