# SPDX-License-Identifier: MIT
"""The program and decks with faults: exit code 2, a message that names the place, no crash."""

import os
import resource
import subprocess
from pathlib import Path

import pytest
from bad_decks import BAD, GOOD

ROOT = Path(__file__).resolve().parents[2]
BINARY = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))
CRASH = ("Fortran runtime", "Backtrace", "Program received", "SIGSEGV", "Error termination")


def run(folder, *arguments):
    """Run the program in a folder; give exit code and all that it printed."""
    if not BINARY.exists():
        pytest.fail(f"{BINARY} is not there: run make first")
    done = subprocess.run(
        [BINARY, *arguments], cwd=folder, capture_output=True, timeout=20, check=False
    )
    text = (done.stdout + done.stderr).decode("utf-8", "replace")
    for word in CRASH:
        assert word not in text, text[:2000]
    return done.returncode, text


def check(folder, text, *arguments, name="case.nml"):
    """Write a deck and check it."""
    (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return run(folder, "run", name, "--check", *arguments)


@pytest.mark.parametrize("bad", BAD, ids=[bad.name for bad in BAD])
def test_fault_is_named(bad, tmp_path):
    """Every fault ends with code 2 and a message that says where and what."""
    code, text = check(tmp_path, bad.text)
    assert code == 2, text[:2000]
    place = "case.nml:" if bad.line is None else f"case.nml:{bad.line}: "
    lines = [line for line in text.splitlines() if place in line]
    assert lines, f"no message names {place}\n{text[:2000]}"
    for word in bad.words:
        assert any(word in line for line in lines), f"{word!r} not in\n{text[:2000]}"
    assert len(text) < 20000, "the message is too long to read"


def test_there_are_at_least_forty_faults():
    """Names are unique, so no fault hides another one."""
    assert len({bad.name for bad in BAD}) == len(BAD) >= 40


def test_many_groups_take_time_in_proportion(tmp_path):
    """Four times as many boxes of gas take four times as long to read, not sixteen times."""
    head = "&run t_end=1e-4 /\n&air box=0,1,0,1,0,1, cells=8,8,8 /\n"
    seconds = []
    for n in (1500, 6000):
        boxes = [
            f"&gas id='g{i}', box=0,1,0,1,0,{1 - i % 8 / 8}, density=1, pressure=1e5 /\n"
            for i in range(n)
        ]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        code, text = check(tmp_path, head + "".join(boxes))
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        assert code == 0, text[:2000]
        seconds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    assert seconds[1] < 9 * seconds[0], f"{seconds} s"


GOOD_FORMS = {
    "as_it_is": GOOD,
    "carriage_returns": GOOD.replace("\n", "\r\n"),
    "old_line_ends": GOOD.replace("\n", "\r"),
    "no_final_newline": GOOD.rstrip("\n"),
    "byte_order_mark": "\ufeff" + GOOD,
    "tabs": GOOD.replace("  ", "\t"),
    "upper_case": GOOD.replace("&run", "&RUN").replace("cells", "CELLS"),
    "comments": GOOD.replace("cells =", "! cells = 'not this' /\n  cells ="),
    "repeat_count": GOOD.replace("20,20,20", "3*20"),
    "fortran_reals": GOOD.replace("t_end=1e-4", "t_end=1.D-4").replace("0.01", "+.1e-1"),
    "blanks_for_commas": GOOD.replace("20,20,20", "20 20\n 20"),
    "spaced_equals": GOOD.replace("t_end=1e-4", "t_end\n = \n 1e-4"),
    "quotes": GOOD.replace("'good'", "'a ''good'' / one & only! \"deck\"'"),
    "double_quotes": GOOD.replace("'good'", '"it\'s good"'),
    "utf_8_prose": "Dr\u00fccke und W\u00e4nde / & =\n" + GOOD,
    "long_comment": GOOD.replace("&air", "x" * 10_000_000 + "\n&air"),
    "plies": GOOD.replace("material='steel'", "material='steel', plies='[0/2*45]s'"),
}


@pytest.mark.parametrize("form", GOOD_FORMS)
def test_good_deck_passes_in_every_form(form, tmp_path):
    """What a deck may look like."""
    code, text = check(tmp_path, GOOD_FORMS[form])
    assert code == 0, text[:2000]


BAD_FILES = ["absent.nml", "folder", "/dev/null", "folder/absent.nml"]


@pytest.mark.parametrize("name", BAD_FILES)
def test_deck_that_is_no_file(name, tmp_path):
    """A deck that cannot be read is named."""
    (tmp_path / "folder").mkdir()
    code, text = run(tmp_path, "run", name, "--check")
    assert code == 2, text
    assert name in text


def test_all_errors_at_once_and_in_order(tmp_path):
    """One look at the deck repairs them all."""
    deck = GOOD.replace("t_end=1e-4", "t_end=abc").replace("density", "densty")
    deck = deck.replace("body='plate'", "body='plat'")
    code, text = check(tmp_path, deck)
    assert code == 2
    places = [text.index(f"case.nml:{line}: ") for line in (2, 8, 11)]
    assert places == sorted(places)


def test_what_is_refused_is_not_warned_of(tmp_path):
    """An interaction that needs two bodies, of a deck with one, has one message."""
    text = "&interaction bodies='plate','{}', law='contact', friction=0.1 /\n"
    code, said = check(tmp_path, GOOD + text.format("plate"))
    assert code == 2
    assert "a body does not meet itself" in said
    assert "has no effect" not in said
    code, said = check(tmp_path, GOOD + text.format("*"))
    assert code == 0
    assert "&interaction: has no effect: it needs two bodies" in said


def test_many_errors_are_counted(tmp_path):
    """Fifty messages are enough."""
    code, text = check(tmp_path, GOOD + "&gauge id='x', at=1 /\n" * 200)
    assert code == 2
    assert text.count("case.nml:") <= 51
    assert "more errors" in text


OVERRIDES = [
    ("run.t_end=abc", "a number > 0.0 [s]"),
    ("run.t_end=-1", "> 0.0"),
    ("run.tend=1", "did you mean 't_end'"),
    ("rum.t_end=1", "did you mean &run"),
    ("body(plat).spacing=1e-3", "plat"),
    ("gauge.at=0,0,0", "2 groups"),
    ("nonsense", "group.key=value"),
    ("=", "group.key=value"),
    ("air.cells=1,2", "3 integers"),
    ("body.spacing=0.5", "larger than the body"),
]


@pytest.mark.parametrize(("override", "words"), OVERRIDES)
def test_bad_override_is_named(override, words, tmp_path):
    """A wrong --set is told like a wrong deck."""
    code, text = check(tmp_path, GOOD, "--set", override)
    assert code == 2, text
    assert f"--set {override}: " in text
    assert words in text


def test_an_old_name_of_a_key_is_read_and_told(tmp_path):
    """In a deck and in --set; both names are a key that stands twice; --describe says it."""
    told = "key 'tension_hold' is called 'tensile_control' now"
    metal = GOOD.replace("material='steel'", "material='steel', formulation='corrected_hourglass'")
    old = metal.replace("spacing=0.01,", "spacing=0.01, tension_hold=2.5,")
    new = metal.replace("spacing=0.01,", "spacing=0.01, tensile_control=2.5,")
    texts = [
        check(tmp_path, old),
        check(tmp_path, new),
        check(tmp_path, metal, "--set", "body.tension_hold=2.5"),
    ]
    for code, text in texts:
        assert code == 0, text
        assert "tensile control 2.5" in text
    assert f"case.nml:9: warning: &body id='plate': {told}" in texts[0][1]
    assert told not in texts[1][1]
    assert told in texts[2][1]
    both = new.replace("tensile_control=2.5,", "tensile_control=2.5, tension_hold=2,")
    code, text = check(tmp_path, both)
    assert code == 2
    assert "key 'tensile_control' stands twice" in text
    assert (
        "Also read as tension_hold, its old name."
        in run(tmp_path, "--describe", "body", "--all")[1]
    )


@pytest.mark.parametrize(
    "override",
    [
        "run.title=it is all one text",
        "run.symmetry=x,y",
        "air.cells=3*24",
        "body(plate).plies=7*(0/90)",
        "gauge(g1).at=0.3, 0.3, 0.3",
        "solid.skin=0.5",
    ],
)
def test_good_override_passes(override, tmp_path):
    """Texts need no quotes on the command line."""
    code, text = check(tmp_path, GOOD, "--set", override)
    assert code == 0, text
