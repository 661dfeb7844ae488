! SPDX-License-Identifier: MIT
!> Lists of the particles of other bodies within reach of a particle, images included.
!>
!> Like the neighbour lists they depend on `x_built` and the order of the particles alone.
module brz_solid_links
    use brz_cell_grid, only: cell_span, fill_cells, lay_grid
    use brz_contact, only: law_bonded, law_none
    use brz_kinds, only: dp, int32, int64, int8
    use brz_solid_state, only: bond_whole, links_t, solid_t, worth_threads
    implicit none
    private
    public :: build_links, is_bonded, link_mirror, first_bonds

contains

    !> Build the links for the positions `x_built`. While they are counted and stored, `first(i+1)`
    !> is the number, then the place, of the last link of i so far.
    subroutine build_links(solid)
        type(solid_t), intent(inout) :: solid
        integer(int64) :: number, total
        integer :: i

        if (.not. solid%links%present) return
        associate (first => solid%links%first)
            first = 0
            call visit_bodies(solid, .false.)
            total = 0
            do i = 1, solid%n
                number = first(i + 1)
                first(i + 1) = total
                total = total + number
            end do
            call make_room(solid%links, total + 1)
            call visit_bodies(solid, .true.)
            first = first + 1
        end associate
        call number_rows(solid%links)
    end subroutine build_links

    !> Count or store, for every particle, its links with one body after the other; note which
    !> bodies have some.
    subroutine visit_bodies(solid, keep)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: keep
        real(dp) :: lo(3), hi(3), reach
        integer(int64) :: last
        integer :: a, b, c, i, m
        logical :: met

        solid%links%met = .false.
        do b = 1, size(solid%bodies)
            if (all(solid%links%table(:, b)%law == law_none)) cycle
            reach = 2*real(maxval(solid%links%table(:, b)%h), dp) + solid%skin
            call lay_grid(solid%search, solid%x_built, solid%bodies(b), reach)
            call fill_cells(solid%search, solid%x_built, solid%bodies(b))
            do c = 1, 3
                lo(c) = minval(solid%x_built(c, solid%bodies(b)%first:solid%bodies(b)%last))
                hi(c) = maxval(solid%x_built(c, solid%bodies(b)%first:solid%bodies(b)%last))
            end do
            do a = 1, size(solid%bodies)
                if (solid%links%table(a, b)%law == law_none) cycle
                reach = 2*real(solid%links%table(a, b)%h, dp) + solid%skin
                met = .false.
                !$omp parallel do if(solid%n >= worth_threads) schedule(static) &
                !$omp private(last, m) reduction(.or.: met)
                do i = solid%bodies(a)%first, solid%bodies(a)%last
                    last = solid%links%first(i + 1)
                    do m = 0, 7
                        if (near(solid, i, m, lo - reach, hi + reach)) &
                            call search(solid, i, m, reach, keep, last)
                    end do
                    met = met .or. last > solid%links%first(i + 1)
                    solid%links%first(i + 1) = last
                end do
                solid%links%met(a, b) = met
            end do
        end do
    end subroutine visit_bodies

    !> True where the planes of the mask m exist and the image of i lies in the box.
    pure logical function near(solid, i, m, lo, hi)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i, m
        real(dp), intent(in) :: lo(3), hi(3) !! [m]
        real(dp) :: x
        integer :: a

        near = .true.
        do a = 1, 3
            x = solid%x_built(a, i)
            if (btest(m, a - 1)) then
                near = near .and. solid%mirror(a)
                x = -x
            end if
            near = near .and. x > lo(a) .and. x < hi(a)
        end do
    end function near

    !> Count or store the particles of the body in the grid near the image of i.
    pure subroutine search(solid, i, m, reach, keep, last)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: i, m
        real(dp), intent(in) :: reach !! [m]
        logical, intent(in) :: keep
        integer(int64), intent(inout) :: last
        real(dp) :: x(3), d(3)
        integer :: c, c1, c2, c3, j, k, lo(3), hi(3)

        x = link_mirror(m)*solid%x_built(:, i)
        call cell_span(solid%search, x, reach, lo, hi)
        do c3 = lo(3), hi(3)
            do c2 = lo(2), hi(2)
                do c1 = lo(1), hi(1)
                    c = solid%search%code(c1, 1) + solid%search%code(c2, 2) &
                        + solid%search%code(c3, 3)
                    do k = solid%search%start(c), solid%search%start(c + 1) - 1
                        j = solid%search%order(k)
                        d = solid%x_built(:, j) - x
                        if (d(1)*d(1) + d(2)*d(2) + d(3)*d(3) >= reach*reach) cycle
                        last = last + 1
                        if (.not. keep) cycle
                        solid%links%list(last) = j
                        solid%links%mask(last) = int(m, int8)
                    end do
                end do
            end do
        end do
    end subroutine search

    !> Signs of the components that the planes of a mask mirror.
    pure function link_mirror(m) result(s)
        integer, intent(in) :: m !! bits 0..2
        real(dp) :: s(3)
        integer :: a

        do a = 1, 3
            s(a) = merge(-1, 1, btest(m, a - 1))
        end do
    end function link_mirror

    !> Rows for the contact of particles that have links; row 0 stays nil, for all others.
    subroutine number_rows(links)
        type(links_t), intent(inout) :: links
        integer :: i, n

        n = 0
        do i = 1, size(links%row)
            links%row(i) = 0
            if (links%first(i + 1) == links%first(i)) cycle
            n = n + 1
            links%row(i) = n
        end do
        links%rows = n
        if (ubound(links%push, 2) < n) then
            deallocate (links%press, links%push)
            allocate (links%press(5, 0:n + n/4), links%push(6, 0:n + n/4))
        end if
        links%press = 0
        links%push = 0
    end subroutine number_rows

    !> Room for the links, with something to spare.
    subroutine make_room(links, n)
        type(links_t), intent(inout) :: links
        integer(int64), intent(in) :: n

        if (allocated(links%list)) then
            if (size(links%list, kind=int64) >= n) return
            deallocate (links%list, links%mask)
        end if
        allocate (links%list(n + n/4 + 64), links%mask(n + n/4 + 64))
    end subroutine make_room

    !> True where a pair of bodies is bonded and the bond is whole at both particles.
    pure logical function is_bonded(links, i, j)
        type(links_t), intent(in) :: links
        integer, intent(in) :: i, j

        is_bonded = .false.
        if (.not. links%bonds) return
        is_bonded = links%table(links%body(i), links%body(j))%law == law_bonded .and. &
                    links%bond(i) == bond_whole .and. links%bond(j) == bond_whole
    end function is_bonded

    !> Bond the particles that have a partner within reach at the start; others never bond.
    subroutine first_bonds(solid)
        type(solid_t), intent(inout) :: solid
        integer :: i, j
        integer(int64) :: k

        do i = 1, solid%n
            do k = solid%links%first(i), solid%links%first(i + 1) - 1
                j = solid%links%list(k)
                if (solid%links%table(solid%links%body(i), solid%links%body(j))%law == law_bonded) &
                    solid%links%bond(i) = bond_whole
            end do
        end do
    end subroutine first_bonds
end module brz_solid_links
