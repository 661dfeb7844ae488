! SPDX-License-Identifier: MIT
!> What a fetch moves, as lists of places in an array and one message for each process: for those
!> who pack and unpack elsewhere than on the host.
module brz_cell_lists
    use brz_boxes, only: cells_t, cells_of
    use brz_fetch, only: field_message_t
    use brz_kinds, only: int32, int64
    use brz_places, only: message_buffers_t
    implicit none
    private
    public :: list_cells, places_in

contains

    !> Places of the cells of some messages in an array that holds the cells `box` of the whole
    !> grid, process by process.
    pure type(message_buffers_t) function list_cells(processes, messages, box) result(list)
        integer, intent(in) :: processes
        type(field_message_t), intent(in) :: messages(:)
        type(cells_t), intent(in) :: box
        integer :: m, r

        allocate (list%first(0:processes), source=1)
        allocate (list%place(0))
        do r = 0, processes - 1
            do m = 1, size(messages)
                if (messages(m)%partner == r) &
                    list%place = [list%place, int(places_in(box, messages(m)%box), int32)]
            end do
            list%first(r + 1) = size(list%place) + 1
        end do
    end function list_cells

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
