! SPDX-License-Identifier: MIT
!> Domain decomposition of the air: boxes of cells on its grid, one for each process, its subdomain.
!>
!> All processes cut alike, without a message. Boxes begin on multiples of `brick` cells, so that a
!> brick lies in one box.
module brz_boxes
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: cells_t, crowd_t, asks_of, common, widened, is_empty, cells_of, cut_grid, most_boxes

    !> Cells lo..hi of the whole grid, both included.
    type :: cells_t
        integer :: lo(3) = 1, hi(3) = 0
    end type cells_t

    !> A body where the grid is cut: particles that fill a box.
    type :: crowd_t
        real(dp) :: lo(3) = 0, hi(3) = 0 !! corners, in cells from that of the grid
        real(dp) :: particles = 0
    end type crowd_t

    ! what the coupling of a particle costs in steps of a cell (0.41 ns over 0.29 ns on an H200),
    ! and a cell beside a cut, of which 1.2 kB are sent in a step
    real(dp), parameter :: particle_cost = 1.4_dp, face_cost = 20

contains

    !> Cells that lie in both of two boxes.
    elemental function common(a, b) result(both)
        type(cells_t), intent(in) :: a, b
        type(cells_t) :: both

        both%lo = max(a%lo, b%lo)
        both%hi = min(a%hi, b%hi)
    end function common

    !> A box and some layers around it.
    pure function widened(box, layers) result(wide)
        type(cells_t), intent(in) :: box
        integer, intent(in) :: layers(3)
        type(cells_t) :: wide

        wide%lo = box%lo - layers
        wide%hi = box%hi + layers
    end function widened

    !> Boxes of cells as kernels are told them: lowest and highest cell.
    pure function asks_of(boxes) result(asks)
        type(cells_t), intent(in) :: boxes(:)
        integer :: asks(6*size(boxes))
        integer :: r

        asks = [(boxes(r)%lo, boxes(r)%hi, r=1, size(boxes))]
    end function asks_of

    elemental logical function is_empty(box)
        type(cells_t), intent(in) :: box

        is_empty = any(box%lo > box%hi)
    end function is_empty

    !> Number of cells.
    elemental integer(int64) function cells_of(box)
        type(cells_t), intent(in) :: box

        cells_of = product(max(int(box%hi - box%lo, int64) + 1, 0_int64))
    end function cells_of

    !> Boxes that a grid can be cut into at most: none is thinner than a brick.
    pure integer(int64) function most_boxes(n, brick, uncut)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: brick !! cells per side of a brick
        logical, intent(in), optional :: uncut(3) !! directions in which all boxes are whole

        most_boxes = product(int(max(n/sides_of(n, brick, uncut), 1), int64))
    end function most_boxes

    !> Least cells of a box along each direction.
    pure function sides_of(n, brick, uncut) result(sides)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: brick
        logical, intent(in), optional :: uncut(3)
        integer :: sides(3)

        sides = brick
        if (.not. present(uncut)) return
        where (uncut) sides = n
    end function sides_of

    !> Cut a grid into boxes of cells as even as whole bricks allow; at most `most_boxes`. Where
    !> there are bodies in it, so that these are shared, too.
    pure subroutine cut_grid(n, brick, boxes, crowds, uncut)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: brick !! cells per side of a brick
        type(cells_t), intent(out) :: boxes(0:) !! (processes)
        type(crowd_t), intent(in), optional :: crowds(:)
        logical, intent(in), optional :: uncut(3) !! directions in which all boxes are whole

        if (present(crowds)) then
            call halve(cells_t([1, 1, 1], n), sides_of(n, brick, uncut), crowds, boxes)
        else
            call halve(cells_t([1, 1, 1], n), sides_of(n, brick, uncut), [crowd_t ::], boxes)
        end if
    end subroutine cut_grid

    !> Cut a box in two, in proportion to the processes on each side, until there is one process.
    pure recursive subroutine halve(box, sides, crowds, boxes)
        type(cells_t), intent(in) :: box
        integer, intent(in) :: sides(3) !! least cells of a box
        type(crowd_t), intent(in) :: crowds(:)
        type(cells_t), intent(out) :: boxes(0:)
        type(cells_t) :: half(2)
        integer :: below

        boxes(0) = box
        if (size(boxes) == 1) return
        call choose_cut(box, sides, crowds, size(boxes), half, below)
        call halve(half(1), sides, crowds, boxes(:below - 1))
        call halve(half(2), sides, crowds, boxes(below:))
    end subroutine halve

    !> Cut a box across its longest side that can be cut. Where there are bodies, across the one
    !> that costs least: air and coupling wait each for the process that has most of it, and what is
    !> beside the cut is sent.
    pure subroutine choose_cut(box, sides, crowds, n, half, below)
        type(cells_t), intent(in) :: box
        integer, intent(in) :: sides(3) !! least cells of a box
        type(crowd_t), intent(in) :: crowds(:)
        integer, intent(in) :: n !! processes
        type(cells_t), intent(out) :: half(2)
        integer, intent(out) :: below !! processes of the lower half
        type(cells_t) :: trial(2)
        real(dp) :: cost, least
        integer :: d, h, k, m

        least = huge(least)
        do k = 3, 1, -1 ! from the longest side to the shortest
            d = side_of(box, k)
            if (box%hi(d) - box%lo(d) + 1 < 2*sides(d)) cycle
            call cut_across(box, sides, d, n, trial, m)
            cost = greater(real(cells_of(trial), dp)) &
                + particle_cost*greater([(crowd_of(crowds, trial(h)), h=1, 2)]) &
                + face_cost*real(cells_of(box), dp)/(box%hi(d) - box%lo(d) + 1)
            if (cost >= least) cycle
            least = cost
            half = trial
            below = m
            if (size(crowds) == 0) return
        end do

    contains

        !> Of the halves the one that has most for each of its processes.
        pure real(dp) function greater(x)
            real(dp), intent(in) :: x(2)

            greater = maxval(x/[m, n - m])
        end function greater
    end subroutine choose_cut

    !> Cut a box across direction d.
    pure subroutine cut_across(box, sides, d, n, half, below)
        type(cells_t), intent(in) :: box
        integer, intent(in) :: sides(3), d
        integer, intent(in) :: n !! processes
        type(cells_t), intent(out) :: half(2)
        integer, intent(out) :: below !! processes of the lower half
        integer :: bricks(3), across, layers

        bricks = max((box%hi - box%lo + 1)/sides, 1) ! the last one may be thicker
        across = product(bricks)/bricks(d)
        layers = min(max(nint(real(bricks(d), dp)*(n/2)/n), 1), bricks(d) - 1)
        below = max(n/2, 1, n - (bricks(d) - layers)*across) ! no side gets more than it has bricks
        below = min(below, n - 1, layers*across)
        half = box
        half(1)%hi(d) = box%lo(d) - 1 + layers*sides(d)
        half(2)%lo(d) = half(1)%hi(d) + 1
    end subroutine cut_across

    !> Particles of bodies in a box, about.
    pure real(dp) function crowd_of(crowds, box) result(n)
        type(crowd_t), intent(in) :: crowds(:)
        type(cells_t), intent(in) :: box
        real(dp) :: share, wide
        integer :: d, k

        n = 0
        do k = 1, size(crowds)
            share = 1
            do d = 1, 3
                wide = max(crowds(k)%hi(d) - crowds(k)%lo(d), tiny(wide))
                share = share*max(min(crowds(k)%hi(d), real(box%hi(d), dp)) &
                                  - max(crowds(k)%lo(d), box%lo(d) - 1.0_dp), 0.0_dp)/wide
            end do
            n = n + share*crowds(k)%particles
        end do
    end function crowd_of

    !> The direction of the side that is `place`-th in length, 3 for the longest; of equal ones the
    !> last direction counts as longer.
    pure integer function side_of(box, place) result(direction)
        type(cells_t), intent(in) :: box
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
