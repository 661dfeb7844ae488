! SPDX-License-Identifier: MIT
!> The CUDA variables of a kernel, for the emulator: set by emulator.c, one set per host thread.
module emulated_cuda
    use, intrinsic :: iso_c_binding, only: c_int
    implicit none
    private
    public :: threadIdx, blockIdx, blockDim, gridDim, atomicadd

    type, bind(c) :: dim3_t
        integer(c_int) :: x, y, z
    end type dim3_t

    type(dim3_t), save, bind(c, name='emulated_thread') :: threadIdx
    type(dim3_t), save, bind(c, name='emulated_block') :: blockIdx
    type(dim3_t), save, bind(c, name='emulated_threads') :: blockDim
    type(dim3_t), save, bind(c, name='emulated_grid') :: gridDim
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
end module emulated_cuda
