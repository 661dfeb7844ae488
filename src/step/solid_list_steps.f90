! SPDX-License-Identifier: MIT
!> Neighbour lists and links built anew: the list of operations. scripts/steps.py writes the same
!> for the GPU.
module brz_solid_list_steps
    use brz_cohesive_steps, only: place_nodes
    !@gpu use brz_gpu_solid_ghosts, only: refresh_kept
    !@gpu use brz_gpu_solid_links, only: build_links, settle_links
    !@gpu use brz_gpu_solid_gradients, only: renew_sleepers
    !@gpu use brz_gpu_solid_books, only: note_boxes
    !@gpu use brz_gpu_solid_search, only: build_list, choose_lists, mean_velocity
    !@gpu use brz_gpu_solid_search, only: note_positions, renew_places, sort_body
    use brz_home_steps, only: go_home, lay_ghosts
    use brz_kinds, only: dp, int64
    use brz_list_drift, only: begin_list, decide_part, may_renew
    use brz_ranks, only: several, sum_of_all
    use brz_solid_links, only: build_links, settle_links !@cpu
    use brz_solid_search, only: build_list !@cpu
    use brz_solid_sort, only: choose_lists, mean_velocity, note_positions !@cpu
    use brz_solid_sort, only: renew_places, sort_body !@cpu
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: build_neighbours

contains

    !> Build the lists and the links. With `sort`, the particles of all bodies, or of the `stale`
    !> ones, are first brought into the order of the cells at their present positions, and go to the
    !> processes in whose regions these are; other lists stay. Without, the lists of the positions
    !> `x_built` are restored.
    subroutine build_neighbours(solid, sort, stale)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: sort
        logical, intent(in), optional :: stale(:) !! (bodies)
        logical :: anew(size(solid%bodies)), whole(size(solid%bodies)), sorted
        integer :: b, news(size(solid%bodies))

        anew = .true.
        if (present(stale)) anew = stale
        solid%part%far = 0
        !@gpu if (sort .and. solid%part%keeps) call refresh_kept(gpu)
        do b = 1, size(anew)
            if (sort .and. anew(b)) call note_places(solid, b)
        end do
        solid%part%recut = .false.
        sorted = sort
        sorted = sort .or. several(solid%ranks) !@cpu
        anew = anew .or. several(solid%ranks) !@cpu particles have moved
        solid%part%keeps = solid%part%keeps .and. sorted
        whole = .not. solid%bodies%cells%in_part
        if (several(solid%ranks)) whole = anew .and. whole .or. .not. solid%part%keeps
        if (sorted .and. several(solid%ranks)) call go_home(solid, anew, whole)
        do b = 1, size(anew)
            if (sorted .and. anew(b) .and. whole(b)) call sort_body(solid, b)
        end do
        !@gpu call note_boxes(gpu, solid, anew)
        call settle_links(solid, .not. sort)
        news = 0
        if (sorted .and. several(solid%ranks)) call lay_ghosts(solid, anew, whole, news)
        where (whole) solid%bodies%cells%in_part = .false.
        do b = 1, size(anew)
            !@gpu if (anew(b) .and. .not. whole(b)) call choose_lists(gpu, solid, b, news(b))
            if (anew(b)) call build_list(solid, b)
            solid%bodies(b)%cells%in_part = .false.
        end do
        call build_links(solid)
        call place_nodes(solid)
        !@gpu call renew_sleepers(gpu, solid)
    end subroutine build_neighbours

    !> The list of body b is about to be built for the places of now: of all its particles, or only
    !> near those that have moved far, if these are few.
    subroutine note_places(solid, b)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer(int64) :: moved(3)
        real(dp) :: v(3)
        logical :: in_part

        if (may_renew(solid, b)) then
            call renew_places(solid, b, moved)
            call sum_of_all(solid%ranks, moved)
            call decide_part(solid, b, moved(1), in_part) !@host
            if (solid%bodies(b)%cells%in_part) call choose_lists(solid, b) !@cpu
            if (in_part) then
                where (moved(2:) > 0) solid%part%far = 1
                return
            end if
        end if
        call note_positions(solid, b)
        call mean_velocity(solid, b, v)
        call begin_list(solid, b, v) !@host
    end subroutine note_places
end module brz_solid_list_steps
