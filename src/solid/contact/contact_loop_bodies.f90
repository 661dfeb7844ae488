! SPDX-License-Identifier: MIT
!> Contact between bodies, a particle at a time: pressures, forces, heat, energy and time step.
!>
!> Forces are gathered, and equal and opposite pair by pair.
module brz_contact_loop_bodies
    use brz_contact, only: add_link, add_moment, contact_drag, contact_normal, contact_push, &
        core_loss, crossing_share, drag_stiffness, link_normal, link_pressure, link_stiffness, &
        link_sum, mean_stiffness, n_link, shared_volume, spring_loss, spring_share, surface_velocity
    use brz_contact_face, only: add_push_by_face, turn_normal
    use brz_contact_release, only: is_freed, is_tied, later_touch
    use brz_face_layout, only: face_edge, face_normal, face_past, face_strain
    use brz_force_layout, only: at_drag, at_friction, at_heat, at_stiff, at_work, n_terms
    use brz_interaction, only: law_shared, interaction_t
    use brz_kernel, only: kernel_slope, kernel_value
    use brz_energy_account, only: kept_early, kept_energy, kept_heat, kept_rub, n_kept
    use brz_kinds, only: dp, int32, int64, real32, rk
    use brz_link_layout, only: link_layout_t, links_of, mask_unit, n_press
    use brz_pair_force, only: viscous_force
    use brz_pair_layout, only: n_pair, pair_linear, pair_quadratic, pair_spin, pair_stress, &
        pair_volume
    implicit none
    private
    public :: owner_of, next_owner, look_ahead, look_along, sum_links, press_particle, &
        push_particle, press_links, push_links
    public :: add_pair, trace_at

