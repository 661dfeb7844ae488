! SPDX-License-Identifier: MIT
!> Velocities of the walls, from the particles in the solid cells.
module brz_velocity_loop_bodies
    use brz_driven_body_rules, only: carried_velocity, driven_body_at, driven_body_t, is_carried
    use brz_cell_place, only: cell_middle
    use brz_column_loop_bodies, only: depth_weight, force_from, look_ahead
    use brz_column_rules, only: direction_of
    use brz_coupling_box, only: box_t
    use brz_kinds, only: dp, int32, rk
    use brz_cell_store_loop_bodies, only: faces_at
    use brz_load_rules, only: pushed_velocity
    use brz_particle_marks, only: is_fixed
    implicit none
    private
    public :: mean_velocity_of, find_wall_velocity, keep_velocity
    public :: driven_body_of

    integer, parameter :: at_once = 4 !! particles of a bin

contains

    !> The body that carries a particle, or 0.
    !@cuf attributes(host,device) &
    pure function driven_body_of(bodies, driven, p, fixed) result(b)
        integer, intent(in) :: bodies
        type(driven_body_t), intent(in) :: driven(bodies)
        integer, intent(in) :: p !! particle
        integer(int32), intent(in) :: fixed !! how it is held
        integer :: b

        b = driven_body_at(bodies, driven, p)
        if (.not. is_carried(driven(b)%carries, fixed == is_fixed)) b = 0
    end function driven_body_of

    !> Velocity that a body gives to the walls of the cell that holds a particle of it [m/s].
    !@cuf attributes(host,device) &
    pure function carried_at(box, driven, x) result(v)
        type(box_t), intent(in) :: box
        type(driven_body_t), intent(in) :: driven
        real(dp), intent(in) :: x(3) !! of the particle [m]
        real(rk) :: v(3)
        real(dp) :: middle(3)

        middle = cell_middle(x, box%lo, box%dx)
        v = carried_velocity(driven, middle)
    end function carried_at

    !> Particles of a bin from one on, their masses, how they are held, and those behind them.
    !@cuf attributes(host,device) &
    pure subroutine take_some(first, last, binned, mass, fixed, next, some, m, hold)
        integer, intent(in) :: first, last !! of the bin
        integer(int32), intent(in) :: binned(*), fixed(*)
        real(rk), intent(in) :: mass(*)
        integer, intent(inout) :: next(at_once) !! from the first on, then those behind
        integer, intent(out) :: some(at_once)
        real(rk), intent(out) :: m(at_once) !! [kg]
        integer(int32), intent(out) :: hold(at_once)
        integer :: q

        do q = 1, at_once
            some(q) = next(q)
            m(q) = mass(next(q))
            hold(q) = fixed(next(q))
        end do
        call look_ahead(at_once, first + at_once, last, binned, next)
    end subroutine take_some

    !> Give each solid cell the mean velocity by mass of its particles: at the step where a body
    !> carries them, else as it is kept, half a step before. One that has none is at rest. Each
    !> direction of a cell is a loop body of its own: three threads of a GPU side by side read the
    !> same rows.
    !@loop_body if(9*n >= worth_threads) schedule(static, 192)
    !@cuf attributes(host,device) &
    pure subroutine mean_velocity_of(t, box, wide, bodies, driven, ends, binned, x, v, mass, &
                                     fixed, v_wall)
        integer, intent(in) :: t !! directions of solid cells
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide, bodies !! rows of x and v, bodies
        type(driven_body_t), intent(in) :: driven(bodies)
        integer(int32), intent(in) :: ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: v(wide, *), mass(*)
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(inout) :: v_wall(3, *)
        real(rk) :: m(at_once), now(at_once), total, momentum, w(3)
        integer :: b, c, d, hold(at_once), i, next(at_once), q, some(at_once)

        c = (t - 1)/3 + 1
        d = t - 3*(c - 1)
        total = 0
        momentum = 0
        call look_ahead(at_once, ends(c) + 1, ends(c + 1), binned, next)
        do i = ends(c) + 1, ends(c + 1), at_once
            call take_some(i, ends(c + 1), binned, mass, fixed, next, some, m, hold)
            do q = 1, at_once
                now(q) = v(d, some(q))
            end do
            do q = 1, at_once
                if (i + q - 1 > ends(c + 1)) exit
                b = driven_body_of(bodies, driven, some(q), hold(q))
                if (b > 0) then
                    w = carried_at(box, driven(b), x(1, some(q)))
                    now(q) = along(d, w)
                end if
                total = total + m(q)
                momentum = momentum + m(q)*now(q)
            end do
        end do
        v_wall(d, c) = momentum/max(total, tiny(total))
    end subroutine mean_velocity_of

    !> Carry each wall to the middle of the step, in the directions in which it meets gas.
    !>
    !> What a body carries goes on with it. The rest of the mass of a cell goes on as it did in the
    !> last step of the air, changed by what the gas, spread as a load will be, now pushes more. So
    !> a body that holds against the pressure does not seem to give way, as it would if the gas
    !> alone pushed. Cells with fixed particles stay at the mean. Each direction of a cell is an
    !> loop body of its own: three threads of a GPU side by side read the same rows.
    !@loop_body if(9*n >= worth_threads) schedule(dynamic, 192)
    !@cuf attributes(host,device) &
    pure subroutine find_wall_velocity(t, box, wide, stride_d, stride_p, bodies, dt, dt_before, &
                              driven, gas, rows, owner, face_of, above, ends, binned, x, v, mass, &
                              load, v_before, id, fixed, surface, weight, force, impedance, v_wall)
        integer, intent(in) :: t !! directions of solid cells
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide, bodies !! rows of x and v, bodies
        integer, intent(in) :: stride_d, stride_p !! distances in `load` of directions, of particles
        real(rk), intent(in) :: dt, dt_before !! this and the last step of the air, 0: none [s]
        type(driven_body_t), intent(in) :: driven(bodies) !! in the middle of the step
        integer(int32), intent(in) :: gas(*), rows(*), owner(*)
        integer, intent(in) :: face_of(6, *), above(6, *)
        integer(int32), intent(in) :: ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: v(wide, *), mass(*), load(*)
        real(rk), intent(in) :: v_before(3, *) !! by the number of a particle, a step ago [m/s]
        integer(int32), intent(in) :: id(*), fixed(*)
        real(dp), intent(in) :: surface(*)
        real(rk), intent(in) :: weight(*), force(*), impedance(*)
        real(rk), intent(inout) :: v_wall(3, *)
        real(rk) :: all_force, carried, change, gas_load, momentum, own, part, speed, total, z
        real(rk) :: w(3)
        real(rk), dimension(at_once) :: before, loads, m, now
        integer :: b, c, d, f, hold(at_once), i, next(at_once), q, row, side, some(at_once)
        logical :: held

        c = (t - 1)/3 + 1
        d = t - 3*(c - 1)
        if (faces_at(c, face_of) == 0) return
        held = .false.
        total = 0
        carried = 0
        own = 0
        momentum = 0
        all_force = 0
        gas_load = 0
        call look_ahead(at_once, ends(c) + 1, ends(c + 1), binned, next)
        do i = ends(c) + 1, ends(c + 1), at_once
            call take_some(i, ends(c + 1), binned, mass, fixed, next, some, m, hold)
            do q = 1, at_once
                now(q) = v(d, some(q))
                if (.not. dt_before > 0) cycle
                before(q) = v_before(d, id(some(q)))
                loads(q) = load(1 + (d - 1)*stride_d + (some(q) - 1)*stride_p)
            end do
            do q = 1, at_once
                if (i + q - 1 > ends(c + 1)) exit
                held = held .or. hold(q) == is_fixed
                b = driven_body_of(bodies, driven, some(q), hold(q))
                if (b > 0) then
                    w = carried_at(box, driven(b), x(1, some(q)))
                    carried = carried + m(q)
                    momentum = momentum + m(q)*along(d, w)
                    cycle
                end if
                total = total + m(q)
                own = own + m(q)*now(q)
                if (.not. dt_before > 0) cycle
                gas_load = gas_load + loads(q)
                all_force = all_force + m(q)*(now(q) - before(q))/dt_before
            end do
        end do
        speed = 0
        if (total > 0) speed = own/total
        if (total > 0 .and. .not. held .and. box%n(d) > 1 &
            .and. max(face_of(2*d - 1, c), face_of(2*d, c)) > 0) then
            z = 0
            change = -gas_load
            do side = 0, 1
                row = 2*d - side
                f = above(row, c)
                if (f == 0) cycle
                part = share_of_face(c, box, rows(f), row, gas(f), surface(f), wide, bodies, &
                                     driven, ends, binned, x, mass, fixed)/weight(f)
                change = change + part*force_from(rows(f), row, force(f))
                if (owner(f) == c .and. rows(f) == row) z = z + part*impedance(f)
            end do
            speed = pushed_velocity(speed, all_force, change, z, total, dt)
        end if
        v_wall(d, c) = (total*speed + momentum)/(total + carried)
    end subroutine find_wall_velocity

    !> A number of three. Spelled out: a kernel keeps what it indexes at run time in local memory.
    !@cuf attributes(host,device) &
    pure real(rk) function along(d, x) result(number)
        integer, intent(in) :: d
        real(rk), intent(in) :: x(3)

        number = merge(x(1), merge(x(2), x(3), d == 2), d == 1)
    end function along

    !> Weight of the particles of a cell that nothing carries in the load of a face [kg].
    !@cuf attributes(host,device) &
    pure function share_of_face(c, box, row, seen, gas, surface, wide, bodies, driven, ends, &
                                binned, x, mass, fixed) result(part)
        integer, intent(in) :: c !! the cell
        type(box_t), intent(in) :: box
        integer, intent(in) :: row, seen !! side of the face, and where it is seen
        integer(int32), intent(in) :: gas !! its gas cell
        real(dp), intent(in) :: surface !! of its column [m]
        integer, intent(in) :: wide, bodies !! rows of x, bodies
        type(driven_body_t), intent(in) :: driven(bodies)
        integer(int32), intent(in) :: ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        integer(int32), intent(in) :: fixed(*)
        real(rk) :: part
        real(dp) :: y(at_once)
        real(rk) :: m(at_once)
        integer :: hold(at_once), i, next(at_once), q, some(at_once)

        part = 0
        call look_ahead(at_once, ends(c) + 1, ends(c + 1), binned, next)
        do i = ends(c) + 1, ends(c + 1), at_once
            call take_some(i, ends(c + 1), binned, mass, fixed, next, some, m, hold)
            do q = 1, at_once
                y(q) = x(direction_of(row), some(q))
            end do
            do q = 1, at_once
                if (i + q - 1 > ends(c + 1)) exit
                if (driven_body_of(bodies, driven, some(q), hold(q)) > 0) cycle
                part = part + depth_weight(box, row, seen, gas, surface, y(q), m(q))
            end do
        end do
    end function share_of_face

    !> Keep the velocities for the forces of the next step.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine keep_velocity(p, wide, stride_d, stride_p, v, id, v_before)
        integer, intent(in) :: p !! particles
        integer, intent(in) :: wide !! rows of v
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in
                                                  !! v_before
        real(rk), intent(in) :: v(wide, *)
        integer(int32), intent(in) :: id(*)
        real(rk), intent(inout) :: v_before(*)
        integer :: d

        do d = 1, 3
            v_before(1 + (id(p) - 1)*stride_p + (d - 1)*stride_d) = v(d, p)
        end do
    end subroutine keep_velocity
end module brz_velocity_loop_bodies
