# SPDX-License-Identifier: MIT
"""Study files: TOML, read with the line of everything that is wrong.

docs/manual/study.md has all keys. A study is a deck, parameters that set its keys, and either a
design of points or a limit to be found.
"""

from __future__ import annotations

import difflib
import math
import re
import tomllib
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from post.designs import DESIGNS, LAWS, RANDOM, Design, Parameter, points_of
from post.ensemble import member_sets
from post.errors import USAGE, PostError
from post.expressions import evaluate
from post.results import OF_BODY
from post.runner import Job
from post.units import base_of, factor_of

KINDS = ("limit", "pi", "standoff_charge", "fragility")
SECTIONS = ("study", "parameter", "derived", "limit", "slots")
KEYS = {
    "study": (
        "deck",
        "design",
        "runs",
        "seed",
        "results",
        "title",
        "set",
        "surrogate",
        "certify",
        "repeat",
        "late",
        "start",
        "start_unit",
    ),
    "parameter": ("values", "from", "to", "count", "scale", "unit", "set", "preset", *LAWS),
    "limit": (
        "kind",
        "unknown",
        "low",
        "high",
        "unit",
        "result",
        "target",
        "target_unit",
        "tolerance",
        "event",
        "set",
        "along",
        "rising",
    ),
    "slots": ("jobs", "threads", "gpus", "share", "pack", "time_limit"),
}
PACK = 64  # members of a run on a GPU, see post/packing.py
MEMBER = "seed"  # name of the number of a member in points and tables
KEY = re.compile(r"\w+(\([^()]+\))?\.\w+")  # as --set takes it
PLACE = re.compile(r"\{([^{}]+)\}")
EVENT_SIGN = re.compile(r"[<>]")


@dataclass(frozen=True)
class Limit:
    """A limit that is searched: where a result meets a target, or where an event sets in."""

    kind: str
    unknown: Parameter
    low: float
    high: float
    result: str
    target: float  # in the unit of the result, SI
    tolerance: float
    event: str = ""  # 'RESULT > number'; empty where a number is met
    along: str = ""  # parameter along which the limit is drawn
    rising: bool = True  # the result grows with the unknown

    @property
    def measured(self) -> str:
        """The result that is looked at: that of the event where there is one."""
        return EVENT_SIGN.split(self.event)[0].strip() if self.event else self.result


@dataclass
class Study:
    """A study as it stands in its file."""

    path: Path
    deck: Path
    text: str  # of the deck
    title: str
    parameters: list[Parameter]
    design: Design
    derived: dict[str, str]
    results: list[str]
    limit: Limit | None = None
    fixed: tuple[str, ...] = ()  # overrides of every run
    surrogate: bool = True
    certify: bool = False  # one certificate at the middle of the ranges
    repeat: int = 1  # members a point, by a jitter of the particles
    late: tuple[str, ...] = ()  # keys of the deck that change only what comes after `start`
    start: float = 0.0  # to which all points are one run [s]
    slots: dict[str, Any] = field(default_factory=dict)
    lines: _Lines | None = None

    def points(self) -> list[dict]:
        """The points of the design, each as often as there are members; of a limit those at which
        it is searched.
        """
        points = points_of(self.parameters, self.design) if self.parameters else [{}]
        if self.repeat == 1:
            return points
        return [point | {MEMBER: k} for point in points for k in range(1, self.repeat + 1)]

    @property
    def pack(self) -> int:
        """Members that go in one run on a GPU: results of gauges and bodies alone are theirs."""
        wanted = [*self.results, *([self.limit.measured] if self.limit else [])]
        own = bool(wanted) and all(_of_members(name) for name in wanted)
        return int(self.slots.get("pack", PACK)) if own else 1

    @property
    def centre(self) -> dict:
        """The middle of all ranges; a limit of its bracket."""
        point = {one.name: one.middle for one in self.parameters}
        if self.limit is not None and self.limit.kind != "fragility":
            point[self.limit.unknown.name] = math.sqrt(self.limit.low * self.limit.high)
        return point

    def job(self, point: dict) -> Job:
        """The run of one point; with late keys it branches off that of the deck's own late keys,
        which all such points share.
        """
        if not self.late:
            return self.whole(point)
        first = self.whole(point, tuple(one.name for one in self.late_parameters()))
        ends = (f"run.t_end={self.start!r}", f"output.checkpoint_every={self.start!r}")
        begin = replace(first, sets=(*first.sets, *ends))
        return replace(self.whole(point), begin=begin)

    def late_parameters(self) -> list[Parameter]:
        """Parameters that set late keys alone."""
        unknown = [self.limit.unknown] if self.limit and self.limit.kind != "fragility" else []
        return [one for one in [*self.parameters, *unknown]
                if one.sets and all(key in self.late for key, _ in one.sets)]  # fmt: skip

    def whole(self, point: dict, left_out: tuple[str, ...] = ()) -> Job:
        """The run of one point from its start; parameters that are left out set no key."""
        names = dict(point)
        for name, formula in self.derived.items():
            names[name] = evaluate(formula, names, self.where("derived", name))
        line = self.where("study", "deck")

        def fill(match: re.Match) -> str:
            return _plain(evaluate(match[1], names, line))

        sets = list(self.fixed)
        unknown = [self.limit.unknown] if self.limit and self.limit.kind != "fragility" else []
        for one in [*self.parameters, *unknown]:
            if one.name in left_out:
                continue
            own = names | ({"x": names[one.name]} if one.name in names else {})
            where = self.where(f"parameter.{one.name}", "set")
            for key, formula in one.sets:
                texts = [_plain(evaluate(part, own, where)) for part in _parts(formula)]
                sets.append(f"{key}={','.join(texts)}")
        if MEMBER in point:
            sets += member_sets(point[MEMBER])
        return Job(PLACE.sub(fill, self.text), self.deck.parent, tuple(sets))

    def where(self, section: str, key: str = "") -> str:
        """File and line of a key, for messages."""
        return f"{self.path}:{self.lines.of(section, key) if self.lines else 1}"


