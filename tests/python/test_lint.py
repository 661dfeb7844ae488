# SPDX-License-Identifier: MIT
"""The rules of the house, the formatter and the check for the GPU can fail."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILE = """! SPDX-License-Identifier: MIT
module brz_{name}
    {use}
    implicit none
{mark}contains
{body}end module brz_{name}
"""


def run(*command, cwd=ROOT):
    text = [str(word) for word in command]
    return subprocess.run(text, cwd=cwd, capture_output=True, text=True, check=False)


def put(root, path, use="", mark="", body=""):
    file = root / "src" / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(FILE.format(name=file.stem, use=use, mark=mark, body=body))
    return file


def structure(root):
    done = run(sys.executable, ROOT / "scripts/structure.py", root)
    return done.returncode, done.stderr


CUF = "    !@cuf attributes(host,device) &\n"
LONG = "    subroutine s()\n" + "    continue\n" * 79 + "    end subroutine s\n"
KERNEL = LONG.replace("    subroutine", "    attributes(global) subroutine", 1)
KIND = "type, bind(c) :: x_t\n    end type x_t"
USE = "use brz_a, only: x"
MANY = "    subroutine s(a, b, c, d, &\n        e, f, g, h, i, j, k, l, m)\n    end subroutine s\n"
RULES = [
    ({"air/a.f90": {}, "base/b.f90": {"use": USE}}, "base must not use brz_a"),
    ({"air/a.f90": {}, "solid/b.f90": {"use": USE}}, "solid must not use brz_a"),
    ({"cpu/a.f90": {}, "coupling/b.f90": {"use": USE}}, "must not use brz_a"),
    ({"deck/a.f90": {}, "air/b.f90": {"use": USE, "mark": CUF}}, "host code"),
    ({"base/a.f90": {"body": LONG}}, "s has 81 lines"),
    ({"base/a.f90": {"body": MANY}}, "s has 13 arguments"),
    ({"base/a.f90": {"body": "! filler\n" * 600}}, "lines; at most 600"),
    ({"base/a.f90": {"use": "use brz_b"}, "base/b.f90": {}}, "use brz_b without only"),
    ({"odd/a.f90": {}}, "src/odd is no layer"),
    ({"air/step/a.f90": {}, "air/grid/b.f90": {"use": USE}}, "b.f90:3: grid must not use brz_a of"),
    (
        {
            "air/step/a_loop_bodies.f90": {},
            "air/grid/b.f90": {"use": USE.replace("_a", "_a_loops")},
        },
        "grid must not use brz_a_loops of step",
    ),
    ({"materials/driver/a.f90": {}, "materials/b.f90": {"use": USE}}, ". must not use brz_a of d"),
    ({"air/odd/a.f90": {}}, "a.f90:1: src/air/odd is no room"),
    ({"air/step/a.f90": {}, "air/b.f90": {}}, "b.f90:1: src/air is no room; src/air has grid"),
    ({"air/a.f90": {"use": KIND}, "gpu/b.f90": {"use": KIND}}, "b.f90:3: x_t is a type of src/air"),
    ({"cpu/solid_sums.f90": {}, "gpu/gpu_solid_totals.f90": {}}, "cpu: solid_sums has no twin"),
    ({"cpu/solid_sums.f90": {}, "gpu/gpu_solid_totals.f90": {}}, "gpu: solid_totals has no twin"),
    ({"cpu/air_sweep.f90": {}, "gpu/gpu_air_sweep.f90": {}}, "air_sweep is not alone in src/cpu"),
]


OTHERS = [
    ("Makefile", "# filler\n" * 601, "Makefile:1: 601 lines; at most 600"),
    ("scripts/a.sh", "f() {\n" + "true\n" * 79 + "}\n", "a.sh:1: a function of 81 lines"),
    ("tests/a.c", "int f(void)\n{\n" + ";\n" * 79 + "}\n", "a.c:2: a function of 81 lines"),
    ("post/a.html", "function f() {  // x\n" + "g();\n" * 79 + "}\n", "a.html:1: a function of 81"),
    ("post/a.html", "\n" * 601, "a.html:1: 601 lines; at most 600"),
    ("Makefile", "all:\n" + "\ttrue\n" * 81, "Makefile:2: a recipe of more than 80 lines"),
    ("cuda/a.CUF", "! filler\n" * 601, "a.CUF:1: 601 lines; at most 600"),
    ("cuda/a.CUF", f"\n! {'x' * 99}\n", "a.CUF:2: 101 columns; at most 100"),
    ("cuda/a.CUF", KERNEL, "a.CUF:1: s has 81 lines; at most 80"),
]


@pytest.mark.parametrize(("path", "text", "reason"), OTHERS)
def test_sizes_hold_in_any_language(tmp_path, path, text, reason):
    (tmp_path / path).parent.mkdir(exist_ok=True)
    (tmp_path / path).write_text(text)
    code, said = structure(tmp_path)
    assert code != 0
    assert reason in said


@pytest.mark.parametrize(("files", "reason"), RULES)
def test_a_broken_rule_is_named(tmp_path, files, reason):
    for path, parts in files.items():
        put(tmp_path, path, **parts)
    code, text = structure(tmp_path)
    assert code != 0
    assert reason in text


def test_what_keeps_the_rules_passes(tmp_path):
    put(tmp_path, "base/a.f90", body="    subroutine s(a, b)\n    end subroutine s\n")
    put(tmp_path, "cpu/b.f90", use="use brz_a, only: s")
    put(tmp_path, "gpu/gpu_b.f90", use="use brz_a, only: s")
    put(tmp_path, "step/run/c.f90", use="use brz_b, only: t")
    put(tmp_path, "step/run/d.f90", use="use brz_c, only: t")
    put(tmp_path, "step/check/e.f90")
    put(tmp_path, "step/run/f.f90", use="use brz_e, only: t")
    assert structure(tmp_path) == (0, "")
    put(tmp_path, "base/g.f90").rename(tmp_path / "src/base/h.f90")
    assert "must hold module brz_h alone" in structure(tmp_path)[1]
    (tmp_path / "src/base/h.f90").write_text("module brz_h\nend module brz_h\n")
    assert "first line must be" in structure(tmp_path)[1]


def test_users_of_the_whole_state_are_counted(tmp_path):
    put(tmp_path, "solid/state/solid_state.f90")
    for k in range(59):
        put(tmp_path, f"driver/user_{k:02}.f90", use="use brz_solid_state, only: solid_t")
    assert structure(tmp_path) == (0, "")
    put(tmp_path, "driver/user_59.f90", use="use brz_solid_state, only: solid_t")
    code, text = structure(tmp_path)
    assert code != 0
    assert "user_59.f90:3: 60 files use brz_solid_state; at most 59" in text


def test_long_prose_is_named_and_tables_are_not(tmp_path):
    page = tmp_path / "docs/sub/page.md"
    page.parent.mkdir(parents=True)
    page.write_text("x" * 120 + "\n| " + "x" * 130 + " |\n```\n" + "x" * 121 + "\n```\n")
    code, text = structure(tmp_path)
    assert code != 0
    assert text == "docs/sub/page.md:4: 121 columns; at most 120\n"


def test_long_python_is_named(tmp_path):
    (tmp_path / "post").mkdir()
    body = "    pass\n" * 80
    text = f"# SPDX-License-Identifier: MIT\ndef f():\n{body}" + "x = 0\n" * 600
    (tmp_path / "post" / "a.py").write_text(text, encoding="utf-8")
    code, text = structure(tmp_path)
    assert code != 0
    assert "a.py:1: 682 lines; at most 600" in text
    assert "a.py:2: f has 81 lines; at most 80" in text


UGLY = """module a
contains
subroutine s(x)
real,intent(out)::x
x=1+ &
  2
