! SPDX-License-Identifier: MIT
!> Particles of rigid bodies: what brz_rigid_steps leaves to each backend.
module brz_solid_rigid
    use brz_cohesive_state, only: push_of
    use brz_exact_sum, only: add_terms, close_sums, limbs, open_sums, scale_t, widen
    use brz_kinds, only: dp, int64, rk
    use brz_rigid, only: cross
    use brz_solid_state, only: body_t, form_rigid, solid_t
    implicit none
    private
    public :: sum_pushes, settle_drag

contains

    !> Force and torque of contact and of interfaces on rigid bodies: exact sums, as they act back.
    subroutine sum_pushes(solid, dt, push)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(out) :: push(6, size(solid%bodies)) !! [N], [N m]
        type(scale_t) :: scales(6)
        real(dp) :: largest(6)
        integer(int64) :: limb(limbs, 6)
        integer :: b, i

        push = 0
        do b = 1, merge(size(solid%bodies), 0, solid%links%present)
            associate (body => solid%bodies(b))
                if (body%formulation /= form_rigid .or. body%asleep .and. dt > 0) cycle
                largest = 0
                do i = body%first, body%last
                    if (is_pushed(i)) call widen(push_on(body, i), largest)
                end do
                call open_sums(solid%ranks, largest, scales)
                limb = 0
                do i = body%first, body%last
                    if (is_pushed(i)) call add_terms(scales, push_on(body, i), limb)
                end do
                call close_sums(solid%ranks, scales, limb, push(:, b))
            end associate
        end do

    contains

        pure logical function is_pushed(i)
            integer, intent(in) :: i

            is_pushed = solid%cohesive%present .or. solid%links%row(i) > 0
        end function is_pushed

        pure function push_on(body, i) result(f)
            type(body_t), intent(in) :: body
            integer, intent(in) :: i
            real(dp) :: f(6)

            associate (push => solid%links%push(:, solid%links%row(i)))
                f(1:3) = push(1:3) + push(4:6)
                if (solid%cohesive%present) f(1:3) = f(1:3) + push_of(solid%cohesive, solid%id(i))
                f(4:6) = cross(solid%x(:, i) - body%rigid%x, f(1:3)) + push(7:9)
            end associate
        end function push_on
    end subroutine sum_pushes

    !> The heat of drag is that of the velocity before the kick; it works with the mean of those
    !> before and after it (see `accelerate` of brz_solid_forces).
    subroutine settle_drag(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp) :: heat
        integer :: b, i

        do b = 1, merge(size(solid%bodies), 0, solid%links%present .and. dt > 0)
            associate (body => solid%bodies(b))
                if (body%formulation /= form_rigid .or. body%asleep) cycle
                do i = body%first, body%last
                    associate (push => solid%links%push(:, solid%links%row(i)))
                        heat = -dt*(dt/2*dot_product(push(4:6), solid%a(:, i)) &
                                    + dot_product(push(7:9), body%rigid%omega - body%rigid%spin))
                    end associate
                    solid%energy(i) = solid%energy(i) + real(heat/solid%mass(i), rk)
                    body%ledger%contact_heat = body%ledger%contact_heat + heat
                end do
            end associate
        end do
    end subroutine settle_drag
end module brz_solid_rigid
