# SPDX-License-Identifier: MIT
"""Several processes with a GPU each, on an emulated driver: the results of one GPU, restarts on any
number, errors of one process."""

import csv
import re
import subprocess

import numpy as np
import pytest
from test_gpu import EMULATOR, stamp
from test_ranks import (
    AIR,
    MATERIALS,
    MPIRUN,
    TOGETHER,
    equal_air,
    equal_bodies,
    needs_mpirun,
    start,
)
from test_ranks_bodies import MEETING
from test_ranks_coupled import equal_runs, equal_states, pelted, wrapped
from test_ranks_cut import SHORT as STEPS
from test_ranks_cut import TORN as CUT
from test_ranks_cut import write_bodies
from test_ranks_loads import LOADED, LOST, TORN
from test_run import BRISANCE, ROOT, arrays, history
from tiers import slow


@pytest.fixture(name="gpu", scope="module")
def _gpu(tmp_path_factory):
    """What a run on the GPU needs in its environment."""
    code = tmp_path_factory.mktemp("code") / "good.ptx"
    code.write_text(f"// {stamp()}\n", encoding="utf-8")
    return {"LD_LIBRARY_PATH": str(EMULATOR), "BRISANCE_PTX": str(code)}


def go(n, folder, gpu, *args, deck=AIR, out="out", **more):
    (folder / "deck.nml").write_text(deck)
    return start(n, "run", "deck.nml", "--backend", "gpu", "--out", out, *args, cwd=folder,
                 **gpu, **more)  # fmt: skip


@pytest.fixture(name="alone", scope="module")
def _alone(gpu, tmp_path_factory):
    """The folder of a run on one GPU."""
    folder = tmp_path_factory.mktemp("alone")
    done = go(0, folder, gpu)
    assert done.returncode == 0, done.stderr
    return folder / "out"


def rows(path):
    with path.open(encoding="utf-8") as file:
        return [[float(x) for x in row] for row in list(csv.reader(file))[1:]]


@needs_mpirun
@pytest.mark.parametrize("n", [slow(1), 2, slow(4)])
def test_air_does_not_depend_on_gpus(n, gpu, alone, tmp_path):
    done = go(n, tmp_path, gpu, BRISANCE_EMULATOR_DEVICES="4")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("Emulated GPU") == 1
    assert (f", each of {n} processes on one" in done.stderr) == (n > 1)
    for name in ("gauges.csv", "energy.csv"):
        assert (alone / name).read_text() == (tmp_path / "out" / name).read_text(), name
    equal_air(alone, tmp_path / "out")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 2), slow(2, 0), slow(2, 3), slow(4, 2)])
def test_other_gpus_go_on(n, m, gpu, alone, tmp_path):
    """The state has the same bits; what has left through the boundaries is added up anew."""
    done = go(n, tmp_path, gpu, "--set", "run.max_steps=20")
    assert done.returncode == 0, done.stderr
    done = go(m, tmp_path, gpu, "--restart", "latest")
    assert done.returncode == 0, done.stderr
    assert (alone / "gauges.csv").read_text() == (tmp_path / "out/gauges.csv").read_text()
    equal_air(alone, tmp_path / "out")
    largest = max(abs(x) for row in rows(alone / "energy.csv") for x in row)
    for a, b in zip(rows(alone / "energy.csv"), rows(tmp_path / "out/energy.csv"), strict=True):
        assert a == pytest.approx(b, rel=1e-11, abs=1e-14 * largest)


@needs_mpirun
def test_the_gpus_of_a_machine_are_shared_out(gpu, tmp_path):
    done = go(3, tmp_path, gpu, "--set", "run.max_steps=1", BRISANCE_EMULATOR_DEVICES="2")
    assert done.returncode == 0, done.stderr
    assert ", 3 processes of a machine share the 2 that each of them sees" in done.stderr


