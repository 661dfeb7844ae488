! SPDX-License-Identifier: MIT
!> Contact and bonds between bodies on the GPU: launches over the bodies that are active.
module brz_gpu_solid_contact
    use brz_bond_launches, only: bond_kernels
    use brz_buffers, only: doubles_t, from, integers_t
    use brz_cohesive_launches, only: cohesive_kernels
    use brz_contact_launches, only: contact_kernels
    use brz_device, only: clear_buffer, copy_out, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_common, only: pick
    use brz_gpu_solid_ghosts, only: refresh_motion, refresh_press, refresh_rows
    use brz_gpu_solid_layout, only: diag_contact, diag_contact_early, diag_contact_heat, diag_rub
    use brz_gpu_solid_state, only: diag_of
    use brz_solid_device, only: solid_device_t
    use brz_kinds, only: dp, int64, rk
    use brz_present_table, only: on_device
    use brz_solid_launches, only: solid_kernels
    use brz_particles, only: particles_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_tie_launches, only: tie_kernels
    implicit none
    private
    public :: note_active, add_bond_moments, break_bonds, contact_pass, find_press

contains

    !> Add the bonded partners to the sums of pass 1.
    subroutine add_bond_moments(gpu, err)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        if (.not. gpu%bonded) return
        call list_linked(gpu, err)
        associate (l => gpu%links)
            call solid_kernels%solid_bond_moments([l%n_linked, 1, 1], gpu%stride_d, l%n_linked, &
                l%linked, l%lay, l%ends, l%table, gpu%x, gpu%x_ref, gpu%v, gpu%volume, &
                gpu%mass, l%bond, l%slice, l%count, l%list, gpu%row, gpu%grad, gpu%k_axes, &
                gpu%control, l%acting, l%near, err)
        end associate
    end subroutine add_bond_moments

    !> Note which bodies sleep, and the ranges of particles of those that are active; bodies side by
    !> side go together.
    subroutine note_active(gpu, inactive, err)
        type(solid_device_t), intent(inout) :: gpu
        logical, intent(in) :: inactive(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer :: b, n, range(2, size(gpu%bodies))

        gpu%bodies%inactive = inactive
        if (failed(err) .or. .not. gpu%linked) return
        range = 0
        n = 0
        do b = 1, size(gpu%bodies)
            if (inactive(b)) cycle
            if (n > 0) then
                if (range(2, n) == gpu%bodies(b)%first - 1) n = n - 1
            end if
            n = n + 1
            if (range(1, n) == 0) range(1, n) = gpu%bodies(b)%first
            range(2, n) = gpu%bodies(b)%last
        end do
        if (any(range /= gpu%links%active)) gpu%links%listed = .false.
        gpu%links%active = range
    end subroutine note_active

    !> List the particles of active bodies that may touch others, and those that may be bonded to
    !> others, so that no thread waits for those beside it; unless they are those of the last step.
    subroutine list_linked(gpu, err)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: k

        associate (l => gpu%links)
            if (l%listed) return
            l%listed = .true.
            associate (active => l%active(:, :count(l%active(1, :) > 0)))
                call list_marked(gpu, links_that_touch(gpu), active, l%touching, l%n_touching, err)
                if (.not. gpu%bonded) return
                call reserve_buffer(l%acting, 4_int64*gpu%n, err)
                call reserve_buffer(l%near, l%list%bytes, err)
                call reserve_buffer(l%mark, 4_int64*gpu%n, err)
                call clear_buffer(l%mark, err)
                do k = 1, size(active, 2)
                    call tie_kernels%mark_linked(active(2, k) - active(1, k) + 1, active(1, k), &
                        l%lay, l%ends, l%table, l%row, l%slice, l%count, l%list, l%mark, err)
                end do
                call list_marked(gpu, l%mark, active, l%linked, l%n_linked, err)
            end associate
        end associate
    end subroutine list_linked

    !> List the particles of some ranges that are marked.
    subroutine list_marked(gpu, mark, ranges, list, n, err)
        type(solid_device_t), intent(in) :: gpu
        type(integers_t), intent(in) :: mark !! (particles)
        integer, intent(in) :: ranges(:, :) !! (2, ranges) first and last particle
        type(integers_t), intent(inout) :: list
        integer, intent(out) :: n !! how many
        type(error_t), intent(inout) :: err
        integer :: k, word(1)

        call reserve_buffer(list, 4_int64*gpu%n, err)
        call clear_buffer(gpu%links%found, err)
        do k = 1, size(ranges, 2)
            call pick(from(mark, int(ranges(1, k), int64)), ranges(1, k) - 1, &
                      ranges(2, k) - ranges(1, k) + 1, list, gpu%links%found, err)
        end do
        word = 0
        call copy_out(gpu%links%found, word, 4_int64, err)
        n = word(1)
    end subroutine list_marked

    !> How many links a particle has along which contact may act.
    pure type(integers_t) function links_that_touch(gpu) result(number)
        type(solid_device_t), intent(in) :: gpu

        number = gpu%links%count
        if (.not. gpu%links%frees) number = gpu%links%loose
    end function links_that_touch

    !> Break the bonds of particles whose traction on the bond exceeds its strength.
    subroutine break_bonds(gpu, solid, err)
        type(solid_device_t), intent(in) :: gpu
        class(listed_bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer :: k

        if (.not. (gpu%linked .and. solid%links%bonds .and. gpu%links%breaks)) return
        associate (l => gpu%links)
            do k = 1, count(l%active(1, :) > 0)
                call bond_kernels%break_bond(l%active(2, k) - l%active(1, k) + 1, l%active(1, k), &
                    l%lay, l%ends, l%table, gpu%x, gpu%v, gpu%pair, gpu%stress, l%row, l%slice, &
                    l%count, l%list, l%bond, err)
            end do
        end associate
    end subroutine break_bonds

    !> All forces between bodies, also those of bonds and interfaces, into `extra`.
    subroutine contact_pass(gpu, solid, dt, err)
        type(solid_device_t), intent(inout) :: gpu
        class(interacting_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err
        integer :: k

        if (.not. gpu%linked) return
        call list_linked(gpu, err)
        associate (l => gpu%links, cohesive => solid%cohesive)
            call press(gpu, real(dt, rk), err)
            call refresh_press(gpu, err)
            call clear_buffer(gpu%extra, err)
            do k = 1, count(l%active(1, :) > 0)
                call forget(diag_of(gpu, diag_contact), l%active(:, k), err)
                call forget(diag_of(gpu, diag_contact_early), l%active(:, k), err)
            end do
            call contact_kernels%push_links(l%n_touching, l%touching, gpu%stride_d, l%lay, dt, &
                l%ends, l%table, l%cell, gpu%x, gpu%v, gpu%mass, l%weight, gpu%stress, gpu%pair, &
                l%press, l%face, l%bond, l%joined, l%row, l%slice, links_that_touch(gpu), &
                l%list, gpu%energy, diag_of(gpu, diag_contact), diag_of(gpu, diag_contact_early), &
                diag_of(gpu, diag_contact_heat), diag_of(gpu, diag_rub), gpu%rate, gpu%extra, err)
            if (solid%links%faces) call refresh_rows(gpu, solid, err) ! with what faces bring
            if (gpu%bonded) call bond_kernels%pull_links(l%n_linked, l%linked, gpu%stride_d, &
                l%lay, l%ends, l%table, gpu%x, gpu%x_ref, gpu%v, gpu%mass, gpu%pair, gpu%k_axes, &
                gpu%control, l%bond, l%row, l%slice, l%acting, l%near, gpu%extra, err)
            if (cohesive%present) call cohesive_kernels%add_pull(cohesive%nodes, gpu%stride_d, &
                integers_t(address=on_device(cohesive%place)), &
                doubles_t(address=on_device(cohesive%push(:, 1:))), gpu%extra, err)
        end associate
    end subroutine contact_pass

    !> What the diagnostics hold of a range of particles becomes 0.
    subroutine forget(diag, range, err)
        type(doubles_t), intent(in) :: diag
        integer, intent(in) :: range(2)
        type(error_t), intent(inout) :: err

        call clear_buffer(from(diag, int(range(1), int64)), err, &
                          8_int64*(range(2) - range(1) + 1))
    end subroutine forget

    !> Pressures of contact of the particles that are listed.
    subroutine press(gpu, dt, err)
        type(solid_device_t), intent(in) :: gpu
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        type(error_t), intent(inout) :: err

        associate (l => gpu%links)
            call contact_kernels%press_links(l%n_touching, l%touching, l%lay, dt, l%ends, &
                l%table, l%cell, gpu%x, gpu%v, gpu%mass, l%weight, l%face, l%touch, l%bond, &
                l%joined, l%row, l%slice, links_that_touch(gpu), l%list, gpu%energy, &
                diag_of(gpu, diag_contact_heat), l%press, err)
        end associate
    end subroutine press

    !> Pressures of contact at the present positions, of sleepers and ghosts as well.
    subroutine find_press(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        type(error_t), intent(inout) :: err

        call refresh_motion(gpu, solid, err)
        call list_marked(gpu, links_that_touch(gpu), reshape([1, gpu%n], [2, 1]), &
                         gpu%links%touching, gpu%links%n_touching, err)
        gpu%links%listed = .false.
        call press(gpu, 0.0_rk, err)
        call refresh_press(gpu, err)
    end subroutine find_press
end module brz_gpu_solid_contact
