# SPDX-License-Identifier: MIT
"""The build recompiles only what it must, `make test` counts right, set-up says what to do."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FIRST = """module brz_first
 implicit none
 integer, parameter :: n = {n}
contains
 subroutine s()
 {body}
 end subroutine
end module
"""
SECOND = (
    "module brz_second\n use brz_first, only: n\n implicit none\n integer :: a(n)\nend module\n"
)
THIRD = "module brz_third\n use brz_second, only: a\n implicit none\nend module\n"


def run(*command, cwd, **more):
    ours = ("MAKE", "MFLAGS", "ARGS", "TIER")
    env = {k: v for k, v in os.environ.items() if not k.startswith(ours)} | more
    return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, check=False)


@pytest.fixture
def project(tmp_path):
    """A copy of the build with three small modules."""
    shutil.copy(ROOT / "Makefile", tmp_path)
    shutil.copytree(ROOT / "scripts", tmp_path / "scripts")
    shutil.copytree(ROOT / "tests/pfstub", tmp_path / "tests/pfstub")
    (tmp_path / "src/base").mkdir(parents=True)
    for name, text in (("first", FIRST.format(n=1, body="")), ("second", SECOND), ("third", THIRD)):
        (tmp_path / f"src/base/{name}.f90").write_text(text)
    return tmp_path


def compiled(project, *options):
    """Names of the sources of src/ that make compiles."""
    done = run("make", "-j2", "lib", *options, cwd=project)
    assert done.returncode == 0, done.stderr
    words = [line.split()[1] for line in done.stdout.splitlines() if "compile src" in line]
    return {Path(word).stem for word in words}


def test_only_what_depends_is_compiled(project):
    first = project / "src/base/first.f90"
    assert compiled(project) == {"first", "second", "third"}
    assert compiled(project) == set()
    first.write_text(FIRST.format(n=1, body="continue"))
    assert compiled(project) == {"first"}
    first.write_text(FIRST.format(n=2, body=""))
    assert compiled(project) == {"first", "second", "third"}
    assert compiled(project) == set()
    assert compiled(project, "OPT=-O0") == {"first", "second", "third"}
    assert compiled(project, "OPT=-O0", "DEBUG=1") == {"first", "second", "third"}


def test_what_includes_a_file_depends_on_it(project):
    part = project / "src/base/part.inc"
    part.write_text("continue\n")
    (project / "src/base/first.f90").write_text(FIRST.format(n=1, body="include 'part.inc'"))
    assert compiled(project) == {"first", "second", "third"}
    part.write_text("continue; continue\n")
    assert compiled(project) == {"first"}


UNIT = """module test_third
 use funit
 use brz_third, only: b
contains
 @test
 subroutine holds()
  @assertEqual(1, b)
 end subroutine
