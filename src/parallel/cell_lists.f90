! SPDX-License-Identifier: MIT
!> What a fetch moves, as lists of places in an array and one parcel for each process: for those who
!> pack and unpack elsewhere than on the host.
module brz_cell_lists
    use brz_boxes, only: cells_t, cells_of
    use brz_fetch, only: fetch_t, parcel_t
    use brz_kinds, only: int64
    use brz_mail, only: mail_t, make_room
    use brz_ranks, only: ranks_t
    implicit none
    private
    public :: cell_list_t, list_cells, places_in

    integer, parameter :: unit = 8 !! bytes: a parcel is a whole number of so many

    !> Places of the cells in the order of the bytes of the mail.
    type :: cell_list_t
        integer(int64), allocatable :: out(:), in(:) !! from 1
        type(mail_t) :: mail
    end type cell_list_t

contains

    !> List the cells of a fetch for arrays that hold the cells `box` of the whole grid.
    subroutine list_cells(ranks, plan, box, bytes, list)
        type(ranks_t), intent(in) :: ranks
        type(fetch_t), intent(in) :: plan
        type(cells_t), intent(in) :: box
        integer, intent(in) :: bytes !! of a cell
        type(cell_list_t), intent(out) :: list
        integer(int64) :: length(0:ranks%n - 1, 2)

        call list_parcels(plan%out, box, bytes, list%out, length(:, 1))
        call list_parcels(plan%in, box, bytes, list%in, length(:, 2))
        call make_room(ranks, length(:, 1), length(:, 2), list%mail)
    end subroutine list_cells

    !> List the cells of all parcels, process by process. The last cell of a process comes again and
    !> again until its parcel is a whole number of units.
    subroutine list_parcels(parcels, box, bytes, place, length)
        type(parcel_t), intent(in) :: parcels(:)
        type(cells_t), intent(in) :: box
        integer, intent(in) :: bytes !! of a cell
        integer(int64), allocatable, intent(out) :: place(:)
        integer(int64), intent(out) :: length(0:) !! (processes) bytes
        integer :: m, r

        allocate (place(0))
        do r = 0, ubound(length, 1)
            length(r) = 0
            do m = 1, size(parcels)
                if (parcels(m)%partner /= r) cycle
                place = [place, places_in(box, parcels(m)%box)]
                length(r) = length(r) + bytes*cells_of(parcels(m)%box)
            end do
            do while (mod(length(r), int(unit, int64)) > 0)
                place = [place, place(size(place))]
                length(r) = length(r) + bytes
            end do
        end do
    end subroutine list_parcels

    !> Places of the cells of one box in an array that holds those of another.
    pure function places_in(whole, box) result(place)
        type(cells_t), intent(in) :: whole, box
        integer(int64), allocatable :: place(:)
        integer(int64) :: n(2)
        integer :: i, j, k
        integer(int64) :: at

        allocate (place(cells_of(box)))
        n = whole%hi(:2) - whole%lo(:2) + 1
        at = 0
        do k = box%lo(3), box%hi(3)
            do j = box%lo(2), box%hi(2)
                do i = box%lo(1), box%hi(1)
                    at = at + 1
                    place(at) = i - whole%lo(1) + 1 &
                        + n(1)*(j - whole%lo(2) + n(2)*(k - whole%lo(3)))
                end do
            end do
        end do
    end function places_in
end module brz_cell_lists
