! SPDX-License-Identifier: MIT
!> What one particle adds to the totals of its body. Point physics: compiled for the CPU and for the
!> GPU.
module brz_particle_sums
    use brz_kinds, only: dp
    implicit none
    private
    public :: add_particle, n_sum

    integer, parameter :: n_sum = 16 !! sums, see totals_of_sums

contains

    !> Add mass, first moments, momentum, angular momentum, energies, damage, and what is outside of
    !> the region or has been taken out.
    !@cuf attributes(host,device) &
    pure subroutine add_particle(m, x, v, energy, damage, region, gone, sums)
        real(dp), intent(in) :: m !! mass [kg]
        real(dp), intent(in) :: x(3), v(3) !! place, velocity at the step [m, m/s]
        real(dp), intent(in) :: energy, damage !! internal energy [J/kg], damage [-]
        real(dp), intent(in) :: region(3, 2) !! corners [m]
        logical, intent(in) :: gone !! it has been taken out of the computation
        real(dp), intent(inout) :: sums(n_sum)
        integer :: c
        logical :: outside

        outside = .false.
        do c = 1, 3
            if (x(c) < region(c, 1) .or. x(c) > region(c, 2)) outside = .true.
            sums(1 + c) = sums(1 + c) + m*x(c)
            sums(4 + c) = sums(4 + c) + m*v(c)
        end do
        sums(1) = sums(1) + m
        sums(8) = sums(8) + m*(x(2)*v(3) - x(3)*v(2))
        sums(9) = sums(9) + m*(x(3)*v(1) - x(1)*v(3))
        sums(10) = sums(10) + m*(x(1)*v(2) - x(2)*v(1))
        sums(11) = sums(11) + m*(v(1)*v(1) + v(2)*v(2) + v(3)*v(3))/2
        sums(12) = sums(12) + m*energy
        sums(13) = sums(13) + m*damage
        if (outside) sums(14) = sums(14) + m
        if (.not. gone) return
        sums(15) = sums(15) + m
        sums(16) = sums(16) + m*((v(1)*v(1) + v(2)*v(2) + v(3)*v(3))/2 + energy)
    end subroutine add_particle
end module brz_particle_sums
