! SPDX-License-Identifier: MIT
!> The CUDA variables of a kernel, for the emulator: set before each call, one set per host thread.
module emulated_cuda
    use, intrinsic :: iso_c_binding, only: c_int
    implicit none
    private
    public :: threadIdx, blockIdx, blockDim, gridDim, atomicadd

    type :: dim3_t
        integer :: x = 1, y = 1, z = 1
    end type dim3_t

    type(dim3_t), save :: threadIdx, blockIdx, blockDim, gridDim
    !$omp threadprivate(threadIdx, blockIdx, blockDim, gridDim)

contains

    !> Add to a number that other threads may add to; the result is what it was.
    integer function atomicadd(mem, value) result(old)
        integer, intent(inout) :: mem
        integer, intent(in) :: value

        !$omp atomic capture
        old = mem
        mem = mem + value
        !$omp end atomic
    end function atomicadd

    subroutine set_grid(gx, gy, gz, bx, by, bz) bind(c)
        integer(c_int), value :: gx, gy, gz, bx, by, bz

        gridDim = dim3_t(gx, gy, gz)
        blockDim = dim3_t(bx, by, bz)
    end subroutine set_grid

    subroutine set_block(x, y, z) bind(c)
        integer(c_int), value :: x, y, z

        blockIdx = dim3_t(x, y, z)
    end subroutine set_block

    subroutine set_thread(x, y, z) bind(c)
        integer(c_int), value :: x, y, z

        threadIdx = dim3_t(x, y, z)
    end subroutine set_thread
end module emulated_cuda
