! SPDX-License-Identifier: MIT
!> Neighbour lists and links built anew: the list of operations.
module brz_solid_list_driver
    use brz_cohesive_driver, only: place_nodes
    use brz_errors, only: error_t
    use brz_owner_driver, only: go_to_owners, lay_ghosts
    use brz_kinds, only: dp, int64
    use brz_list_drift, only: begin_list, decide_part, may_renew
    use brz_ranks, only: several, sum_of_all
    use brz_solid_backend, only: build_links, build_list, choose_lists, mean_velocities, &
        note_boxes, note_positions, refresh_kept, renew_places, renew_sleepers, settle_links, &
        sort_bodies
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: build_neighbours

contains

    !> Build the lists and the links. With `sort`, the particles of all bodies, or of the `stale`
    !> ones, are first brought into the order of the cells at their present positions, and go to the
    !> processes in whose regions these are; other lists stay. Without, the lists of the positions
    !> `x_built` are restored.
    subroutine build_neighbours(solid, sort, err, stale)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: sort
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: stale(:) !! (bodies)
        logical, dimension(size(solid%bodies)) :: anew, begins, whole
        logical :: sorted
        integer :: b, news(size(solid%bodies))

        anew = .true.
        if (present(stale)) anew = stale
        solid%part%far = 0
        if (solid%on_gpu .and. sort .and. solid%part%keeps) call refresh_kept(solid%device, err)
        begins = .false.
        do b = 1, size(anew)
            if (sort .and. anew(b)) call note_places(solid, b, begins(b), err)
        end do
        call begin_lists(solid, begins, err)
        solid%part%recut = .false.
        ! on the CPU particles change places whenever lists are built
        sorted = sort .or. several(solid%ranks) .and. .not. solid%on_gpu
        anew = anew .or. several(solid%ranks) .and. .not. solid%on_gpu
        solid%part%keeps = solid%part%keeps .and. sorted
        whole = .not. solid%bodies%cells%in_part
        if (several(solid%ranks)) whole = anew .and. whole .or. .not. solid%part%keeps
        if (sorted .and. several(solid%ranks)) call go_to_owners(solid, anew, whole, err)
        if (solid%on_gpu) call note_boxes(solid%device, solid, anew, err)
        if (sorted) call sort_bodies(solid, anew .and. whole, err)
        call settle_links(solid, anew, .not. sort, err)
        news = 0
        if (sorted .and. several(solid%ranks)) call lay_ghosts(solid, anew, whole, news, err)
        where (whole) solid%bodies%cells%in_part = .false.
        do b = 1, size(anew)
            if (solid%on_gpu .and. anew(b) .and. .not. whole(b)) &
                call choose_lists(solid, b, news(b), err)
            if (anew(b)) call build_list(solid, b, err)
            solid%bodies(b)%cells%in_part = .false.
        end do
        call build_links(solid, err)
        call place_nodes(solid, err)
        if (solid%on_gpu .and. solid%part%recut) call renew_sleepers(solid%device, solid, err)
    end subroutine build_neighbours

    !> The list of body b is about to be built for the places of now: of all its particles, or only
    !> near those that have moved far, if these are few.
    subroutine note_places(solid, b, begins, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        logical, intent(out) :: begins !! of all its particles
        type(error_t), intent(inout) :: err
        integer(int64) :: moved(3)
        logical :: in_part

        begins = .false.
        if (may_renew(solid, b)) then
            call renew_places(solid, b, moved, err)
            call sum_of_all(solid%ranks, moved)
            call decide_part(solid%bodies(b), solid%part%keeps .or. .not. several(solid%ranks), &
                             moved(1), in_part)
            if (solid%bodies(b)%cells%in_part .and. .not. solid%on_gpu) &
                call choose_lists(solid, b, 0, err)
            if (in_part) then
                where (moved(2:) > 0) solid%part%far = 1
                return
            end if
        end if
        begins = .true.
        call note_positions(solid, b, err)
    end subroutine note_places

    !> Some bodies are about to get lists for the places of today: they drift on as they move now.
    subroutine begin_lists(solid, which, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        type(error_t), intent(inout) :: err
        real(dp) :: v(3, size(which))
        integer :: b

        if (.not. any(which)) return
        call mean_velocities(solid, which, v, err)
        do b = 1, size(which)
            if (which(b)) call begin_list(solid, b, v(:, b))
        end do
    end subroutine begin_lists
end module brz_solid_list_driver
