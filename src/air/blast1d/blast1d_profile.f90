! SPDX-License-Identifier: MIT
!> The state of a blast in one dimension at a radius.
module brz_blast1d_profile
    use brz_bisection, only: count_up_to
    use brz_blast1d_state, only: blast1d_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: blast1d_at

contains

    !> Density, velocity and pressure at a radius, linear between the centres of the cells; the
    !> density jumps at the contact. Belongs to the last time at which the blast was prepared.
    pure subroutine blast1d_at(blast, radius, state)
        type(blast1d_t), intent(in) :: blast
        real(dp), intent(in) :: radius !! [m]
        real(dp), intent(out) :: state(3)
        real(dp) :: part
        integer :: lo, hi

        lo = count_up_to(blast%x(1:blast%n), radius)
        hi = lo + 1
        part = min((radius - blast%x(lo))/(blast%x(hi) - blast%x(lo)), 1.0_dp)
        state = blast%state(:3, lo) + part*(blast%state(:3, hi) - blast%state(:3, lo))
        if (lo /= blast%n_in) return
        state(1) = blast%state(1, merge(lo, hi, radius < blast%r(lo)))
    end subroutine blast1d_at
end module brz_blast1d_profile
