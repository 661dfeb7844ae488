# SPDX-License-Identifier: MIT
"""A movie: a picture for each dump, all in one scale, and a file that can be played."""

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import write_run  # noqa: E402

from post import movie  # noqa: E402
from post.__main__ import main  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.reader import Run  # noqa: E402


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return write_run(tmp_path_factory.mktemp("movie") / "one", nx=6, frames=3, spacing=0.0042)


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(movie, "DOTS", 40)


def test_pictures_are_of_one_size_and_scale(folder, tmp_path, monkeypatch):
    run, scales, draw = Run(folder), [], movie.draw_air

    def note_scale(axis, air, cut, colours):
        scales.append((colours.norm.vmin, colours.norm.vmax))
        draw(axis, air, cut, colours)

    monkeypatch.setattr(movie, "draw_air", note_scale)
    pictures = movie.draw_frames(run, run.frames, tmp_path)
    images = [np.asarray(Image.open(path).convert("RGB")) for path in pictures]
    assert len(images) == len(run.frames) == 3
    assert len({image.shape for image in images}) == 1
    assert all(side % 2 == 0 for side in images[0].shape[:2])  # as an encoder wants it
    same = [np.array_equal(images[0], image) for image in images[1:]]
    assert not any(same)
    top = max(frame.air("pressure").field["pressure"].max() for frame in run.frames[1:])
    assert scales == [(0.1 * run.deck.ambient, pytest.approx(top))] * 3


def test_a_gif_where_there_is_no_encoder(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(movie, "find_encoder", lambda: None)
    path = movie.make_movie(Run(folder), tmp_path / "m.gif", 5)
    with Image.open(path) as image:
        assert image.n_frames == 3 and image.info["duration"] == 200
    with pytest.raises(PostError, match="no encoder"):
        movie.make_movie(Run(folder), tmp_path / "m.mp4")
    assert movie.make_movie(Run(folder)).name == "movie.gif"


@pytest.mark.skipif(movie.find_encoder() is None, reason="imageio-ffmpeg is not installed")
def test_the_command_writes_mp4(folder, capsys):
    assert main(["movie", str(folder)]) == 0
    assert "movie.mp4" in capsys.readouterr().out
    assert (folder / "movie.mp4").read_bytes()[4:8] == b"ftyp"


def test_the_command_refuses(folder, capsys):
    assert main(["movie", str(folder), "--rate", "0"]) == 2
    assert main(["movie", str(folder), "--out", "m.avi"]) == 2
    assert capsys.readouterr().err.count("--rate is 0 to 60") == 2
