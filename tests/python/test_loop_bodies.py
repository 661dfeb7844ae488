# SPDX-License-Identifier: MIT
"""What is written around a loop body does what the loop body says, and checks how it is called."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LOOP_BODIES = """module brz_twig_loop_bodies
    use brz_kinds, only: dp, int32, rk
    implicit none
contains
    !> Twice a number; sums of what was there.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine double_it(i, factor, x, n_big, total, low)
        integer, intent(in) :: i !! numbers
        real(rk), intent(in) :: factor
        real(rk), intent(inout) :: x(*)
        integer, intent(inout) :: n_big !@count numbers above 1
        real(dp), intent(inout) :: total(2) !@sum of x, of its squares
        real(rk), intent(inout) :: low !@least of them

        if (x(i) > 1) n_big = n_big + 1
        total(1) = total(1) + x(i)
        total(2) = total(2) + x(i)**2
        low = min(low, x(i))
        x(i) = factor*x(i)
    end subroutine double_it

    !> Squares.
    !@loop_body if(n >= 2) schedule(dynamic, 1)
    !@cuf attributes(host,device) &
    pure subroutine square(i, x, y)
        integer, intent(in) :: i !! numbers
        real(rk), intent(in) :: x(*)
        integer(int32), intent(inout) :: y(*)
        real(rk) :: side

        side = x(i)
        y(i) = nint(side**2)
    end subroutine square

    !> What threads may look for together.
    !@loop_body if(n >= 2) schedule(dynamic, 1)
    !@cuf attributes(host,device) &
    pure subroutine look(i, x, high, n_big)
        integer, intent(in) :: i !! numbers
        real(rk), intent(in) :: x(*)
        real(rk), intent(inout) :: high !@most
        integer, intent(inout) :: n_big !@count numbers above 1

        high = max(high, x(i))
        if (x(i) > 1) n_big = n_big + 1
    end subroutine look

    !> What threads and processes may sum in any order.
    !@loop_body if(n >= 2) schedule(dynamic, 1)
    !@cuf attributes(host,device) &
    pure subroutine weigh(i, x, total)
        integer, intent(in) :: i !! numbers
        real(dp), intent(in) :: x(*)
        real(dp), intent(inout) :: total(2) !@exact sums of x and -3x

        total(1) = total(1) + x(i)
        total(2) = total(2) - 3*x(i)
    end subroutine weigh
end module brz_twig_loop_bodies
"""
STUBS = """module brz_errors
    type :: error_t
    end type
end module
module brz_threads
    integer, parameter :: worth_threads = 10
end module
module brz_ranks
    use brz_kinds
    type :: ranks_t
    end type
contains
    pure logical function several(ranks)
        type(ranks_t), intent(in) :: ranks
        several = .false.
    end function
    subroutine most_of_all(ranks, x)
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(inout) :: x(:)
    end subroutine
    subroutine sum_of_all(ranks, x)
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(inout) :: x(:)
    end subroutine
end module
module brz_device
    use brz_buffers
    use brz_errors
    type :: device_t
    end type
    type :: kernel_t
    end type
contains
    subroutine find_kernel(device, name, kernel, err)
        type(device_t), intent(in) :: device
        character(*), intent(in) :: name
        type(kernel_t), intent(inout) :: kernel
        type(error_t), intent(inout) :: err
    end subroutine
    subroutine find_once(name, kernel, err)
        character(*), intent(in) :: name
        type(kernel_t), intent(inout) :: kernel
        type(error_t), intent(inout) :: err
    end subroutine
    subroutine launch(kernel, n, a, err)
        type(kernel_t), intent(in) :: kernel
        integer, intent(in) :: n(3)
        type(arguments_t), intent(in) :: a
        type(error_t), intent(inout) :: err
        print '(*(i0,1x))', n, a%n, a%missing
    end subroutine
end module
module brz_gpu_counts
    use brz_buffers
    use brz_errors
contains
    function begin_counts(err) result(buffer)
        type(error_t), intent(inout) :: err
        type(integers_t) :: buffer
    end function
    subroutine read_counts(number, err)
        integer, intent(out) :: number(:)
        type(error_t), intent(inout) :: err
        number = 5
    end subroutine
