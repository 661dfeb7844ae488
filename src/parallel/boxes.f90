! SPDX-License-Identifier: MIT
!> Boxes of cells on the grid of the air, and how the grid is cut into one for each process.
!>
!> All processes cut alike, without a message. Boxes begin on multiples of `brick` cells, so that a
!> brick lies in one box.
module brz_boxes
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: box_t, common, widened, is_empty, cells_of, cut_grid, most_boxes

    !> Cells lo..hi of the whole grid, both included.
    type :: box_t
        integer :: lo(3) = 1, hi(3) = 0
    end type box_t

contains

    !> Cells that lie in both of two boxes.
    elemental function common(a, b) result(both)
        type(box_t), intent(in) :: a, b
        type(box_t) :: both

        both%lo = max(a%lo, b%lo)
        both%hi = min(a%hi, b%hi)
    end function common

    !> A box and some layers around it.
    pure function widened(box, layers) result(wide)
        type(box_t), intent(in) :: box
        integer, intent(in) :: layers(3)
        type(box_t) :: wide

        wide%lo = box%lo - layers
        wide%hi = box%hi + layers
    end function widened

    elemental logical function is_empty(box)
        type(box_t), intent(in) :: box

        is_empty = any(box%lo > box%hi)
    end function is_empty

    !> Number of cells.
    elemental integer(int64) function cells_of(box)
        type(box_t), intent(in) :: box

        cells_of = product(max(int(box%hi - box%lo, int64) + 1, 0_int64))
    end function cells_of

    !> Boxes that a grid can be cut into at most: none is thinner than a brick.
    pure integer(int64) function most_boxes(n, brick)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: brick !! cells per side of a brick

        most_boxes = product(int(max(n/brick, 1), int64))
    end function most_boxes

    !> Cut a grid into boxes of cells as even as whole bricks allow; at most `most_boxes`.
    pure subroutine cut_grid(n, brick, boxes)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: brick !! cells per side of a brick
        type(box_t), intent(out) :: boxes(0:) !! (processes)

        call halve(box_t([1, 1, 1], n), brick, boxes)
    end subroutine cut_grid

    !> Cut a box across its longest side that can be cut, in proportion to the processes on each
    !> side, until there is one process.
    pure recursive subroutine halve(box, brick, boxes)
        type(box_t), intent(in) :: box
        integer, intent(in) :: brick
        type(box_t), intent(out) :: boxes(0:)
        type(box_t) :: low, high
        integer :: bricks(3), across, below, d, layers, n, trial

        n = size(boxes)
        boxes(0) = box
        if (n == 1) return
        bricks = max((box%hi - box%lo + 1)/brick, 1) ! the last one may be thicker
        do trial = 3, 1, -1 ! from the longest side to the shortest
            d = side_of(box, trial)
            if (bricks(d) > 1) exit
        end do
        across = product(bricks)/bricks(d)
        layers = min(max(nint(real(bricks(d), dp)*(n/2)/n), 1), bricks(d) - 1)
        below = max(n/2, 1, n - (bricks(d) - layers)*across) ! no side gets more than it has bricks
        below = min(below, n - 1, layers*across)
        low = box
        high = box
        low%hi(d) = box%lo(d) - 1 + layers*brick
        high%lo(d) = low%hi(d) + 1
        call halve(low, brick, boxes(:below - 1))
        call halve(high, brick, boxes(below:))
    end subroutine halve

    !> The direction of the side that is `place`-th in length, 3 for the longest; of equal ones the
    !> last direction counts as longer.
    pure integer function side_of(box, place) result(direction)
        type(box_t), intent(in) :: box
        integer, intent(in) :: place
        integer :: d, length(3)

        length = box%hi - box%lo + 1
        direction = 3
        do d = 1, 3
            if (1 + count(length < length(d)) + count(length(:d - 1) == length(d)) == place) &
                direction = d
        end do
    end function side_of
end module brz_boxes
