! SPDX-License-Identifier: MIT
!> Which ghosts a process needs: all whose place is within reach of its region by a list, a link
!> or a facet.
module brz_ghost_wants
    use brz_cell_grid, only: reach_of_lists
    use brz_home_items, only: near_region
    use brz_kinds, only: dp
    use brz_list_drift, only: links_reach, may_link
    use brz_ranks, only: least_of_all
    use brz_solid_state, only: form_rigid, is_gone, solid_t
    implicit none
    private
    public :: find_lowest, inhabited, is_needed, most_outside, planes_of, wants_of

    real(dp), parameter :: beside = 1.5_dp !! spacings within which neighbours on a lattice are

contains

    !> True where a process needs a ghost of a particle, in one of the ways that its body has.
    pure logical function is_needed(solid, region, want, i) result(yes)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: region(3, 2) !! corners, see inhabited [m]
        real(dp), intent(in) :: want(:, :) !! of its body, see wants_of
        integer, intent(in) :: i
        integer :: k

        yes = .false.
        if (solid%fixed(i) == is_gone) return
        do k = 1, size(want, 2)
            yes = yes .or. near_region(planes_of(solid), region, want(4, k), &
                                       solid%x_built(:, i) + want(1:3, k))
        end do
    end function is_needed

    !> Where in its region a process may have particles. Without it images, which lie below planes
    !> of symmetry, would all be in the regions that end there.
    pure function inhabited(solid, region) result(corners)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: region(3, 2) !! corners [m]
        real(dp) :: corners(3, 2)

        corners(:, 1) = max(region(:, 1), solid%part%lowest)
        corners(:, 2) = region(:, 2)
    end function inhabited

    !> The lowest places `x_built` of particles of all processes, where planes of symmetry are; all
    !> must call.
    subroutine find_lowest(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b

        solid%part%lowest = -huge(1.0_dp)
        if (.not. any(solid%mirror)) return
        where (solid%mirror) solid%part%lowest = huge(1.0_dp)
        do b = 1, size(solid%bodies)
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                where (solid%mirror) solid%part%lowest = &
                    min(solid%part%lowest, minval(solid%x_built(:, first:last), 2))
            end associate
        end do
        call least_of_all(solid%ranks, solid%part%lowest)
    end subroutine find_lowest

    !> What particles of bodies that are listed in part may be outside the region of their process
    !> [m].
    pure real(dp) function most_outside(solid) result(most)
        type(solid_t), intent(in) :: solid
        integer :: b

        most = maxval([(reach_of_lists(solid, b), b=1, size(solid%bodies))])
    end function most_outside

    !> Planes of symmetry as bits 0..2.
    pure integer function planes_of(solid)
        type(solid_t), intent(in) :: solid

        planes_of = sum(merge([1, 2, 4], 0, solid%mirror))
    end function planes_of

    !> How ghosts of body b are needed: by lists, facets, links with other bodies. Of each: what is
    !> added to the place, how far from a region it may then be [m].
    pure function wants_of(solid, b) result(want)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), allocatable :: want(:, :) !! (4, ways)
        real(dp) :: all(4, size(solid%bodies) + 1)
        integer :: a, n

        n = 0
        associate (body => solid%bodies(b))
            if (body%formulation /= form_rigid) then
                n = 1
                all(:, n) = [0.0_dp, 0.0_dp, 0.0_dp, reach_of_lists(solid, b)]
            else if (allocated(solid%loads%of)) then ! facets of what has no lists
                n = 1
                all(:, n) = [0.0_dp, 0.0_dp, 0.0_dp, beside*body%spacing]
            end if
            do a = 1, merge(size(solid%bodies), 0, solid%links%present)
                if (.not. may_link(solid, a, b)) cycle
                n = n + 1
                all(:, n) = [solid%links%drift(:, b, a), links_reach(solid, a, b)]
            end do
        end associate
        want = all(:, :n)
        want(4, :) = want(4, :) + solid%part%margin
    end function wants_of
end module brz_ghost_wants
