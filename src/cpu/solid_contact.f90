! SPDX-License-Identifier: MIT
!> Contact between bodies: forces, heat, energy and time step, in gather loops of their own.
!>
!> Forces are equal and opposite pair by pair and do not depend on the number of threads.
module brz_solid_contact
    use brz_contact, only: add_link, add_moment, contact_drag, contact_normal, contact_push, &
                           core_loss, crossing_share, drag_stiffness, in_core, law_shared, &
                           link_normal, link_pressure, link_stiffness, link_sum, mean_stiffness, &
                           meeting_t, n_link, spring_loss, spring_share, surface_velocity
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int64, real32, rk
    use brz_pair_force, only: viscous_force
    use brz_solid_links, only: first_link, is_tied, last_link, link_body
    use brz_solid_mirror, only: signs
    use brz_solid_state, only: pair_linear, pair_quadratic, pair_spin, solid_t, worth_threads
    implicit none
    private
    public :: contact_pass, find_touch, is_pressed

    !> What the links of one particle add up to.
    type :: sums_t
        real(rk) :: force(3) = 0 !! of springs [N]
        real(rk) :: drag(3) = 0 !! of what makes heat [N]
        real(rk) :: moment(3) = 0 !! of drag about the particle, of rigid bodies [N m]
        real(rk) :: heat(2) = 0 !! of damping and shared pressure; of friction [W]
        real(rk) :: energy = 0 !! held by springs [J]
        real(rk) :: lost = 0 !! by hard cores in the step [J]
        real(rk) :: stiffness = 0 !! [N/m]
        real(rk) :: damping = 0 !! of the shared viscosity [N s/m]
    end type sums_t

