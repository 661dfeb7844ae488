# SPDX-License-Identifier: MIT
"""Presets: the list, the sources, every one of them in a deck, overrides, wrong names."""

import re
import shutil
from pathlib import Path

import pytest
from test_bad_decks import ROOT, check, run

FILES = sorted((ROOT / "inputs" / "presets").glob("*.nml"))
NAMES = [path.stem for path in FILES]
VALUE = re.compile(r"^\s*(\w+)\s*=\s*(\S+)")


def deck(preset, more=""):
    """A block of few particles of a preset."""
    return f"""&run t_end=1e-7 /
&material id='m', preset='{preset}' {more} /
&body id='b', box=0,0.004, 0,0.004, 0,0.004, spacing=1e-3, material='m', velocity=1,0,0 /
"""


def keys_of(text):
    """Keys and values of the &material group of a deck."""
    body = text[text.index("&material") :].split("\n/")[0]
    found = {}
    for line in body.splitlines():
        if match := VALUE.match(line):
            found[match[1]] = match[2].strip(",'")
    return found


def same(a, b):
    """The same number or word."""
    try:
        return float(a) == float(b)
    except ValueError:
        return a == b


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_every_number_has_a_source(path):
    """Behind each number stand its unit and where it comes from."""
    lines = path.read_text(encoding="ascii").splitlines()
    assert 20 < len(lines[0]) <= 100
    assert not lines[0].startswith("&")
    numbers = [x for x in lines if (m := VALUE.match(x)) and m[2][0] in "-0123456789"]
    assert len(numbers) >= 3
    for line in numbers:
        assert re.search(r" ! \[[^]]+\] .{3}", line), line
        assert len(line) <= 120


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_preset_runs_and_echoes_itself(path, tmp_path):
    """The echo holds all keys of the file and none of its name; its own echo is the same."""
    (tmp_path / "a.nml").write_text(deck(path.stem))
    code, text = run(tmp_path, "run", "a.nml", "--out", "one")
    assert code == 0, text
    echo = (tmp_path / "one" / "a.echo.nml").read_text()
    assert path.stem not in echo
    found = keys_of(echo)
    for key, value in keys_of(path.read_text()).items():
        assert same(found[key], value), key
    shutil.copy(tmp_path / "one" / "a.echo.nml", tmp_path / "a.nml")
    code, text = run(tmp_path, "run", "a.nml", "--out", "two")
    assert code == 0, text
    assert (tmp_path / "two" / "a.echo.nml").read_text() == echo


def test_keys_of_the_deck_win(tmp_path):
    """A key of the deck, and one of the command line, stand over those of the preset."""
    (tmp_path / "a.nml").write_text(deck("cfrp_woven", ", xt=1e9, yt=1.1e9"))
    code, text = run(tmp_path, "run", "a.nml", "--out", "o", "--set", "material(m).yt=1.2e9")
    assert code == 0, text
    found = keys_of((tmp_path / "o" / "a.echo.nml").read_text())
    assert (float(found["xt"]), float(found["yt"])) == (1e9, 1.2e9)
    assert float(found["zt"]) == 60e6


def test_the_command_line_takes_another_preset(tmp_path):
    """As a study does: the deck of the other preset, but for the keys that stand in the deck."""
    echoes = []
    for preset, more in (("mild_steel", ("--set", "material(m).preset=rebar")), ("rebar", ())):
        (tmp_path / "a.nml").write_text(deck(preset, ", density=7777"))
        code, text = run(tmp_path, "run", "a.nml", "--check", "--echo", "e.nml", *more)
        assert code == 0, text
        echoes.append((tmp_path / "e.nml").read_text())
    assert echoes[0] == echoes[1] and keys_of(echoes[0])["density"] == "7777.0"


