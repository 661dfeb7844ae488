! SPDX-License-Identifier: MIT
!> What one process has to do with the others where several share the particles: the regions of all,
!> and whose ghosts are where.
module brz_solid_part
    use brz_kinds, only: dp, int64
    use brz_message_exchange, only: message_exchange_t
    use brz_places, only: marks_t, message_buffers_t
    implicit none
    private
    public :: solid_part_t

    !> Regions fill all of space. Marks say who goes where.
    type, extends(marks_t) :: solid_part_t
        real(dp), allocatable :: region(:, :, :) !! (3, 2, 0:processes-1) corners [m]
        real(dp), allocatable :: boxes(:, :, :, :)
        !! (3, 2, bodies, 0:processes-1) corners of `x_built`, see has_boxes [m]
        real(dp) :: lowest(3) = -huge(1.0_dp)
        !! no particle of any body is at home lower, where a plane of symmetry is [m]
        integer :: most = 0 !! most particles of a process when the regions were cut
        logical :: recut = .false., grown = .false. !! in the last search: regions, arrays laid anew
        logical :: keeps = .false. !! `sent` and `kept` are those of the ghosts of now
        integer(int64), allocatable :: kept(:, :, :)
        !! (bodies, to processes, from processes) ghosts of all
        real(dp) :: margin = 0 !! what particles may be outside the region of their process [m]
        integer :: far(2) = 0 !! 1: some of any process are outside; by more than they may
        type(message_buffers_t) :: out !! particles of this process that others have ghosts of
        type(message_buffers_t) :: in !! ghosts of this process
        type(message_exchange_t) :: exchange
    end type solid_part_t
end module brz_solid_part
