! SPDX-License-Identifier: MIT
!> Artificial stress: a short-range repulsion between particles in tension, against clumping,
!> the tensile instability of SPH.
!>
!> Between two particles it is the force m_i m_j F_ij (W_ij/W(dx))^n (R_i + R_j) x_ij with
!> n = W(0)/W(dx). It belongs to the uncorrected form of the paper;
!> docs/evidence/verification.md shows what it can and cannot do. Point physics.
!>
!> Source: Monaghan 2000, Gray, Monaghan & Swift 2001; docs/theory/solids.md
module brz_artificial_stress
    use brz_algebra, only: to_matrix
    use brz_eigen, only: diagonalise
    use brz_formulation_names, only: artificial_gray
    use brz_kinds, only: rk
    implicit none
    private
    public :: artificial_stress

contains

    !> R of a particle: strength times its tension over density squared.
    !@cuf attributes(host,device) &
    pure subroutine artificial_stress(kind, strength, density, stress, r)
        integer, intent(in) :: kind !! one of the above
        real(rk), intent(in) :: strength !! share of the tension that is taken back
        real(rk), intent(in) :: density !! [kg/m3]
        real(rk), intent(in) :: stress(6) !! xx, yy, zz, xy, yz, xz, tension positive [Pa]
        real(rk), intent(out) :: r(3, 3) !! [Pa m6/kg2]
        real(rk) :: a(3, 3), q(3, 3), s(3), c
        integer :: i, j

        c = strength/(density*density)
        if (kind == artificial_gray) then
            call to_matrix(stress, a)
            call diagonalise(a, q)
            do i = 1, 3
                s(i) = c*max(a(i, i), 0.0_rk)
            end do
            do j = 1, 3
                do i = 1, 3
                    r(i, j) = s(1)*q(i, 1)*q(j, 1) + s(2)*q(i, 2)*q(j, 2) + s(3)*q(i, 3)*q(j, 3)
                end do
            end do
        else
            do j = 1, 3
                do i = 1, 3
                    r(i, j) = 0
                end do
                r(j, j) = c*max((stress(1) + stress(2) + stress(3))/3, 0.0_rk)
            end do
        end if
    end subroutine artificial_stress
end module brz_artificial_stress
