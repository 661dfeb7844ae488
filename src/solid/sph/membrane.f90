! SPDX-License-Identifier: MIT
!> Bodies of a single layer of particles: membranes whose normal turns with them.
!>
!> The sums of a layer know nothing of its normal: M has rank two, and the gradient across it is
!> missing. Left at zero, a turn of the layer is half a shear, which holds the layer straight like
!> a string under a tension of G. So M gets n (x) n, with n its normal; the gradient across turns
!> n with the layer, so that no shear across it appears, and stretches it so that its faces are
!> free of stress; the stress acts in the layer alone, and so exerts no torque. Point physics.
!>
!> Source: docs/theory/solids.md
module brz_membrane
    use brz_algebra, only: determinant3, inverse3
    use brz_kinds, only: rk
    implicit none
    private
    public :: close_layer, open_faces, turn_layer, lie_in_layer, stay_in_layer, face_power

contains

    !> Complete the moments M and the sums of X_ij (x) x_ij by the normal, and give it.
    !@cuf attributes(host,device) &
    pure subroutine close_layer(axis, m, a, normal)
        integer, intent(in) :: axis !! normal of the unloaded layer
        real(rk), intent(inout) :: m(6) !! xx, yy, zz, xy, yz, xz
        real(rk), intent(inout) :: a(9) !! column by column
        real(rk), intent(out) :: normal(3)
        real(rk) :: c(6), f(3, 3), size
        integer :: i, j

        c(1) = m(2)*m(3) - m(5)*m(5) ! cofactors: n (x) n, but for a factor
        c(2) = m(1)*m(3) - m(6)*m(6)
        c(3) = m(1)*m(2) - m(4)*m(4)
        c(4) = m(5)*m(6) - m(4)*m(3)
        c(5) = m(4)*m(6) - m(1)*m(5)
        c(6) = m(4)*m(5) - m(2)*m(6)
        if (c(1) >= c(2) .and. c(1) >= c(3)) then
            normal(1) = c(1)
            normal(2) = c(4)
            normal(3) = c(6)
        else if (c(2) >= c(3)) then
            normal(1) = c(4)
            normal(2) = c(2)
            normal(3) = c(5)
        else
            normal(1) = c(6)
            normal(2) = c(5)
            normal(3) = c(3)
        end if
        size = sqrt(normal(1)*normal(1) + normal(2)*normal(2) + normal(3)*normal(3))
        do i = 1, 3
            if (size > 0) normal(i) = normal(i)/size
            if (.not. size > 0) normal(i) = merge(1, 0, i == axis)
        end do
        do j = 1, 3
            do i = 1, 3
                f(i, j) = a(i + 3*(j - 1))
                if (i == axis) f(i, j) = f(i, j) + normal(j)
            end do
        end do
        size = sign(1.0_rk, determinant3(f)) ! the side that was up stays up
        do i = 1, 3
            normal(i) = size*normal(i)
            m(i) = m(i) + normal(i)*normal(i)
            do j = 1, 3
                if (j == axis) a(j + 3*(i - 1)) = a(j + 3*(i - 1)) + normal(i)
            end do
        end do
        m(4) = m(4) + normal(1)*normal(2)
        m(5) = m(5) + normal(2)*normal(3)
        m(6) = m(6) + normal(1)*normal(3)
    end subroutine close_layer

    !> Strain across the layer that its faces lack to be free of stress, Q^-1 sigma n.
    !>
    !> Q = n.C.n of the intact material, wherever its axes are: in a crumpled layer a fibre may
    !> stand on it. Then the stiffness across is that of the fibre, and with that of the unloaded
    !> layer each step would overshoot the last, 13 times in a ply of carbon. What is damaged is
    !> softer than intact, and never overshoots.
    !@cuf attributes(host,device) &
    pure subroutine open_faces(c, axes, normal, stress, gap)
        real(rk), intent(in) :: c(9) !! C11, C22, C33, C12, C23, C13, G12, G23, G13 [Pa]
        real(rk), intent(in) :: axes(3, 3) !! of the material, column by column
        real(rk), intent(in) :: normal(3)
        real(rk), intent(in) :: stress(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(out) :: gap(3) !! change of dv/dx n, times a time [-]
        real(rk) :: n(3), face(3), pull(3), q(3, 3), inverse(3, 3)
        integer :: i, j
        logical :: ok

        face(1) = stress(1)*normal(1) + stress(4)*normal(2) + stress(6)*normal(3)
        face(2) = stress(4)*normal(1) + stress(2)*normal(2) + stress(5)*normal(3)
        face(3) = stress(6)*normal(1) + stress(5)*normal(2) + stress(3)*normal(3)
        do i = 1, 3
            n(i) = axes(1, i)*normal(1) + axes(2, i)*normal(2) + axes(3, i)*normal(3)
            pull(i) = axes(1, i)*face(1) + axes(2, i)*face(2) + axes(3, i)*face(3)
        end do
        q(1, 1) = c(1)*n(1)**2 + c(7)*n(2)**2 + c(9)*n(3)**2
        q(2, 2) = c(7)*n(1)**2 + c(2)*n(2)**2 + c(8)*n(3)**2
        q(3, 3) = c(9)*n(1)**2 + c(8)*n(2)**2 + c(3)*n(3)**2
        q(1, 2) = (c(4) + c(7))*n(1)*n(2)
        q(2, 3) = (c(5) + c(8))*n(2)*n(3)
        q(1, 3) = (c(6) + c(9))*n(1)*n(3)
        do j = 1, 3
            do i = 1, 3
                q(i, j) = q(min(i, j), max(i, j))/c(3) ! of order 1: real32 has no room for Pa**3
            end do
        end do
        call inverse3(q, inverse, ok)
        do i = 1, 3
            n(i) = (inverse(i, 1)*pull(1) + inverse(i, 2)*pull(2) + inverse(i, 3)*pull(3))/c(3)
        end do
        do i = 1, 3
            gap(i) = axes(i, 1)*n(1) + axes(i, 2)*n(2) + axes(i, 3)*n(3)
        end do
    end subroutine open_faces

    !> The velocity gradient across the layer: it turns the normal with the layer, contracts the
    !> layer as it is stretched, and relaxes what stress the faces have all the same.
    !@cuf attributes(host,device) &
    pure subroutine turn_layer(contraction, normal, gap, rate, h)
        real(rk), intent(in) :: contraction !! strain across over minus that of the area, elastic
        real(rk), intent(in) :: normal(3)
        real(rk), intent(in) :: gap(3) !! see open_faces
        real(rk), intent(in) :: rate !! 1/step, or 0 [1/s]
        real(rk), intent(inout) :: h(3, 3) !! dv/dx [1/s]
        real(rk) :: turn(3), across(3), along, area
        integer :: i, j

        along = 0
        area = 0
        do j = 1, 3
            turn(j) = 0
            across(j) = 0
            do i = 1, 3
                turn(j) = turn(j) + normal(i)*h(i, j)
                across(j) = across(j) + h(j, i)*normal(i)
            end do
            along = along + turn(j)*normal(j)
            area = area + h(j, j)
        end do
        area = contraction*(area - along)
        do j = 1, 3
            do i = 1, 3
                h(i, j) = h(i, j) + ((along - area)*normal(i) - turn(i) - rate*gap(i) &
                                     - across(i))*normal(j)
            end do
        end do
    end subroutine turn_layer

    !> The part of B in the layer.
    !@cuf attributes(host,device) &
    pure subroutine lie_in_layer(normal, b)
        real(rk), intent(in) :: normal(3)
        real(rk), intent(inout) :: b(3, 3)
        real(rk) :: along
        integer :: i, j

        do j = 1, 3
            along = normal(1)*b(1, j) + normal(2)*b(2, j) + normal(3)*b(3, j)
            do i = 1, 3
                b(i, j) = b(i, j) - along*normal(i)
            end do
        end do
    end subroutine lie_in_layer

    !> The part in the layer of sigma B, where B has been laid in it: its normal is that of both.
    !@cuf attributes(host,device) &
    pure subroutine stay_in_layer(b, t)
        real(rk), intent(in) :: b(3, 3)
        real(rk), intent(inout) :: t(3, 3)
        real(rk) :: normal(3)

        call find_normal(b, normal)
        call lie_in_layer(normal, t)
    end subroutine stay_in_layer

    !> Power of the stress on the faces of a layer, which are free: it does not come from the
    !> forces, and so is no energy.
    !@cuf attributes(host,device) &
    pure function face_power(b, h, s) result(power)
        real(rk), intent(in) :: b(3, 3) !! correction, laid in the layer
        real(rk), intent(in) :: h(3, 3) !! dv/dx, with turn_layer [1/s]
        real(rk), intent(in) :: s(6) !! stress, xx, yy, zz, xy, yz, xz [Pa]
        real(rk) :: power !! [W/m3]
        real(rk) :: n(3), q(3), along
        integer :: i

        call find_normal(b, n)
        along = 0
        do i = 1, 3 ! what turns the normal with the layer cancels
            q(i) = h(i, 1)*n(1) + h(i, 2)*n(2) + h(i, 3)*n(3)
            along = along + n(i)*q(i)
        end do
        do i = 1, 3
            q(i) = q(i) + h(1, i)*n(1) + h(2, i)*n(2) + h(3, i)*n(3) - along*n(i)
        end do
        power = q(1)*(s(1)*n(1) + s(4)*n(2) + s(6)*n(3)) &
                + q(2)*(s(4)*n(1) + s(2)*n(2) + s(5)*n(3)) &
                + q(3)*(s(6)*n(1) + s(5)*n(2) + s(3)*n(3))
    end function face_power

    !> Normal of a layer in which B lies; 0 where B is zero.
    !@cuf attributes(host,device) &
    pure subroutine find_normal(b, normal)
        real(rk), intent(in) :: b(3, 3)
        real(rk), intent(out) :: normal(3)
        real(rk) :: c(3), size, largest
        integer :: i, j, k

        largest = 0
        do i = 1, 3
            normal(i) = 0
        end do
        do j = 1, 3
            k = merge(1, j + 1, j == 3)
            c(1) = b(2, j)*b(3, k) - b(3, j)*b(2, k)
            c(2) = b(3, j)*b(1, k) - b(1, j)*b(3, k)
            c(3) = b(1, j)*b(2, k) - b(2, j)*b(1, k)
            size = c(1)*c(1) + c(2)*c(2) + c(3)*c(3)
            if (size <= largest) cycle
            largest = size
            do i = 1, 3
                normal(i) = c(i)
            end do
        end do
        if (.not. largest > 0) return
        do i = 1, 3
            normal(i) = normal(i)/sqrt(largest)
        end do
    end subroutine find_normal
end module brz_membrane
