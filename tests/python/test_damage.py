# SPDX-License-Identifier: MIT
"""Files of a run that are damaged, lost or not files at all: code 4 and a clear line, at once.

Thirty places of a checkpoint by default; `BRISANCE_DAMAGES=300` draws so many.
"""

import os
import random
import shutil
import subprocess
import zlib

import h5py
import numpy as np
import pytest
from test_run import BRISANCE, DECK, run, tables

DAMAGES = int(os.environ.get("BRISANCE_DAMAGES", "30"))
SEAL = 512  # bytes


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """A run that stopped at step 60 of about 100, with one checkpoint."""
    folder = tmp_path_factory.mktemp("stopped")
    (folder / "slab.nml").write_text(DECK)
    run("run", "slab.nml", "--set", "run.max_steps=60", cwd=folder)
    for old in sorted(results(folder).glob("chk_*.h5"))[:-1]:
        old.unlink()
    return folder


@pytest.fixture
def scene(stopped, tmp_path):
    shutil.copytree(stopped, tmp_path, dirs_exist_ok=True)
    return tmp_path


def results(scene):
    return scene / "out" / "slab"


def checkpoint(scene):
    return max(results(scene).glob("chk_*.h5"))


def go_on(scene, code, word="", which="latest"):
    """A restart ends with this code in some seconds, and one clear text has the word in it."""
    done = run("run", "slab.nml", "--restart", which, cwd=scene, code=code)
    assert word in done.stderr
    assert "Backtrace" not in done.stderr and "HDF5-DIAG" not in done.stderr
    return done


def seal(path):
    """Seal a checkpoint anew, as the program would have."""
    data = bytearray(path.read_bytes())
    title = bytes(data).split(b"\n")[0].decode()
    crc = zlib.crc32(data[SEAL:])
    text = f"{title}\nlength {len(data)}\ncrc32 {crc:08X} from byte {SEAL}\n"
    data[:SEAL] = text.ljust(SEAL - 1).encode() + b"\n"
    path.write_bytes(data)


def test_the_seal_is_a_crc32(scene):
    before = checkpoint(scene).read_bytes()
    seal(checkpoint(scene))
    assert checkpoint(scene).read_bytes() == before


@pytest.mark.parametrize("seed", range(DAMAGES))
def test_no_damage_of_a_checkpoint_gets_past_its_seal(seed, scene):
    rng = random.Random(seed)
    data = bytearray(checkpoint(scene).read_bytes())
    if seed % 3 == 0:
        del data[rng.randrange(len(data)) :]
    else:
        end = SEAL if seed % 10 == 1 else len(data)
        for _ in range(rng.choice([1, 1, 2, 50])):
            data[rng.randrange(end)] ^= 1 << rng.randrange(8)
    checkpoint(scene).write_bytes(data)
    before = tables(results(scene))
    go_on(scene, 4, "no checkpoint that can be read")
    go_on(scene, 4, checkpoint(scene).name, which=checkpoint(scene))
    assert tables(results(scene)) == before


def test_a_checkpoint_of_before_seals_is_refused(scene):
    path = checkpoint(scene)
    path.write_bytes(path.read_bytes()[SEAL:])
    go_on(scene, 4, "another version")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("solid/id", 0),
        ("solid/id", 10**6),
        ("solid/fixed", 9),
        ("solid/body_sums", np.nan),
        ("solid/x", np.inf),
        ("clock/time", -1.0),
        ("clock/cycle", -5),
        ("sums", np.nan),
    ],
)
def test_impossible_values_are_refused(name, value, scene):
    """A checkpoint with a right seal may still be none that Brisance wrote."""
    path = checkpoint(scene)
    with h5py.File(path, "r+") as file:
        array = file[name]
        array[(0,) * array.ndim if array.ndim else ()] = value
    seal(path)
    go_on(scene, 4, f"'{name}'")


def cut(path):
    path.write_bytes(path.read_bytes()[:-80])


def change(path):
    data = path.read_bytes()
    place = len(data) // 2
    path.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])


@pytest.mark.parametrize("harm", [cut, change, os.unlink])
@pytest.mark.parametrize("name", ["energy.csv", "bodies.csv", "gauges.csv"])
def test_lost_rows_are_noticed(name, harm, scene):
    before = tables(results(scene))
    harm(results(scene) / name)
    done = go_on(scene, 4, name)
    assert "--out" in done.stderr
    after = tables(results(scene))
    assert all(after[other] == before[other] for other in after if other != name)
    go_on(scene, 4, name)  # and still: nothing was mended in silence


@pytest.mark.parametrize("name", ["solid_00000.vtkhdf", "air.vtkhdf.series"])
def test_lost_dumps_are_noticed(name, scene):
    os.unlink(results(scene) / name)
    go_on(scene, 4, name)


def test_a_run_goes_on_in_an_empty_folder(scene):
    done = run("run", "slab.nml", "--restart", checkpoint(scene), "--out", "new", cwd=scene)
    assert "holds no histories" in done.stderr
    first = (scene / "new" / "energy.csv").read_text().splitlines()[1]
    last = (results(scene) / "energy.csv").read_text().splitlines()[-1]
    assert float(first.split(",")[0]) > float(last.split(",")[0])


def test_a_history_that_vanishes_ends_the_run(scene):
    """Two seconds of steps without end; the file goes while they are made."""
    endless = ["--set", "run.t_end=1", "--set", "output.report_every=0"]
    process = subprocess.Popen(
        [BRISANCE, "run", "slab.nml", "--out", "long", *endless],
        cwd=scene, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        while "e-0" not in (line := process.stdout.readline()).lower():
            assert line
        (scene / "long" / "energy.csv").unlink()
        _, words = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 4, words
    assert "energy.csv" in words


@pytest.mark.parametrize("args", [["pipe"], ["stl.nml"], ["slab.nml", "--restart", "pipe"]])
def test_pipes_are_refused(args, scene):
    """As a deck, as a surface, as a checkpoint; never waited for."""
    os.mkfifo(scene / "pipe")
    body = DECK.replace("dimension=2", "dimension=3").replace(
        "box=0.02,0.026, 0,0.012, 0,0.001,", "shape='stl', file='pipe',"
    )
    (scene / "stl.nml").write_text(body)
    code = 2 if args[0] == "pipe" else 4
    done = run("run", *args, "--out", "other", cwd=scene, code=code, stdin=subprocess.DEVNULL)
    assert "ordinary file" in done.stderr