end module
module brz_gpu_exact_sum
    use brz_buffers
    use brz_errors
    use brz_ranks
    type :: gpu_exact_t
        type(doubles_t) :: sums, up
        real(dp) :: total(2) = 3
    contains
        procedure :: end => end_pass
    end type
contains
    subroutine end_pass(self, pass, n, err)
        class(gpu_exact_t), intent(inout) :: self
        integer, intent(in) :: pass, n
        type(error_t), intent(inout) :: err
    end subroutine
    function exact_for(ranks, err) result(exact)
        type(ranks_t), intent(in) :: ranks
        type(error_t), intent(inout) :: err
        type(gpu_exact_t), pointer :: exact
        allocate (exact)
    end function
end module
"""
USER = """program user
    use brz_buffers
    use brz_errors
    use brz_kinds
    use brz_present_table
    use brz_ranks
    use brz_twig_launches
    use brz_twig_loops
    type(twig_kernels_t) :: kernels
    type(error_t) :: err
    type(reals_t) :: x
    type(integers_t) :: y
    type(doubles_t) :: sums
    real(rk) :: a(20) = [(0.5_rk*i, i=1, 20)], low = 9, high = 0
    real(dp) :: total(2) = 0
    real(dp) :: wide(4) = [1e17_dp, 2.0_dp, -1e17_dp, 1.0_dp], sum_of_wide(2) = 7
    type(ranks_t) :: ranks
    integer :: big = 0, many = 1, squares(20)
    call each_double_it(20, 2.0_rk, a, big, total, low)
    call each_square(20, a, squares)
    call each_look(20, a, high, many)
    call each_weigh(4, ranks, wide, sum_of_wide)
    print '(*(g0,1x))', nint(sum_of_wide), nint(high), many, big, nint(total), nint(2*low), &
        squares(20)
    {launch}
