! SPDX-License-Identifier: MIT
!> What one process has to do with the others where several share the particles: the regions of all,
!> and whose ghosts are where.
module brz_solid_part
    use brz_kinds, only: dp, int32, int64
    use brz_lists, only: at_least
    use brz_mail, only: mail_t
    implicit none
    private
    public :: part_t, parcels_t, find_firsts, find_pieces, fill_pieces

    !> Particles that are in a message: parcel r is entries first(r) to first(r + 1) - 1.
    type :: parcels_t
        integer, allocatable :: place(:) !! of the particles
        integer, allocatable :: first(:) !! (0:processes)
    end type parcels_t

    !> Regions fill all of space.
    type :: part_t
        real(dp), allocatable :: region(:, :, :) !! (3, 2, 0:processes-1) corners [m]
        real(dp) :: lowest(3) = -huge(1.0_dp)
        !! no particle of any body is lower, where a plane of symmetry is [m]
        integer :: most = 0 !! most particles of a process when the regions were cut
        logical :: recut = .false., grown = .false. !! in the last search: regions, arrays laid anew
        integer(int32), allocatable :: mark(:) !! (places, processes) who goes where
        type(parcels_t) :: out !! particles of this process that others have ghosts of
        type(parcels_t) :: in !! ghosts of this process
        type(mail_t) :: mail
    end type part_t

contains

    !> First entry of the parcel of each process.
    pure subroutine find_firsts(number, first)
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, allocatable, intent(inout) :: first(:) !! (0:processes)
        integer :: r

        if (.not. allocated(first)) allocate (first(0:size(number, 2)))
        first(0) = 1
        do r = 1, size(number, 2)
            first(r) = first(r - 1) + int(sum(number(:, r)))
        end do
    end subroutine find_firsts

    !> Pieces of a list of what comes, process by process: that of a process and body is one.
    pure subroutine find_pieces(number, before, piece)
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, intent(inout) :: before(:) !! (bodies) places that are taken; these ones, too, then
        integer, intent(out) :: piece(:, :) !! (2, pieces) last entry, what an entry is short of
        integer :: b, k, n, r

        n = 0
        k = 0
        do r = 1, size(number, 2)
            do b = 1, size(number, 1)
                k = k + 1
                piece(2, k) = before(b) - n
                n = n + int(number(b, r))
                before(b) = before(b) + int(number(b, r))
                piece(1, k) = n
            end do
        end do
    end subroutine find_pieces

    !> Places of what comes.
    subroutine fill_pieces(number, before, list)
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, intent(inout) :: before(:) !! see find_pieces
        type(parcels_t), intent(inout) :: list
        integer :: i, k, n, piece(2, size(number))

        call at_least(list%place, int(sum(number)))
        call find_firsts(number, list%first)
        call find_pieces(number, before, piece)
        n = 0
        do k = 1, size(number)
            do i = n + 1, piece(1, k)
                list%place(i) = i + piece(2, k)
            end do
            n = piece(1, k)
        end do
    end subroutine fill_pieces
end module brz_solid_part
