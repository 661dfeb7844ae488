! SPDX-License-Identifier: MIT
!> Contact and bonds between bodies on the GPU: memory, lists of links.
module brz_gpu_solid_links
    use brz_buffers, only: from
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, copy_out, copy_within, &
        put_buffer, reserve_buffer, side_by_side
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_layout, only: slice_width
    use brz_gpu_solid_lists, only: lay_lists, move_lists, pick_chosen
    use brz_gpu_solid_state, only: attach_links, bytes_of_real, threads_of
    use brz_solid_device, only: solid_device_t, news_all, news_none, news_part
    use brz_interaction, only: law_bonded
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: fix_layout, link_layout_t
    use brz_list_drift, only: begin_links, links_reach, may_link
    use brz_ranks, only: most_of_all, several
    use brz_solid_launches, only: solid_kernels
    use brz_listed_bodies, only: listed_bodies_t
    use brz_tie_launches, only: tie_kernels
    implicit none
    private
    public :: open_gpu_links, settle_links, build_links

    integer, parameter :: spare_entries = 8 !! of a slice that has moved

contains

    !> Reserve memory and copy what the laws between the bodies are.
    subroutine open_gpu_links(solid, gpu, err)
        class(listed_bodies_t), intent(in) :: solid
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        if (.not. gpu%linked) return
        associate (links => gpu%links)
            call put_buffer(solid%links%ends, links%ends, 4_int64*size(solid%bodies), err)
            bytes = size(solid%links%table)*(storage_size(solid%links%table)/8_int64)
            call put_buffer(solid%links%table, links%table, bytes, err)
            bytes = size(solid%links%cell)*bytes_of_real
            call put_buffer(solid%links%cell, links%cell, bytes, err)
            call fix_layout(link_layout_t(size(solid%bodies), solid%dimension, &
                merge(1, 0, gpu%column%control_due > 0), 0, gpu%stride_d, 0, 0, 0, 0, 0, 0, &
                real(solid%depth, rk)), links%lay)
            call allocate_buffer(links%found, 4_int64, err)
            call allocate_buffer(links%met, 4_int64*size(solid%bodies)**2, err)
            call allocate_buffer(links%box, 48_int64*size(solid%bodies), err)
            allocate (links%active(2, size(solid%bodies)), source=0)
            associate (t => solid%links%table)
                links%breaks = any(t%law == law_bonded .and. &
                                   min(t%tensile, t%shear) < huge(t%shear))
                links%frees = links%breaks .or. any(t%bit /= 0) .or. several(solid%ranks)
            end associate
        end associate
    end subroutine open_gpu_links

    !> Build the links for the positions `built`, to which the drifts of the bodies are added; in
    !> part where only few may be others, unless these no longer have room.
    subroutine build_links(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: met(size(solid%bodies), size(solid%bodies))
        integer(int64) :: all(size(met))
        logical :: fits

        if (.not. gpu%linked) return
        call copy_in(corners(gpu), gpu%links%box, 48_int64*size(gpu%bodies), err)
        gpu%links%last = gpu%n
        gpu%links%slices = (gpu%n - 1)/slice_width + 1
        gpu%links%spare = spare_entries
        fits = .false.
        if (any(gpu%bodies%news /= news_all)) call link_part(gpu, solid, fits, err)
        if (.not. fits) call link_all(gpu, solid, err)
        gpu%bodies%news = news_none
        gpu%links%listed = .false.
        call attach_links(gpu, solid%links)
        associate (l => gpu%links)
            if (.not. l%frees) call tie_kernels%count_failed_ties(gpu%n, l%lay, l%ends, l%table, &
                l%bond, l%joined, l%row, l%slice, l%count, l%list, l%loose, err)
        end associate
        met = 0
        call copy_out(gpu%links%met, met, 4_int64*size(met), err)
        all = reshape(met, [size(met)])
        call most_of_all(solid%ranks, all)
        solid%links%met = reshape(all == 1, shape(met))
    end subroutine build_links

    !> All links anew, with room behind them, as they may be built in part.
    subroutine link_all(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        logical :: all(size(gpu%bodies))

        all = .true.
        call clear_buffer(gpu%links%met, err)
        call clear_buffer(gpu%links%count, err)
        call visit_bodies(gpu, solid, all, 0, .false., err)
        call lay_lists(gpu%links, gpu%common, gpu%links%count, 0, 4, gpu%links%slices, err)
        call clear_buffer(gpu%links%count, err)
        call visit_bodies(gpu, solid, all, 1, .false., err)
    end subroutine link_all

    !> Links near new places, and of stale pairs of bodies. Lists that no longer have room go behind
    !> all others.
    subroutine link_part(gpu, solid, fits, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        logical, intent(out) :: fits !! else there is no room behind them, and no list is right
        type(error_t), intent(inout) :: err
        integer :: b, filled
        logical :: changed(size(gpu%bodies))

        call clear_buffer(gpu%chosen, err)
        changed = .false.
        do b = 1, size(gpu%bodies)
            call side_by_side(b)
            call choose_by(gpu, solid, b, changed, err)
        end do
        call side_by_side(0)
        associate (links => gpu%links)
            call tie_kernels%drop_links(gpu%n, gpu%chosen, links%count, err)
            call visit_bodies(gpu, solid, changed, 2, .true., err)
            call clear_buffer(gpu%chosen, err)
            filled = links%filled
            call move_lists(links, links%count, gpu%chosen, fits, err)
            if (.not. fits .or. links%filled == filled) return
            call tie_kernels%drop_links(gpu%n, gpu%chosen, links%count, err)
            call visit_bodies(gpu, solid, share_slice(gpu, changed), 1, .true., err)
        end associate
    end subroutine link_part

    !> Bodies some of whose particles have their links in a slice with those of the given bodies.
    pure function share_slice(gpu, of) result(shares)
        type(solid_device_t), intent(in) :: gpu
        logical, intent(in) :: of(:) !! (bodies)
        logical :: shares(size(of))
        integer, dimension(size(of)) :: first, last
        integer :: b

        first = (gpu%bodies%first - 1)/slice_width
        last = (gpu%bodies%last - 1)/slice_width
        do b = 1, size(of)
            shares(b) = any(of .and. first <= last(b) .and. last >= first(b))
        end do
    end function share_slice

    !> Choose the particles whose links with body b, or of which those in it, may be others.
    subroutine choose_by(gpu, solid, b, changed, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        logical, intent(inout) :: changed(:) !! (bodies) true from now on where some are
        type(error_t), intent(inout) :: err
        integer :: a, everyone
        real(dp) :: reach

        do a = 1, size(gpu%bodies)
            associate (body => gpu%bodies(b), other => gpu%bodies(a), &
                       shift => solid%links%drift(:, a, b))
                if (.not. (body%news /= news_none .or. a /= b .and. solid%links%stale(a, b))) cycle
                everyone = 1
                if (body%news == news_part .and. .not. solid%links%stale(a, b)) everyone = 0
                reach = -1 ! itself
                if (a /= b) then
                    if (.not. may_link(solid, a, b)) cycle
                    reach = links_reach(solid, a, b)
                end if
                changed(a) = .true.
                call solid_kernels%choose_links([body%rim - body%first + 1, 1, 1], everyone, &
                    body%rim, reach, &
                    shift(1), shift(2), shift(3), body%grid, body%code, body%marked, other%grid, &
                    from(gpu%links%box, 6*a - 5_int64), other%code, other%start, gpu%order, &
                    gpu%built, gpu%chosen, err)
            end associate
        end do
    end subroutine choose_by

    !> Corners of the bodies [m].
    pure function corners(gpu) result(box)
        type(solid_device_t), intent(in) :: gpu
        real(dp) :: box(3, 2, size(gpu%bodies))
        integer :: b

        do b = 1, size(gpu%bodies)
            box(:, :, b) = gpu%bodies(b)%box
        end do
    end function corners

    !> Links are about to be built, for the drifts of now or, to resume, those that they had.
    subroutine settle_links(gpu, solid, anew, resume, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! see begin_links
        logical, intent(in) :: resume
        type(error_t), intent(inout) :: err

        if (gpu%linked .and. .not. failed(err)) call begin_links(solid, anew, corners(gpu), resume)
    end subroutine settle_links

    !> Count or list, for every particle of some bodies or the chosen ones, the links with one body
    !> after the other; note which bodies have some. Particles of different bodies look side by
    !> side: those of small ones leave the GPU empty.
    subroutine visit_bodies(gpu, solid, which, keep, some, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(in) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        integer, intent(in) :: keep !! see solid_link_search
        logical, intent(in) :: some
        type(error_t), intent(inout) :: err
        integer :: a, b

        if (some) call clear_buffer(gpu%found, err)
        do a = 1, size(gpu%bodies)
            if (.not. which(a)) cycle
            call side_by_side(a)
            if (some) call pick_chosen(gpu, a, err)
            do b = 1, size(gpu%bodies)
                if (.not. may_link(solid, a, b)) cycle
                associate (body => gpu%bodies(a), other => gpu%bodies(b), &
                           shift => solid%links%drift(:, a, b))
                    call solid_kernels%solid_link_search(threads_of(body), keep, &
                        merge(1, 0, some), body%first, body%last - body%gone, &
                        links_reach(solid, a, b), shift(1), shift(2), shift(3), other%grid, &
                        from(gpu%links%box, 6*b - 5_int64), other%code, other%start, &
                        gpu%sorted, gpu%built, from(gpu%found, int(a, int64)), &
                        from(gpu%picked, int(body%first, int64)), &
                        gpu%links%slice, gpu%links%width, gpu%links%count, gpu%links%list, &
                        from(gpu%links%met, a + size(gpu%bodies)*(b - 1_int64)), err)
                end associate
            end do
        end do
        call side_by_side(0)
    end subroutine visit_bodies
end module brz_gpu_solid_links
