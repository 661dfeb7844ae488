! SPDX-License-Identifier: MIT
!> Fields from the boxes of those who own them to the wider boxes of those who want them.
!>
!> All processes know all boxes, so who sends what to whom follows from their intersections; there
!> are no lists and no handshakes. A box that is wanted may reach beyond the grid in a direction
!> that is periodic: it goes on from the other end.
module brz_fetch
    use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_null_ptr, c_ptr
    use brz_boxes, only: cells_t, cells_of, common, is_empty
    use brz_kinds, only: dp, int8, int64, rk
    use brz_mpi_library, only: mpi_double, mpi_float, mpi_irecv, mpi_isend, mpi_waitall
    use brz_ranks, only: ranks_t, several, traffic
    use brz_timer, only: lap, wall_seconds
    implicit none
    private
    public :: fetch_t, field_message_t, plan_fetch, fetch

    integer, parameter :: first_tag = 100 !! and the number of the image behind it

    !> What passes to or from one process in one message.
    type :: field_message_t
        integer :: partner = 0
        integer :: image = 0 !! 0..26: how far the field is shifted around the grid
        type(cells_t) :: box !! as this process numbers the cells
        real(rk), allocatable :: numbers(:)
    end type field_message_t

    !> Who sends what to whom.
    type :: fetch_t
        type(cells_t) :: whole !! cells that the arrays of this process hold
        type(field_message_t), allocatable :: out(:), in(:)
        type(c_ptr), allocatable :: requests(:)
        integer(int64) :: bytes = 0 !! that this process sends each time
    end type fetch_t

    !> Fill those cells of an array that this process wants and others own.
    interface fetch
        module procedure fetch_reals, fetch_marks
    end interface fetch

