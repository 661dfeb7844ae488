# SPDX-License-Identifier: MIT
"""Steps that stand once: what the script writes from them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"

ITEM = """\
module brz_debt_items
contains
    !> Pay.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pay_debt(e, cell, low, over)
        integer, intent(in) :: e !! debts
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(inout) :: low !@least of all
        integer, intent(inout) :: over !@count of them
    end subroutine pay_debt
end module brz_debt_items
"""
STEPS = """\
! SPDX-License-Identifier: MIT
module brz_debt_steps
    use brz_coupling_state, only: coupling_t
    use brz_debt_loops, only: each_pay_debt
    implicit none
contains
    !> Pay all.
    subroutine pay_all(c, n)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: n
        integer :: over

        over = 0 !@cpu
        call each_pay_debt(n, c%cell, c%low, &
                           over) !@gpu book_low count_over
        if (over > 0) call drop(c)
    end subroutine pay_all
end module brz_debt_steps
"""
OF_AIR = """\
! SPDX-License-Identifier: MIT
module brz_gust_steps
    use brz_air_operations, only: blow
    use brz_air_state, only: air_t, wall_t
    use brz_debt_loops, only: each_pay_debt
    implicit none
contains
    !> Let it blow.
    subroutine let_blow(air, wall, n)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: n

        call blow(air, wall, air%n)
        call settle(n)
        call each_pay_debt(n, air%u, wall%push, air%u_start) !@cpu
        !@gpu call gpu%go_on()
        !@gpu call gpu%halo%reals_of_others(gpu%u)
    end subroutine let_blow
end module brz_gust_steps
"""


MARK = re.compile(r'^# (\d+) "(.*)"$')


def lines_of(folder, script, source, text):
    """What is written: (line of the source that the compiler takes it for, code) for each line."""
    (folder / source).write_text(text)
    command = [sys.executable, SCRIPTS / script, folder / source, folder / "out.f90"]
    subprocess.run(command, check=True)
    number = 0
    for line in (folder / "out.f90").read_text().splitlines():
        if mark := MARK.match(line):
            assert mark[2] == str(folder / source)
            number = int(mark[1])
        else:
            yield number, line
            number += 1


def written(folder, script, source, text):
    return "\n".join(code for _, code in lines_of(folder, script, source, text))


@pytest.mark.parametrize(("script", "source", "text", "pairs"), [
    ("steps.py", "debt_steps.f90", STEPS, {"call debt_kernels": "call each_pay_debt",
                                           "if (over > 0)": "if (over > 0)"}),
])  # fmt: skip
def test_the_compiler_speaks_of_the_lines_of_the_source(tmp_path, script, source, text, pairs):
    (tmp_path / "debt_items.f90").write_text(ITEM)
    made = list(lines_of(tmp_path, script, source, text))
    asked = text.splitlines()
    for code, origin in pairs.items():
        (line,) = (k for k, one in enumerate(asked, 1) if one.strip().startswith(origin))
        found = [number for number, one in made if one.strip().startswith(code)]
        assert found and set(found) == {line}, (code, found, line)


def test_steps_of_the_gpu_launch_and_hand_on_the_error(tmp_path):
    (tmp_path / "debt_items.f90").write_text(ITEM)
    text = written(tmp_path, "steps.py", "debt_steps.f90", STEPS)
    assert "module brz_gpu_debt_steps" in text
    assert "subroutine pay_all(c, n, err)" in text
    assert "type(gpu_coupling_t), intent(inout) :: c" in text
    assert text.index("type(error_t), intent(inout) :: err") < text.index("integer :: over")
    joined = " ".join(text.replace("&", "").split())
    tallies = "book_at(c, book_low), count_at(c, count_over), err)"
    assert f"call debt_kernels%pay_debt(n, c%cell, {tallies}" in joined
    assert "call read_counts(c, count_over, err, over)" in text
    assert "if (over > 0) call drop(c, err)" in text
    assert "over = 0" not in text and "each_pay_debt" not in text


def test_steps_of_the_air_hand_on_the_gpu_and_the_host(tmp_path):
    folder = tmp_path / "air"
    folder.mkdir()
    lines = [x.strip() for x in written(folder, "steps.py", "gust_steps.f90", OF_AIR).splitlines()]
    assert "use brz_gpu_air_operations, only: blow" in lines
    assert "subroutine let_blow(gpu, air, n, err)" in lines
    head = lines.index("type(gpu_air_t), intent(inout) :: gpu")
    assert lines[head + 1] == "type(air_t), intent(inout) :: air"
    assert not [x for x in lines if x.startswith("type(wall_t)")]
    body = lines.index("call blow(gpu, air, air%n, err)")
    rest = ["call settle(n)", "call gpu%go_on()", "call gpu%halo%reals_of_others(gpu%u, err)"]
    assert lines[body + 1 : body + 4] == rest
