! SPDX-License-Identifier: MIT
!> The particles of a body in the order of the cells of their search, and what their lists are
!> measured by.
module brz_solid_sort
    use brz_cell_grid, only: box_span, cell_of_groups, extent, fill_cells, lay_grid, &
        number_of_cell, reach_of_lists
    use brz_drift_loops, only: each_renew_place
    use brz_force_loops, only: each_sum_momentum
    use brz_formulation_names, only: form_total
    use brz_kinds, only: dp, int64, rk
    use brz_list_drift, only: level_unit
    use brz_particle_groups, only: lanes
    use brz_particle_order, only: reorder_particles
    use brz_solid_arrays, only: group_of
    use brz_solid_mirror, only: signs
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: choose_lists, mean_velocity, note_positions, renew_places, sort_body

contains

    !> Bring the particles of a body into the order of the cells at the places `x_built`. It has no
    !> ghosts.
    subroutine sort_body(solid, b)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b

        associate (body => solid%bodies(b))
            call lay_grid(solid%search, solid%x_built, solid%fixed, body, cell_of_groups(solid, b))
            call fill_cells(solid%search, solid%x_built, solid%fixed, body)
            call reorder_particles(solid, body%first, body%last)
        end associate
    end subroutine sort_body

    !> Give new places to the particles of body b that have moved far, mark the cells of the old and
    !> the new ones, and count them.
    subroutine renew_places(solid, b, moved)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer(int64), intent(out) :: moved(3)
        !! particles of this process; 0, as who has changed regions goes to its owner
        integer :: found

        found = 0
        associate (body => solid%bodies(b), s => solid%search)
            call lay_grid(s, solid%x_built, solid%fixed, body, cell_of_groups(solid, b))
            if (allocated(s%marked)) then
                if (size(s%marked) < size(s%start)) deallocate (s%marked)
            end if
            if (.not. allocated(s%marked)) allocate (s%marked(0:ubound(s%start, 1)))
            s%marked = 0
            call each_renew_place(body%last - body%first + 1, body%first, 3, level_unit(solid), &
                body%drift(1), body%drift(2), body%drift(3), size(s%code, 1), s%cells(1), &
                s%cells(2), s%cells(3), s%lo(1), s%lo(2), s%lo(3), s%size, s%code, solid%fixed, &
                solid%x, solid%x_built, s%marked, found)
        end associate
        moved = [found, 0, 0]
    end subroutine renew_places

    !> Choose the groups of body b that are within reach of a marked cell.
    subroutine choose_lists(solid, b)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp) :: hi(3), lo(3), reach
        integer :: i

        if (allocated(solid%search%chosen)) then
            if (size(solid%search%chosen) < size(solid%first)) deallocate (solid%search%chosen)
        end if
        if (.not. allocated(solid%search%chosen)) &
            allocate (solid%search%chosen(size(solid%first)), source=.false.)
        reach = reach_of_lists(solid, b)
        associate (body => solid%bodies(b))
            call extent(solid%x_built, solid%fixed, body, lo, hi) ! new places may be lower
            solid%search%deep = max(-lo, 0.0_dp)
            !$omp parallel do if(solid%n >= worth_threads) schedule(static)
            do i = body%first, body%last, lanes
                solid%search%chosen(group_of(body, i)) = is_near(solid, reach, &
                    solid%x_built(:, i:min(i + lanes - 1, body%last)))
            end do
        end associate
    end subroutine choose_lists

    !> True where the cells within reach of a box around some places, or around its images, are
    !> marked.
    pure logical function is_near(solid, reach, x) result(near)
        class(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: reach, x(:, :) !! [m]
        real(dp) :: half(3), middle(3)
        integer :: c1, c2, c3, hi(3), lo(3), m

        half = (maxval(x, 2) - minval(x, 2))/2
        middle = minval(x, 2) + half
        near = .false.
        do m = 0, 7
            if (any(signs(m) < 0 .and. .not. (solid%mirror .and. &
                middle - half < reach + solid%search%deep))) cycle
            call box_span(solid%search, signs(m)*middle, half + reach, lo, hi)
            do c3 = lo(3), hi(3)
                do c2 = lo(2), hi(2)
                    do c1 = lo(1), hi(1)
                        near = solid%search%marked(number_of_cell(solid%search, c1, c2, c3)) > 0
                        if (near) return
                    end do
                end do
            end do
        end do
    end function is_near

    !> Velocity of the mass of a body at the step [m/s]: an exact sum, as lists last by it.
    subroutine mean_velocity(solid, b, v)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(out) :: v(3)
        real(dp) :: sums(4)

        associate (body => solid%bodies(b))
            call each_sum_momentum(body%last - body%first + 1, solid%ranks, body%first, 3, 1, 3, &
                                   real(solid%dt_last/2, rk), solid%mass, solid%fixed, solid%v, &
                                   solid%a, sums)
        end associate
        v = sums(2:)/max(sums(1), tiny(sums))
    end subroutine mean_velocity

    !> Positions that decide on the neighbours of a body: a total-Lagrangian body that meets no
    !> other keeps the unloaded ones, and with them its order and its list.
    subroutine note_positions(solid, b)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b

        associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
            if (solid%bodies(b)%formulation == form_total .and. .not. solid%links%present) then
                solid%x_built(:, first:last) = solid%x_ref(:, first:last)
            else
                solid%x_built(:, first:last) = solid%x(:, first:last)
            end if
        end associate
    end subroutine note_positions
end module brz_solid_sort
