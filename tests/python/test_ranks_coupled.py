# SPDX-License-Identifier: MIT
"""Bodies in air on several processes: the results and restarts of one, from outside."""

import functools
import itertools

import numpy as np
import pytest
from test_ranks import equal_air, go, in_two, needs_mpirun, start
from test_run import ROOT, arrays, history
from tiers import slow

HEAD = """\
&run title = 'pelted', t_end = 6e-5, energy_band = 0.5 /
&air box = 0, 0.28,  0, 0.24,  0, 0.24, cells = 28, 24, 24, activity = {activity},
     bc = 'symmetry', 'outflow', 'wall', 'outflow', 'outflow', 'outflow',
     reconstruction = 'muscl', flux = 'hllc', integrator = 'ssprk2' /
&gas id = 'hot', box = 0, 0.12,  0.02, 0.2,  0.05, 0.24, density = 4, pressure = 3e6,
     velocity = 300, -50, 20 /
&material id = 's', model = 'linear_elastic', density = 200, youngs_modulus = 2e7,
     poisson_ratio = 0.3 /
&interaction law = 'none' /
&gauge id = 'a', at = 0.14, 0.12, 0.12, quantity = 'pressure' /
&gauge id = 'b', at = 0.2, 0.1, 0.16, quantity = 'speed' /
&gauge id = 'c', at = 0.02, 0.03, 0.02, quantity = 'density' /
&output dump_every = 3e-5, history_every = 0 /
"""


