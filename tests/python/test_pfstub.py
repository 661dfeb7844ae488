# SPDX-License-Identifier: MIT
"""The stand-in for pFUnit: what must pass, fail, crash, be disabled and be refused."""

import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import pytest

STUB = Path(__file__).parents[1] / "pfstub"


def run(*command, cwd=None):
    text = [str(word) for word in command]
    return subprocess.run(text, cwd=cwd, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def kit(tmp_path_factory):
    """The stand-in, compiled in a folder of its own."""
    folder = tmp_path_factory.mktemp("kit")
    (folder / "funit.f90").write_text(run(sys.executable, STUB / "write_funit.py").stdout)
    sources = [STUB / "pf_core.f90", "funit.f90"]
    sources += [STUB / f"{x}.f90" for x in ("pf_mpi", "pf_run", "pf_report")]
    done = run("gfortran", "-std=f2018", "-O0", "-c", *sources, cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder


def build(kit, name):
    """Executable of the tests of selftest/NAME.pf."""
    done = run(
        sys.executable, STUB / "pfproc.py", STUB / "selftest" / f"{name}.pf", f"{name}.F90", cwd=kit
    )
    assert done.returncode == 0, done.stderr
    (kit / f"{name}.inc").write_text(f"ADD_TEST_SUITE({name}_suite)\n")
    flags = [
        "-std=f2018",
        "-O0",
        "-ffree-line-length-none",
        f'-D_TEST_SUITES="{name}.inc"',
        f"-I{kit}",
    ]
    objects = [f"{x}.o" for x in ("pf_core", "funit", "pf_mpi", "pf_run", "pf_report")]
    done = run(
        "gfortran", *flags, f"{name}.F90", STUB / "driver.F90", *objects, "-o", name, cwd=kit
    )
    assert done.returncode == 0, done.stderr
    return kit / name


def test_all_assertions_hold(kit):
    done = run(build(kit, "good"), "-v", "-t", "good.tap", "-x", "good.xml", cwd=kit)
    assert done.returncode == 0
    assert " OK\n (5 tests, 1 disabled)" in done.stdout
    assert re.search(r"end: <good_suite.reals> +\d+\.\d+ s", done.stdout)
    assert "ok 5 - good_suite.compiled_in" in (kit / "good.tap").read_text()
    cases = {case.get("name"): case for case in xml.parse(kit / "good.xml").iter("testcase")}
    assert 0.19 < float(cases["computes_slow"].get("core")) < 0.4
    assert float(cases["others"].get("core")) < 0.1


def test_slow_tests_are_left_out(kit):
    done = run(build(kit, "good"), "-q", "-t", "quick.tap", cwd=kit)
    assert " OK\n (4 tests, 1 disabled)" in done.stdout
    assert "slow" not in (kit / "quick.tap").read_text()


def test_every_failure_is_seen(kit):
    done = run(build(kit, "bad"), "-x", "bad.xml", cwd=kit)
    assert done.returncode == 2
    assert "Tests run: 8, Failures: 5, Errors: 2" in done.stdout
    assert "[bad.pf:18] half too much expected" in done.stdout
    assert "Error in: bad_suite.crashes\ncrash: killed by signal 11" in done.stdout
    assert "Error in: bad_suite.stops\nthe test stopped the program with exit code 0" in done.stdout
    cases = {case.get("name"): case for case in xml.parse(kit / "bad.xml").iter("testcase")}
    assert all(float(case.get("time")) >= 0 for case in cases.values())
    good = [name for name, case in cases.items() if case.find("failure") is None]
    assert [name for name in good if cases[name].find("error") is None] == ["passes_after_all_that"]


def test_filter_and_output_file(kit):
    program = build(kit, "bad")
    done = run(program, "-f", "after_all", "-o", "report.txt", cwd=kit)
    assert done.returncode == 0
    assert "(1 tests)" in (kit / "report.txt").read_text()
    assert run(program, "--no-such-option", cwd=kit).returncode == 2


def test_processes_fail_by_name_and_are_skipped_where_there_are_none(kit):
    program = build(kit, "processes")
    done = run("env", "PATH=/nowhere", program, "-x", "none.xml", cwd=kit)
    assert done.returncode == 0
    assert "skipped, as there is no mpirun: processes_suite.one_fails[npes=2]" in done.stdout
    assert "(1 tests, 4 disabled)" in done.stdout
    if not shutil.which("mpirun"):
        pytest.skip("no mpirun")
    done = run(program, "-x", "some.xml", cwd=kit)
    assert done.returncode == 2
    assert "Tests run: 5, Failures: 2, Errors: 0" in done.stdout
    assert re.search(r"\[process 1:2\] \[processes.pf:\d+\] who am I expected 0", done.stdout)
    assert "Failure in: processes_suite.one_crashes[npes=2]" in done.stdout


BODY = """module sample
    use funit
contains
    @test
    subroutine one()
        {}
    end subroutine one
end module sample
"""
REFUSED = [
    (BODY.format("@assertEqual(1, 2, 'why')"), 6, "takes 2 argument"),
    (BODY.format("@assertEqual(1, 2, tol=3)"), 6, "takes no tol="),
    (BODY.format("@assertTrue(.true., tolerance=3)"), 6, "takes no tolerance="),
    (BODY.format("@assertEqual(1, &"), 6, "without continuation"),
    (BODY.format("@assertTrue(.true.) ! because"), 6, "no comment"),
    (BODY.format("@assertTrue(.true.) + 1"), 6, "alone on its line"),
    (BODY.format("if (.true.) @assertTrue(.true.)"), 6, "alone on its line"),
    (BODY.format("@assertExceptionRaised('x')"), 6, "outside the subset"),
    (BODY.format("@mpiAssertTrue(.true.)"), 6, "outside the subset"),
    (BODY.replace("@test", "@test(npes=[1, 2])"), 4, "needs 'use pfunit'"),
    (BODY.replace("@test", "@test(cases=[1, 2])"), 4, "options of @test"),
    (
        BODY.replace("use funit", "use pfunit").replace("@test", "@test(npes=[1, 2])"),
        5,
        "'subroutine name(this)' must follow",
    ),
    (BODY.replace("@test", "@disable\n    @test"), 4, "after @test"),
    (BODY.replace("@test", "@suite"), 4, "outside the subset"),
    (BODY.replace("@test", "@test\n    integer :: i"), 5, "must follow @test"),
    (BODY.replace("one()", "one(this)"), 5, "must follow @test"),
    (BODY.replace("@test", "@before\n    @test"), 5, "directly after"),
    (BODY.replace("module sample", "module other"), 1, "must be called sample"),
    (BODY.replace("    @test\n", ""), 1, "no @test"),
]
# Names of genuine pFUnit: in the module (line 3), from another one, as a test, in the suite.
PUBLIC = "is a public name of pFUnit"
SUITE = "is a name of the suite"
OUTSIDE = BODY.format("@assertTrue(.true.)")
LOCAL = OUTSIDE.replace("one()\n", "one()\n    integer :: run, t, suite, throw\n", 1)
REFUSED += [
    (OUTSIDE.replace("contains", "integer, parameter :: n = size([1, 2]), &\n t(2) = 0"), 3, SUITE),
    (OUTSIDE.replace("contains", "type :: near\nend type near"), 3, f"'near' {PUBLIC}"),
    (OUTSIDE.replace("contains", "use tools, only: g, Catch => h"), 3, f"'catch' {PUBLIC}"),
    (OUTSIDE.replace("contains", "interface is\nend interface is"), 3, f"'is' {PUBLIC}"),
    (OUTSIDE.replace(" one()", " throw()"), 5, f"'throw' {PUBLIC}"),
    (
        LOCAL.replace("end module", "pure real function run(x)\nend function run\nend module"),
        9,
        f"'run' {PUBLIC}",
    ),
]


def test_names_inside_procedures_are_free(tmp_path):
    file = tmp_path / "sample.pf"
    file.write_text(
        LOCAL.replace("contains", "type :: a_t\ninteger :: run\nend type a_t\ncontains")
    )
    done = run(sys.executable, STUB / "pfproc.py", file, tmp_path / "sample.F90")
    assert done.returncode == 0, done.stderr


RANKS = [
    ("@assertIsFinite([1.0, 2.0])", "assertisfinite"),
    ("@assertIsNan([1.0, 2.0])", "assertisnan"),
    ("@assertAll(reshape([.true., .true.], [1, 2]))", "assertall"),
]


@pytest.mark.parametrize(("directive", "name"), RANKS)
def test_ranks_that_pfunit_lacks_are_refused(kit, directive, name):
    (kit / "sample.pf").write_text(BODY.format(directive))
    done = run(sys.executable, STUB / "pfproc.py", "sample.pf", "sample.F90", cwd=kit)
    assert done.returncode == 0, done.stderr
    done = run("gfortran", "-ffree-line-length-none", "-c", "sample.F90", cwd=kit)
    assert done.returncode != 0
    assert "sample.pf:6" in done.stderr
    assert f"generic '{name}'" in done.stderr.lower().replace("‘", "'").replace("’", "'")


@pytest.mark.parametrize(("text", "line", "reason"), REFUSED)
def test_outside_the_subset_is_refused(tmp_path, text, line, reason):
    file = tmp_path / "sample.pf"
    file.write_text(text)
    done = run(sys.executable, STUB / "pfproc.py", file, tmp_path / "sample.F90")
    assert done.returncode != 0
    assert f"sample.pf:{line}: " in done.stderr
    assert reason in done.stderr
