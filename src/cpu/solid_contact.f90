! SPDX-License-Identifier: MIT
!> Contact between bodies on the CPU: the loops over blocks, whose sums go to the energy accounts.
!>
!> Results do not depend on the number of threads.
module brz_solid_contact
    use brz_contact, only: link_sum, n_link
    use brz_contact_loop_bodies, only: press_particle, push_particle, sum_links
    use brz_energy_account, only: n_kept
    use brz_force_layout, only: at_drag, at_stiff, n_terms
    use brz_listed_bodies, only: listed_bodies_t
    use brz_kinds, only: dp, real32, rk
    use brz_link_rows, only: joined_of
    use brz_solid_diagnostics, only: record_contact
    use brz_solid_ghosts, only: refresh_motion, refresh_press, refresh_rows
    use brz_solid_part, only: solid_part_t
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: contact_pass, find_press, find_touch

contains

    !> Forces of contact at the present positions into `push`; heat over dt, the step just made.
    subroutine contact_pass(solid, part, dt)
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(inout) :: part
        real(dp), intent(in) :: dt !! [s]
        real(rk) :: lost
        real(dp) :: limit
        integer :: i, k

        solid%bodies%account%early = 0
        if (.not. solid%links%present) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i, lost)
        do k = 1, size(solid%block, 2)
            solid%search%sums(1:4, k) = 0
            if (solid%bodies(solid%block(1, k))%inactive .and. dt > 0) cycle
            do i = solid%block(2, k), solid%block(3, k)
                associate (row => solid%links%row(i))
                    if (row == 0) cycle
                    call press(solid, i, real(dt, rk), lost)
                    solid%energy(i) = solid%energy(i) + lost/solid%mass(i)
                    solid%search%sums(2, k) = solid%search%sums(2, k) + lost
                end associate
            end do
        end do
        call refresh_press(solid, part)
        limit = solid%dt_limit
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i) &
        !$omp reduction(min: limit)
        do k = 1, size(solid%block, 2)
            if (solid%bodies(solid%block(1, k))%inactive .and. dt > 0) cycle
            do i = solid%block(2, k), solid%block(3, k)
                if (solid%links%row(i) > 0) &
                    call add_up(solid, dt, i, solid%search%sums(:, k), limit)
            end do
        end do
        solid%dt_limit = limit
        if (solid%links%faces) call refresh_rows(solid, part) ! with what contact brings
        call record_contact(solid)
    end subroutine contact_pass

    !> Kernel sum over other bodies at the start: where it exceeds that of a flat surface, as in a
    !> bar within concrete, contact begins there.
    subroutine find_touch(solid)
        class(listed_bodies_t), intent(inout) :: solid
        real(rk) :: now(n_link), before(n_link), freed
        integer :: i

        !$omp parallel do if(solid%n >= worth_threads) schedule(dynamic, 1024) &
        !$omp private(now, before, freed)
        do i = 1, solid%n
            associate (s => solid, l => solid%links)
                call sum_links(i, .true., l%lay, 0.0_rk, l%ends, l%table, l%cell, s%x, s%v, &
                               s%mass, l%weight, l%face, l%bond, joined_of(l), l%row, &
                               l%slice(1:), l%count(1:), l%list, now, before, freed)
            end associate
            solid%links%touch(i) = max(solid%links%touch(i), &
                                       nearest(real(now(link_sum), real32), 1.0_real32))
        end do
    end subroutine find_touch

    !> Pressure of contact of particle i, and what its spring lost over dt, the step just made.
    subroutine press(solid, i, dt, lost)
        type(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: i
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(out) :: lost !! [J]

        associate (s => solid, l => solid%links)
            call press_particle(i, l%lay, dt, l%ends, l%table, l%cell, s%x, s%v, s%mass, l%weight, &
                                l%face, l%bond, joined_of(l), l%row, l%slice(1:), l%count(1:), &
                                l%list, l%touch(i), l%press(:, l%row(i)), lost)
        end associate
    end subroutine press

    !> Pressures of contact at the present positions, of ghosts as well.
    subroutine find_press(solid, part)
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(inout) :: part
        real(rk) :: lost
        integer :: i, k

        call refresh_motion(solid, part)
        do k = 1, size(solid%block, 2)
            do i = solid%block(2, k), solid%block(3, k)
                associate (row => solid%links%row(i))
                    if (row > 0) call press(solid, i, 0.0_rk, lost)
                end associate
            end do
        end do
        call refresh_press(solid, part)
    end subroutine find_press

    !> Force on particle i, its share of the energies, and what time step it bears.
    subroutine add_up(solid, dt, i, sums, limit)
        type(listed_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt
        integer, intent(in) :: i
        real(dp), intent(inout) :: sums(:), limit
        real(rk) :: f(n_terms), gain
        real(dp) :: kept(n_kept)

        associate (s => solid, l => solid%links)
            call push_particle(i, l%lay, dt, l%ends, l%table, l%cell, s%x, s%v, s%mass, &
                               l%weight, s%stress, s%pair, l%press(:, 1:), l%face, l%bond, &
                               joined_of(l), l%row, l%slice(1:), l%count(1:), l%list, f, kept, &
                               gain, limit)
            l%push(:, l%row(i)) = [f(1:3), f(at_drag + 1:at_drag + 3), f(at_stiff + 1:at_stiff + 3)]
            s%energy(i) = s%energy(i) + gain/s%mass(i)
        end associate
        sums(1:n_kept) = sums(1:n_kept) + kept
    end subroutine add_up
end module brz_solid_contact
