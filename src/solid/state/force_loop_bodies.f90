! SPDX-License-Identifier: MIT
!> Forces on a whole body and its momentum, summed over its particles.
module brz_force_loop_bodies
    use brz_kinds, only: dp, int32, rk
    use brz_particle_marks, only: is_gone, is_fixed
    use brz_support, only: is_driven, is_kept
    implicit none
    private
    public :: sum_forces, sum_momentum, sum_region, n_forces

    integer, parameter :: n_forces = 12 !! sums of sum_forces

contains

    !> Add what a particle has of the forces on its body: force and moment of the body on what holds
    !> it, force of the load, force of other bodies. Forces between particles of a body cancel, so
    !> what is left of those on all of them comes from others.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_forces(p, first, wide, stride_d, stride_p, loaded, gripped, cx, cy, cz, x, &
                               mass, fixed, accel, load, reaction_force, total)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in forces
        integer, intent(in) :: loaded, gripped !! 1: `load`, `reaction_force` are there
        real(dp), intent(in) :: cx, cy, cz !! point of the moment [m]
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(in) :: accel(*), load(*), reaction_force(*) !! [m/s2], [N], [N]
        real(dp), intent(inout) :: total(12) !@exact [N], [N m], [N], [N]
        real(dp) :: arm(3), f, g(3), push
        integer :: at, d, i

        i = first - 1 + p
        if (fixed(i) == is_gone) return
        arm(1) = x(1, i) - cx
        arm(2) = x(2, i) - cy
        arm(3) = x(3, i) - cz
        do d = 1, 3
            at = 1 + (i - 1)*stride_p + (d - 1)*stride_d
            push = 0
            if (loaded == 1) push = load(at)
            g(d) = 0
            if (gripped == 1) g(d) = reaction_force(at)
            f = g(d)
            if (is_kept(fixed(i), d)) f = f - push
            if (fixed(i) /= is_fixed) f = f + mass(i)*real(accel(at), dp)
            total(d) = total(d) + g(d)
            total(6 + d) = total(6 + d) + push
            total(9 + d) = total(9 + d) + f
        end do
        total(4) = total(4) + (arm(2)*g(3) - arm(3)*g(2))
        total(5) = total(5) + (arm(3)*g(1) - arm(1)*g(3))
        total(6) = total(6) + (arm(1)*g(2) - arm(2)*g(1))
    end subroutine sum_forces

    !> Mass and momentum of a particle at the step; none of one that is gone.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_momentum(p, first, wide, stride_d, stride_p, half, mass, fixed, v, accel, &
    total)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of v
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in accel
        real(rk), intent(in) :: half !! half the last step [s]
        real(rk), intent(in) :: mass(*)
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(in) :: v(wide, *), accel(*) !! [m/s], [m/s2]
        real(dp), intent(inout) :: total(4) !@exact [kg], [kg m/s]
        real(dp) :: m
        integer :: d, i

        i = first - 1 + p
        if (fixed(i) == is_gone) return
        m = mass(i)
        total(1) = total(1) + m
        do d = 1, 3
            total(1 + d) = total(1 + d) &
                + m*(v(d, i) + half*accel(1 + (i - 1)*stride_p + (d - 1)*stride_d))
        end do
    end subroutine sum_momentum

    !> Add the force of a body, with its load, on a particle that a motion of it moves, and that
    !> load.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_region(p, first, region, stride_d, stride_p, loaded, fixed, load, &
    reaction_force, total)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: region !! the motion
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in forces
        integer, intent(in) :: loaded !! 1: `load` is there
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(in) :: load(*), reaction_force(*) !! [N]
        real(dp), intent(inout) :: total(6) !@exact [N]
        integer :: at, d, i

        i = first - 1 + p
        if (.not. is_driven(fixed(i), region)) return
        do d = 1, 3
            if (.not. is_kept(fixed(i), d)) cycle
            at = 1 + (i - 1)*stride_p + (d - 1)*stride_d
            total(d) = total(d) + reaction_force(at)
            if (loaded == 1) total(3 + d) = total(3 + d) + load(at)
        end do
    end subroutine sum_region
end module brz_force_loop_bodies