@needs_mpirun
@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("BRISANCE_EMULATOR_FAIL=cuDeviceGetCount", "no GPU: the CUDA driver is there but shows"),
        ("BRISANCE_EMULATOR_MEMORY=100000", "MiB on the GPU, but only 0 MiB are free"),
        ("BRISANCE_EMULATOR_FAIL=cuLaunchKernel:40", "launching "),
        ("BRISANCE_EMULATOR_FAIL=cuMemcpyDtoH_v2:9", "a kernel before it"),
    ],
)
def test_what_goes_wrong_in_one_ends_all(fault, words, gpu, tmp_path):
    (tmp_path / "deck.nml").write_text(AIR)
    program = f"{BRISANCE} run deck.nml --backend gpu --out out"
    command = f"{MPIRUN} -n 1 {program} : -n 1 env {fault} {program} : -n 1 {program}"
    done = subprocess.run(command.split(), cwd=tmp_path, env={**TOGETHER, **gpu}, check=False,
                          capture_output=True, text=True, timeout=60)  # fmt: skip
    assert done.returncode == 5, done.stderr
    said = [line for line in done.stderr.splitlines() if "process 2 of 3: " in line]
    assert len(said) == 1, done.stderr
    assert words in said[0]


@needs_mpirun
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("solid_00001.vtkhdf.002.parcel.tmp", "the dump of t = 1.0"),
        ("solid.vtkhdf.series.tmp", "solid.vtkhdf.series"),
    ],
)
def test_what_cannot_be_written_beside_the_run_ends_it(name, words, gpu, tmp_path):
    """A folder where process 2 hands its particles over, or where the first names a dump."""
    (tmp_path / "out" / name / "x").mkdir(parents=True)
    done = go(3, tmp_path, gpu, deck=APART)
    assert done.returncode == 4, done.stderr
    assert words in done.stderr
    assert not list(tmp_path.glob("out/*.parcel")) and not list(tmp_path.glob("out/chk_*.tmp"))


@needs_mpirun
def test_a_driver_that_cannot_pin_memory_serves(gpu, alone, tmp_path):
    done = go(2, tmp_path, gpu, BRISANCE_EMULATOR_FAIL="cuMemHostRegister_v2",
              BRISANCE_TRANSPORT="mpi")  # fmt: skip
    assert done.returncode == 0, done.stderr
    equal_air(alone, tmp_path / "out")


def through_the_bus(stderr):
    """Bytes from the device of all processes."""
    return sum(int(n) for n in re.findall(r"bus: .* (\d+) to the host", stderr))


@needs_mpirun
@pytest.mark.parametrize("fault", ["cuIpcOpenMemHandle_v2:2", slow("cuIpcGetMemHandle")])
def test_gpus_that_do_not_see_each_other_serve(fault, gpu, tmp_path):
    """Parcels go by the host then, and only then."""
    said = []
    for k, more in enumerate(({}, {"BRISANCE_EMULATOR_FAIL": fault})):
        done = go(2, tmp_path, gpu, "--set", "run.max_steps=12", deck=APART, out=f"out{k}",
                  BRISANCE_EMULATOR_COUNT="1", **more)  # fmt: skip
        assert done.returncode == 0, done.stderr
        said.append(through_the_bus(done.stderr))
    equal_bodies(tmp_path / "out0", tmp_path / "out1")
    assert said[0] < said[1]


@needs_mpirun
def test_the_cpu_is_taken_where_nothing_is_asked_for(gpu, tmp_path):
    (tmp_path / "deck.nml").write_text(AIR)
    done = start(2, "run", "deck.nml", "--set", "run.max_steps=1", cwd=tmp_path, **gpu)
    assert done.returncode == 0, done.stderr
    assert "GPU" not in done.stderr


# Bodies that do not meet: steel that is drawn until it fails beside two planes of symmetry, a
# total-Lagrangian plate, a block of variable smoothing length, one with stiff hourglass forces that
# are summed along its plies, one of plain gradients.
APART = f"""\
&run title = 'apart', t_end = 2e-6, symmetry = 'x', 'z', energy_band = 0.5 /
{MATERIALS}\
&material id = 'p', preset = 'cfrp_ud' /
&body id = 'bar', shape = 'box', box = 0,0.008, 0,0.005, 0,0.005, spacing = 1e-3, material = 's',
     fix = 'x+', velocity = -900,10,30 /
&body id = 'plate', shape = 'box', box = 0,0.009, 0.03,0.032, 0,0.009, spacing = 1e-3,
     material = 'm', velocity = 20,900,30, formulation = 'total_lagrangian' /
&body id = 'block', shape = 'box', box = 0,0.007, 0.035,0.039, 0.03,0.037, spacing = 1e-3,
     material = 's', velocity = 50,400,900, spin = 2e5,1e5,0, variable_h = .true. /
&body id = 'plies', shape = 'box', box = 0.02,0.028, 0.01,0.013, 0.02,0.027, spacing = 1e-3,
     material = 'p', plies = '0/90/0', velocity = 900,300,100,
     spin = 0,2e5,5e4, formulation = 'bending' /
&body id = 'plain', shape = 'box', box = 0.04,0.046, 0.01,0.014, 0,0.006, spacing = 1e-3,
     material = 'm', velocity = 40,300,-700, formulation = 'corrected' /
&interaction law = 'none' /
&gauge id = 'end', body = 'bar', at = 0.0035,0.001,0.001, quantity = 'displacement_x' /
&gauge id = 'middle', body = 'block', at = 0.006,0.038,0.036, quantity = 'speed' /
&gauge id = 'stress', body = 'plies', at = 0.0245,0.0115,0.0235, quantity = 'stress_xx' /
&output dump_every = 1e-6, history_every = 0 /
"""