def test_list_and_file(tmp_path):
    """--describe presets has a line for each; --describe NAME prints the file."""
    code, text = run(tmp_path, "--describe", "presets")
    assert code == 0
    assert [line.split()[0] for line in text.splitlines()] == NAMES
    code, text = run(tmp_path, "--describe", "cfrp_ud")
    assert code == 0
    assert text == (ROOT / "inputs" / "presets" / "cfrp_ud.nml").read_text()


def test_no_preset_has_gone():
    """What decks and documents refer to."""
    wanted = (
        "hjc_48 hjc_44 hjc_40_scaled hjc_35_scaled al2024_paper steel_paper al2024 al6061 al1100"
    )
    wanted += " steel_4340 ofhc_copper armco_iron rebar cfrp_ud_paper cfrp_woven_paper cfrp_ud"
    wanted += " mild_steel high_tensile_steel ofhc_copper_za armco_iron_za"
    wanted += " cfrp_woven tnt_jwl tnt_balloon concrete_48 concrete_40"
    assert set(wanted.split()) <= set(NAMES)


FAULTS = {
    "unknown": ("cfrp_udd", "", ["2: ", "unknown preset 'cfrp_udd'", "'cfrp_ud'?", "cfrp_woven"]),
    "empty": ("", "", ["2: ", "unknown preset ''"]),
    "other_model": ("cfrp_ud", ", model='gruneisen'", ["'orthotropic_ply'", "take the key"]),
    "other_key": ("cfrp_ud", ", bulk_modulus=1e9", ["2: ", "unknown key 'bulk_modulus'"]),
    "bad_value": ("cfrp_ud", ", nu12=20", ["case.nml:2: ", "nu12", "not positive definite"]),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_named(fault, tmp_path):
    """What is wrong, where, and what there is."""
    preset, more, words = FAULTS[fault]
    code, text = check(tmp_path, deck(preset, more))
    assert code == 2, text
    for word in words:
        assert word in text, text
    assert "is missing" not in text


def test_all_materials_are_told_together(tmp_path):
    """Two bad materials: two messages."""
    text = deck("cfrp_ud", ", nu12=20") + deck("cfrp_woven", ", nu13=20").split("\n")[1].replace(
        "id='m'", "id='n'"
    )
    code, text = check(tmp_path, text)
    assert code == 2
    assert "nu12" in text
    assert "nu13" in text


def test_presets_need_no_files(tmp_path):
    """The binary alone is enough."""
    assert Path.cwd() != tmp_path
    code, text = check(tmp_path, deck("cfrp_ud"))
    assert code == 0, text


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_check_names_what_is_unconfirmed(path, tmp_path):
    """As many as the file marks, by name; no number of a preset is called implausible."""
    code, text = check(tmp_path, deck(path.stem))
    assert code == 0, text
    assert "not plausible" not in text
    lines = [x for x in path.read_text().splitlines() if VALUE.match(x)]
    keys = [VALUE.match(x)[1] for x in lines if "unconfirmed" in x]
    words = f"{len(keys)} constant" + (
        " of this preset is" if len(keys) == 1 else "s of this preset are"
    )
    assert (f"{words} unconfirmed: {' '.join(keys)}\n" in text) == (len(keys) > 0), text


def test_a_key_of_the_deck_is_the_users(tmp_path):
    code, text = check(tmp_path, deck("rebar", ", failure_strain=0.12"))
    assert code == 0
    assert "unconfirmed" not in text


@pytest.mark.parametrize(
    ("preset", "more", "words"),
    [
        ("hjc_48", ", fc=48", "2: warning: &material id='m': fc = 48.0 [Pa] is not plausible"),
        ("al2024", ", melt_temperature=502", "melt_temperature = 502.0 [K] is not plausible"),
        ("cfrp_ud", ", xt=2700", "xt = 2700.0 [Pa] is not plausible"),
        ("rebar", ", density=7.85", "density = 7.85 [kg/m3] is not plausible"),
        ("mild_steel", ", yield_stress=250", "yield_stress = 250.0 [Pa] is not plausible"),
        ("ofhc_copper_za", ", c0=65", "c0 = 65.0 [Pa] is not plausible"),
    ],
)
def test_an_implausible_constant_is_told(tmp_path, preset, more, words):
    """Other units are the usual reason; it is a warning, since the program cannot know."""
    code, text = check(tmp_path, deck(preset, more))
    assert code == 0, text
    assert words in text, text


def test_a_key_of_a_preset_is_taken_back(tmp_path):
    """`d1 = none`: metal that cannot fail, in the deck, by --set, and as total_lagrangian."""
    (tmp_path / "a.nml").write_text(deck("al6061", "d1 = none"))
    code, text = run(tmp_path, "run", "a.nml", "--out", "one")
    assert code == 0, text
    keys = keys_of((tmp_path / "one" / "a.echo.nml").read_text())
    assert "a" in keys
    assert "d1" not in keys
    code, text = run(tmp_path / "one", "run", "a.echo.nml", "--check")
    assert code == 0, text
    (tmp_path / "b.nml").write_text(deck("al6061"))
    total = ["--set", "body(b).formulation=total_lagrangian"]
    code, text = run(tmp_path, "run", "b.nml", "--check", *total)
    assert code == 2
    code, text = run(tmp_path, "run", "b.nml", "--check", *total, "--set", "material(m).d1=none")
    assert code == 0, text
    assert "time step in proportion to its compression" in text


def test_a_preset_is_chosen_by_an_override(tmp_path):
    """--set material(m).preset=: the other preset's keys, those of the deck on top of them."""
    (tmp_path / "a.nml").write_text(deck("al6061", "a = 3e8"))
    choose = ["--set", "material(m).preset=steel_4340"]
    code, text = run(tmp_path, "run", "a.nml", "--out", "o", *choose)
    assert code == 0, text
    keys = keys_of((tmp_path / "o" / "a.echo.nml").read_text())
    steel = keys_of((ROOT / "inputs" / "presets" / "steel_4340.nml").read_text())
    assert float(keys["a"]) == 3e8
    for key in ("b", "d1", "density"):
        assert same(keys[key], steel[key]), key
    wrong = "material(m).preset=steel_434"
    code, text = run(tmp_path, "run", "a.nml", "--check", "--set", wrong)
    assert code == 2
    assert f"--set {wrong}: &material id='m': unknown preset" in text
    assert "did you mean 'steel_4340'" in text


METALS = ("al1100", "al2024", "al6061", "armco_iron", "ofhc_copper", "rebar", "steel_4340")


@pytest.mark.parametrize("preset", METALS)
def test_metals_without_failure(preset, tmp_path):
    """failure = 'none': no constant of failure is left, and total_lagrangian takes the metal."""
    (tmp_path / "a.nml").write_text(deck(preset, ", failure = 'none'"))
    total = ["--set", "body(b).formulation=total_lagrangian"]
    code, text = run(tmp_path, "run", "a.nml", "--out", "one", *total)
    assert code == 0, text
    keys = keys_of((tmp_path / "one" / "a.echo.nml").read_text())
    assert keys["failure"] == "none"
    assert not keys.keys() & {"d1", "failure_strain"}
    (tmp_path / "b.nml").write_text(deck(preset))
    code, text = run(tmp_path, "run", "b.nml", "--check", *total)
    assert code == 2
    assert "failure = 'none'" in text
    code, text = run(tmp_path, "run", "b.nml", "--check", *total, "--set", "material.failure=none")
    assert code == 0, text


def test_concrete_cannot_be_without_damage(tmp_path):
    """The strength of concrete falls with its damage: said, with what to take."""
    (tmp_path / "a.nml").write_text(deck("hjc_48", "failure = 'none'"))
    code, text = run(tmp_path, "run", "a.nml", "--check")
    assert code == 2
    assert "a.nml:2: &material id='m': failure = 'none' is for metals and plies" in text
    assert "'linear_elastic'" in text


def test_check_says_what_fracture_rests_on(tmp_path):
    """Failure strains, that no energy stands behind them, guesses, cracks without a rate."""
    (tmp_path / "a.nml").write_text(deck("al6061"))
    code, text = run(tmp_path, "run", "a.nml", "--check")
    assert code == 0
    assert "failure strain at 1e5 1/s and triaxiality 0, 1/3, 1:  0.6800  0.4697  0.1363" in text
    assert "it breaks by strain, not by an energy" in text
    assert "rests on guesses" in text
    code, text = run(tmp_path, "run", "a.nml", "--check", "--set", "material.failure=none")
    assert code == 0
    assert "breaks" not in text
    (tmp_path / "c.nml").write_text(deck("concrete_48"))
    code, text = run(tmp_path, "run", "c.nml", "--check")
    assert code == 0
    assert "tests have 1.4, 3.1, 6.6" in text
    rate = ["--set", "material.rate_tension=malvar"]
    code, text = run(tmp_path, "run", "c.nml", "--check", *rate)
    assert "tests have" not in text


def test_a_failure_strain_at_its_floor_is_told(tmp_path):
    """By d4 < 0 at high rates a warning; nearly everywhere an error, unless the floor is given."""
    low = "reference_rate = 1e-4, d4 = -0.05279"
    (tmp_path / "a.nml").write_text(deck("steel_4340", low))
    code, text = run(tmp_path, "run", "a.nml", "--check")
    assert code == 0
    assert "a.nml:2: &material id='m': warning: the failure strain is at its floor" in text
    assert "3 of 9 states" in text
    assert "at 16859.0" in text
    (tmp_path / "b.nml").write_text(deck("steel_4340", "d1 = -3.5"))
    code, text = run(tmp_path, "run", "b.nml", "--check")
    assert code == 2
    assert "b.nml:2: &material id='m': the failure strain is at its floor" in text
    floor = ["--set", "material.least_failure_strain=0.02"]
    code, text = run(tmp_path, "run", "b.nml", "--check", *floor)
    assert code == 0
    assert "9 of 9 states" in text


def test_tougher_in_tension_is_told(tmp_path):
    """The other sign of d3, as some print it; `brisance mat` says so too."""
    path = "&point material='m' /\n&segment duration=1e-6, l=9*0 /\n"
    (tmp_path / "a.nml").write_text("&material id='m', preset='steel_4340', d3=2 /\n" + path)
    code, text = run(tmp_path, "mat", "a.nml", "--check")
    assert code == 0
    assert "a.nml:1: &material id='m': warning: tension makes it tougher" in text
    assert "failure strain at 1 1/s" in text


@pytest.mark.parametrize("key", ["youngs_modulus", "bulk_modulus", "shear_modulus", "density"])
def test_elastic_constants_are_asked_for_their_unit(key, tmp_path):
    """30e3 for 30e9, and a density in g/cm3."""
    values = {"bulk_modulus": 2e10, "shear_modulus": 1e10, "density": 2400.0}
    if key == "youngs_modulus":
        values = {"youngs_modulus": 3e10, "poisson_ratio": 0.2, "density": 2400.0}
    values[key] *= 1e-3 if key == "density" else 1e-6
    keys = ", ".join(f"{name}={value}" for name, value in values.items())
    scene = deck("x").replace("preset='x'", f"model='linear_elastic', {keys}")
    (tmp_path / "a.nml").write_text(scene)
    code, text = run(tmp_path, "run", "a.nml", "--check")
    assert code == 0, text
    assert f"a.nml:2: warning: &material id='m': {key} = " in text
    assert "is it in SI units?" in text


def test_only_what_the_preset_has_is_taken_back(tmp_path):
    """A number that must be there, and one that the deck gives beside d1 = none, are told."""
    for more in ("a = none", "t_cut = none", "d1 = none, d2 = 0.1"):
        (tmp_path / "a.nml").write_text(deck("al6061", more))
        code, text = run(tmp_path, "run", "a.nml", "--check")
        assert code == 2, text
        assert "a.nml:2" in text
