! SPDX-License-Identifier: MIT
!> How fast bodies of a deck move against each other.
module brz_approach_speed
    use brz_case, only: body_case_t, case_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: approach_speed, closing_speed

contains

    !> Largest speed at which two bodies, a body and its mirror image, or a body and the part of it
    !> that is held or driven from the start move against each other [m/s]. What all share is none.
    pure real(dp) function approach_speed(case) result(speed)
        type(case_t), intent(in) :: case
        real(dp), allocatable :: v(:, :)
        integer :: a, b, k

        speed = 0
        do a = 1, size(case%bodies)
            v = speeds_of(case%bodies(a))
            speed = max(speed, norm2(v(:, 2) - v(:, 1)))
            do k = 1, size(v, 2)
                speed = max(speed, 2*maxval(merge(abs(v(:, k)), 0.0_dp, case%run%symmetry)))
            end do
            do b = 1, a - 1
                speed = max(speed, closing_speed(case%bodies(a), case%bodies(b)))
            end do
        end do
    end function approach_speed

    !> The same of two bodies [m/s].
    pure real(dp) function closing_speed(a, b) result(speed)
        type(body_case_t), intent(in) :: a, b
        real(dp), allocatable :: v(:, :), w(:, :)
        integer :: k

        allocate (v, source=speeds_of(a))
        allocate (w, source=speeds_of(b))
        speed = 0
        do k = 1, size(v, 2)
            speed = max(speed, maxval(norm2(w - spread(v(:, k), 2, size(w, 2)), dim=1)))
        end do
    end function closing_speed

    !> Velocities of a body (3, at least 2): at the start, of its held or driven particles, if any,
    !> at the start, and of these at later times [m/s].
    pure function speeds_of(body) result(v)
        type(body_case_t), intent(in) :: body
        real(dp), allocatable :: v(:, :)
        integer :: m

        allocate (v(3, 1 + max(body%n_motion, 1)))
        v(:, 1) = body%velocity
        v(:, 2) = 0
        if (body%n_motion > 0) then
            v(:, 2:) = body%motion_velocity(:, :body%n_motion)
            if (body%formulation == 'rigid') v(:, 1) = v(:, 2)
        else if (.not. (any(body%fix /= '') .or. body%n_fix_boxes > 0)) then
            v(:, 2) = body%velocity
        end if
        if (.not. allocated(body%regions)) return
        do m = 1, size(body%regions)
            v = reshape([v, body%regions(m)%velocity], &
                        [3, size(v, 2) + size(body%regions(m)%velocity, 2)])
        end do
    end function speeds_of
end module brz_approach_speed