@pytest.fixture(name="bodies", scope="module")
def _bodies(gpu, tmp_path_factory):
    """The folder of a run of bodies on one GPU."""
    folder = tmp_path_factory.mktemp("bodies")
    done = go(0, folder, gpu, deck=APART)
    assert done.returncode == 0, done.stderr
    return folder / "out"


@needs_mpirun
@pytest.mark.parametrize("n", [2, slow(4)])
def test_bodies_do_not_depend_on_gpus(n, gpu, bodies, tmp_path):
    done = go(n, tmp_path, gpu, deck=APART, BRISANCE_EMULATOR_DEVICES="4")
    assert done.returncode == 0, done.stderr
    assert f", each of {n} processes on one" in done.stderr
    equal_bodies(bodies, tmp_path / "out")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 3), slow(2, 0)])
def test_bodies_go_on_on_other_gpus(n, m, gpu, bodies, tmp_path):
    done = go(n, tmp_path, gpu, "--set", "run.max_steps=15", deck=APART)
    assert done.returncode == 0, done.stderr
    done = go(m, tmp_path, gpu, "--restart", "latest", deck=APART)
    assert done.returncode == 0, done.stderr
    equal_bodies(bodies, tmp_path / "out")


SHORT = ("--set", "run.max_steps=40")


LEAVING = MEETING + "&solid region = -1,0.0097, -1,1, -0.0022,1, leave = 'remove' /\n"


@pytest.fixture(name="met", scope="module", params=["meeting", "loaded", "leaving"])
def _met(request, gpu, tmp_path_factory):
    """Bodies that meet, with friction, bonds that break, a rigid and a driven one; or loaded ones;
    or such that leave the region: the deck, and the folder of a run on one GPU."""
    # the plate is off the plane x = 0: where its middle is must not be rounding alone
    deck = {"meeting": MEETING, "loaded": LOADED.replace("= -0.02,0.02,", "= -0.018,0.022,", 1),
            "leaving": LEAVING}[request.param]  # fmt: skip
    folder = tmp_path_factory.mktemp(request.param)
    done = go(0, folder, gpu, *SHORT, deck=deck)
    assert done.returncode == 0, done.stderr
    gone = arrays(sorted((folder / "out").glob("chk_*.h5"))[-1])["solid/fixed"] == 2
    assert (5 < gone.sum() < 50) == (request.param == "leaving")
    return deck, folder / "out"


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [slow(2, None), slow(4, None), (3, 2)])
def test_bodies_that_meet_and_are_loaded_do_not_depend_on_gpus(n, m, gpu, met, tmp_path):
    deck, alone = met
    more = () if m is None else ("--set", "run.max_steps=18")
    done = go(n, tmp_path, gpu, *(more or SHORT), deck=deck)
    assert done.returncode == 0, done.stderr
    if m is not None:
        done = go(m, tmp_path, gpu, "--restart", "latest", *SHORT, deck=deck)
        assert done.returncode == 0, done.stderr
    equal_bodies(alone, tmp_path / "out")


