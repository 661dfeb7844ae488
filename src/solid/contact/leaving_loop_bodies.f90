! SPDX-License-Identifier: MIT
!> Particles that leave the region, one at a time. There is no other erosion of particles.
module brz_leaving_loop_bodies
    use brz_bond_marks, only: loose_by
    use brz_contact, only: crossing_share, in_core
    use brz_contact_loop_bodies, only: look_along, owner_of
    use brz_contact_release, only: is_tied
    use brz_interaction, only: law_shared, interaction_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_link_layout, only: link_layout_t, links_of, n_press
    use brz_particle_marks, only: is_free, is_gone, is_leaving
    implicit none
    private
    public :: leave_region, stay_pressed, let_go, take_out

contains

    !> Mark a particle that moves freely and has left the region since the start.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine leave_region(p, first, wide, region, x, x_ref, fixed)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of the places
        real(dp), intent(in) :: region(3, 2) !! corners [m]
        real(dp), intent(in) :: x(wide, *), x_ref(wide, *) !! [m]
        integer(int32), intent(inout) :: fixed(*)
        logical :: inside, was_inside
        integer :: c, i

        i = first - 1 + p
        if (fixed(i) /= is_free) return
        inside = .true.
        was_inside = .true.
        do c = 1, 3
            inside = inside .and. x(c, i) >= region(c, 1) .and. x(c, i) <= region(c, 2)
            was_inside = was_inside .and. x_ref(c, i) >= region(c, 1) &
                         .and. x_ref(c, i) <= region(c, 2)
        end do
        if (was_inside .and. .not. inside) fixed(i) = is_leaving
    end subroutine leave_region

    !> What is glued stays for the time being, and what contact at the present places pushes, or may
    !> after one more step: contact holds energy.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine stay_pressed(p, first, glued, lay, ends, table, x, v, press, bond, joined, &
                                 row, slice, count, list, fixed)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: glued !! 1: `joined` says what cohesive interfaces hold
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), press(n_press, *)
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        integer(int32), intent(inout) :: fixed(*)
        real(rk) :: s(3), r(3), dv(3), distance
        integer :: a, b, i, j, k, n, q, u
        integer(int64) :: at

        i = first - 1 + p
        if (fixed(i) /= is_leaving) return
        if (glued == 1) then
            if (iand(joined(i), ibset(0, loose_by) - 1) /= 0) fixed(i) = is_free
        end if
        call links_of(lay, i, row, slice, count, q, n, at)
        a = owner_of(lay%bodies, ends, i)
        do k = 0, n - 1
            call look_along(lay, list(at + k*lay%side), i, x, v, j, s, r, dv)
            b = owner_of(lay%bodies, ends, j)
            if (table(a, b)%law /= law_shared) then
                if (is_tied(table(a, b), bond(i), bond(j), joined(i), joined(j))) cycle
            end if
            distance = sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3))
            if (distance > 2*table(a, b)%h) cycle
            u = j
            if (lay%compact == 1) u = row(j)
            if (press(1, q) + press(1, u) > 0 .or. table(a, b)%law == law_shared .or. &
                in_core(table(a, b), distance - real(crossing_share, rk)*table(a, b)%spacing)) &
                fixed(i) = is_free
        end do
    end subroutine stay_pressed

    !> What the tensile control owes to a particle that leaves becomes heat.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine let_go(p, first, fixed, mass, control_due, energy)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(in) :: mass(*) !! [kg]
        real(rk), intent(inout) :: control_due(*) !! [J]
        real(rk), intent(inout) :: energy(*) !! [J/kg]
        integer :: i

        i = first - 1 + p
        if (fixed(i) /= is_leaving) return
        energy(i) = energy(i) + control_due(i)/mass(i)
        control_due(i) = 0
    end subroutine let_go

    !> Take a particle that leaves out: it has no force from now on.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine take_out(p, first, stride_d, stride_p, loaded, accel, load, fixed)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in forces
        integer, intent(in) :: loaded !! 1: `load` is there
        real(rk), intent(inout) :: accel(*), load(*) !! [m/s2], [N]
        integer(int32), intent(inout) :: fixed(*)
        integer :: at, d, i

        i = first - 1 + p
        if (fixed(i) /= is_leaving) return
        fixed(i) = is_gone
        do d = 1, 3
            at = 1 + (i - 1)*stride_p + (d - 1)*stride_d
            accel(at) = 0
            if (loaded == 1) load(at) = 0
        end do
    end subroutine take_out
end module brz_leaving_loop_bodies