contains

    !> Find who sends what to whom, for fields of up to `numbers` numbers per cell.
    subroutine plan_fetch(ranks, owners, wanted, n, periodic, numbers, plan)
        type(ranks_t), intent(in) :: ranks
        type(cells_t), intent(in) :: owners(0:) !! (processes) the cells of each
        type(cells_t), intent(in) :: wanted(0:) !! (processes) what each wants, own cells or not
        integer, intent(in) :: n(3) !! cells of the whole grid
        logical, intent(in) :: periodic(3)
        integer, intent(in) :: numbers
        type(fetch_t), intent(out) :: plan
        integer :: r, image

        allocate (plan%out(0), plan%in(0))
        plan%whole = wanted(ranks%rank)
        plan%whole%lo = min(plan%whole%lo, owners(ranks%rank)%lo)
        plan%whole%hi = max(plan%whole%hi, owners(ranks%rank)%hi)
        do r = 0, ranks%n - 1
            if (r == ranks%rank) cycle
            do image = 0, 26
                if (any(shift_of(image) /= 0 .and. .not. periodic)) cycle
                call add(plan%in, r, image, common(moved(owners(r), shift_of(image)*n), &
                                                   wanted(ranks%rank)), numbers)
                call add(plan%out, r, image, &
                         moved(common(moved(owners(ranks%rank), shift_of(image)*n), wanted(r)), &
                               -shift_of(image)*n), numbers)
            end do
        end do
        allocate (plan%requests(size(plan%in) + size(plan%out)))
        plan%requests = c_null_ptr
        do r = 1, size(plan%out)
            plan%bytes = plan%bytes + size(plan%out(r)%numbers, kind=int64)*storage_size(1.0_rk)/8
        end do
    end subroutine plan_fetch

    !> Note a message, unless it is empty.
    subroutine add(messages, partner, image, box, numbers)
        type(field_message_t), allocatable, intent(inout) :: messages(:)
        integer, intent(in) :: partner, image
        type(cells_t), intent(in) :: box
        integer, intent(in) :: numbers !! per cell
        type(field_message_t) :: message

        if (is_empty(box)) return
        message%partner = partner
        message%image = image
        message%box = box
        allocate (message%numbers(cells_of(box)*numbers))
        messages = [messages, message]
    end subroutine add

    !> Steps around the grid of an image.
    pure function shift_of(image) result(shift)
        integer, intent(in) :: image !! 0..26, 0: none
        integer :: shift(3), d

        shift = [(modulo(image/3**(d - 1) + 1, 3) - 1, d=1, 3)]
    end function shift_of

    pure function moved(box, by) result(to)
        type(cells_t), intent(in) :: box
        integer, intent(in) :: by(3)
        type(cells_t) :: to

        to%lo = box%lo + by
        to%hi = box%hi + by
    end function moved

    !> Reals: the array holds the cells lo..hi of the whole grid.
    subroutine fetch_reals(ranks, plan, n_var, lo, hi, field)
        type(ranks_t), intent(in) :: ranks
        type(fetch_t), intent(inout) :: plan
        integer, intent(in) :: n_var !! numbers per cell
        integer, intent(in) :: lo(3), hi(3)
        real(rk), intent(inout) :: field(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), n_var)
        integer :: m

        if (.not. several(ranks)) return
        call listen(ranks, plan, n_var*cells_of(plan%in%box))
        do m = 1, size(plan%out)
            associate (b => plan%out(m)%box)
                call pack_reals(field(b%lo(1):b%hi(1), b%lo(2):b%hi(2), b%lo(3):b%hi(3), :), &
                                plan%out(m)%numbers)
            end associate
            call send(ranks, plan, m, n_var*cells_of(plan%out(m)%box))
        end do
        call wait_for_all(plan)
        do m = 1, size(plan%in)
            associate (b => plan%in(m)%box)
                call unpack_reals(plan%in(m)%numbers, &
                                  field(b%lo(1):b%hi(1), b%lo(2):b%hi(2), b%lo(3):b%hi(3), :))
            end associate
        end do
    end subroutine fetch_reals

    !> Small whole numbers, one per cell.
    subroutine fetch_marks(ranks, plan, lo, hi, field)
        type(ranks_t), intent(in) :: ranks
        type(fetch_t), intent(inout) :: plan
        integer, intent(in) :: lo(3), hi(3)
        integer(int8), intent(inout) :: field(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))
        integer :: m

        if (.not. several(ranks)) return
        call listen(ranks, plan, cells_of(plan%in%box))
        do m = 1, size(plan%out)
            associate (b => plan%out(m)%box)
                plan%out(m)%numbers(:cells_of(b)) = real(reshape( &
                    field(b%lo(1):b%hi(1), b%lo(2):b%hi(2), b%lo(3):b%hi(3)), [cells_of(b)]), rk)
            end associate
            call send(ranks, plan, m, cells_of(plan%out(m)%box))
        end do
        call wait_for_all(plan)
        do m = 1, size(plan%in)
            associate (b => plan%in(m)%box)
                field(b%lo(1):b%hi(1), b%lo(2):b%hi(2), b%lo(3):b%hi(3)) = reshape( &
                    nint(plan%in(m)%numbers(:cells_of(b)), int8), b%hi - b%lo + 1)
            end associate
        end do
    end subroutine fetch_marks

    !> Be ready for what comes in.
    subroutine listen(ranks, plan, lengths)
        type(ranks_t), intent(in) :: ranks
        type(fetch_t), intent(inout), target :: plan
        integer(int64), intent(in) :: lengths(:) !! numbers of each message
        integer(c_int) :: status
        integer :: m

        do m = 1, size(plan%in)
            associate (message => plan%in(m))
                status = mpi_irecv(c_loc(message%numbers), &
                                   int(lengths(m), c_int), kind_of_reals(), &
                                   int(message%partner, c_int), &
                                   int(first_tag + message%image, c_int), ranks%comm, &
                                   plan%requests(m))
            end associate
        end do
    end subroutine listen

    !> Send message m, which is packed.
    subroutine send(ranks, plan, m, length)
        type(ranks_t), intent(in) :: ranks
        type(fetch_t), intent(inout), target :: plan
        integer, intent(in) :: m
        integer(int64), intent(in) :: length !! numbers
        integer(c_int) :: status

        associate (message => plan%out(m))
            status = mpi_isend(c_loc(message%numbers), int(length, c_int), &
                               kind_of_reals(), int(message%partner, c_int), &
                               int(first_tag + message%image, c_int), ranks%comm, &
                               plan%requests(size(plan%in) + m))
        end associate
    end subroutine send

    subroutine wait_for_all(plan)
        type(fetch_t), intent(inout) :: plan
        integer(c_int) :: status
        real(dp) :: mark

        mark = wall_seconds()
        status = mpi_waitall(size(plan%requests, kind=c_int), plan%requests, c_null_ptr)
        traffic%fetches = traffic%fetches + 1
        call lap(mark, traffic%seconds)
    end subroutine wait_for_all

    !> The type of MPI for working reals.
    type(c_ptr) function kind_of_reals()
        kind_of_reals = mpi_double
        if (storage_size(1.0_rk) == 32) kind_of_reals = mpi_float
    end function kind_of_reals

    pure subroutine pack_reals(field, numbers)
        real(rk), intent(in) :: field(:, :, :, :)
        real(rk), intent(inout) :: numbers(:)
        integer :: j, k, c
        integer(int64) :: at

        at = 0
        do c = 1, size(field, 4)
            do k = 1, size(field, 3)
                do j = 1, size(field, 2)
                    numbers(at + 1:at + size(field, 1)) = field(:, j, k, c)
                    at = at + size(field, 1)
                end do
            end do
        end do
    end subroutine pack_reals

    pure subroutine unpack_reals(numbers, field)
        real(rk), intent(in) :: numbers(:)
        real(rk), intent(inout) :: field(:, :, :, :)
        integer :: j, k, c
        integer(int64) :: at

        at = 0
        do c = 1, size(field, 4)
            do k = 1, size(field, 3)
                do j = 1, size(field, 2)
                    field(:, j, k, c) = numbers(at + 1:at + size(field, 1))
                    at = at + size(field, 1)
                end do
            end do
        end do
    end subroutine unpack_reals
end module brz_fetch