# (make test has it on processes, and loaded faces on GPUs)
@pytest.mark.slow
@needs_mpirun
def test_a_loaded_face_may_be_torn_on_gpus(gpu, tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    for folder, n, m in [(one, 0, 0), (two, 2, 3)]:
        folder.mkdir()
        for k, more in [(n, ("--set", "run.max_steps=50")), (m, ("--restart", "latest"))]:
            done = go(k, folder, gpu, *more, deck=TORN)
            assert done.returncode == 0, done.stderr
    equal_bodies(one / "out", two / "out")


@needs_mpirun
@pytest.mark.parametrize("n", [0, 3])
def test_a_place_that_is_no_number_ends_all_gpus(n, gpu, tmp_path):
    done = go(n, tmp_path, gpu, deck=LOST)
    assert done.returncode == 3
    assert done.stderr.count("particle of body 'bar' has a place that is no number") == 1


@needs_mpirun
def test_what_leaves_a_gpu_is_what_leaves_the_cpu(gpu, tmp_path):
    (tmp_path / "deck.nml").write_text(LEAVING)
    done = start(0, "run", "deck.nml", "--backend", "cpu", "--out", "cpu", *SHORT, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = go(0, tmp_path, gpu, *SHORT, deck=LEAVING)
    assert done.returncode == 0, done.stderr
    for name, columns in (("energy", ("removed[kg]", "removed[J]", "contact[J]", "hourglass[J]")),
                          ("gauges", ("edge:speed[m/s]",))):  # fmt: skip
        one, other = (history(tmp_path / f / f"{name}.csv") for f in ("cpu", "out"))
        for column in columns:
            assert one[column].max() > 0
            np.testing.assert_allclose(one[column], other[column], rtol=1e-9, atol=1e-12)


PELTED = ("--set", "run.max_steps=40")


@pytest.fixture(name="pelted_alone", scope="module")
def _pelted_alone(gpu, tmp_path_factory):
    """The folder of a run of soft, rigid and driven bodies in a burst on one GPU."""
    folder = tmp_path_factory.mktemp("pelted")
    done = go(0, folder, gpu, *PELTED, deck=pelted(2))
    assert done.returncode == 0, done.stderr
    return folder / "out"


@pytest.mark.long("several GPUs are emulated")
@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(2, None), slow(4, None), slow(4, 3)])
def test_bodies_in_air_do_not_depend_on_gpus(n, m, gpu, pelted_alone, tmp_path):
    """Cells open and close beside boxes; after a restart outflow is to rounding. By the host,
    too."""
    more = {"BRISANCE_TRANSPORT": "mpi"} if n == 2 else {}
    args = PELTED if m is None else ("--set", "run.max_steps=18")
    done = go(n, tmp_path, gpu, *args, deck=pelted(2), **more)
    assert done.returncode == 0, done.stderr
    if m is not None:
        done = go(m, tmp_path, gpu, "--restart", "latest", *PELTED, deck=pelted(2))
        assert done.returncode == 0, done.stderr
    equal_runs(pelted_alone, tmp_path / "out", () if m is None else ("air/outflow",))


@pytest.mark.slow
@needs_mpirun
def test_bodies_across_periodic_ends_do_not_depend_on_gpus(gpu, tmp_path):
    for n in (0, 3):
        (tmp_path / str(n)).mkdir()
        done = go(n, tmp_path / str(n), gpu, *PELTED, deck=wrapped())
        assert done.returncode == 0, done.stderr
    equal_runs(tmp_path / "0/out", tmp_path / "3/out")


@needs_mpirun
@pytest.mark.parametrize(
    "fault",
    ["BRISANCE_EMULATOR_FAIL=cuLaunchKernel:3000", "BRISANCE_EMULATOR_FAIL=cuMemAlloc_v2:150"],
)
def test_what_goes_wrong_among_bodies_in_air_ends_all(fault, gpu, tmp_path):
    (tmp_path / "deck.nml").write_text(pelted(2))
    program = f"{BRISANCE} run deck.nml --backend gpu --out out"
    command = f"{MPIRUN} -n 1 {program} : -n 1 env {fault} {program}"
    done = subprocess.run(command.split(), cwd=tmp_path, env={**TOGETHER, **gpu}, check=False,
                          capture_output=True, text=True, timeout=60)  # fmt: skip
    assert done.returncode == 5, done.stderr
    assert "process 2 of 2: " in done.stderr


@pytest.fixture(name="cut_alone", scope="module")
def _cut_alone(gpu, tmp_path_factory):
    """The folder of a run by cut cells on one GPU: bodies that are held, rigid and torn lie where
    boxes meet."""
    folder = tmp_path_factory.mktemp("cut")
    write_bodies(folder)
    done = go(0, folder, gpu, deck=CUT)
    assert done.returncode == 0, done.stderr
    return folder / "out"