end module
"""


@pytest.mark.slow
def test_tests_use_the_library_as_it_is_built(project):
    (project / "src/base/third.f90").write_text(THIRD.replace("only: a", "only: b => a"))
    (project / "tests/unit").mkdir()
    (project / "tests/unit/test_third.pf").write_text(UNIT)
    (project / "src/base/second.f90").write_text(SECOND.replace("a(n)", "a = n"))
    done = run("make", "-j2", "unit", cwd=project)
    assert "(1 tests)" in done.stdout, done.stderr
    assert compiled(project) == set()
    for target in ("obj/tests/unit/test_third.o", "tests/unit/run"):
        (project / "tests/unit/test_third.pf").write_text(UNIT.replace("1, b", "1, b*1"))
        assert run("make", "-j2", f"build/cpu/{target}", cwd=project).returncode == 0
        assert compiled(project) == set()


def test_files_may_come_and_go(project):
    compiled(project)
    third = project / "src/base/third.f90"
    (project / "src/base/fourth.f90").write_text(THIRD.replace("third", "fourth"))
    third.unlink()
    assert compiled(project) == {"fourth"}
    third.write_text("module brz_third\n use brz_nowhere, only: a\nend module\n")
    done = run("make", "lib", cwd=project)
    assert done.returncode != 0
    assert "src/base/third.f90:2: no source makes brz_nowhere.mod" in done.stderr


def test_an_error_in_a_source_stops_the_build(project):
    (project / "src/base/second.f90").write_text(SECOND.replace("a(n)", "a(m)"))
    assert run("make", "lib", cwd=project).returncode != 0


@pytest.mark.slow
def test_a_warning_of_the_compiler_stays_until_its_file_is_compiled_anew(project):
    first = project / "src/base/first.f90"
    shutil.copytree(ROOT / "inputs/presets", project / "inputs/presets")
    assert run("make", "lib", "warnings", cwd=project).returncode == 0
    first.write_text(FIRST.format(n=1, body="integer :: idle"))
    assert compiled(project) == {"first"}
    for _ in range(2):
        done = run("make", "lib", "warnings", cwd=project)
        assert done.returncode != 0
        assert "Unused variable" in done.stdout
        assert "idle" in done.stdout
    first.write_text(FIRST.format(n=1, body=""))
    assert run("make", "lib", "warnings", cwd=project).returncode == 0


PARTS = """
good:
\t@echo '<t><testcase/><testcase/><testcase><skipped/></testcase></t>' > build/log/good.xml
bad:
\t@echo '<t><testcase/><testcase><failure/></testcase></t>' > build/log/bad.xml; exit 2
crash:
\t@echo '<t><testcase/></t>' > build/log/crash.xml; kill -9 $$$$
plain:
\t@true
later:
\t@echo 'skipped: no tool'
"""


@pytest.mark.parametrize(
    ("parts", "last", "code"),
    [
        (["plain"], "1 passed, 0 failed", 0),
        (["good", "plain", "later"], "3 passed, 0 failed, 2 skipped", 0),
        (["good", "bad"], "3 passed, 1 failed, 1 skipped", 1),
        (["crash", "plain"], "2 passed, 1 failed", 1),
        (["no-such-part"], "0 passed, 1 failed", 1),
        (["good+plain", "later"], "3 passed, 0 failed, 2 skipped", 0),
        (["plain+bad+good"], "4 passed, 1 failed, 1 skipped", 1),
    ],
)
def test_parts_are_counted(tmp_path, parts, last, code):
    (tmp_path / "Makefile").write_text(PARTS)
    done = run(ROOT / "scripts/run_tests.py", *parts, cwd=tmp_path)
    assert done.stdout.splitlines()[-1] == last
    assert done.returncode == code
    assert "slowest" not in done.stdout  # (these tests tell no seconds)


def test_the_slowest_tests_of_all_parts_are_listed(tmp_path):
    """Ten of them, the slowest first, before the last line; a part without XML has none."""
    case = "<testcase classname='{}_suite' name='n{}' core='{}' time='1000'/>"
    for part, times in (("one", range(20, 28)), ("two", (0.5, 300.5, 23.5, 1.0, 2.0))):
        cases = "".join(case.format(part, k, time) for k, time in enumerate(times))
        (tmp_path / f"{part}.xml").write_text(f"<t>{cases}<testcase/></t>")
    copies = [f"{part}:\n\t@cp {part}.xml build/log/\n" for part in ("one", "two")]
    (tmp_path / "Makefile").write_text("".join(copies) + "plain:\n\t@true\n")
    done = run(ROOT / "scripts/run_tests.py", "one+two", "plain", cwd=tmp_path)
    lines = done.stdout.splitlines()
    rows = [line.split() for line in lines[lines.index("slowest tests, core-seconds:") + 1 : -3]]
    assert rows[:2] == [
        ["300.5", "s", "two", "two_suite", "n1"],
        ["27.0", "s", "one", "one_suite", "n7"],
    ]
    seconds = [float(row[0]) for row in rows]
    assert seconds == [300.5, 27.0, 26.0, 25.0, 24.0, 23.5, 23.0, 22.0, 21.0, 20.0]
    assert re.fullmatch(r"\d+ s, \d+ core-seconds", lines[-2])
    assert lines[-1] == "16 passed, 0 failed"


LONG = """<t><testcase classname="test_a_suite" name="short" core="9.9"/>
<testcase classname="test_a_suite" name="told[npes=2]" core="20"/>
<testcase classname="test_a_suite" name="long" core="11"/>
<testcase classname="test_a_suite" name="disturbed" core="11"/>
<testcase classname="tests.b" name="told"><properties><property name="core" value="12"/>
<property name="long" value="a mesh"/></properties></testcase>
<testcase classname="tests.b" name="long"><properties><property name="core" value="13"/>
</properties></testcase></t>"""
LONG_TESTS = """module test_a
contains
    subroutine long()
    end subroutine long
    subroutine told(this)
        !@long: a fine mesh
    end subroutine told
