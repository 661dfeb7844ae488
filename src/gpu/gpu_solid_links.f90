! SPDX-License-Identifier: MIT
!> Contact and bonds between bodies on the GPU: memory, lists of links.
module brz_gpu_solid_links
    use brz_buffers, only: from
    use brz_contact, only: law_bonded
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, copy_out, put_buffer, &
        reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_layout, only: slice_width
    use brz_gpu_solid_state, only: bytes_of_real, gpu_solid_t, threads_of
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: fix_layout, link_layout_t
    use brz_list_drift, only: begin_links, links_reach, may_link
    use brz_ranks, only: most_of_all, several
    use brz_solid_launches, only: solid_kernels
    use brz_solid_state, only: solid_t
    use brz_tie_launches, only: tie_kernels
    implicit none
    private
    public :: open_gpu_links, settle_links, build_links

contains

    !> Reserve memory and copy what the laws between the bodies are.
    subroutine open_gpu_links(solid, gpu, err)
        type(solid_t), intent(in) :: solid
        type(gpu_solid_t), intent(inout) :: gpu
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
                merge(1, 0, gpu%column%owed > 0), 0, gpu%n, 0, 0, 0, 0, 0, &
                real(solid%depth, rk)), links%lay)
            call allocate_buffer(links%met, 4_int64*size(solid%bodies)**2, err)
            associate (t => solid%links%table)
                links%breaks = any(t%law == law_bonded .and. &
                                   min(t%tensile, t%shear) < huge(t%shear))
                links%frees = links%breaks .or. any(t%bit /= 0) .or. several(solid%ranks)
            end associate
        end associate
    end subroutine open_gpu_links

    !> Build the links for the positions `built`, to which the drifts of the bodies are added: count
    !> them, then list them, body by body.
    subroutine build_links(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        type(error_t), intent(inout) :: err
        integer :: keep, slices, longest, met(size(solid%bodies), size(solid%bodies))
        integer(int64) :: all(size(met))

        if (.not. gpu%linked) return
        slices = (gpu%n - 1)/slice_width + 1
        call clear_buffer(gpu%links%met, err)
        do keep = 0, 1
            call clear_buffer(gpu%links%count, err)
            call visit_bodies(gpu, solid, keep, err)
            if (keep == 1) exit
            call solid_kernels%slice_widths([slices, 1, 1], slices, 1, gpu%n, 0, &
                gpu%links%count, gpu%links%slice, err)
            call gpu%common%running_sum(gpu%links%slice, slices, err, longest)
            call reserve_buffer(gpu%links%list, 4_int64*slice_width*(longest + 1_int64), err)
        end do
        associate (l => gpu%links)
            if (.not. l%frees) call tie_kernels%count_loose(gpu%n, l%lay, l%ends, l%table, &
                l%bond, l%joined, l%row, l%slice, l%count, l%list, l%loose, err)
        end associate
        met = 0
        call copy_out(gpu%links%met, met, 4_int64*size(met), err)
        all = reshape(met, [size(met)])
        call most_of_all(solid%ranks, all)
        solid%links%met = reshape(all == 1, shape(met))
    end subroutine build_links

    !> Links are about to be built, for the drifts of now or, to resume, those that they had.
    subroutine settle_links(gpu, solid, resume, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: resume
        type(error_t), intent(inout) :: err
        integer :: b

        if (gpu%linked .and. .not. failed(err)) &
            call begin_links(solid, reshape([(gpu%bodies(b)%box, b=1, size(gpu%bodies))], &
                                            [3, 2, size(gpu%bodies)]), resume)
    end subroutine settle_links

    !> Count or list, for every particle, its links with one body after the other; note which bodies
    !> have some.
    subroutine visit_bodies(gpu, solid, keep, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: keep
        type(error_t), intent(inout) :: err
        real(dp) :: shift(3)
        integer :: a, b

        do b = 1, size(gpu%bodies)
            if (.not. any([(may_link(solid, a, b), a=1, size(gpu%bodies))])) cycle
            call copy_in(gpu%bodies(b)%box, gpu%box, 48_int64, err)
            do a = 1, size(gpu%bodies)
                if (.not. may_link(solid, a, b)) cycle
                shift = solid%bodies(a)%drift_linked - solid%bodies(b)%drift_linked
                call solid_kernels%solid_link_search(threads_of(gpu%bodies(a)), keep, &
                    gpu%bodies(a)%first, gpu%bodies(a)%last, links_reach(solid, a, b), &
                    shift(1), shift(2), shift(3), gpu%bodies(b)%grid, gpu%box, &
                    gpu%bodies(b)%code, gpu%bodies(b)%start, &
                    gpu%order, gpu%built, gpu%links%slice, gpu%links%count, gpu%links%list, &
                    from(gpu%links%met, a + size(gpu%bodies)*(b - 1_int64)), err)
            end do
        end do
    end subroutine visit_bodies
end module brz_gpu_solid_links
