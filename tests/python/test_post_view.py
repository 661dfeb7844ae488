# SPDX-License-Identifier: MIT
"""The view that turns in a browser: what is in it is what the dumps hold; Chromium draws it."""

import base64
import json
import re
import shutil
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import write_run  # noqa: E402

from post.__main__ import main  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.reader import Run  # noqa: E402
from post.view import WIDTH, make_view, pack  # noqa: E402

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("view") / "one"
    return write_run(path, nx=4, frames=3, rows=50, spacing=0.0042 / 3)


@pytest.fixture(scope="module")
def page(folder):
    return make_view(Run(folder))


def decoded(page):
    """What the browser makes of a page: about, unloaded places, records [time, kind, particle]."""
    blocks = dict(re.findall(r'<script id="(\w+)"[^>]*>(.*?)</script>', page, re.DOTALL))
    about = json.loads(blocks["about"])
    raw = zlib.decompress(base64.b64decode(blocks["data"]))
    n, frames = about["particles"], len(about["times"])
    words = np.frombuffer(raw, "<u2", 3 * n + frames * WIDTH * n)
    rest = words[: 3 * n].reshape(n, 3)
    steps = words[3 * n :].reshape(frames, WIDTH, n)
    records = np.cumsum(steps, axis=0, dtype="u2")
    bodies = np.frombuffer(raw, "u1", n, words.nbytes)
    return about, rest, records, bodies, raw[words.nbytes + n :]


def _key(places):
    """Number of each place, by its column and layer of the lattice."""
    near = np.rint(places / (0.0042 / 6)).astype(int)
    return {tuple(key): k for k, key in enumerate(near)}


def test_particles_are_where_the_dumps_have_them(folder, page):
    about, rest, records, bodies, air = decoded(page)
    run = Run(folder)
    low, size = np.array(about["low"]), np.array(about["size"])
    assert about["times"] == pytest.approx([frame.time for frame in run.frames])
    solid = run.frames[-1].solid("displacement", "damage")
    unloaded = solid.points - solid.field["displacement"]
    places = low + size * records[-1, :3].T / 65535.0
    # each particle of the view is one of the dump, by its unloaded place
    order, mine = (_key(x) for x in (unloaded, low + size * rest / 65535.0))
    row = np.array([order[key] for key in mine])
    assert len(set(row)) == len(row)
    step = np.linalg.norm(size) / 65535
    assert np.abs(places - solid.points[row]).max() < step
    assert np.abs(records[-1, 5] / 65535 - solid.field["damage"][row]).max() < 1e-4
    assert set(bodies) == {0}
    sheet = about["air"]
    assert len(air) == len(run.frames) * sheet["width"] * sheet["height"]
    top = sheet["low"] * (sheet["high"] / sheet["low"]) ** ((max(air) - 1) / 254)
    pressure = max(frame.air("pressure").field["pressure"].max() for frame in run.frames[1:])
    assert top == pytest.approx(pressure, rel=0.1)


def test_only_surfaces_are_shown_and_it_is_said(folder, page):
    about = decoded(page)[0]
    total = len(Run(folder).frames[-1].solid("id").points)
    assert about["total"] == total
    assert 0.6 * total < about["particles"] < total  # of three layers the inside of one is left out
    assert f"{about['particles']:,} of {total:,} particles".replace(",", " ") in about["said"]
    assert "1/4 is modelled" in about["said"]
    assert about["mirrors"] == [True, True, False]


def test_a_body_of_one_layer_is_all_surface(tmp_path):
    run = Run(write_run(tmp_path / "thin", nx=4, frames=2, rows=20, spacing=0.0042))
    assert pack(run, 10**6).shown == len(run.frames[-1].solid("id").points)


def test_thinned_to_fit(folder):
    few = pack(Run(folder), 1000)
    assert 800 < few.shown < 1100
    assert "% of them at random" in few.about["said"]
    many = pack(Run(folder), 10**6)
    assert few.about["bodies"][0]["radius"] > 2 * many.about["bodies"][0]["radius"]
    small = make_view(Run(folder), 120e3)
    assert len(small) < 120e3
    with pytest.raises(PostError):
        make_view(Run(folder), 21e3)


def test_the_command(folder, capsys):
    assert main(["view", str(folder)]) == 0
    assert "view.html" in capsys.readouterr().out
    text = (folder / "view.html").read_text()
    assert "@DATA@" not in text and "http" not in text.replace("http-equiv", "")


@pytest.mark.skipif(BROWSER is None, reason="chromium is not installed")
def test_a_browser_draws_it(page, tmp_path):
    """The page says what it has drawn, and the picture is not empty."""
    file, picture = tmp_path / "view.html", tmp_path / "view.png"
    file.write_text(page)
    command = [BROWSER, "--headless=new", "--no-sandbox", "--use-gl=angle"]
    command += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
    command += [
        "--window-size=800,600",
        "--virtual-time-budget=20000",
        f"--user-data-dir={tmp_path}",
    ]
    where = f"{file.as_uri()}#time=1&pitch=0.8"
    done = subprocess.run([*command, "--dump-dom", where], capture_output=True, timeout=240)
    about = decoded(page)[0]
    state = re.search(r'data-state="([^"]*)"', done.stdout.decode())
    assert state, done.stderr.decode()[-2000:]
    assert state[1] == f"drawn {about['particles']} particles at {about['times'][-1]:.3e}".replace(
        "e-0", "e-"
    )
    shot = [*command, f"--screenshot={picture}", where]
    subprocess.run(shot, capture_output=True, timeout=240, check=True)
    colours = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    middle = colours[150:450, 200:560]
    assert (middle.min(axis=2) < 235).mean() > 0.15  # the plate
    assert (middle.max(axis=2) < 110).mean() > 0.003  # its damage