@pytest.mark.long("several GPUs are emulated")
@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(2, None), (3, 2), slow(3, None), slow(4, None), slow(0, 3)])
def test_cut_cells_do_not_depend_on_gpus(n, m, gpu, cut_alone, tmp_path):
    """Nor does a restart; then sums over steps are to rounding. By the host, too."""
    more = {"BRISANCE_TRANSPORT": "mpi"} if n == 2 else {}
    write_bodies(tmp_path)
    done = go(n, tmp_path, gpu, *(("--set", "run.max_steps=35") if m else ()), deck=CUT, **more)
    assert done.returncode in (0, 3), done.stderr
    if m is None:
        equal_runs(cut_alone, tmp_path / "out")
        return
    done = go(m, tmp_path, gpu, "--restart", "latest", deck=CUT)
    assert done.returncode == 0, done.stderr
    equal_states(cut_alone, tmp_path / "out", ("air/outflow",))


@needs_mpirun
@pytest.mark.parametrize("name", ["disc", *(slow(name) for name in STEPS if name != "disc")])
def test_scenes_with_cut_cells_give_the_same_on_gpus(name, gpu, tmp_path):
    """Of the disc one process sees nothing at first; others have bonds, and bodies that sleep."""
    deck = (ROOT / f"tests/scenes/{name}.nml").read_text()
    for n in (0, 3):
        done = go(n, tmp_path, gpu, "--set", f"run.max_steps={STEPS[name] // 2}", "--set",
                  "output.history_every=0", deck=deck, out=str(n))  # fmt: skip
        assert done.returncode == 0, done.stderr
    equal_states(tmp_path / "0", tmp_path / "3")


# Its walls are all in one box and then all in the other.
ACROSS = """\
&run title = 'across', t_end = 5e-5, energy_band = 0.5 /
&air box = 0, 0.2, 0, 0.1, 0, 0.1, cells = 20, 10, 10, activity = .false.,
     bc = 'wall', 'outflow', 'wall', 'outflow', 'outflow', 'outflow',
     reconstruction = 'muscl', flux = 'hllc', integrator = 'ssprk2' /
&gas id = 'hot', box = 0, 0.09, 0.02, 0.08, 0, 0.1, density = 4, pressure = 3e6,
     velocity = 300, -50, 20 /
&material id = 's', model = 'linear_elastic', density = 200, youngs_modulus = 2e7,
     poisson_ratio = 0.3 /
&body id = 'b', shape = 'box', box = 0.175, 0.195, 0.03, 0.07, 0.03, 0.07, spacing = 5e-3,
     material = 's', formulation = 'rigid', velocity = -2500, 0, 0 /
&gauge id = 'g', body = 'b', at = 0.185, 0.05, 0.05, quantity = 'velocity_x' /
&gauge id = 'a', at = 0.09, 0.05, 0.05, quantity = 'pressure' /
&output dump_every = 5e-6, history_every = 0 /
"""


@pytest.mark.slow
@needs_mpirun
def test_a_body_flies_from_one_gpu_to_the_next(gpu, tmp_path):
    """The driver guards its memory, and dumps hold walls that others' cells have changed."""
    for n in (0, 2):
        done = go(n, tmp_path, gpu, deck=ACROSS, out=f"out{n}")
        assert done.returncode == 0, done.stderr
    equal_runs(tmp_path / "out0", tmp_path / "out2")


# A body that runs into gas.
GROWN = """\
&run t_end = 1e-3, dimension = 1, max_steps = 26 /
&air box = -0.018, 0.018, 0, 1, 0, 1, cells = 134, 1, 1 /
&material id = 'm', model = 'linear_elastic', density = 1000, youngs_modulus = 5e8,
     poisson_ratio = 0.3 /
&body id = 'b', box = 0.00068, 0.00168, 0, 1, 0, 1, spacing = 2e-4, material = 'm',
     velocity = -1500, 0, 0 /
&gauge id = 'a', at = 0, 0, 0, quantity = 'pressure' /
"""


@needs_mpirun
def test_a_body_of_a_cell_runs_into_gas(gpu, tmp_path):
    """The driver guards its memory."""
    for n in (0, 2):
        done = go(n, tmp_path, gpu, deck=GROWN, out=f"out{n}")
        assert done.returncode == 0, done.stderr
    equal_runs(tmp_path / "out0", tmp_path / "out2")