def pelted(seed):
    """Boxes and balls, soft and rigid, one driven, that fly at random in a burst."""
    dice = np.random.default_rng(seed)
    words = [HEAD.format(activity=".true." if seed % 2 else ".false.")]
    kinds = [("box", ""), ("box", "formulation = 'rigid'"), ("sphere", "formulation = 'rigid'"),
             ("sphere", ""), ("box", "fix = 'x-', motion_time = 0, 1, motion_velocity = "
                                     "90, 0, 40,  90, 0, 40")]  # fmt: skip
    slots = dice.permutation(list(itertools.product((0, 1), repeat=3)))
    for k, (shape, more) in enumerate(kinds):  # balls reach to all sides of their place
        lo = 0.055 + 0.09 * slots[k] + dice.uniform(0, 0.012, 3)
        side = dice.uniform(0.02, 0.05, 3)
        speed = dice.uniform(-250, 250, 3)
        at = ", ".join(f"{x:.4f}, {x + w:.4f}" for x, w in zip(lo, side, strict=True))
        centre = ", ".join(f"{x:.4f}" for x in lo)
        place = (
            f"box = {at}" if shape == "box" else f"centre = {centre}, radius = {side[0] / 2:.4f}"
        )
        fly = "" if "motion" in more else "velocity = " + ", ".join(f"{v:.1f}" for v in speed)
        words.append(f"&body id = 'b{k}', shape = '{shape}', {place}, spacing = 5e-3, "
                     f"material = 's'\n     {', '.join(w for w in (fly, more) if w)} /\n"
                     f"&gauge id = 'g{k}', body = 'b{k}', at = {centre}, "
                     f"quantity = 'velocity_x' /\n")  # fmt: skip
    return "".join(words)


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The folder of a run on one process, for each seed."""

    @functools.cache
    def alone_with(seed):
        folder = tmp_path_factory.mktemp(f"pelted{seed}")
        go(0, pelted(seed), folder)
        return folder / "out"

    return alone_with


def state_of(folder):
    """The last checkpoint: cells of all processes in one, particles by number."""
    path = sorted(folder.glob("chk_??????.h5"))[-1]
    state = arrays(path)
    if "air/boxes" in state:
        boxes = state.pop("air/boxes").reshape(-1, 6)
        whole = np.zeros((5, *boxes[:, :2:-1].max(axis=0)))
        for r, (i, j, k, ii, jj, kk) in enumerate(boxes):
            part = arrays(path.with_name(f"{path.stem}.part{r + 1:03d}.h5"))
            whole[:, k - 1 : kk, j - 1 : jj, i - 1 : ii] = part["air/u"]
        state["air/u"] = whole
    else:
        u = state["air/u"]
        state["air/u"] = u[(slice(None), *(slice(3, -3) if n > 1 else slice(None)
                                           for n in u.shape[1:]))]  # fmt: skip
    order = np.argsort(state["solid/id"])
    for name, values in state.items():
        if name.startswith("solid/") and values.shape[:1] == order.shape:
            state[name] = values[order]
    state["driven"] = state["solid/rigid"][:, 25:28]  # what drives a body that deforms is a sum
    state["solid/rigid"] = np.delete(state["solid/rigid"], range(25, 28), axis=1)
    return state


# What rounds apart: sums over steps. What one process alone writes, or writes in another way.
BOOKS = ("coupling/work", "coupling/work_reference", "coupling/impulse",
         "coupling/impulse_reference", "solid/body_sums", "sums", "driven")  # fmt: skip
OTHER = ("air/reached", "air/left", "coupling/solid", "clock/history_bytes", "clock/history_sums")


def equal_states(one, other, sums=()):
    a, b = state_of(one), state_of(other)
    assert set(a) - set(OTHER) == set(b) - set(OTHER)
    for name in set(a) - set(OTHER):
        if name in (*BOOKS, *sums):
            whole = next((word for word in ("impulse", "work") if word in name), name)
            scale = max(np.abs(a[key]).max() for key in (name, f"coupling/{whole}") if key in a)
            assert np.allclose(a[name], b[name], rtol=0, atol=1e-12 * scale), name
        else:
            assert np.array_equal(a[name], b[name]), name


def equal_runs(one, other, sums=()):
    assert (one / "gauges.csv").read_text() == (other / "gauges.csv").read_text()
    equal_air(one, other)
    for file in one.glob("solid_*.vtkhdf"):
        first, second = arrays(file), arrays(other / file.name)
        assert all(np.array_equal(first[path], second[path]) for path in first)
    for name in ("bodies.csv", "energy.csv"):
        a, b = history(one / name), history(other / name)
        for column in a.dtype.names:
            scale = np.abs(a[column]).max()
            if "velocity" in column:  # means over particles that swing faster
                scale = max(scale, 1e-2)
            if name == "energy.csv":
                scale = 1 if "error" in column else max(scale, a["energy_scale[J]"].max())
            assert np.abs(a[column] - b[column]).max() <= 1e-12 * scale, column
    equal_states(one, other, sums)


@pytest.mark.long("runs on several processes")
@needs_mpirun
@pytest.mark.parametrize(
    ("seed", "n"), [(1, 3), slow(2, 3), *(slow(seed, n) for seed in (1, 2) for n in (2, 4))]
)
def test_bodies_in_air_do_not_depend_on_processes(seed, n, alone, tmp_path):
    go(n, pelted(seed), tmp_path)
    equal_runs(alone(seed), tmp_path / "out")


# Bodies that lie across the periodic ends of the air, which is cut in the other directions alone.
BESIDE = {"0, 0.28,  0, 0.24,  0, 0.24, cells = 28, 24, 24": "0.06, 0.22,  0, 0.24,  0.05, 0.21, "
          "cells = 16, 24, 16", "'symmetry', 'outflow', 'wall', 'outflow', 'outflow', 'outflow'":
          "'periodic', 'periodic', 'wall', 'outflow', 'periodic', 'periodic'"}  # fmt: skip


def wrapped():
    deck = pelted(3)
    for old, new in BESIDE.items():
        assert old in deck
        deck = deck.replace(old, new)
    return deck.replace("at = 0.02, 0.03, 0.02", "at = 0.07, 0.03, 0.06")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(3, 2), slow(2, None)])
def test_bodies_across_periodic_ends_do_not_depend_on_processes(n, m, tmp_path):
    go(0, wrapped(), tmp_path, out="one")
    if m is None:
        go(n, wrapped(), tmp_path)
    else:
        in_two(n, m, 25, tmp_path)
    state = arrays(sorted((tmp_path / "one").glob("chk_*.h5"))[-1])
    x = state["solid/x"]
    assert ((x[:, 0] < 0.06) | (x[:, 0] > 0.22) | (x[:, 2] < 0.05)).sum() > 30
    equal_runs(tmp_path / "one", tmp_path / "out")


FLYING_IN = """\
&run title = 'flies in', t_end = 3e-4 /
&air box = 0, 0.4, 0, 0.1, 0, 0.1, cells = 40, 10, 10, bc = 6*'outflow',
     reconstruction = 'muscl', flux = 'hllc', integrator = 'ssprk2' /
&gas id = 'hot', box = 0.15, 0.3,  0.02, 0.08,  0.02, 0.08, density = 4, pressure = 1e6 /
&material id = 's', model = 'linear_elastic', density = 2000, youngs_modulus = 2e8,
     poisson_ratio = 0.3 /
&interaction law = 'none' /
&body id = 'soft', shape = 'box', box = -0.045, 0.005, 0.03, 0.07, 0.03, 0.07, spacing = 5e-3,
      material = 's', velocity = 500, 0, 0 /
&body id = 'hard', shape = 'sphere', centre = 0.41, 0.05, 0.05, radius = 0.02, spacing = 5e-3,
      material = 's', formulation = 'rigid', velocity = -400, 10, 0 /
