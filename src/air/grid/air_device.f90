! SPDX-License-Identifier: MIT
!> What the air has on a GPU besides the arrays of air_t: the states of a step, fluxes, lists of
!> cells near walls, and what others need of it.
module brz_air_device
    use brz_air_grid, only: grid_t
    use brz_buffers, only: buffer_t, bytes_t, doubles_t, integers_t, reals_t
    use brz_device, only: kernel_t
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_fetch, only: gpu_fetch_t
    use brz_kinds, only: rk
    use brz_scheme, only: scheme_t
    use brz_total_state, only: running_total_t
    implicit none
    private
    public :: air_device_t, wall_device_t, brick_device_t

    !> Maps of the cells; without walls the buffers hold nothing.
    type :: wall_device_t
        type(bytes_t) :: solid !! 1 in cells without gas, as wall_t has it
        type(bytes_t) :: near !! see air_near
    end type wall_device_t

    !> Which bricks of the air something has reached, and which are computed, as air_t has them.
    type :: brick_device_t
        type(bytes_t) :: reached, active !! one byte for each brick
        ! on several processes, with the bricks of others that are near
        type(bytes_t) :: near_reached, near_active
        type(buffer_t) :: own !! (bricks) place of each of this process there
        type(gpu_fetch_t) :: others
    end type brick_device_t

    type :: air_device_t
        type(grid_t) :: grid
        logical :: fetched = .true. !! the host arrays hold the state of the GPU
        type(scheme_t) :: scheme
        real(rk) :: rho_rest = 0, p_rest = 0 !! as in air_t
        type(reals_t) :: u !! conserved variables, as in air_t; in a step those of a stage
        type(reals_t) :: start !! the same at the start of the step, in one of the others
        type(reals_t) :: new, spare !! the next state; room for another
        type(reals_t) :: flux !! through the faces of direction x above each cell
        type(bytes_t) :: bad !! one byte for each cell, see mark_cell
        type(integers_t) :: found !! 1: a kernel has found a bad cell; a count
        type(reals_t) :: outside !! (lines, n_var, 2) gas beyond open boundaries
        type(reals_t) :: edge !! (lines, n_var, 2) fluxes through the outer faces
        type(doubles_t) :: leaving !! (faces of bricks, n_var, 2) what left since the start
        type(doubles_t) :: part !! a number for each column along z; sums of bricks
        type(kernel_t) :: faces, march, last, redo !! of the scheme
        type(gpu_fetch_t) :: halo, beside !! as in air_part_t: states, marks of bad cells
        logical :: offered = .false. !! they have written theirs, and all have met since
        type(gpu_common_t) :: common
        type(wall_device_t) :: walls
        integer :: n_near = 0 !! cells at walls at the ends of lines
        type(integers_t) :: near_at, near_before !! their places; how many are before each chunk
        type(brick_device_t) :: bricks
        type(running_total_t) :: left_before(6) !! what had left when the GPU took over
    end type air_device_t
end module brz_air_device