contains

    !> Place of a number of the face of a particle.
    !@cuf attributes(host,device) &
    pure function face_at(lay, i, slot) result(at)
        type(link_layout_t), intent(in) :: lay
        integer, intent(in) :: i, slot !! see brz_contact_face
        integer(int64) :: at

        at = 1 + (i - 1_int64)*lay%step_f + (slot - 1_int64)*lay%step_c
    end function face_at

    !> Body of a particle.
    !@cuf attributes(host,device) &
    pure function owner_of(bodies, ends, i) result(b)
        integer, intent(in) :: bodies
        integer(int32), intent(in) :: ends(*) !! last place of each body
        integer, intent(in) :: i
        integer :: b, middle, most

        b = 1
        most = bodies
        do while (b < most)
            middle = (b + most)/2
            if (i > ends(middle)) then
                b = middle + 1
            else
                most = middle
            end if
        end do
    end function owner_of

    !> The same, if the last one was of body b: links lie body by body.
    !@cuf attributes(host,device) &
    pure function next_owner(bodies, ends, i, b) result(owner)
        integer, intent(in) :: bodies
        integer(int32), intent(in) :: ends(*) !! last place of each body
        integer, intent(in) :: i, b
        integer :: owner

        owner = b
        if (i <= ends(b)) then
            if (b == 1) return
            if (i > ends(b - 1)) return
        end if
        owner = owner_of(bodies, ends, i)
    end function next_owner

    !> Other end of a link: x_ij, v_ij, and the signs of mirrored components.
    !@cuf attributes(host,device) &
    pure subroutine look_along(lay, entry, i, x, v, j, s, r, dv)
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: entry
        integer, intent(in) :: i
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *)
        integer, intent(out) :: j
        real(rk), intent(out) :: s(3), r(3), dv(3)
        integer :: t

        j = iand(entry, mask_unit - 1)
        do t = 1, 3
            s(t) = 1
            if (btest(entry, 27 + t)) s(t) = -1
            r(t) = real(x(t, i) - s(t)*x(t, j), rk)
            dv(t) = v(t, i) - s(t)*v(t, j)
        end do
    end subroutine look_along

    !> The same along link k of n, and fetch the entry of the next one while this one is computed.
    !@cuf attributes(host,device) &
    pure subroutine look_ahead(lay, list, at, k, n, i, x, v, next, j, s, r, dv)
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: list(*)
        integer(int64), intent(in) :: at !! first entry
        integer, intent(in) :: k, n, i
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *)
        integer(int32), intent(inout) :: next !! entry, set by the first link
        integer, intent(out) :: j
        real(rk), intent(out) :: s(3), r(3), dv(3)

        if (k == 1) next = list(at)
        call look_along(lay, next, i, x, v, j, s, r, dv)
        next = list(at + min(k, n - 1)*lay%side)
    end subroutine look_ahead

    !> Kernel sum over the particles of other bodies, 1 at a flat surface one spacing away: now, and
    !> a step before, where all came from with their velocities.
    !@cuf attributes(host,device) &
    pure subroutine sum_links(i, all, lay, dt, ends, table, cell, x, v, mass, weight, face, bond, &
                              joined, row, slice, count, list, now, before, freed)
        integer, intent(in) :: i
        logical, intent(in) :: all !! bonded partners as well
        type(link_layout_t), intent(in) :: lay
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(rk), intent(in) :: cell(*)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*)
        real(real32), intent(in) :: weight(*)
        real(real32), intent(in) :: face(*) !! see brz_contact_face
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        real(rk), intent(out) :: now(n_link), before(n_link) !! see brz_contact
        real(rk), intent(out) :: freed !! sum over particles that had no contact then
        real(rk) :: s(3), r(3), dv(3), w, d, grown, past, growth
        integer :: a, b, j, k, n, t
        integer(int32) :: next
        integer(int64) :: at

        do t = 1, n_link
            now(t) = 0
            before(t) = 0
        end do
        freed = 0
        a = owner_of(lay%bodies, ends, i)
        b = a
        call links_of(lay, i, row, slice, count, t, n, at)
        do k = 1, n
            call look_ahead(lay, list, at, k, n, i, x, v, next, j, s, r, dv)
            b = next_owner(lay%bodies, ends, j, b)
            if (.not. all) then
                if (is_tied(table(a, b), bond(i), bond(j), joined(i), joined(j))) cycle
            end if
            w = cell(b)*mass(j)*weight(j)/lay%depth/table(a, b)%touch
            grown = table(a, b)%steep*(table(a, b)%reach(1)*face(face_at(lay, i, face_strain)) &
                                       + table(a, b)%reach(2)*face(face_at(lay, j, face_strain)))
            past = table(a, b)%steep*(table(a, b)%reach(1)*face(face_at(lay, i, face_past)) &
                                      + table(a, b)%reach(2)*face(face_at(lay, j, face_past)))
            growth = 0
            if (dt > 0) growth = (grown - past)/dt
            call add_link(table(a, b), w, r, dv, grown, growth, now)
            if (.not. dt > 0) cycle
            do t = 1, 3
                r(t) = r(t) - dt*dv(t)
            end do
            if (is_freed(table(a, b), bond(i), bond(j), joined(i), joined(j))) then
                d = sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3))
                freed = freed + (1 + past)*w*kernel_value(kernel_slope(table(a, b)%scale, &
                                             table(a, b)%half_over_h, d), table(a, b)%h, d)
            else
                call add_link(table(a, b), w, r, dv, past, growth, before)
            end if
        end do
        call mean_stiffness(real(face(face_at(lay, i, face_edge)), rk), now)
        call mean_stiffness(real(face(face_at(lay, i, face_edge)), rk), before)
    end subroutine sum_links

    !> Pressure of contact of a particle, the sum of V F x_ij that shows its normal, stiffness; what
    !> its spring lost over dt, the step just made.
    !>
    !> Where a bond or an interface has let go, contact begins with what is nearer than a step
    !> before: it must not find the bodies pressed together, with an energy that nothing gave.
    !@cuf attributes(host,device) &
    pure subroutine press_particle(i, lay, dt, ends, table, cell, x, v, mass, weight, face, &
                                   bond, joined, row, slice, count, list, touch, press, lost)
        integer, intent(in) :: i
        type(link_layout_t), intent(in) :: lay
        real(rk), intent(in) :: dt !! 0: none [s]
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(rk), intent(in) :: cell(*)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*)
        real(real32), intent(in) :: weight(*)
        real(real32), intent(in) :: face(*)
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        real(real32), intent(inout) :: touch !! its kernel sum at which contact begins
        real(rk), intent(inout) :: press(n_press) !! see links_t
        real(rk), intent(out) :: lost !! [J]
        real(rk) :: now(n_link), before(n_link), freed, last
        integer :: t

        call sum_links(i, .false., lay, dt, ends, table, cell, x, v, mass, weight, face, bond, &
                       joined, row, slice, count, list, now, before, freed)
        last = touch
        if (freed > 0) touch = later_touch(touch, before(link_sum), freed)
        press(1) = link_pressure(now, real(touch, rk))
        do t = 1, 3
            press(1 + t) = now(link_normal + t)
        end do
        press(5) = now(link_stiffness)
        lost = 0
        if (dt > 0) lost = cell(owner_of(lay%bodies, ends, i))*mass(i)*weight(i) &
            *spring_loss(last, real(touch, rk), dt, now, before)
    end subroutine press_particle

    !> The same of each particle that may touch; its energy and heat.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine press_links(k, touching, lay, dt, ends, table, cell, x, v, mass, weight, &
                                face, touch, bond, joined, row, slice, count, list, energy, &
                                heat, press)
        integer, intent(in) :: k !! particles that may touch
        integer(int32), intent(in) :: touching(*) !! they
        type(link_layout_t), intent(in) :: lay
        real(rk), intent(in) :: dt !! [s]
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(rk), intent(in) :: cell(*)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*)
        real(real32), intent(in) :: weight(*)
        real(real32), intent(in) :: face(*) !! see brz_contact_face
        real(real32), intent(inout) :: touch(*)
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        real(rk), intent(inout) :: energy(*)
        real(dp), intent(inout) :: heat(*) !! of contact, of each particle [J]
        real(rk), intent(inout) :: press(n_press, *) !! see links_t
        real(rk) :: lost
        integer :: i

        i = touching(k)
        call press_particle(i, lay, dt, ends, table, cell, x, v, mass, weight, face, bond, joined, &
                            row, slice, count, list, touch(i), press(1, i), lost)
        energy(i) = energy(i) + lost/mass(i)
        heat(i) = heat(i) + lost
    end subroutine press_links

    !> Forces of contact on a particle, its shares of the energies, and what time step it bears.
    !@cuf attributes(host,device) &
    pure subroutine push_particle(i, lay, dt, ends, table, cell, x, v, mass, weight, stress, &
                                  pair, press, face, bond, joined, row, slice, count, list, f, &
                                  kept, gain, limit)
        integer, intent(in) :: i
        type(link_layout_t), intent(in) :: lay
        real(dp), intent(in) :: dt !! step just made, 0: none [s]
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(rk), intent(in) :: cell(*)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*), stress(*)
        real(real32), intent(in) :: weight(*)
        real(rk), intent(inout) :: pair(n_pair, *) !! to that of i: the stress by its face
        real(rk), intent(in) :: press(n_press, *)
        real(real32), intent(inout) :: face(*) !! see brz_contact_face
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        real(rk), intent(out) :: f(n_terms) !! springs; at_drag: what makes heat; at_stiff: moment
        real(dp), intent(out) :: kept(n_kept) !! [J]
        real(rk), intent(out) :: gain !! heat of the particle itself [J]
        real(dp), intent(inout) :: limit !! largest stable time step [s]
        real(rk) :: s(3), r(3), dv(3), own, other, energy, lost, stiffness, damping, d, vr
        integer :: a, b, j, k, n, q, t, u
        integer(int32) :: next
        integer(int64) :: at

        a = owner_of(lay%bodies, ends, i)
        b = a
        do t = 1, n_terms
            f(t) = 0
        end do
        call links_of(lay, i, row, slice, count, q, n, at)
        own = cell(a)*mass(i)*weight(i)
        energy = 0
        lost = 0
        stiffness = 0
        damping = 0
        if (press(1, q) > 0) then
            energy = own*press(1, q)*press(1, q)/(2*press(5, q))
            d = 0
            do t = 2, 4
                d = d + press(t, q)*press(t, q)
            end do
            stiffness = own*press(5, q)*d
        end if
        do k = 1, n
            call look_ahead(lay, list, at, k, n, i, x, v, next, j, s, r, dv)
            d = sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3))
            vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
            b = next_owner(lay%bodies, ends, j, b)
            if (d > 2*table(a, b)%h) cycle
            if (table(a, b)%law /= law_shared) then
                if (is_tied(table(a, b), bond(i), bond(j), joined(i), joined(j))) cycle
            end if
            if (vr < 0) limit = min(limit, crossing_share*table(a, b)%spacing*d/(-real(vr, dp)))
            if (table(a, b)%law == law_shared) cycle
            u = j
            if (lay%compact == 1) u = row(j)
            other = cell(b)*mass(j)*weight(j)
            call add_pair(lay, table(a, b), table(b, a), real(dt, rk), own, other, mass(i), &
                          mass(j), s, r, dv, d, vr, press(1, q), press(1, u), pair(1, i), &
                          pair(1, j), trace_at(lay, stress, i), trace_at(lay, stress, j), &
                          is_freed(table(a, b), bond(i), bond(j), joined(i), joined(j)), f, &
                          energy, lost, stiffness, damping)
        end do
        if (stiffness > 0 .and. .not. table(a, a)%rigid) & ! see rigid_step
            limit = min(limit, spring_share*sqrt(real(mass(i), dp)/stiffness))
        if (damping > 0) limit = min(limit, real(mass(i), dp)/damping)
        if (table(a, a)%reach(1) > 0) call push_by_face(lay, i, f(at_work), press(2, q), &
            press(6, q), pair(pair_stress + 1, i), face)
        gain = real(dt, rk)*(f(at_heat) + f(at_friction)) + lost
        kept(kept_energy) = energy
        kept(kept_heat) = dt*f(at_heat) + lost
        kept(kept_rub) = dt*f(at_friction)
        kept(kept_early) = dt/2*(f(at_heat) + f(at_friction))
    end subroutine push_particle

    !> Give the row of a particle what the springs bring by its face, and the face its new normal.
    !@cuf attributes(host,device) &
    pure subroutine push_by_face(lay, i, push, slope, row, stress, face)
        type(link_layout_t), intent(in) :: lay
        integer, intent(in) :: i
        real(rk), intent(in) :: push !! on the face [N]
        real(rk), intent(in) :: slope(3) !! of the kernel sum [1/m]
        real(rk), intent(in) :: row(3) !! see strain_face
        real(rk), intent(inout) :: stress(9) !! of the row of the particle
        real(real32), intent(inout) :: face(*)
        real(rk) :: normal(3)
        integer :: t

        do t = 1, 3
            normal(t) = face(face_at(lay, i, face_normal + t))
        end do
        if (push > 0) call add_push_by_face(push, normal, row, stress)
        call turn_normal(slope, normal)
        do t = 1, 3
            face(face_at(lay, i, face_normal + t)) = real(normal(t), real32)
        end do
    end subroutine push_by_face

    !> Sum of the normal stresses of a particle.
    !@cuf attributes(host,device) &
    pure function trace_at(lay, stress, p) result(total)
        type(link_layout_t), intent(in) :: lay
        real(rk), intent(in) :: stress(*)
        integer, intent(in) :: p
        real(rk) :: total(3)
        integer(int64) :: at
        integer :: t

        at = (p - 1_int64)*lay%stride_p + 1
        do t = 1, 3
            total(t) = stress(at + (t - 1_int64)*lay%step_c)
        end do
    end function trace_at

    !> What a link adds to the sums of a particle.
    !@cuf attributes(host,device) &
    pure subroutine add_pair(lay, m, back, dt, own, other, mass_i, mass_j, s, r, dv, distance, &
                             vr, p, q, pair_i, pair_j, stress_i, stress_j, fresh, f, energy, &
                             lost, stiffness, damping)
        type(link_layout_t), intent(in) :: lay
        type(interaction_t), intent(in) :: m, back !! law of i with j, of j with i
        real(rk), intent(in) :: dt, own, other !! step just made [s], volumes of the cells [m3]
        real(rk), intent(in) :: mass_i, mass_j !! [kg]
        real(rk), intent(in) :: s(3), r(3), dv(3), distance, vr
        real(rk), intent(in) :: p(n_press), q(n_press), pair_i(n_pair), pair_j(n_pair)
        real(rk), intent(in) :: stress_i(3), stress_j(3)
        logical, intent(in) :: fresh !! without contact until this step
        real(rk), intent(inout) :: f(n_terms), energy, lost, stiffness, damping !! at_work: force
                                                                                !! on the face
        real(rk) :: slip(3), n(3), g(3), z(3), spin_i(3), spin_j(3), moment(3), heat(2)
        real(rk) :: cells, slope, u, core, area, toward, share, w
        integer :: t

        slope = kernel_slope(m%scale, m%half_over_h, distance)
        cells = own*other/lay%depth
        f(at_work) = f(at_work) + cells*kernel_value(slope, m%h, distance) &
                     *(p(1)*m%steep/m%touch + q(1)*back%steep/back%touch)
        call contact_push(m, cells*slope, p(1)/m%touch + q(1)/back%touch, distance, u, core)
        energy = energy + core/2
        lost = lost + core_loss(m, fresh, dt, r, dv)/2
        do t = 1, 3
            f(t) = f(t) + u*r(t)
        end do
        share = 0
        if (m%shared) then ! its limit ahead of the first touch
            w = shared_volume(m, mass_i, pair_i(pair_volume), mass_j, pair_j(pair_volume)) &
                *slope/lay%depth
            share = viscous_force(w, m%h, distance*distance, vr, &
                                  pair_i(pair_linear) + pair_j(pair_linear), &
                                  pair_i(pair_quadratic) + pair_j(pair_quadratic))
            damping = damping + drag_stiffness(share, distance*distance, vr)
            share = share + w*max(-(stress_i(1) + stress_i(2) + stress_i(3) + stress_j(1) &
                                    + stress_j(2) + stress_j(3))/3, 0.0_rk)
        end if
        if (.not. (p(1) + q(1) > 0 .or. core > 0)) return
        do t = 1, 3
            g(t) = p(1 + t)
            z(t) = s(t)*q(1 + t)
            spin_i(t) = pair_i(pair_spin + t)
            spin_j(t) = s(1)*s(2)*s(3)*s(t)*pair_j(pair_spin + t)
            moment(t) = f(at_stiff + t)
        end do
        call contact_normal(p(1), g, q(1), z, r, n)
        toward = r(1)*n(1) + r(2)*n(2) + r(3)*n(3)
        area = cells*slope*max(toward, 0.0_rk)*2/(m%slope + back%slope)
        call surface_velocity(m, r, dv, spin_i, spin_j, slip)
        call contact_drag(m, area, u*toward, slip, n, g, heat)
        call add_moment(m, r, g, moment)
        stiffness = stiffness + cells*q(5)*(slope*distance/back%touch)**2*own/lay%depth
        if (core > 0) stiffness = stiffness + m%core/(m%spacing/2)
        do t = 1, 3
            f(at_stiff + t) = moment(t)
            f(at_drag + t) = f(at_drag + t) + g(t)
            f(at_drag + t) = f(at_drag + t) + share*r(t)
        end do
        f(at_heat) = f(at_heat) + heat(1)/2
        f(at_heat) = f(at_heat) - share*vr/2
        f(at_friction) = f(at_friction) + heat(2)/2
    end subroutine add_pair

    !> Forces of contact, heat, the diagnostics, and what time step the links bear.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine push_links(k, touching, particles, lay, dt, ends, table, cell, x, v, mass, &
                               weight, stress, pair, press, face, bond, joined, row, slice, &
                               count, list, energy, held, early, heat, rub, rate, extra)
        integer, intent(in) :: k !! particles that may touch
        integer(int32), intent(in) :: touching(*) !! they
        integer, intent(in) :: particles !! all
        type(link_layout_t), intent(in) :: lay
        real(dp), intent(in) :: dt !! [s]
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(rk), intent(in) :: cell(*)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*), stress(*)
        real(real32), intent(in) :: weight(*)
        real(rk), intent(inout) :: pair(n_pair, *)
        real(rk), intent(in) :: press(n_press, *)
        real(real32), intent(inout) :: face(*)
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        real(rk), intent(inout) :: energy(*)
        real(dp), intent(inout) :: held(*), early(*), heat(*), rub(*) !! see n_kept [J]
        real(dp), intent(inout) :: rate(*) !! 1/(largest stable time step) [1/s]
        real(rk), intent(inout) :: extra(particles, *) !! n_terms columns, what pass 2 starts from
        real(rk) :: f(n_terms), gain
        real(dp) :: kept(n_kept), limit
        integer :: i, t

        i = touching(k)
        limit = huge(limit)
        call push_particle(i, lay, dt, ends, table, cell, x, v, mass, weight, stress, pair, &
                           press, face, bond, joined, row, slice, count, list, f, kept, gain, &
                           limit)
        rate(i) = max(rate(i), 1/limit)
        do t = 1, 3
            extra(i, t) = f(t)
            extra(i, at_drag + t) = f(at_drag + t)
            extra(i, at_stiff + t) = f(at_stiff + t)
        end do
        energy(i) = energy(i) + gain/mass(i)
        held(i) = kept(kept_energy)
        early(i) = kept(kept_early)
        heat(i) = heat(i) + kept(kept_heat)
        rub(i) = rub(i) + kept(kept_rub)
    end subroutine push_links
end module brz_contact_loop_bodies
