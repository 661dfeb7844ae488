# SPDX-License-Identifier: MIT
"""Installed, packed and taken from an archive: everything finds what it needs."""

import os
import re
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

import gpu_build  # noqa: E402
from cuda_fortran import Fault  # noqa: E402

DECK = """&run t_end=1e-6 /
&material id='m', preset='al6061' /
&body id='b', box=0,0.01, 0,0.01, 0,0.004, spacing=1e-3, material='m', velocity=1,0,0 /
&output history_every=1e-7 /
"""


def call(*command, cwd=None, **more):
    env = {k: v for k, v in os.environ.items() if not k.startswith(("BRISANCE", "PYTHONPATH"))}
    command = [str(word) for word in command]
    return subprocess.run(command, cwd=cwd, env=env | more, capture_output=True, text=True)


def stamp():
    text = (ROOT / "build/cpu/version.f90").read_text(encoding="utf-8")
    return re.search(r"device_code = &\s*'(\w+)'", text)[1]


@pytest.fixture(name="place")
def _place(tmp_path):
    """What `make install` leaves, moved since; its GPU code is a line for the emulated driver."""
    program = tmp_path / "built"
    program.write_bytes((ROOT / "bin/brisance").read_bytes())
    program.chmod(0o755)
    (tmp_path / "built.ptx").write_text(f"// {stamp()}\n")
    script = ROOT / "scripts/install.sh"
    done = call(script, program, "brisance", stamp(), "/usr", tmp_path / "stage")
    assert done.returncode == 0, done.stderr
    (tmp_path / "stage/usr").rename(tmp_path / "moved")
    return tmp_path / "moved"


def test_what_is_installed_runs_from_anywhere(place, tmp_path):
    (tmp_path / "a.nml").write_text(DECK)
    program, emulator = place / "bin/brisance", ROOT / "build/gpu/emulator"
    done = call(program, "run", "a.nml", "--backend", "gpu", cwd=tmp_path, LD_LIBRARY_PATH=emulator)
    assert done.returncode == 0, done.stderr
    assert "Emulated GPU" in done.stderr
    (place / "lib/brisance/brisance.ptx").write_text("// of other sources\n")
    done = call(program, "run", "a.nml", "--backend", "gpu", "--replace", cwd=tmp_path,
                LD_LIBRARY_PATH=emulator)  # fmt: skip
    assert done.returncode != 0
    assert "lib/brisance/brisance.ptx" in done.stderr
    beside = place / "bin/brisance.ptx"
    beside.write_text(f"// {stamp()}\n")
    done = call(program, "run", "a.nml", "--backend", "gpu", "--replace", cwd=tmp_path,
                LD_LIBRARY_PATH=emulator)  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_the_installed_tools_say_their_name_or_what_they_lack(place):
    command = place / "bin/brisance-post"
    done = call(command, "--help", BRISANCE_PYTHON=sys.executable)
    assert done.stdout.startswith("usage: brisance-post"), done.stderr
    done = call(command, "--help", BRISANCE_PYTHON="/usr/bin/false")
    assert done.returncode == 1
    needs = re.search(r"-m pip install -r (\S+)", done.stderr)[1]
    assert "h5py==" in Path(needs).read_text()
    assert "pytest" not in Path(needs).read_text()
    assert (place / "share/brisance/inputs/presets/tnt_jwl.nml").is_file()


def test_gpu_code_of_other_sources_is_not_installed(tmp_path):
    program = tmp_path / "brisance"
    program.write_text("#!/bin/sh\n")
    (tmp_path / "brisance.ptx").write_text("// old\n")
    done = call(ROOT / "scripts/install.sh", program, "brisance", "new", tmp_path / "usr")
    assert "without GPU code: run make gpu" in done.stdout
    assert not list((tmp_path / "usr/lib").rglob("*.ptx"))


def test_gpu_code_of_an_archive_is_taken_where_no_compiler_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    args = SimpleNamespace(out=Path("bin/brisance-portable-mixed.ptx"), stamp="a1", no_fma=False)
    with pytest.raises(Fault, match="make dist"):
        gpu_build.take_shipped(args, "flang-22 is not installed")
    Path("ptx").mkdir()
    Path("ptx/brisance-mixed.ptx").write_text("// b2\ncode\n")
    with pytest.raises(Fault, match="is of other sources"):
        gpu_build.take_shipped(args, "flang-22 is not installed")
    Path("ptx/brisance-mixed.ptx").write_text("// a1\ncode\n")
    gpu_build.take_shipped(args, "flang-22 is not installed")
    assert args.out.read_text() == "// a1\ncode\n"


def test_the_archive_carries_sources_commit_and_gpu_code(tmp_path):
    identity = ("-c", "user.name=a", "-c", "user.email=a@example.org")
    (tmp_path / "scripts").mkdir()
    for name in ("dist.sh", "version.py"):
        (tmp_path / "scripts" / name).write_bytes((ROOT / "scripts" / name).read_bytes())
        (tmp_path / "scripts" / name).chmod(0o755)
    for command in (("init", "-q"), ("add", "."), (*identity, "commit", "-q", "-m", "a")):
        assert call("git", *command, cwd=tmp_path).returncode == 0
    for name in ("one", "two"):
        (tmp_path / f"{name}.ptx").write_text("// 0a\n")
    done = call("scripts/dist.sh", "9.9", "0b", "one.ptx", "two.ptx", cwd=tmp_path)
    assert done.returncode == 1
    assert "one.ptx is of other sources" in done.stderr
    done = call("scripts/dist.sh", "9.9", "0a", "one.ptx", "two.ptx", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with tarfile.open(tmp_path / "build/dist/brisance-9.9.tar.gz") as archive:
        archive.extractall(tmp_path / "else", filter="data")
    home = tmp_path / "else/brisance-9.9"
    found = {str(path.relative_to(home)) for path in home.rglob("*") if path.is_file()}
    assert found == {"COMMIT", "ptx/one.ptx", "ptx/two.ptx", "scripts/dist.sh",
                     "scripts/version.py"}  # fmt: skip
    words = [f"--{w}=x" for w in ("version", "compiler", "flags", "precision", "device-code")]
    said = call(home / "scripts/version.py", *words, cwd=home, GIT_CEILING_DIRECTORIES=home.parent)
    commit = call("git", "describe", "--always", "--abbrev=12", cwd=tmp_path).stdout.strip()
    assert f"'{commit}'" in said.stdout


def test_the_package_of_the_tools_is_what_the_program_needs():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    pinned = (ROOT / "requirements.txt").read_text().splitlines()
    assert set(project["dependencies"]) <= set(pinned)
    module, name = project["scripts"]["brisance-post"].split(":")
    done = call(sys.executable, "-c", f"from {module} import {name}", cwd=ROOT)
    assert done.returncode == 0, done.stderr
    used = set()
    for path in (ROOT / "post").glob("*.py"):
        used |= set(re.findall(r"^\s*(?:import|from) (\w+)", path.read_text(), re.MULTILINE))
    names = {"h5py", "matplotlib", "numpy", "pyvista", "vtk", "f90nml", "imageio_ffmpeg", "scipy"}
    listed = {line.split("==")[0].replace("-", "_") for line in project["dependencies"]}
    assert used & names <= listed
    version = re.search(r"^VERSION := (\S+)", (ROOT / "Makefile").read_text(), re.MULTILINE)[1]
    assert project["version"] == version