class _Lines:
    """Lines at which sections and keys of a TOML file stand."""

    def __init__(self, text: str):
        self._found: dict[tuple[str, str], int] = {}
        section = ""
        for number, line in enumerate(text.splitlines(), 1):
            head = re.match(r"\s*\[([^\[\]]+)\]", line)
            key = re.match(r"\s*[\"']?([\w.-]+)[\"']?\s*=", line)
            if head:
                section = head[1].strip().replace('"', "")
                self._found.setdefault((section, ""), number)
                self._found.setdefault((section.split(".", 1)[0], ""), number)
            elif key:
                self._found.setdefault((section, key[1]), number)
                self._found.setdefault((f"{section}.{key[1]}", ""), number)

    def of(self, section: str, key: str = "") -> int:
        """The line of a key, else of its section, else of what holds it; 1 where none is found."""
        for place in ((section, key), (section, ""), (section.split(".", maxsplit=1)[0], "")):
            if place in self._found:
                return self._found[place]
        return 1


def read_study(path: str | Path) -> Study:
    """Read a study file. PostError, with file, line and remedy, for the first fault."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
        data = tomllib.loads(text)
    except OSError as error:
        raise PostError(f"{path}: cannot be read: {error.strerror}", USAGE) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        line = re.search(r"line (\d+)", str(error))
        raise PostError(f"{path}:{line[1] if line else 1}: is no TOML: {error}", USAGE) from error
    return _Reader(path, _Lines(text), data).study()


class _Reader:
    """Turns the parts of a file into a study; `wrong` has file and line."""

    def __init__(self, path: Path, lines: _Lines, data: dict):
        self.path, self.lines, self.data = path, lines, data

    def wrong(self, section: str, key: str, text: str) -> PostError:
        return PostError(f"{self.path}:{self.lines.of(section, key)}: {text}", USAGE)

    def study(self) -> Study:
        self._names(SECTIONS, self.data, "", "section")
        head = self._section("study")
        if "deck" not in head:
            raise self.wrong("study", "", 'there is no deck: write deck = "scene.nml" in [study]')
        deck = self.path.parent / str(head["deck"])
        if not deck.is_file():
            raise self.wrong("study", "deck", f"there is no deck {deck}")
        parameters = [self._parameter(name, table)
                      for name, table in self._tables("parameter").items()]  # fmt: skip
        limit = self._limit() if "limit" in self.data else None
        design = self._design(head, parameters, limit)
        derived = {str(k): str(v) for k, v in self.data.get("derived", {}).items()}
        results = [str(one) for one in _as_list(head.get("results", []))]
        study = Study(
            self.path,
            deck,
            deck.read_text(encoding="utf-8"),
            str(head.get("title", self.path.stem)),
            parameters,
            design,
            derived,
            results,
            limit,
            tuple(str(one) for one in _as_list(head.get("set", []))),
            bool(head.get("surrogate", True)),
            self._certify(head),
            self._repeat(head, parameters, limit),
            *self._late(head),
            slots=self._slots(),
            lines=self.lines,
        )
        self._placeholders(study)
        if study.late and not study.late_parameters():
            text = f"no parameter sets {' or '.join(study.late)} alone; name the keys that one sets"
            raise self.wrong("study", "late", text)
        return study

    def _certify(self, head: dict) -> bool:
        if head.get("certify", "centre") != "centre":
            raise self.wrong("study", "certify", 'certify is "centre", or left out')
        return "certify" in head

    def _repeat(self, head: dict, parameters: list[Parameter], limit: Limit | None) -> int:
        count = head.get("repeat", 1)
        if not isinstance(count, int) or count < 1:
            raise self.wrong("study", "repeat", "repeat is a number of members, 1 or more")
        if count > 1 and limit is not None and limit.kind != "fragility":
            text = "repeat: where chance decides there is no single limit; use kind = 'fragility'"
            raise self.wrong("study", "repeat", text)
        if count > 1 and any(one.name == MEMBER for one in parameters):
            text = f"a parameter is called '{MEMBER}', as the numbers of the members are; rename it"
            raise self.wrong(f"parameter.{MEMBER}", "", text)
        return count

    def _late(self, head: dict) -> tuple[tuple[str, ...], float]:
        late = tuple(str(one) for one in _as_list(head.get("late", [])))
        if ("late" in head) != ("start" in head):
            text = "late and start belong together: keys, and the time before which they are alike"
            raise self.wrong("study", "late" if "late" in head else "start", text)
        for key in late:
            if not KEY.fullmatch(key):
                text = f"'{key}': write group.key or group(id).key, as for --set"
                raise self.wrong("study", "late", text)
        start = head.get("start", 0.0)
        factor, unit = self._unit("study", str(head.get("start_unit", "s")))
        if late and (not isinstance(start, (int, float)) or start <= 0 or unit != "s"):
            raise self.wrong("study", "start", "start is a time after 0 [s]")
        return late, float(start) * factor

    def _section(self, name: str) -> dict:
        table = self.data.get(name, {})
        if not isinstance(table, dict):
            raise self.wrong(name, "", f"[{name}] must be a section")
        self._names(KEYS[name], table, name, "key")
        return table

    def _tables(self, name: str) -> dict[str, dict]:
        found = self.data.get(name, {})
        for key, table in found.items():
            section = f"{name}.{key}"
            if not isinstance(table, dict):
                raise self.wrong(section, "", f"write [{section}] with values or a distribution")
            self._names(KEYS[name], table, section, "key")
        return found

    def _names(self, known: tuple, table: dict, section: str, what: str) -> None:
        for key in table:
            if key in known:
                continue
            near = difflib.get_close_matches(key, known, 1)
            hint = f"; did you mean '{near[0]}'?" if near else f"; known are {', '.join(known)}"
            place = (section, key) if section else (key, "")
            raise self.wrong(*place, f"unknown {what} '{key}'{hint}")

    def _unit(self, section: str, unit: str) -> tuple[float, str]:
        try:
            return factor_of(unit), base_of(unit)
        except ValueError as error:
            hint = "units are those of the report, such as mm, kPa, m/s, kg, Pa s"
            raise self.wrong(section, "unit", f"{error}; {hint}") from error

    def _parameter(self, name: str, table: dict) -> Parameter:
        section = f"parameter.{name}"
        factor, unit = self._unit(section, str(table.get("unit", "-")))
        ways = [key for key in ("values", "preset", "from", *LAWS) if key in table]
        if len(ways) != 1:
            several = " and ".join(ways) or "nothing"
            text = f"it has {several}; give one of values, from ... to, {', '.join(LAWS)}"
            raise self.wrong(section, "", f"parameter '{name}': {text}")
        given = {"name": name, "unit": unit, "factor": factor, "line": self.lines.of(section)}
        given["sets"] = self._sets(name, table, section)
        way = ways[0]
        if way in LAWS:
            numbers = self._numbers(section, way, table[way], len(LAWS[way].split(",")))
            keep = {"lognormal": (1,), "weibull": (1,)}.get(way, ())
            scaled = tuple(v if i in keep else v * factor for i, v in enumerate(numbers))
            self._check_law(section, way, scaled)
            return Parameter(law=way, numbers=scaled, **given)
        if way == "from":
            return self._range(section, table, given)
        values = _as_list(table[way])
        if not values:
            raise self.wrong(section, way, f"parameter '{name}' has no values")
        found = tuple(v if isinstance(v, str) else float(v) * factor for v in values)
        return Parameter(values=found, **given)

    def _range(self, section: str, table: dict, given: dict) -> Parameter:
        ends = [table.get("from"), table.get("to")]
        if not all(isinstance(v, (int, float)) for v in ends):
            raise self.wrong(section, "from", "a range needs numbers: from, to")
        low, high = (float(v) * given["factor"] for v in ends)
        logs = table.get("scale", "linear") == "log"
        if logs and min(low, high) <= 0:
            raise self.wrong(section, "scale", 'scale = "log" needs positive ends')
        if "count" not in table:
            law = "loguniform" if logs else "uniform"
            return Parameter(law=law, numbers=(low, high), **given)
        count = int(table["count"])
        if count < 2:
            raise self.wrong(section, "count", "count must be 2 or more")
        make = np.geomspace if logs else np.linspace
        return Parameter(values=tuple(make(low, high, count).tolist()), **given)

    def _numbers(self, section: str, key: str, value: Any, count: int) -> list[float]:
        rows = _as_list(value)
        if len(rows) != count or not all(isinstance(v, (int, float)) for v in rows):
            text = f"{key} takes {count} numbers: {LAWS[key]}"
            raise self.wrong(section, key, text)
        return [float(v) for v in rows]

    def _check_law(self, section: str, law: str, numbers: tuple[float, ...]) -> None:
        rising = all(a < b for a, b in pairwise(numbers))
        positive = all(v > 0 for v in numbers)
        bad = {
            "uniform": not rising,
            "triangular": not numbers[0] <= numbers[1] <= numbers[-1] or numbers[0] == numbers[-1],
            "loguniform": not (rising and positive),
            "lognormal": not positive,
            "weibull": not positive,
            "normal": numbers[1] <= 0,
        }[law]
        if bad:
            raise self.wrong(section, law, f"{law}: {LAWS[law]} do not fit each other")

    def _sets(self, name: str, table: dict, section: str) -> tuple[tuple[str, str], ...]:
        given = table.get("set", [])
        if isinstance(given, str):
            given = [given]
        pairs = list(given.items()) if isinstance(given, dict) else [(k, name) for k in given]
        for key, _ in pairs:
            if not KEY.fullmatch(str(key)):
                text = f"'{key}': write group.key or group(id).key, as for --set"
                raise self.wrong(section, "set", text)
        return tuple((str(k), str(v)) for k, v in pairs)

    def _design(self, head: dict, parameters: list[Parameter], limit: Limit | None) -> Design:
        default = "sobol" if limit and limit.kind == "fragility" else "grid"
        kind, runs = str(head.get("design", default)), int(head.get("runs", 0))
        if kind not in DESIGNS:
            raise self.wrong("study", "design", f"design is one of {', '.join(DESIGNS)}")
        if kind in RANDOM:
            if runs < 1:
                raise self.wrong("study", "design", f"design = '{kind}' needs runs = 64 or so")
            power = 2 ** max(runs - 1, 1).bit_length()
            notes = []
            if kind == "sobol" and runs & (runs - 1):
                notes = [f"sobol: {runs} runs are rounded up to {power}, a power of 2"]
                runs = power
            return Design(kind, runs, int(head.get("seed", 1)), notes)
        for one in parameters:
            if one.law:
                text = f"parameter '{one.name}' is a distribution: use design = 'lhs' or 'sobol'"
                raise self.wrong(f"parameter.{one.name}", one.law, text)
        lengths = {len(one.values) for one in parameters} - {1}
        if kind == "list" and len(lengths) > 1:
            raise self.wrong("study", "design", "design = 'list': values of unequal number")
        if not parameters and limit is None:
            raise self.wrong("study", "", "there is no parameter and no limit: nothing to vary")
        return Design(kind)

    def _limit(self) -> Limit:
        table = self._section("limit")
        kind = str(table.get("kind", "limit"))
        if kind not in KINDS:
            raise self.wrong("limit", "kind", f"kind is one of {', '.join(KINDS)}")
        for key in ("unknown", *(() if "event" in table else ("result", "target"))):
            if key not in table:
                raise self.wrong("limit", "", f"[limit] lacks '{key}'")
        factor, unit = self._unit("limit", str(table.get("unit", "-")))
        if kind != "fragility" and not 0 < float(table.get("low", 0)) < float(table.get("high", 0)):
            raise self.wrong("limit", "low", "give the bracket: 0 < low < high")
        name = str(table["unknown"])
        sets = self._sets(name, table, "limit")
        unknown = Parameter(name, unit, factor, sets=sets, line=self.lines.of("limit", "unknown"))
        target, _ = self._unit("limit", str(table.get("target_unit", "-")))
        if "event" in table and not re.fullmatch(r"[^<>]+[<>]\s*[-+.\deE]+", str(table["event"])):
            raise self.wrong("limit", "event", "write event = 'RESULT > NUMBER', in SI units")
        return Limit(
            kind,
            unknown,
            float(table.get("low", 0)) * factor,
            float(table.get("high", 0)) * factor,
            str(table.get("result", "")),
            float(table.get("target", 0)) * target,
            float(table.get("tolerance", 0.01)),
            str(table.get("event", "")),
            str(table.get("along", "")),
            bool(table.get("rising", kind != "standoff_charge")),
        )

    def _slots(self) -> dict[str, Any]:
        table = dict(self._section("slots"))
        if "time_limit" in table:
            text = str(table["time_limit"])
            found = re.fullmatch(r"\s*([\d.]+)\s*(s|min|h)\s*", text)
            if not found:
                raise self.wrong("slots", "time_limit", f"'{text}': write 90 s, 10 min or 2 h")
            table["time_limit"] = float(found[1]) * {"s": 1, "min": 60, "h": 3600}[found[2]]
        if not isinstance(table.get("pack", 1), int) or table.get("pack", 1) < 1:
            raise self.wrong("slots", "pack", "pack is a number of members, 1 or more")
        return table

    def _placeholders(self, study: Study) -> None:
        """Every {name} of the deck has a value, and every parameter sets something."""
        names = {one.name for one in study.parameters} | set(study.derived)
        names |= {study.limit.unknown.name} if study.limit else set()
        filled = " ".join(PLACE.findall(study.text)) + " " + " ".join(study.derived.values())
        unknown = [study.limit.unknown] if study.limit and study.limit.kind != "fragility" else []
        formulas = " ".join(f for one in [*study.parameters, *unknown] for _, f in one.sets)
        for one in [*study.parameters, *unknown]:
            used = re.search(rf"\b{re.escape(one.name)}\b", f"{filled} {formulas}")
            if not one.sets and not used:
                section = f"parameter.{one.name}" if one not in unknown else "limit"
                text = f"parameter '{one.name}' changes nothing: give it set = ['group.key'], or "
                raise self.wrong(section, "", text + f"write {{{one.name}}} in {study.deck.name}")
        point = {one.name: one.middle for one in study.parameters}
        point |= {one.name: study.limit.low for one in unknown}
        study.job(point)  # formulas are tried once, so that their faults are told now


def _of_members(result: str) -> bool:
    """Whether a result is of a gauge, or of the history of a body: each member of a pack has it."""
    return ":" in result or result.rpartition(" ")[2] in OF_BODY


def _plain(value: float | str) -> str:
    """A value as a deck has it: whole numbers without a point, which suits reals and integers."""
    if isinstance(value, str):
        return value
    whole = value == int(value) and abs(value) < 1e9
    return str(int(value)) if whole else repr(float(value))


def _parts(formula: str) -> list[str]:
    """Formulas between the commas of a list that are in no brackets."""
    found, depth = [""], 0
    for letter in formula:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return found


def _as_list(value: Any) -> list:
    return list(value) if isinstance(value, (list, tuple)) else [value]