&gauge id = 'soft', body = 'soft', at = -0.03, 0.05, 0.05, quantity = 'velocity_x' /
&gauge id = 'hard', body = 'hard', at = 0.41, 0.05, 0.05, quantity = 'velocity_x' /
&output dump_every = 1e-4, history_every = 0 /
"""


@needs_mpirun
@pytest.mark.parametrize("n", [slow(2), 3])
def test_bodies_that_fly_into_the_air_do_not_depend_on_processes(n, tmp_path):
    """They drift through many cells without new lists; each part is a guest as soon as it is in."""
    go(0, FLYING_IN, tmp_path, out="one")
    go(n, FLYING_IN, tmp_path, out="several")
    equal_runs(tmp_path / "one", tmp_path / "several")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 3), (2, 0), slow(4, 2)])
def test_bodies_in_air_go_on_on_other_processes(n, m, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(pelted(1))
    done = start(n, "run", "deck.nml", "--out", "out", "--set", "run.max_steps=25", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = start(m, "run", "deck.nml", "--out", "out", "--restart", "latest", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    equal_runs(alone(1), tmp_path / "out")


# Scenes of other tests: a blast that starts in one dimension between planes of symmetry, bodies
# that sleep and are bonded, one that is clamped beside one that stands.
SHORT = {"struck_fragment": 100, "two_plates": 200, "panel": 60}
SEEN = "&gauge id = 'seen', at = 0, 0, -0.3, quantity = 'pressure' /\n"  # of the early rows, too


@needs_mpirun
@pytest.mark.parametrize("name", ["two_plates", slow("struck_fragment"), slow("panel")])
def test_scenes_of_bodies_in_air_give_the_same(name, tmp_path):
    deck = (ROOT / f"tests/scenes/{name}.nml").read_text()
    (tmp_path / f"{name}.nml").write_text(deck + SEEN * ("fragment" in name))
    for n in (0, 3):
        done = start(n, "run", tmp_path / f"{name}.nml", "--out", tmp_path / str(n),
                     "--set", f"run.max_steps={SHORT[name]}", "--set", "output.history_every=0",
                     "--set", "output.dump_every=1e-4")  # fmt: skip
        assert done.returncode == 0, done.stderr
    one, other = tmp_path / "0", tmp_path / "3"
    if (one / "gauges.csv").exists():
        assert (one / "gauges.csv").read_text() == (other / "gauges.csv").read_text()
    equal_states(one, other)


COARSE = ["air.cells=16,16,60", "body(plate).spacing=4.2e-3",
          "run.t_end=2e-4", "output.dump_every=5e-5"]  # fmt: skip


@pytest.mark.slow
@needs_mpirun
def test_the_demo_is_the_same_on_processes(tmp_path):
    """Coarse, until the plate has got its blow."""
    for n in (0, 2, 4):
        done = start(n, "run", ROOT / "inputs/demo.nml", "--out", tmp_path / str(n),
                     *(word for change in COARSE for word in ("--set", change)))  # fmt: skip
        assert done.returncode == 0, done.stderr
        if n > 0:
            equal_runs(tmp_path / "0", tmp_path / str(n))
    gauges = history(tmp_path / "0/gauges.csv")
    assert np.abs(gauges["mid_v:velocity_z[m/s]"]).max() > 5


@needs_mpirun
@pytest.mark.parametrize(
    ("deck", "args", "reason"),
    [
        ("inputs/demo.nml", ["--set", "coupling.scheme='paper'"], "the coupling scheme='paper'"),
        ("tests/scenes/blown_disc.nml", [], "with bodies no periodic one is cut; run 1 at most"),
    ],
)
def test_what_bodies_in_air_cannot_do_is_refused(deck, args, reason, tmp_path):
    done = start(3, "run", ROOT / deck, "--out", tmp_path / "out", *args)
    assert done.returncode == 2
    assert reason in done.stderr.splitlines()[-1]
    assert not (tmp_path / "out").exists()


def test_a_check_counts_the_halo_and_what_is_in_it(tmp_path):
    """Ten layers of cells beyond the box, and one more for copies; five of six layers of particles
    lie in both."""
    (tmp_path / "deck.nml").write_text(
        "&run t_end = 1e-5 /\n"
        "&air box = 0, 0.16, 0, 0.16, 0, 0.32, cells = 16, 16, 32 /\n"
        "&material id = 's', preset = 'rebar' /\n"
        "&body id = 'p', shape = 'box', box = 0.02, 0.12, 0.02, 0.14, 0.245, 0.275,\n"
        "     spacing = 5e-3, material = 's' /\n"
    )
    done = start(0, "run", "deck.nml", "--check", "--ranks", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("4096 of its own, 2560 of neighbours") == 2
    assert "process    1: 2400 particles in its window" in done.stdout
    assert "process    2: 2880 particles in its window" in done.stdout