end program
"""


@pytest.fixture(scope="module")
def twig(tmp_path_factory):
    """A folder with a loop body, and what was written around it."""
    folder = tmp_path_factory.mktemp("twig")
    (folder / "twig_loop_bodies.f90").write_text(LOOP_BODIES)
    (folder / "stubs.f90").write_text(STUBS)
    writer = [sys.executable, ROOT / "scripts/loops.py", folder, folder / "twig_loop_bodies.f90"]
    subprocess.run(writer, check=True)
    return folder


def built(folder, launch, *flags):
    """The result of the compiler for a program that launches so."""
    (folder / "user.f90").write_text(USER.format(launch=launch))
    base = [ROOT / "src" / x for x in ("base/kinds.F90", "base/tallies.f90", "base/buffers.f90")]
    base += [ROOT / "src/device/present_table.f90"]
    stubs = [folder / "stubs.f90", ROOT / "src/parallel/exact_sum.f90"]
    made = [folder / f"{x}.f90" for x in ("twig_loop_bodies", "twig_launches", "twig_loops")]
    command = ["gfortran", "-cpp", "-fopenmp", *flags, "-J", folder, *base, *stubs, *made]
    command += [folder / "user.f90"]
    command += ["-o", folder / "user"]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_loops_do_all_loop_bodies_and_sum(twig):
    done = built(twig, "call kernels%square(20, x, y, err)")
    assert done.returncode == 0, done.stderr
    said = subprocess.run([twig / "user"], capture_output=True, text=True, check=True).stdout
    # the doubled numbers 1, 2, ..., 20: 19 above 1, and the one that was counted before;
    # 18 of 0.5, 1, ..., 10 are above 1; their sum is 105, that of their squares 717.5.
    # Exact sums have no order: of 1e17, 2, -1e17, 1 that of reals is 1
    assert said.split("\n")[:2] == ["3 -9 20 20 18 105 718 1 400", "20 1 1 3 0"]


def test_drivers_loop_or_launch_with_the_copies_of_arrays(twig):
    launch = """call for_each_square(.true., 20, a, squares, err)
    call attach(a, buffer_t(64, 160))
    call attach(squares, buffer_t(256, 80))
    squares = 0
    call for_each_square(.true., 20, a, squares, err)
    call for_each_look(.true., 20, a, high, many, sums, err)
    call for_each_weigh(.false., 4, ranks, wide, sum_of_wide, err)
    print '(*(i0,1x))', sum(squares), many, nint(sum_of_wide)
    call for_each_square(.false., 20, a, squares, err)
    print '(i0)', squares(20)"""
    done = built(twig, launch)
    assert done.returncode == 0, done.stderr
    said = subprocess.run([twig / "user"], capture_output=True, text=True, check=True).stdout
    # without copies the last argument that has none is told; counts are read and added
    assert said.split("\n")[1:6] == ["20 1 1 3 3", "20 1 1 3 0", "4096 1 1 4 0", "0 25 3 -9", "400"]


@pytest.mark.skipif(not shutil.which("gdb"), reason="there is no gdb")
def test_gdb_stops_at_loop_bodies_and_shows_their_loops_there(twig):
    flags = re.search(r"^CHECKED *:= (.*)", (ROOT / "Makefile").read_text(), re.M)[1]
    done = built(twig, "call kernels%square(20, x, y, err)", *flags.split())  # as DEBUG=1 builds
    assert done.returncode == 0, done.stderr
    line = 1 + LOOP_BODIES[: LOOP_BODIES.index("end subroutine square")].count("\n")
    steps = [f"break twig_loop_bodies.f90:{line}", "set env OMP_NUM_THREADS=1", "run"]
    steps += ["info locals", "bt 2", "finish"]
    command = ["gdb", "-batch", "-nx", *(x for one in steps for x in ("-ex", one)), twig / "user"]
    said = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False).stdout
    if "ptrace: Operation not permitted" in said:
        pytest.skip("processes may not be traced here")
    head = 1 + LOOP_BODIES[: LOOP_BODIES.index("pure subroutine square")].count("\n")
    assert re.search(rf"#0 .*square .* at \S*twig_loop_bodies.f90:{line}", said), said
    assert "\nside = 1\n" in said, said
    assert re.search(rf"#1 .*each_square.* at \S*twig_loop_bodies.f90:{head}", said), said


def test_sums_have_a_fixed_number_of_threads(twig):
    done = built(twig, "call kernels%double_it(20, 2.0_rk, x, sums, y, err)")
    assert done.returncode == 0, done.stderr
    said = subprocess.run([twig / "user"], capture_output=True, text=True, check=True).stdout
    assert said.split("\n")[1] == "4096 1 1 5 0"
    kernel = (twig / "twig_kernels.CUF").read_text()
    for line in ("low = sums(t, 3)", "sums(t, 2) = total(2)", "do i = t, n, tally_threads"):
        assert line in kernel
    assert "if (n_big > 0) old = atomicadd(counts(1), n_big)" in kernel


@pytest.mark.parametrize(
    ("launch", "why"),
    [
        ("call kernels%square(20, x, err)", "TYPE(error_t) to TYPE(integers_t)"),
        ("call kernels%square(20, y, y, err)", "passed TYPE(integers_t) to TYPE(reals_t)"),
        ("call kernels%square(20, sums, y, err)", "passed TYPE(doubles_t) to TYPE(reals_t)"),
        ("call kernels%double_it(20, 2, x, sums, y, err)", "passed INTEGER(4) to REAL"),
    ],
)
def test_a_wrong_launch_does_not_compile(twig, launch, why):
    done = built(twig, launch)
    assert done.returncode != 0
    assert "Error" in done.stderr
    assert why in done.stderr


KERNELS = """module brz_leaf_kernels
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: press, flat, folded

    integer, parameter :: flat = 0, folded = 1

contains

    !> Leave a mark.
    attributes(global) subroutine leaf_mark(n, size, x, words)
        integer, value :: n !! numbers
        real(dp), value :: size !! [m]
        real(rk), device, intent(in) :: x(n)
        integer(int32), device, intent(inout) :: words(*) !@any
    end subroutine leaf_mark

    !> Press a leaf.
    !@kernel press_flat(128,2): flat, .true.
    !@kernel press_folded: folded, .false.
    attributes(device) subroutine press(kind, dry, n, step, x)
        integer, intent(in) :: kind !! known to the compiler
        logical, intent(in) :: dry
        integer, intent(in) :: n
        real(rk), intent(in) :: step
        real(rk), intent(inout) :: x(n, *)
    end subroutine press
