! SPDX-License-Identifier: MIT
!> The stress at a loaded face. Point physics.
!>
!> A load acts on the face of a body, half a layer outside the particles of its outermost layer. Its
!> work is that on the velocity of the face, v + L q, where q points from the particle to its face.
!> So a traction t on the area A of a particle is, besides the force A t, the stress A t (x) q/V,
!> taken off the stress of the particle in the forces of pairs: the adjoint of L q. Without it the
!> force alone meets half of the traction in the outermost layer, as its corrected gradient sees
!> neighbours on one side and weighs them twice. |q| A/V is `face_share`, some 0.47.
!>
!> Source: docs/theory/solids.md, loaded faces
module brz_face_stress
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: add_face_stress, face_share, face_work

contains

    !> Add the stress of a pressure on a face, -p n (x) n.
    !@cuf attributes(host,device) &
    pure subroutine add_face_stress(p, area, tau)
        real(rk), intent(in) :: p !! [Pa]
        real(rk), intent(in) :: area(3) !! along its normal [m2]
        real(rk), intent(inout) :: tau(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk) :: w

        w = area(1)*area(1) + area(2)*area(2) + area(3)*area(3)
        if (.not. w > 0) return
        w = p/w
        tau(1) = tau(1) - w*area(1)*area(1)
        tau(2) = tau(2) - w*area(2)*area(2)
        tau(3) = tau(3) - w*area(3)*area(3)
        tau(4) = tau(4) - w*area(1)*area(2)
        tau(5) = tau(5) - w*area(2)*area(3)
        tau(6) = tau(6) - w*area(1)*area(3)
    end subroutine add_face_stress

    !> Power of the stress of a face per volume, tau : L [W/m3].
    !@cuf attributes(host,device) &
    pure function face_work(tau, l) result(power)
        real(rk), intent(in) :: tau(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(in) :: l(3, 3) !! velocity gradient [1/s]
        real(rk) :: power

        power = tau(1)*l(1, 1) + tau(2)*l(2, 2) + tau(3)*l(3, 3) + tau(4)*(l(1, 2) + l(2, 1)) &
                + tau(5)*(l(2, 3) + l(3, 2)) + tau(6)*(l(1, 3) + l(3, 1))
    end function face_work

    !> The share c of the traction that a particle below a flat face of a regular lattice takes as a
    !> stress.
    !>
    !> With the gradient D across the layers, a uniform unit stress asks for the forces a = D^T 1:
    !> on a few layers, where the load is e, 1 on the first. c is the projection of what is missing,
    !> a - e, on what a stress in the first layer gives, D^T e. It is near 1/2, the distance of the
    !> face in spacings.
    pure real(rk) function face_share(dimension, h) result(share)
        integer, intent(in) :: dimension
        real(rk), intent(in) :: h !! smoothing length over spacing
        integer, parameter :: half = 9 !! layers, more than any pair reaches
        integer, parameter :: most = 2*half - 1
        real(dp) :: d(most, most), missing(most)

        d = layer_gradient(dimension, real(h, dp), most)
        missing = sum(d, dim=1)
        missing(1) = missing(1) - 1
        missing(half:) = 0 ! what the other end of the lattice asks for
        share = real(dot_product(missing, d(1, :))/dot_product(d(1, :), d(1, :)), rk)
    end function face_share

    !> The gradient across the layers of a regular lattice from a face inwards, along the outward
    !> normal: value in layer j to gradient in layer i.
    pure function layer_gradient(dimension, h, n) result(d)
        integer, intent(in) :: dimension
        real(dp), intent(in) :: h !! smoothing length over spacing
        integer, intent(in) :: n !! layers
        real(dp) :: d(n, n), moment, w(0:n)
        integer :: i, j, k, m, side(2)

        side = 0
        side(:dimension - 1) = ceiling(2*h)
        w = 0
        do m = 0, n
            do k = -side(2), side(2)
                do j = -side(1), side(1)
                    w(m) = w(m) + kernel_slope(1.0_rk, real(1/(2*h), rk), &
                                               sqrt(real(j*j + k*k + m*m, rk)))
                end do
            end do
        end do
        d = 0
        do i = 1, n
            moment = 0
            do j = 1, n
                moment = moment + w(abs(i - j))*(i - j)**2
            end do
            do j = 1, n
                if (j == i) cycle
                d(i, j) = w(abs(i - j))*(i - j)/moment
                d(i, i) = d(i, i) - d(i, j)
            end do
        end do
    end function layer_gradient
end module brz_face_stress
