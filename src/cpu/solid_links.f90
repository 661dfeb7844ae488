! SPDX-License-Identifier: MIT
!> Lists of the particles of other bodies within reach of a particle, images included.
!>
!> Like the neighbour lists they depend on `x_built`, on how the bodies have drifted since, and on
!> the order of the particles alone. Links of a particle stand in the order of the bodies, of the
!> planes of images, and of the numbers of the particles.
module brz_solid_links
    use brz_bond_marks, only: tie_intact
    use brz_cell_grid, only: cell_span, extent, fill_cells, lay_grid, number_of_cell
    use brz_interaction, only: law_bonded, law_none
    use brz_kinds, only: dp, int32, int64
    use brz_link_layout, only: link_unit, mask_unit, n_press
    use brz_link_rows, only: body_of, first_link, last_link, link_partner
    use brz_links, only: links_t
    use brz_list_drift, only: begin_links, links_reach, may_link
    use brz_particle_marks, only: is_gone
    use brz_ranks, only: least_of_all, most_of_all, several
    use brz_solid_mirror, only: signs
    use brz_listed_bodies, only: listed_bodies_t
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: build_links, settle_links, first_bonds

contains

    !> The links are about to be built: note the drifts of the bodies, and how far they are apart.
    subroutine settle_links(solid, anew, resume)
        class(listed_bodies_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! see begin_links
        logical, intent(in) :: resume !! for the drifts of the links that were there
        real(dp) :: ends(6*size(solid%bodies))
        integer :: b

        if (.not. solid%links%present) return
        associate (box => solid%links%box)
            do b = 1, size(solid%bodies)
                call extent(solid%x_built, solid%fixed, solid%bodies(b), box(:, 1, b), box(:, 2, b))
            end do
            if (several(solid%ranks)) then
                do b = 1, size(solid%bodies)
                    if (solid%bodies(b)%last >= solid%bodies(b)%first) cycle
                    box(:, 1, b) = huge(box) ! this process has nothing of it
                    box(:, 2, b) = -huge(box)
                end do
                ends = reshape([box(:, 1, :), -box(:, 2, :)], shape(ends))
                call least_of_all(solid%ranks, ends)
                box(:, 1, :) = reshape(ends(:size(ends)/2), shape(box(:, 1, :)))
                box(:, 2, :) = -reshape(ends(size(ends)/2 + 1:), shape(box(:, 1, :)))
            end if
            call begin_links(solid, anew, box, resume)
        end associate
    end subroutine settle_links

    !> Build the links for the positions `x_built`, to which the drifts of the bodies are added.
    subroutine build_links(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: b, i

        if (.not. solid%links%present) return
        solid%links%row = 0
        call visit_bodies(solid, solid%links%box, .false.)
        call number_rows(solid%links, sum(solid%bodies%rim - solid%bodies%last))
        call visit_bodies(solid, solid%links%box, .true.)
        if (several(solid%ranks)) call join_interactions(solid)
        do b = 1, size(solid%bodies) ! ghosts have rows, without links of their own
            do i = solid%bodies(b)%last + 1, solid%bodies(b)%rim
                solid%links%rows = solid%links%rows + 1
                solid%links%row(i) = solid%links%rows
            end do
        end do
    end subroutine build_links

    !> Bodies have met where they have in any process.
    subroutine join_interactions(solid)
        type(listed_bodies_t), intent(inout) :: solid
        integer(int64) :: met(size(solid%links%met))

        met = reshape(merge(1_int64, 0_int64, solid%links%met), shape(met))
        call most_of_all(solid%ranks, met)
        solid%links%met = reshape(met == 1, shape(solid%links%met))
    end subroutine join_interactions

    !> Count in `row`, or store, the links of every particle with one body after the other; note
    !> which bodies have some.
    subroutine visit_bodies(solid, box, keep)
        type(listed_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: box(:, :, :) !! (3, 2, bodies) corners of x_built [m]
        logical, intent(in) :: keep
        real(dp) :: shift(3), reach
        integer :: a, b, i, m, more
        logical :: met

        solid%links%met = .false.
        do b = 1, size(solid%bodies)
            if (.not. any([(may_link(solid, a, b), a=1, size(solid%bodies))])) cycle
            reach = 2*real(maxval(solid%links%table(:, b)%h), dp) + solid%skin
            call lay_grid(solid%search, solid%x_built, solid%fixed, solid%bodies(b), reach)
            call fill_cells(solid%search, solid%x_built, solid%fixed, solid%bodies(b))
            do a = 1, size(solid%bodies)
                if (.not. may_link(solid, a, b)) cycle
                reach = links_reach(solid, a, b)
                shift = solid%links%drift(:, a, b)
                met = .false.
                !$omp parallel do if(solid%n >= worth_threads) schedule(static) &
                !$omp private(m, more) reduction(.or.: met)
                do i = solid%bodies(a)%first, solid%bodies(a)%last
                    associate (row => solid%links%row(i))
                        if (solid%fixed(i) == is_gone .or. keep .and. row == 0) cycle
                        more = 0
                        do m = 0, 7
                            if (near(solid, i, m, box(:, 1, b) - shift - reach, &
                                     box(:, 2, b) - shift + reach)) &
                                call search(solid, i, m, shift, reach, keep, more)
                        end do
                        met = met .or. more > 0
                        if (keep) solid%links%count(row) = solid%links%count(row) + more
                        if (.not. keep) row = row + more
                    end associate
                end do
                solid%links%met(a, b) = met
            end do
        end do
    end subroutine visit_bodies

    !> True where the planes of the mask m exist and the image of i lies in the box.
    pure logical function near(solid, i, m, lo, hi)
        type(listed_bodies_t), intent(in) :: solid
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

    !> Count or store the particles of the body in the grid near the image of i, which has drifted.
    pure subroutine search(solid, i, m, shift, reach, keep, more)
        type(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: i, m
        real(dp), intent(in) :: shift(3), reach !! relative to the body in the grid [m]
        logical, intent(in) :: keep
        integer, intent(inout) :: more !! links with this body
        integer(int64) :: last
        real(dp) :: x(3), d(3)
        integer :: c, c1, c2, c3, j, k, before, lo(3), hi(3)

        x = signs(m)*solid%x_built(:, i) + shift
        before = more
        if (keep) last = last_link(solid%links, i)
        call cell_span(solid%search, x, reach, lo, hi)
        do c3 = lo(3), hi(3)
            do c2 = lo(2), hi(2)
                do c1 = lo(1), hi(1)
                    c = number_of_cell(solid%search, c1, c2, c3)
                    do k = solid%search%start(c), solid%search%start(c + 1) - 1
                        j = solid%search%order(k)
                        d = solid%x_built(:, j) - x
                        if (d(1)*d(1) + d(2)*d(2) + d(3)*d(3) >= reach*reach) cycle
                        more = more + 1
                        if (keep) solid%links%list(last + more) = j + m*mask_unit
                    end do
                end do
            end do
        end do
        if (keep) call order_links(solid%id, m*mask_unit, solid%links%list(last + before + 1: &
                                                                           last + more))
    end subroutine search

    !> Bring links with particles of one body into the order of their numbers.
    pure subroutine order_links(id, mask, list)
        integer(int32), intent(in) :: id(:)
        integer, intent(in) :: mask !! what entries have besides the place of a particle
        integer(int32), intent(inout) :: list(:)
        integer(int32) :: entry
        integer :: k, l

        do k = 2, size(list)
            entry = list(k)
            do l = k - 1, 1, -1
                if (id(list(l) - mask) < id(entry - mask)) exit
                list(l + 1) = list(l)
            end do
            list(l + 1) = entry
        end do
    end subroutine order_links

    !> Turn numbers of links into numbers of rows, of particles that have some. Row 0 is for all
    !> others: it has no links and stays nil.
    subroutine number_rows(links, ghosts)
        type(links_t), intent(inout) :: links
        integer, intent(in) :: ghosts !! that will have rows, too
        integer :: i, number, total

        links%rows = count(links%row > 0)
        call make_room(links, links%rows + ghosts, &
                       sum(int((links%row + link_unit - 1)/link_unit, int64)))
        links%rows = 0
        links%slice = 0
        links%count = 0
        total = 0
        do i = 1, size(links%row)
            number = links%row(i)
            if (number == 0) cycle
            links%rows = links%rows + 1
            links%row(i) = links%rows
            links%slice(links%rows) = total
            total = total + (number + link_unit - 1)/link_unit
        end do
        links%press = 0
        links%push = 0
    end subroutine number_rows

    !> Room for so many rows and entries, with something to spare.
    subroutine make_room(links, rows, units)
        type(links_t), intent(inout) :: links
        integer, intent(in) :: rows
        integer(int64), intent(in) :: units !! of link_unit entries
        integer :: most

        if (ubound(links%push, 2) < rows) then
            most = rows + rows/4
            deallocate (links%slice, links%count, links%press, links%push)
            allocate (links%slice(0:most), links%count(0:most), links%press(n_press, 0:most), &
                      links%push(9, 0:most))
        end if
        if (allocated(links%list)) then
            if (size(links%list, kind=int64) >= units*link_unit) return
            deallocate (links%list)
        end if
        allocate (links%list((units + units/4 + 8)*link_unit))
    end subroutine make_room

    !> Bond the particles that have a partner within reach at the start; others never bond.
    subroutine first_bonds(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: a, b, i
        integer(int64) :: k

        do i = 1, solid%n
            a = body_of(solid%links, i)
            do k = first_link(solid%links, i), last_link(solid%links, i)
                b = body_of(solid%links, link_partner(solid%links, k))
                if (solid%links%table(a, b)%law == law_bonded) &
                    solid%links%bond(i) = tie_intact
            end do
        end do
    end subroutine first_bonds
end module brz_solid_links