end subroutine s
end module a
"""


def test_formatter_finds_and_mends(tmp_path):
    file = tmp_path / "a.f90"
    file.write_text(UGLY)
    tool = ROOT / "scripts/format.py"
    done = run(sys.executable, tool, "--check", file)
    assert done.returncode != 0
    assert "+        x = 1 + &\n+          2\n" in done.stdout
    run(sys.executable, tool, file)
    assert run(sys.executable, tool, "--check", file).returncode == 0


def test_formatter_leaves_the_device_mark_alone():
    file = ROOT / "src/base/algebra.f90"
    assert run(sys.executable, ROOT / "scripts/format.py", "--check", file).returncode == 0


def test_linter_fails_on_a_bad_file(tmp_path):
    file = put(
        tmp_path, "base/a.f90", body="    subroutine s(x)\n        real*8 x\n    end subroutine s\n"
    )
    tool = Path(sys.executable).parent / "fortitude"
    assert run(tool, "check", "--config-file", ROOT / "fortitude.toml", file).returncode != 0


SAMPLE = """module brz_d
    implicit none
    real :: kept = 2
    real, parameter :: table(3) = [1.0, 2.0, 3.0]
contains
    !@cuf attributes(host,device) &
    pure subroutine s(n, a, y)
        integer, intent(in) :: n
        real, intent(in) :: a(3)
        real, intent(out) :: y
{}
    end subroutine s
end module brz_d
"""
GOOD = "        y = sum(a)*exp(a(1))*table(n)"
DEVICE = {
    "run-time library call _Fortran": "        y = norm2(a)",
    "unresolved symbol j0": "        y = bessel_j0(a(1))",
    "module variable _QMbrz_dEkept": "        y = a(1)*kept",
    "may not appear in device code": "associate (b => a(1))\n        y = b\n        end associate",
    "stack array of run-time size": """        real :: w(n)
        integer :: i
        do i = 1, n
            w(i) = a(1)*i
        end do
        do i = 1, n
            w(i) = w(n + 1 - i)*w(i)
        end do
        y = w(1)""",
}


def check_device(folder, text):
    if not Path("/usr/lib/llvm-22/bin/flang").exists():
        pytest.skip("flang-22 is missing")
    (folder / "d.f90").write_text(text)
    tool = ROOT / "scripts/gpu_check.py"
    return run(sys.executable, tool, "--work", folder, folder / "d.f90")


def test_device_code(tmp_path):
    done = check_device(tmp_path, SAMPLE.format(GOOD))
    assert done.returncode == 0, done.stderr
    assert "1 device procedures compile" in done.stdout


@pytest.mark.parametrize(("reason", "body"), DEVICE.items())
def test_no_device_code(tmp_path, reason, body):
    done = check_device(tmp_path, SAMPLE.format(body))
    assert done.returncode != 0
    assert reason in done.stderr


def test_mark_needs_a_pure_procedure(tmp_path):
    done = check_device(tmp_path, SAMPLE.format(GOOD).replace("pure ", ""))
    assert "d.f90:7: a pure procedure must follow" in done.stderr
