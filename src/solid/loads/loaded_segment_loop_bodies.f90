! SPDX-License-Identifier: MIT
!> Loads in scenes without air, a particle at a time: body forces, pressures on loaded segments
!> (loaded segments), what they do to a rigid body.
module brz_loaded_segment_loop_bodies
    use brz_face_stress, only: add_face_stress
    use brz_friedlander, only: friedlander_impulse
    use brz_kinds, only: dp, int32, int64, rk
    use brz_particle_marks, only: is_gone, is_fixed
    implicit none
    private
    public :: place_particle, own_carrier, mark_beside, begin_load, load_carrier, sum_load

contains

    !> Where the particle of a number lies.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine place_particle(p, first, side, id, place)
        integer, intent(in) :: p !! particles
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: side !! 1: of this process; -1: ghosts
        integer(int32), intent(in) :: id(*)
        integer(int32), intent(inout) :: place(*) !! 0 of those that are not here

        place(id(first - 1 + p)) = side*(first - 1 + p)
    end subroutine place_particle

    !> Note whether this process has a loaded particle.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine own_carrier(c, own, first, id, place, owner)
        integer, intent(in) :: c !! carriers of loaded segments
        integer, intent(in) :: own !! number of this process, from 1
        integer(int32), intent(in) :: first(*), id(*), place(*)
        integer(int32), intent(inout) :: owner(*)

        owner(c) = 0
        if (place(id(first(c))) > 0) owner(c) = own
    end subroutine own_carrier

    !> Mark the particles of this process to which loaded segments of another one span, however far
    !> they are.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine mark_beside(c, row, own, first, beside, owner, place, sent, mark)
        integer, intent(in) :: c !! carriers of loaded segments
        integer, intent(in) :: row !! marks of a process
        integer, intent(in) :: own !! number of this process, from 1
        integer(int32), intent(in) :: first(*), beside(4, *), owner(*)
        integer(int32), intent(in) :: place(*) !! of the particles of this process, else 0
        integer(int32), intent(inout) :: sent(*) !! 1: marked before
        integer(int32), intent(inout) :: mark(*)
        integer(int64) :: at
        integer :: k, m

        if (owner(c) == own) return
        do k = first(c), first(c + 1) - 1
            do m = 1, 4
                if (beside(m, k) == 0) cycle
                if (place(beside(m, k)) == 0) cycle
                at = place(beside(m, k)) + (owner(c) - 1)*int(row, int64)
                if (sent(at) == 1) cycle
                mark(at) = 1
                sent(at) = 1
            end do
        end do
    end subroutine mark_beside

    !> Begin the load of a particle by the push on its body.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine begin_load(p, first, stride_d, stride_p, ax, ay, az, mass, fixed, load)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in load
        real(dp), intent(in) :: ax, ay, az !! acceleration [m/s2]
        real(rk), intent(in) :: mass(*)
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(inout) :: load(*) !! [N]
        real(dp) :: m
        integer :: i

        i = first - 1 + p
        m = mass(i)
        if (fixed(i) == is_gone) m = 0
        load(1 + (i - 1)*stride_p) = real(m*ax, rk)
        load(1 + (i - 1)*stride_p + stride_d) = real(m*ay, rk)
        load(1 + (i - 1)*stride_p + 2*stride_d) = real(m*az, rk)
    end subroutine begin_load

    !> Add the pressures on the loaded segments of a particle to its load.
    !@loop_body if(n >= worth_threads/4) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine load_carrier(c, wide, stride_d, stride_p, stride_t, time, dt, first, id, of, &
                                 beside, mirror, width, most, side, wave, mean, place, x, fixed, &
                                 load, face_stress)
        integer, intent(in) :: c !! carriers of loaded segments
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in load
        integer, intent(in) :: stride_t !! distance of particles in face_stress
        real(dp), intent(in) :: time, dt !! start of the step, its length [s]
        integer(int32), intent(in) :: first(*), id(*), of(*), beside(4, *), mirror(4, *)
        real(dp), intent(in) :: width(2, *), most(2, *)
        integer(int32), intent(in) :: side(*)
        real(dp), intent(in) :: wave(6, *), mean(*) !! mean: pressures of the loads [Pa]
        integer(int32), intent(in) :: place(*)
        real(dp), intent(in) :: x(wide, *)
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(inout) :: load(*) !! [N]
        real(rk), intent(inout) :: face_stress(*) !! [Pa]
        real(dp) :: area(3), total(3), p
        real(rk) :: tau(6)
        integer :: d, i, k

        i = place(id(first(c)))
        if (i <= 0) return ! another process has it
        if (fixed(i) == is_gone) return
        do d = 1, 3
            total(d) = 0
            tau(d) = 0
            tau(3 + d) = 0
        end do
        do k = first(c), first(c + 1) - 1
            p = mean(of(k))
            if (wave(2, k) > 0) p = mean_of_wave(wave(1, k), time, dt)
            call area_of(k, i, wide, beside, mirror, width, most, side(k), place, x, area)
            do d = 1, 3
                total(d) = total(d) - p*area(d)
            end do
            call add_face_stress(real(p, rk), real(area, rk), tau)
        end do
        do d = 1, 3
            k = 1 + (i - 1)*stride_p + (d - 1)*stride_d
            load(k) = load(k) + real(total(d), rk)
        end do
        do d = 1, 6
            face_stress(1 + (i - 1)*stride_t + (d - 1)*stride_d) = tau(d)
        end do
    end subroutine load_carrier

    !> Mean pressure of a blast over a step, reflected and incident part [Pa].
    !@cuf attributes(host,device) &
    pure function mean_of_wave(w, time, dt) result(p)
        real(dp), intent(in) :: w(6) !! see loaded_segments_t
        real(dp), intent(in) :: time, dt !! [s]
        real(dp) :: p, t

        t = time - w(1)
        p = friedlander_impulse(w(3), w(2), w(5), t + dt) - friedlander_impulse(w(3), w(2), w(5), t)
        p = p + friedlander_impulse(w(4), w(2), w(6), t + dt) &
            - friedlander_impulse(w(4), w(2), w(6), t)
        p = p/dt
    end function mean_of_wave

    !> Area of loaded segment k, along its outward normal [m2].
    !@cuf attributes(host,device) &
    pure subroutine area_of(k, i, wide, beside, mirror, width, most, side, place, x, area)
        integer, intent(in) :: k, i !! loaded segment, its particle
        integer, intent(in) :: wide
        integer(int32), intent(in) :: beside(4, *), mirror(4, *)
        real(dp), intent(in) :: width(2, *), most(2, *)
        integer(int32), intent(in) :: side, place(*)
        real(dp), intent(in) :: x(wide, *)
        real(dp), intent(out) :: area(3)
        real(dp) :: span(3, 2), length, other(2)
        integer :: d, j(2), t, u

        do t = 1, 2
            length = 0
            do u = 1, 2
                j(u) = i
                if (beside(2*t - 2 + u, k) == 0) cycle
                if (place(beside(2*t - 2 + u, k)) /= 0) j(u) = abs(place(beside(2*t - 2 + u, k)))
            end do
            do d = 1, 3
                do u = 1, 2
                    other(u) = x(d, j(u))
                    if (mirror(2*t - 2 + u, k) == d) other(u) = -other(u)
                end do
                span(d, t) = (other(1) - other(2))*width(t, k)
                length = length + span(d, t)*span(d, t)
            end do
            length = sqrt(length)
            do d = 1, 3
                if (length > most(t, k)) span(d, t) = span(d, t)*most(t, k)/length
                ! a direction that is not modelled
                if (.not. width(t, k) > 0 .and. d == mod(abs(side) + t - 1, 3) + 1) span(d, t) = 1
            end do
        end do
        area(1) = (span(2, 1)*span(3, 2) - span(3, 1)*span(2, 2))*sign(1, side)
        area(2) = (span(3, 1)*span(1, 2) - span(1, 1)*span(3, 2))*sign(1, side)
        area(3) = (span(1, 1)*span(2, 2) - span(2, 1)*span(1, 2))*sign(1, side)
    end subroutine area_of

    !> Add the load of a particle to the force and the torque on its body.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_load(p, first, held, wide, stride_d, stride_p, cx, cy, cz, x, fixed, load, &
    push)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: held !! 1: those that are held alone
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in load
        real(dp), intent(in) :: cx, cy, cz !! centre of mass [m]
        real(dp), intent(in) :: x(wide, *)
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(in) :: load(*) !! [N]
        real(dp), intent(inout) :: push(6) !@exact force [N], torque [N m]
        real(dp) :: arm(3), f(3)
        integer :: d, i

        i = first - 1 + p
        if (held == 1 .and. fixed(i) /= is_fixed) return
        arm(1) = x(1, i) - cx
        arm(2) = x(2, i) - cy
        arm(3) = x(3, i) - cz
        do d = 1, 3
            f(d) = load(1 + (i - 1)*stride_p + (d - 1)*stride_d)
            push(d) = push(d) + f(d)
        end do
        push(4) = push(4) + (arm(2)*f(3) - arm(3)*f(2))
        push(5) = push(5) + (arm(3)*f(1) - arm(1)*f(3))
        push(6) = push(6) + (arm(1)*f(2) - arm(2)*f(1))
    end subroutine sum_load
end module brz_loaded_segment_loop_bodies
