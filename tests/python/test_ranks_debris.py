# SPDX-License-Identifier: MIT
"""An impact that throws up debris: lists are built anew in nearly every step, on one process in
part, of several bodies in one step. Several processes and GPUs have the results of one."""

import pytest
from test_gpu import EMULATOR, stamp
from test_ranks import equal_bodies, needs_mpirun, start
from test_run import arrays
from tiers import slow

# off the planes x = 0 and y = 0: where a middle is must not be rounding alone
PLACES = ["5e-4, 7e-4, -1e-4", "9e-4, 8e-4, -8e-4", "0, 1e-3, -1.6e-3", "1.5e-3, -1e-4, -3e-4",
          "2.5e-3, 2.7e-3, -2e-3", "-6e-4, 7e-4, -1.2e-3"]  # fmt: skip
DEBRIS = """\
&run title = 'debris', t_end = 1, max_steps = 45, energy_band = 1 /
&material id = 'aluminium', preset = 'al2024_paper' /
&material id = 'cfrp', preset = 'cfrp_ud', pressure = 'anderson' /
&body id = 'ball', shape = 'sphere', centre = 5e-4, 7e-4, 1.05e-3, radius = 0.75e-3, spacing = 3e-4,
     material = 'aluminium', velocity = 200, 100, -4960 /
&body id = 'plate', shape = 'box', box = -0.003, 0.0042, -0.0029, 0.0043, -0.0024, 0,
     spacing = 3e-4, material = 'cfrp', plies = '45/0/-45/90', fix = 'sides',
     formulation = 'corrected_hourglass' /
&interaction bodies = 'ball', 'plate', law = 'contact', shared_pressure = .true. /
&output history_every = 0 /
""" + "".join(
    f"&gauge id = 'g{k}', body = 'plate', at = {at}, quantity = 'velocity_z' /\n"
    for k, at in enumerate(PLACES)
)


def two_are_one(folder):
    """Two GPUs have the results of one for deck.nml of a folder."""
    (folder / "good.ptx").write_text(f"// {stamp()}\n")
    gpu = {"LD_LIBRARY_PATH": str(EMULATOR), "BRISANCE_PTX": str(folder / "good.ptx")}
    for n, out in [(0, "one"), (2, "two")]:
        done = start(n, "run", "deck.nml", "--backend", "gpu", "--out", out, cwd=folder, **gpu)
        assert done.returncode == 0, done.stderr
    equal_bodies(folder / "one", folder / "two")


@needs_mpirun
@pytest.mark.parametrize("backend", ["cpu", slow("gpu")])
def test_debris_does_not_depend_on_processes(backend, tmp_path):
    """Two go on from one in the middle, too."""
    (tmp_path / "deck.nml").write_text(DEBRIS.replace("max_steps = 45", "max_steps = 32"))
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n")
    gpu = {"LD_LIBRARY_PATH": str(EMULATOR), "BRISANCE_PTX": str(tmp_path / "good.ptx")}
    for n, out, more in [(0, "one", []), (2, "two", []), (0, "both", ["--set", "run.max_steps=20"]),
                         (2, "both", ["--restart", "latest"])]:  # fmt: skip
        done = start(n, "run", "deck.nml", "--backend", backend, "--out", out, *more, cwd=tmp_path,
                     **gpu)  # fmt: skip
        assert done.returncode == 0, done.stderr
    for name in ("two", "both"):
        equal_bodies(tmp_path / "one", tmp_path / name)
    parts = arrays(sorted((tmp_path / "one").glob("chk_*.h5"))[-1])["solid/body_cells"][:, 6]
    assert parts.max() > 0


@needs_mpirun
@pytest.mark.long("the emulated GPUs of two processes, until a ball has changed between them")
def test_the_room_of_a_body_grows(tmp_path):
    """A ball slides along a plate to another GPU, which lays its arrays anew in the middle: the
    pressure that bodies share in contact reads stresses that lie further apart then."""
    deck = DEBRIS.replace("centre = 5e-4, 7e-4", "centre = -2.2e-3, 7e-4")
    deck = deck.replace("200, 100, -4960", "6000, 100, -900")
    (tmp_path / "deck.nml").write_text(deck.replace("-0.003, 0.0042", "-0.0042, 0.0039"))
    two_are_one(tmp_path)


