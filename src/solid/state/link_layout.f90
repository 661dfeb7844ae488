! SPDX-License-Identifier: MIT
!> How lists of particles are written: an entry is a particle plus mask_unit times the mask of the
!> axes in which it is mirrored, bits 0..2.
module brz_link_layout
    use brz_kinds, only: int32, int64, rk
    implicit none
    private
    public :: mask_unit, link_unit, slice_width, n_press, link_layout_t, fix_layout
    public :: links_of

    integer, parameter :: mask_unit = 2**28
    integer, parameter :: link_unit = 8 !! entries by which places in the list are counted on a CPU
    integer, parameter :: slice_width = 32 !! lists side by side on a GPU
    integer, parameter :: n_press = 8 !! rows of `press`, a whole number of cache lines

    !> What the loops over links are told about the bodies and about how arrays lie.
    type :: link_layout_t
        integer :: bodies, dimension
        integer :: holds !! 1: some body has the tensile control
        integer :: wide !! rows of positions and velocities
        integer :: step_c, stride_p !! distances in `stress` of components, of particles
        integer :: step_f !! distance of particles in `face`; its numbers are step_c apart
        integer :: step_v !! distance of volumes
        integer :: compact !! 1: lists and sums of contact are those of rows; 0: of particles
        integer :: side !! lists side by side, entry by entry
        integer :: unit !! entries by which places in the list are counted
        real(rk) :: depth !! of directions that are not modelled [m or m2]
    end type link_layout_t

contains

    !> A layout with the numbers that are the same for all scenes on a GPU, which has rows of four
    !> and lists of particles. Kernels call it, so that the compiler knows where rows begin and
    !> fetches 16 B at a time.
    !@cuf attributes(host,device) &
    pure subroutine fix_layout(given, lay)
        type(link_layout_t), intent(in) :: given
        type(link_layout_t), intent(out) :: lay

        lay%bodies = given%bodies
        lay%dimension = given%dimension
        lay%holds = given%holds
        lay%wide = 4
        lay%step_c = given%step_c
        lay%stride_p = 1
        lay%step_f = 1
        lay%step_v = 4
        lay%compact = 0
        lay%side = slice_width
        lay%unit = slice_width
        lay%depth = given%depth
    end subroutine fix_layout

    !> The links of particle i: entries at, at + side, ... of the list, n of them, and the row of
    !> its sums.
    !@cuf attributes(host,device) &
    pure subroutine links_of(lay, i, row, slice, count, r, n, at)
        type(link_layout_t), intent(in) :: lay
        integer, intent(in) :: i
        integer(int32), intent(in) :: row(*), slice(*), count(*)
        integer, intent(out) :: r, n
        integer(int64), intent(out) :: at

        r = i
        if (lay%compact == 1) r = row(i)
        n = 0
        at = 1
        if (r == 0) return
        n = count(r)
        at = int(slice((r - 1)/lay%side + 1), int64)*lay%unit + mod(r - 1, lay%side) + 1
    end subroutine links_of
end module brz_link_layout
