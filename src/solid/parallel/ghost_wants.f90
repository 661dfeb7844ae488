! SPDX-License-Identifier: MIT
!> Which ghosts a process needs: all whose place is within reach of its region by a list, a link
!> or a loaded segment.
!>
!> Particles of total-Lagrangian bodies are at home where they were before any load, since their
!> neighbours of then are theirs for good. So links with them are not looked for in regions, but in
!> the boxes that those of each process fill now.
module brz_ghost_wants
    use brz_cell_grid, only: reach_of_lists
    use brz_formulation_names, only: form_rigid, form_total
    use brz_owner_loop_bodies, only: near_region
    use brz_kinds, only: dp, int64
    use brz_list_drift, only: links_reach, may_link
    use brz_message_exchange, only: tell_all
    use brz_particle_marks, only: is_gone
    use brz_ranks, only: least_of_all, ranks_t
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_solid_part, only: solid_part_t
    use brz_want_rows, only: n_want, want_corners, want_reach
    implicit none
    private
    public :: find_boxes, find_lowest, has_boxes, owners_of, inhabited, is_needed, most_outside, &
        of_lists, planes_of, tell_boxes, wants_of

    real(dp), parameter :: beside = 1.5_dp !! spacings within which neighbours on a lattice are

contains

    !> Places that decide to which process the particles of body b belong.
    function owners_of(solid, b) result(x)
        class(bodies_t), intent(in), target :: solid
        integer, intent(in) :: b
        real(dp), pointer, contiguous :: x(:, :) !! (3, n) [m]

        x => solid%x_built
        if (solid%bodies(b)%formulation == form_total) x => solid%x_ref
    end function owners_of

    !> True where a process needs a ghost of particle i of body b, in one of the ways that it has.
    logical function is_needed(solid, want, b, i) result(yes)
        class(bodies_t), intent(in) :: solid
        real(dp), intent(in) :: want(:, :) !! (n_want, ways) of the body and the process
        integer, intent(in) :: b, i
        real(dp) :: x(3)
        integer :: k

        yes = .false.
        if (solid%fixed(i) == is_gone) return
        do k = 1, size(want, 2)
            x = solid%x_built(:, i)
            if (k <= of_lists(solid, b) .and. solid%bodies(b)%formulation == form_total) &
                x = solid%x_ref(:, i)
            yes = yes .or. near_region(planes_of(solid), want(want_corners:, k), &
                                       want(want_reach, k), x + want(1:3, k))
        end do
    end function is_needed

    !> True where links are looked for in boxes.
    pure logical function has_boxes(solid)
        class(listed_bodies_t), intent(in) :: solid

        has_boxes = solid%links%present .and. any(solid%bodies%formulation == form_total)
    end function has_boxes

    !> Boxes that the particles of each body fill in each process, where links want them; all must
    !> call.
    subroutine find_boxes(solid, part)
        class(listed_bodies_t), intent(in) :: solid
        type(solid_part_t), intent(inout) :: part
        real(dp) :: box(3, 2, size(solid%bodies))
        integer :: b

        if (.not. has_boxes(solid)) return
        do b = 1, size(solid%bodies)
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                box(:, 1, b) = minval(solid%x_built(:, first:last), 2)
                box(:, 2, b) = maxval(solid%x_built(:, first:last), 2)
            end associate
        end do
        call tell_boxes(solid%ranks, box, part%boxes)
    end subroutine find_boxes

    !> Tell all processes the boxes of this one.
    subroutine tell_boxes(ranks, box, boxes)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: box(:, :, :) !! (3, 2, bodies) [m]
        real(dp), intent(inout), allocatable :: boxes(:, :, :, :) !! (3, 2, bodies, 0:processes-1)
        integer(int64) :: out(size(box), ranks%n), all(size(box), ranks%n, ranks%n)
        integer :: r

        if (.not. allocated(boxes)) allocate (boxes(3, 2, size(box, 3), 0:ranks%n - 1))
        out = spread(transfer(box, out(:, 1)), 2, ranks%n)
        call tell_all(ranks, out, all)
        do r = 0, ranks%n - 1
            boxes(:, :, :, r) = reshape(transfer(all(:, 1, r + 1), box), shape(box))
        end do
    end subroutine tell_boxes

    !> Where in its region a process may have particles. Without it images, which lie below planes
    !> of symmetry, would all be in the regions that end there.
    pure function inhabited(part, region) result(corners)
        type(solid_part_t), intent(in) :: part
        real(dp), intent(in) :: region(3, 2) !! corners [m]
        real(dp) :: corners(3, 2)

        corners(:, 1) = max(region(:, 1), part%lowest)
        corners(:, 2) = region(:, 2)
    end function inhabited

    !> The lowest homes of particles of all processes, where planes of symmetry are; all must call.
    subroutine find_lowest(solid, part)
        class(bodies_t), intent(in) :: solid
        type(solid_part_t), intent(inout) :: part
        real(dp), pointer, contiguous :: x(:, :)
        integer :: b

        part%lowest = -huge(1.0_dp)
        if (.not. any(solid%mirror)) return
        where (solid%mirror) part%lowest = huge(1.0_dp)
        do b = 1, size(solid%bodies)
            x => owners_of(solid, b)
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                where (solid%mirror) part%lowest = min(part%lowest, minval(x(:, first:last), 2))
            end associate
        end do
        call least_of_all(solid%ranks, part%lowest)
    end subroutine find_lowest

    !> What particles of bodies that are listed in part may be outside the region of their process
    !> [m].
    pure real(dp) function most_outside(solid) result(most)
        class(listed_bodies_t), intent(in) :: solid
        integer :: b

        most = maxval([(reach_of_lists(solid, b), b=1, size(solid%bodies))])
    end function most_outside

    !> Planes of symmetry as bits 0..2.
    pure integer function planes_of(solid)
        class(particles_t), intent(in) :: solid

        planes_of = sum(merge([1, 2, 4], 0, solid%mirror))
    end function planes_of

    !> How many ways to need ghosts of body b are those of lists and loaded segments, by the homes
    !> of the particles; the others are links, by their places.
    pure integer function of_lists(solid, b) result(n)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b

        n = 1
        if (solid%bodies(b)%formulation == form_rigid .and. .not. allocated(solid%loads%of)) n = 0
    end function of_lists

    !> How ghosts of body b are needed: by lists or loaded segments, then by links with other
    !> bodies. Of each way and process: what is added to the place, how far it may then be from
    !> which box [m].
    pure function wants_of(solid, part, b, region) result(want)
        class(listed_bodies_t), intent(in) :: solid
        type(solid_part_t), intent(in) :: part
        integer, intent(in) :: b
        real(dp), intent(in) :: region(:, :, 0:) !! (3, 2, processes) corners [m]
        real(dp), allocatable :: want(:, :, :) !! (n_want, ways, processes)
        real(dp) :: all(n_want, size(solid%bodies) + 1, 0:ubound(region, 3))
        integer :: a, n, r

        n = of_lists(solid, b)
        all = 0
        associate (body => solid%bodies(b))
            all(want_reach, 1, :) = reach_of_lists(solid, b)
            if (body%formulation == form_rigid) & ! loaded segments of what has no lists
                all(want_reach, 1, :) = beside*body%spacing
        end associate
        do r = 0, ubound(region, 3)
            all(want_corners:, :, r) = spread(reshape(inhabited(part, region(:, :, r)), [6]), 2, &
                                              size(all, 2))
        end do
        do a = 1, merge(size(solid%bodies), 0, solid%links%present)
            if (.not. may_link(solid, a, b)) cycle
            n = n + 1
            all(:3, n, :) = spread(solid%links%drift(:, b, a), 2, size(all, 3))
            all(want_reach, n, :) = links_reach(solid, a, b)
            if (solid%bodies(a)%formulation == form_total) &
                all(want_corners:, n, :) = reshape(part%boxes(:, :, a, :), [6, size(all, 3)])
        end do
        want = all(:, :n, :)
        want(want_reach, :, :) = want(want_reach, :, :) + part%margin
    end function wants_of
end module brz_ghost_wants