# what is summed up step by step: on a GPU a restart begins partial sums anew
SUMS = {"clock/history_sums", "solid/body_sums"}


@pytest.mark.parametrize("backend, steps", [("cpu", 20), ("gpu", 20), slow("gpu", 40)])
def test_lists_in_part_go_on_after_a_restart(backend, steps, tmp_path):
    """How often lists were built in part, and their cells on a GPU, decide on the order of sums."""
    deck = DEBRIS if steps > 20 else DEBRIS.replace("max_steps = 45", "max_steps = 30")
    (tmp_path / "deck.nml").write_text(deck)
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n")
    gpu = {"LD_LIBRARY_PATH": str(EMULATOR), "BRISANCE_PTX": str(tmp_path / "good.ptx")}
    last = {}
    for out, more in [("whole", []), ("parts", ["--set", f"run.max_steps={steps}"]),
                      ("parts", ["--restart", "latest"])]:  # fmt: skip
        done = start(0, "run", "deck.nml", "--backend", backend, "--out", out, *more, cwd=tmp_path,
                     **gpu)  # fmt: skip
        assert done.returncode == 0, done.stderr
        last[out] = arrays(sorted((tmp_path / out).glob("chk_*.h5"))[-1])
    other = {name for name, values in last["whole"].items()
             if values.tobytes() != last["parts"][name].tobytes()}  # fmt: skip
    assert other <= (SUMS if backend == "gpu" else set())


STEP = """\
&run title = 'chip', t_end = 1, max_steps = {steps}, energy_band = 1 /
&solid skin = {skin} /
&material id = 'aluminium', preset = 'al2024_paper' /
&body id = 'plate', shape = 'particles', file = 'at.csv', start_file = 'at.csv', spacing = 3e-4,
     material = 'aluminium', formulation = 'corrected_hourglass' /
&output history_every = 0 /
&gauge id = 'g', body = 'plate', at = 1.5e-4, 1.5e-4, 1.5e-4, quantity = 'velocity_x' /
"""
BLOCK = [(i, j, k) for i in range(12) for j in range(6) for k in range(3)]
WALL = [(i, j, k) for i in range(12, 16) for j in range(6) for k in range(9)]
CHIP = [(i, j, k) for i in range(2) for j in range(2) for k in range(2)]


def scene(particles, chip, at, velocity):
    """A table of particles with their velocities, in spacings of 3e-4 m; a chip flies."""
    rows = [(*p, 0, 0, 0) for p in particles]
    rows += [(*(c + a for c, a in zip(p, at, strict=True)), *velocity) for p in chip]
    head = "x,y,z,velocity_x,velocity_y,velocity_z\n"
    return head + "".join(
        ",".join(f"{(v + 0.5) * 3e-4:.6e}" if n < 3 else f"{v}" for n, v in enumerate(row)) + "\n"
        for row in rows
    )


# A chip of one half flies at a wall that begins where the other half does: it is a ghost there, and
# near, from one step to the next. And one that flies above both: what it passes are ghosts of its
# process although it has left its region.
CHIPS = {
    "against": (0.1, 11, [*BLOCK, (11.95, 12, 0), *WALL, *((16, 2, k) for k in range(3))],
                CHIP[::4], (6.5, 2, 5.01), (6000, 5, 3)),
    "over": (0.3, 16, [(i, j, k) for i in range(30) for j in range(5) for k in range(3)], CHIP,
             (11.2, 1.7, 4.6), (4500, 150, -900)),
}  # fmt: skip


@needs_mpirun
@pytest.mark.parametrize("name", CHIPS)
def test_a_chip_that_flies_past_another_process(name, tmp_path):
    """Lists in part of one body whose particles cross between the GPUs."""
    skin, steps, particles, chip, at, velocity = CHIPS[name]
    (tmp_path / "deck.nml").write_text(STEP.format(skin=skin, steps=steps))
    (tmp_path / "at.csv").write_text(scene(particles, chip, at, velocity))
    two_are_one(tmp_path)
    parts = arrays(sorted((tmp_path / "two").glob("chk_*.h5"))[-1])["solid/body_cells"][:, 6]
    assert parts.max() > 0