contains

    !> Forces of contact at the present positions into `push`; heat over dt, the step just made.
    subroutine contact_pass(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        real(rk) :: lost
        real(dp) :: limit
        integer :: i, k

        solid%bodies%ledger%early = 0
        if (.not. solid%links%present) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i, lost)
        do k = 1, size(solid%block, 2)
            solid%search%sums(1:4, k) = 0
            if (solid%bodies(solid%block(1, k))%asleep .and. dt > 0) cycle
            do i = solid%block(2, k), solid%block(3, k)
                associate (row => solid%links%row(i))
                    if (row == 0) cycle
                    call press(solid, i, real(dt, rk), solid%links%press(:, row), lost)
                    solid%energy(i) = solid%energy(i) + lost/solid%mass(i)
                    solid%search%sums(2, k) = solid%search%sums(2, k) + lost
                end associate
            end do
        end do
        limit = solid%dt_limit
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i) &
        !$omp reduction(min: limit)
        do k = 1, size(solid%block, 2)
            if (solid%bodies(solid%block(1, k))%asleep .and. dt > 0) cycle
            do i = solid%block(2, k), solid%block(3, k)
                if (solid%links%row(i) == 0) cycle
                call add_up(solid, dt, i, solid%search%sums(:, k), limit)
            end do
        end do
        solid%dt_limit = limit
        call book(solid)
    end subroutine contact_pass

    !> Energy, heat of damping and of friction of all blocks to their bodies, in fixed order.
    subroutine book(solid)
        type(solid_t), intent(inout) :: solid
        integer :: k

        solid%bodies%ledger%contact = 0
        do k = 1, size(solid%block, 2)
            associate (ledger => solid%bodies(solid%block(1, k))%ledger, &
                       sums => solid%search%sums(:, k))
                ledger%contact = ledger%contact + sums(1)
                ledger%contact_heat = ledger%contact_heat + sums(2)
                ledger%friction = ledger%friction + sums(3)
                ledger%early = ledger%early + sums(4)
            end associate
        end do
    end subroutine book

    !> Kernel sum over other bodies at the start: where it exceeds that of a flat surface, as in a
    !> bar within concrete, contact begins there.
    subroutine find_touch(solid)
        type(solid_t), intent(inout) :: solid
        real(rk) :: now(n_link), before(n_link)
        integer :: i

        do i = 1, solid%n
            call kernel_sum(solid, i, .true., 0.0_rk, now, before)
            solid%links%touch(i) = max(solid%links%touch(i), &
                                       nearest(real(now(link_sum), real32), 1.0_real32))
        end do
    end subroutine find_touch

    !> Volume of the cell of particle i of body a, as contact sees it [m3].
    pure real(rk) function cell_of(solid, a, i)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: a, i

        cell_of = solid%links%cell(a)*solid%mass(i)*solid%links%weight(i)
    end function cell_of

    !> Pressure of contact of particle i, the sum of V F x_ij that shows its normal, and what its
    !> spring lost over dt, the step just made.
    pure subroutine press(solid, i, dt, p, lost)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(out) :: p(5) !! as links%press
        real(rk), intent(out) :: lost !! [J]
        real(rk) :: now(n_link), before(n_link)

        call kernel_sum(solid, i, .false., dt, now, before)
        p(1) = link_pressure(now, real(solid%links%touch(i), rk))
        p(2:4) = now(link_normal + 1:link_normal + 3)
        p(5) = now(link_stiffness)
        lost = 0
        if (dt > 0) lost = cell_of(solid, link_body(solid%links, i), i) &
            *spring_loss(real(solid%links%touch(i), rk), dt, now, before)
    end subroutine press

    !> True where contact at the present positions pushes particle i, or may after one more step.
    pure logical function is_pressed(solid, i)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk) :: own(5), other(5), distance, lost
        integer(int64) :: k
        integer :: j

        is_pressed = .false.
        if (.not. solid%links%present) return
        call press(solid, i, 0.0_rk, own, lost)
        do k = first_link(solid%links, i), last_link(solid%links, i)
            j = solid%links%list(k)
            associate (m => solid%links%table(link_body(solid%links, i), link_body(solid%links, j)))
                if (is_tied(solid%links, i, j) .and. m%law /= law_shared) cycle
                distance = real(norm2(solid%x(:, i) - signs(int(solid%links%mask(k))) &
                                      *solid%x(:, j)), rk)
                if (distance > 2*m%h) cycle
                call press(solid, j, 0.0_rk, other, lost)
                is_pressed = own(1) + other(1) > 0 .or. m%law == law_shared .or. &
                             in_core(m, distance - real(crossing_share, rk)*m%spacing)
            end associate
            if (is_pressed) return
        end do
    end function is_pressed

    !> Kernel sum over the particles of other bodies, 1 at a flat surface one spacing away: now, and
    !> a step before, where all came from with their velocities.
    pure subroutine kernel_sum(solid, i, all, dt, now, before)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        logical, intent(in) :: all !! bonded partners as well
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        real(rk), intent(out) :: now(n_link), before(n_link) !! see brz_contact
        real(rk) :: s(3), r(3), dv(3), v
        integer :: a, b, j
        integer(int64) :: k

        now = 0
        before = 0
        a = link_body(solid%links, i)
        do k = first_link(solid%links, i), last_link(solid%links, i)
            j = solid%links%list(k)
            if (.not. all) then
                if (is_tied(solid%links, i, j)) cycle
            end if
            b = link_body(solid%links, j)
            s = signs(int(solid%links%mask(k)))
            r = real(solid%x(:, i) - s*solid%x(:, j), rk)
            dv = solid%v(:, i) - s*solid%v(:, j)
            associate (m => solid%links%table(a, b))
                v = cell_of(solid, b, j)/real(solid%depth, rk)/m%touch
                call add_link(m, v, r, dv, now)
                if (dt > 0) call add_link(m, v, r - dt*dv, dv, before)
            end associate
        end do
        call mean_stiffness(now)
        call mean_stiffness(before)
    end subroutine kernel_sum

    !> Force on particle i, its share of the energies, and what time step it bears.
    subroutine add_up(solid, dt, i, sums, limit)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt
        integer, intent(in) :: i
        real(dp), intent(inout) :: sums(:), limit
        type(sums_t) :: total
        integer(int64) :: k

        associate (p => solid%links%press(:, solid%links%row(i)), &
                   v => cell_of(solid, link_body(solid%links, i), i))
            if (p(1) > 0) then
                total%energy = v*p(1)*p(1)/(2*p(5))
                total%stiffness = v*p(5)*dot_product(p(2:4), p(2:4))
            end if
            do k = first_link(solid%links, i), last_link(solid%links, i)
                call add_pair(solid, dt, i, k, total, limit)
            end do
        end associate
        solid%links%push(:, solid%links%row(i)) = [total%force, total%drag, total%moment]
        if (total%stiffness > 0 .and. .not. moves_whole(solid, i)) &
            limit = min(limit, spring_share*sqrt(real(solid%mass(i), dp)/total%stiffness))
        if (total%damping > 0) limit = min(limit, real(solid%mass(i), dp)/total%damping)
        solid%energy(i) = solid%energy(i) + (real(dt, rk)*(total%heat(1) + total%heat(2)) &
                                             + total%lost)/solid%mass(i)
        sums(1) = sums(1) + total%energy
        sums(2) = sums(2) + (dt*total%heat(1) + total%lost)
        sums(4) = sums(4) + dt/2*(total%heat(1) + total%heat(2))
        sums(3) = sums(3) + dt*total%heat(2)
    end subroutine add_up

    !> True for particles of rigid bodies: their springs move the whole body, see rigid_step.
    pure logical function moves_whole(solid, i)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i

        associate (a => link_body(solid%links, i))
            moves_whole = solid%links%table(a, a)%rigid
        end associate
    end function moves_whole

    !> What link k adds to the sums of particle i.
    subroutine add_pair(solid, dt, i, k, total, limit)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        integer, intent(in) :: i
        integer(int64), intent(in) :: k
        type(sums_t), intent(inout) :: total
        real(dp), intent(inout) :: limit
        real(rk) :: r(3), dv(3), slip(3), n(3), f(3), s(3), heat(2), cells, distance, slope, u, vr
        real(rk) :: energy, area, toward, share
        integer :: a, b, j

        j = solid%links%list(k)
        a = link_body(solid%links, i)
        b = link_body(solid%links, j)
        s = signs(int(solid%links%mask(k)))
        r = real(solid%x(:, i) - s*solid%x(:, j), rk)
        distance = sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3))
        dv = solid%v(:, i) - s*solid%v(:, j)
        vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
        associate (m => solid%links%table(a, b), back => solid%links%table(b, a), &
                   p => solid%links%press(:, solid%links%row(i)), &
                   q => solid%links%press(:, solid%links%row(j)))
            if (distance > 2*m%h) return
            if (is_tied(solid%links, i, j) .and. m%law /= law_shared) return
            if (vr < 0) limit = min(limit, crossing_share*m%spacing*distance/(-real(vr, dp)))
            if (m%law == law_shared) return
            slope = kernel_slope(m%scale, m%half_over_h, distance)
            cells = cell_of(solid, a, i)*cell_of(solid, b, j)/real(solid%depth, rk)
            call contact_push(m, cells*slope, p(1)/m%touch + q(1)/back%touch, distance, u, energy)
            total%energy = total%energy + energy/2
            total%lost = total%lost + core_loss(m, real(dt, rk), r, dv)/2
            total%force = total%force + u*r
            share = 0
            if (m%shared) call shared_force(solid, i, j, slope, distance*distance, vr, share, &
                                            total%damping) ! its limit ahead of the first touch
            if (.not. (p(1) + q(1) > 0 .or. energy > 0)) return
            call contact_normal(p(1), p(2:4), q(1), s*q(2:4), r, n)
            toward = r(1)*n(1) + r(2)*n(2) + r(3)*n(3)
            area = cells*slope*max(toward, 0.0_rk)*2/(m%slope + back%slope)
            call surface_velocity(m, r, dv, solid%pair(pair_spin + 1:pair_spin + 3, i), &
                                  s(1)*s(2)*s(3)*s*solid%pair(pair_spin + 1:pair_spin + 3, j), &
                                  slip)
            call contact_drag(m, area, u*toward, slip, n, f, heat)
            total%drag = total%drag + f
            call add_moment(m, r, f, total%moment)
            total%heat = total%heat + heat/2
            total%stiffness = total%stiffness + cells*q(5)*(slope*distance/back%touch)**2 &
                              *cell_of(solid, a, i)
            if (energy > 0) total%stiffness = total%stiffness + m%core/(m%spacing/2)
            total%drag = total%drag + share*r
            total%heat(1) = total%heat(1) - share*vr/2
        end associate
    end subroutine add_pair

    !> Mean pressure and viscosity of a pair that shares them, as a factor of x_ij.
    pure subroutine shared_force(solid, i, j, slope, r2, vr, u, damping)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i, j
        real(rk), intent(in) :: slope, r2, vr
        real(rk), intent(out) :: u
        real(rk), intent(inout) :: damping !! of the links of i so far [N s/m]
        real(rk) :: h, w, pressure

        w = solid%volume(i)*solid%volume(j)*slope/real(solid%depth, rk)
        pressure = -(solid%stress(1, i) + solid%stress(2, i) + solid%stress(3, i) &
                     + solid%stress(1, j) + solid%stress(2, j) + solid%stress(3, j))/3
        h = solid%links%table(link_body(solid%links, i), link_body(solid%links, j))%h
        u = viscous_force(w, h, r2, vr, &
                          solid%pair(pair_linear, i) + solid%pair(pair_linear, j), &
                          solid%pair(pair_quadratic, i) + solid%pair(pair_quadratic, j))
        damping = damping + drag_stiffness(u, r2, vr)
        u = u + w*max(pressure, 0.0_rk)
    end subroutine shared_force
end module brz_solid_contact