end module brz_leaf_kernels
"""


@pytest.fixture(scope="module")
def leaf(tmp_path_factory):
    """A folder with kernels, and what was written around them."""
    folder = tmp_path_factory.mktemp("leaf")
    (folder / "leaf_kernels.CUF").write_text(KERNELS)
    writer = [sys.executable, ROOT / "scripts/loops.py", folder, "leaf"]
    subprocess.run([*writer, folder / "leaf_kernels.CUF"], check=True)
    return folder


def test_a_question_mark_stands_for_all_schemes_that_are_not_named(tmp_path):
    text = KERNELS.replace("!@kernel press_flat(128,2): flat, .true.", "!@kernel press_?(64,1): ?")
    named = "!@kernel press_weno3_hllc(9,9): weno3_cells, hllc"
    (tmp_path / "leaf.CUF").write_text(
        text.replace("!@kernel press_folded: folded, .false.", named)
    )
    writer = [sys.executable, ROOT / "scripts/loops.py", tmp_path, "leaf", tmp_path / "leaf.CUF"]
    subprocess.run(writer, check=True)
    made = (tmp_path / "leaf_variants.CUF").read_text()
    found = re.findall(r"launch_bounds\((.*)\) subroutine press_(\w+)\(", made)
    assert len(found) == 8
    assert {bounds for bounds, name in found if name != "weno3_hllc"} == {"64,1"}
    assert ("9,9", "weno3_hllc") in found
    assert "call press(muscl_cells, steger_warming, n, step, x)" in made


@pytest.mark.parametrize(
    ("launch", "fault"),
    [
        ("call k%leaf_mark([9, 2, 1], 9, 1.0_dp, x, words, err)", ""),
        ("call k%leaf_mark([9, 2, 1], 9, 1.0_dp, words, words, err)", "Type mismatch"),
        ("call k%leaf_mark([9, 2, 1], 9, x, words, err)", "Type mismatch"),
        ("call launch_press(one, [9, 2, 1], 9, 1.0_rk, x, err)", ""),
        ("call launch_press(one, [9, 2, 1], 9, 1.0_rk, err)", "Type mismatch"),
    ],
)
def test_launches_of_kernels_are_checked(leaf, launch, fault):
    (leaf / "stubs.f90").write_text(STUBS)
    (leaf / "user.f90").write_text(
        f"""program user
    use brz_buffers
    use brz_device
    use brz_kinds
    use brz_leaf_launches
    type(leaf_kernels_t) :: k
    type(kernel_t) :: one
    type(error_t) :: err
    type(reals_t) :: x
    type(doubles_t) :: words
    {launch}
end program
"""
    )
    base = [ROOT / "src" / x for x in ("base/kinds.F90", "base/buffers.f90")]
    made = [leaf / f"{x}.f90" for x in ("stubs", "leaf_launches", "user")]
    command = ["gfortran", "-cpp", "-J", leaf, *base, *made, "-o", leaf / "user"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if fault:
        assert fault in done.stderr
        return
    assert done.returncode == 0, done.stderr
    said = subprocess.run([leaf / "user"], capture_output=True, text=True, check=True).stdout
    assert said.split() == ["9", "2", "1", "4" if "mark" in launch else "3", "0"]


def test_variants_are_kernels_that_know_their_constants(leaf):
    text = (leaf / "leaf_variants.CUF").read_text()
    assert "use brz_leaf_kernels, only: flat, folded, press" in text
    assert "attributes(global) launch_bounds(128,2) subroutine press_flat(n, step, x)" in text
    assert "attributes(global) subroutine press_folded(n, step, x)" in text
    assert "real(rk), value :: step" in text
    assert "real(rk), device, intent(inout) :: x(n, *)" in text
    assert "call press(folded, .false., n, step, x)" in text
