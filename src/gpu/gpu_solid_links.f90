! SPDX-License-Identifier: MIT
!> Contact and bonds between bodies on the GPU: memory, lists of links, launches.
module brz_gpu_solid_links
    use brz_buffers, only: from, integers_t
    use brz_contact, only: law_bonded
    use brz_device, only: allocate_buffer, clear_buffer, copy_out, put_buffer, &
        reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_cohesive_steps, only: cohesive_pass
    use brz_gpu_solid_ghosts, only: refresh_gpu_bonds, refresh_gpu_press
    use brz_gpu_solid_layout, only: book_contact, book_contact_early, book_contact_heat, book_rub, &
        slice_width
    use brz_gpu_solid_search, only: order_body
    use brz_gpu_solid_state, only: book_of, bytes_of_real, gpu_solid_t, threads_of
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: fix_layout, link_layout_t
    use brz_list_drift, only: begin_links, links_reach, may_link
    use brz_ranks, only: most_of_all, several
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_gpu_links, settle_gpu_links, build_gpu_links, add_bond_moments, contact_pass

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
    subroutine build_gpu_links(gpu, solid, err)
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
            call gpu%kernels%slice_widths([slices, 1, 1], slices, 1, gpu%n, gpu%links%count, &
                                          gpu%links%slice, err)
            call gpu%common%running_sum(gpu%links%slice, slices, err, longest)
            call reserve_buffer(gpu%links%list, 4_int64*slice_width*(longest + 1_int64), err)
        end do
        associate (l => gpu%links)
            if (.not. l%frees) call gpu%tie_kernels%count_loose(gpu%n, l%lay, l%ends, l%table, &
                l%bond, l%joined, l%row, l%slice, l%count, l%list, l%loose, err)
        end associate
        met = 0
        call copy_out(gpu%links%met, met, 4_int64*size(met), err)
        all = reshape(met, [size(met)])
        call most_of_all(solid%ranks, all)
        solid%links%met = reshape(all == 1, shape(met))
    end subroutine build_gpu_links

    !> Links are about to be built, for the drifts of now or, to resume, those that they had.
    subroutine settle_gpu_links(gpu, solid, resume)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: resume
        integer :: b

        if (gpu%linked) call begin_links(solid, reshape([(gpu%bodies(b)%box, &
            b=1, size(gpu%bodies))], [3, 2, size(gpu%bodies)]), resume)
    end subroutine settle_gpu_links

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
            call order_body(gpu, solid, b, gpu%built, &
                            2*real(maxval(solid%links%table(:, b)%h), dp) + solid%skin, err)
            do a = 1, size(gpu%bodies)
                if (.not. may_link(solid, a, b)) cycle
                shift = solid%bodies(a)%drift_linked - solid%bodies(b)%drift_linked
                call gpu%kernels%solid_link_search(threads_of(gpu%bodies(a)), keep, &
                    gpu%bodies(a)%first, gpu%bodies(a)%last, links_reach(solid, a, b), &
                    shift(1), shift(2), shift(3), gpu%grid, gpu%box, gpu%code, gpu%start, &
                    gpu%order, gpu%built, gpu%links%slice, gpu%links%count, gpu%links%list, &
                    from(gpu%links%met, a + size(gpu%bodies)*(b - 1_int64)), err)
            end do
        end do
    end subroutine visit_bodies

    !> Add the bonded partners to the sums of pass 1.
    subroutine add_bond_moments(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        integer :: k, range(2, size(gpu%bodies))

        if (.not. gpu%bonded) return
        call find_awake(gpu, range)
        associate (l => gpu%links)
            do k = 1, count(range(1, :) > 0)
                call gpu%kernels%solid_bond_moments([range(2, k) - range(1, k) + 1, 1, 1], &
                    gpu%n, range(1, k), range(2, k), l%lay, l%ends, l%table, gpu%x, gpu%x_ref, &
                    gpu%v, gpu%volume, gpu%mass, l%bond, l%slice, l%count, l%list, gpu%row, &
                    gpu%grad, gpu%hold, gpu%held, err)
            end do
        end associate
    end subroutine add_bond_moments

    !> Between the passes: bonds break, interfaces open, then all forces between bodies go into
    !> `extra`.
    subroutine contact_pass(gpu, solid, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err
        integer :: k, m, n(size(gpu%bodies)), range(2, size(gpu%bodies))
        type(integers_t) :: touching

        if (.not. gpu%linked) return
        call find_awake(gpu, range)
        n = range(2, :) - range(1, :) + 1
        m = count(range(1, :) > 0)
        associate (l => gpu%links, glue => gpu%cohesive, first => range(1, :))
            touching = l%count ! links along which contact may act
            if (.not. l%frees) touching = l%loose
            do k = 1, merge(m, 0, gpu%bonded .and. l%breaks .and. dt > 0)
                call gpu%bond_kernels%break_bond(n(k), first(k), l%lay, l%ends, l%table, gpu%x, &
                    gpu%v, gpu%pair, gpu%stress, l%row, l%slice, l%count, l%list, l%bond, err)
            end do
            if (gpu%bonded .and. dt > 0) call refresh_gpu_bonds(gpu, err)
            call cohesive_pass(gpu, solid, err)
            do k = 1, m
                call gpu%contact_kernels%press_links(n(k), first(k), l%lay, real(dt, rk), l%ends, &
                    l%table, l%cell, gpu%x, gpu%v, gpu%mass, l%weight, l%touch, l%bond, l%joined, &
                    l%row, l%slice, touching, l%list, gpu%energy, &
                    book_of(gpu, book_contact_heat), l%press, err)
            end do
            call refresh_gpu_press(gpu, err)
            do k = 1, m
                call gpu%contact_kernels%push_links(n(k), first(k), gpu%n, l%lay, dt, l%ends, &
                    l%table, l%cell, gpu%x, gpu%v, gpu%mass, l%weight, gpu%stress, gpu%pair, &
                    l%press, l%bond, l%joined, l%row, l%slice, touching, l%list, gpu%energy, &
                    book_of(gpu, book_contact), book_of(gpu, book_contact_early), &
                    book_of(gpu, book_contact_heat), book_of(gpu, book_rub), gpu%rate, gpu%extra, &
                    err)
                if (gpu%bonded) call gpu%bond_kernels%pull_links(n(k), first(k), gpu%n, l%lay, &
                    l%ends, l%table, gpu%x, gpu%x_ref, gpu%v, gpu%mass, gpu%pair, gpu%hold, &
                    gpu%held, l%bond, l%row, l%slice, l%count, l%list, gpu%extra, err)
            end do
            if (solid%cohesive%present) call gpu%cohesive_kernels%add_pull(glue%nodes, gpu%n, &
                glue%place, glue%push, gpu%extra, err)
        end associate
    end subroutine contact_pass

    !> First and last particles of the bodies that are awake; bodies side by side go together.
    pure subroutine find_awake(gpu, range)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(out) :: range(:, :) !! (2, bodies), 0 behind the last
        integer :: b, n

        range = 0
        n = 0
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%asleep) cycle
            if (n > 0) then
                if (range(2, n) == gpu%bodies(b)%first - 1) n = n - 1
            end if
            n = n + 1
            if (range(1, n) == 0) range(1, n) = gpu%bodies(b)%first
            range(2, n) = gpu%bodies(b)%last
        end do
    end subroutine find_awake
end module brz_gpu_solid_links