end module test_a
"""


@pytest.mark.parametrize("tier", ["quick", ""])
def test_a_long_test_says_why(tmp_path, tier):
    (tmp_path / "tests/unit").mkdir(parents=True)
    (tmp_path / "tests/unit/test_a.pf").write_text(LONG_TESTS)
    (tmp_path / "long.xml").write_text(LONG)
    (tmp_path / "alone.xml").write_text(LONG.replace('disturbed" core="11"', 'disturbed" core="2"'))
    recipe = f"@cp $(if $(ARGS),alone,long).xml build/log/long.xml; test '$(TIER)' = '{tier}'"
    (tmp_path / "Makefile").write_text(f"long:\n\t{recipe}\n")
    done = run(ROOT / "scripts/run_tests.py", *(["--quick"] if tier else []), "long", cwd=tmp_path)
    assert done.stdout.splitlines()[-1] == f"6 passed, {2 if tier else 0} failed"
    assert done.returncode == (1 if tier else 0)
    assert ("test_a_suite long: 11.0 core-seconds" in done.stdout) == bool(tier)
    assert ("tests.b long: 13.0 core-seconds" in done.stdout) == bool(tier)
    assert "told: " not in done.stdout and "disturbed: " not in done.stdout


def fake(folder, name, text):
    file = folder / "bin" / name
    file.parent.mkdir(exist_ok=True)
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)


def test_set_up_without_root_names_the_command(tmp_path):
    (tmp_path / "scripts").mkdir()
    for name in ("setup.sh", "packages.txt"):
        shutil.copy(ROOT / "scripts" / name, tmp_path / "scripts")
    shutil.copy(ROOT / "requirements.txt", tmp_path)
    fake(tmp_path, "dpkg-query", "echo installed gcc; exit 1")
    fake(tmp_path, "apt-cache", "exit 1")
    fake(tmp_path, "sudo", "exit 1")
    fake(tmp_path, "id", "echo 1000")
    fake(tmp_path, "apt-get", f"touch {tmp_path}/touched")
    path = f"{tmp_path}/bin:{os.environ['PATH']}"
    done = run("sh", "scripts/setup.sh", cwd=tmp_path, PATH=path)
    assert done.returncode == 1
    assert "sudo apt-get install -y --no-install-recommends gfortran" in done.stdout
    assert " gcc " not in done.stdout
    assert not (tmp_path / "touched").exists()


# What an installed pFUnit looks like to make: the real one is in no package registry. Its
# preprocessor, modules and library are those of the stand-in; its driver says who it is.
FAKE_MK = """PFUNIT_EXTRA_FFLAGS := -I{home}/include
PFUNIT_LIBRARIES := -L{home}/lib -lfunit -lfake_argparse
"""
FAKE_PROC = '#!/bin/sh\nexec python3 "{root}/tests/pfstub/pfproc.py" "$@"\n'
SMALL_TEST = """! SPDX-License-Identifier: MIT
module test_small
    use funit
    implicit none
contains
    @test
    subroutine one_is_one()
        @assertEqual(1, 1)
    end subroutine one_is_one
end module test_small
"""


def fake_pfunit(folder, name, project):
    """A folder as PFUNIT_DIR names one; programs linked with it print `name`."""
    home = folder / "PFUNIT-4.99"
    for part in ("include", "bin", "lib"):
        (home / part).mkdir(parents=True)
    (home / "include/PFUNIT.mk").write_text(FAKE_MK.format(home=home))
    (home / "bin/funitproc").write_text(FAKE_PROC.format(root=project))
    (home / "bin/funitproc").chmod(0o755)
    driver = (project / "tests/pfstub/driver.F90").read_text()
    driver = driver.replace("allocate (tests(0))", f"print '(a)', 'made with {name}'\n&", 1)
    driver = driver.replace("\n&", "\n    call parse_nothing()\n    allocate (tests(0))", 1)
    (home / "include/driver.F90").write_text(driver)
    stub = project / "tests/pfstub"
    text = run("python3", stub / "write_funit.py", cwd=home).stdout
    (home / "lib/funit.f90").write_text(text)
    (home / "lib/none.f90").write_text("subroutine parse_nothing()\nend subroutine\n")
    parts = ["pf_core", "pf_mpi", "pf_run", "pf_report"]
    sources = [*(stub / f"{part}.f90" for part in parts[:2]), "funit.f90"]
    sources += [stub / f"{part}.f90" for part in parts[2:]]
    done = run("gfortran", "-c", "-J../include", *sources, "none.f90", cwd=home / "lib")
    assert done.returncode == 0, done.stderr
    objects = [*(f"{part}.o" for part in parts), "funit.o"]
    run("ar", "rc", "libfunit.a", *objects, cwd=home / "lib")
    run("ar", "rc", "libfake_argparse.a", "none.o", cwd=home / "lib")
    return folder


@pytest.mark.slow
def test_another_pfunit_is_not_the_one_before(project):
    (project / "tests/unit").mkdir()
    (project / "tests/unit/test_small.pf").write_text(SMALL_TEST)
    first = fake_pfunit(project / "first", "pFUnit one", project)
    second = fake_pfunit(project / "second", "pFUnit two", project)
    said = []
    for options in ((), (f"PFUNIT_DIR={first}",), (f"PFUNIT_DIR={second}",), ()):
        done = run("make", "QUICK=1", "build/cpu-quick/tests/unit/run", *options, cwd=project)
        assert done.returncode == 0, done.stdout + done.stderr
        done = run("build/cpu-quick/tests/unit/run", cwd=project)
        said.append(done.stdout.splitlines()[0] if "made with" in done.stdout else "")
        assert "OK\n (1 tests)" in done.stdout
    assert said == ["", "made with pFUnit one", "made with pFUnit two", ""]
    again = run("make", "QUICK=1", "build/cpu-quick/tests/unit/run", cwd=project)
    assert "test_small" not in again.stdout
    assert not list(project.glob("*.mod"))


def test_a_pfunit_that_is_not_there_is_named(project):
    done = run("make", "QUICK=1", "unit", "PFUNIT_DIR=/nowhere", cwd=project)
    assert done.returncode == 2
    assert "/nowhere holds no PFUNIT-*/include/PFUNIT.mk" in done.stderr


COUNTED = """module brz_first
 implicit none
contains
 integer function double_of(n)
  integer, intent(in) :: n
  double_of = 2*n
  if (n < 0) then
   double_of = 0
  end if
 end function
end module
"""
COUNTING = """module test_first
 use funit
 use brz_first, only: double_of
contains
 @test
 subroutine doubles()
  @assertEqual(2, double_of(1))
 end subroutine
end module
"""


@pytest.fixture(name="counted")
def _counted(project):
    """A project of one module, with the same test in both folders of tests."""
    for path in (project / "src/base").glob("*.f90"):
        path.unlink()
    (project / "src/base/first.f90").write_text(COUNTED)
    shutil.copy(ROOT / "tests/coverage.c", project / "tests")
    for folder in ("unit", "verify"):
        (project / "tests" / folder).mkdir()
        text = COUNTING.replace("test_first", f"{folder}_first")
        (project / f"tests/{folder}/{folder}_first.pf").write_text(text)
    return project


@pytest.mark.slow
def test_lines_that_tests_run_are_counted(counted):
    """Tests end by _exit, where nothing is written unless it is asked for."""
    done = run("make", "-j2", "coverage", "COVERED=unit", cwd=counted)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1] == "4 of 5 lines run: 80.0 %"
    done = run("scripts/coverage.py", "build/cpu-coverage", "src/base/first.f90", cwd=counted)
    assert done.stdout == "src/base/first.f90: not run: 8\n"


@pytest.mark.slow
def test_after_an_edit_nothing_is_optimised_at_link_time(counted):
    done = run("make", "-j2", "V=1", "try", "ARGS=-f doubles", cwd=counted)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("(1 tests)") == 2
    assert "-O1" in done.stdout
    assert "-flto" not in done.stdout.replace("-fno-lto", "")
