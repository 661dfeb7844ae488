! SPDX-License-Identifier: MIT
!> Bodies of a single layer of particles: membranes whose normal turns with them.
!>
!> The sums of a layer know nothing of its normal: M has rank two, and the gradient across it is
!> missing. Left at zero, a turn of the layer is half a shear, which holds the layer straight like
!> a string under a tension of G. So M gets n (x) n, with n its normal; the gradient across turns
!> n with the layer, so that no shear across it appears, and stretches it so that its faces are
!> free of stress; the stress acts in the layer alone, and so exerts no torque. Point physics.
!>
!> Source: docs/solid.md section 3
module brz_lone_layer
    use brz_algebra, only: determinant3
    use brz_kinds, only: rk
    implicit none
    private
    public :: close_layer, turn_layer, lie_in_layer, stay_in_layer

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

    !> The velocity gradient across the layer: it turns the normal with the layer, contracts the
    !> layer as it is stretched, and relaxes what stress the faces have all the same.
    !@cuf attributes(host,device) &
    pure subroutine turn_layer(contraction, normal, stress, rate, h)
        real(rk), intent(in) :: contraction !! strain across over minus that of the area, elastic
        real(rk), intent(in) :: normal(3)
        real(rk), intent(in) :: stress(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(in) :: rate !! 1/(stiffness across the layer times the step) [1/(Pa s)]
        real(rk), intent(inout) :: h(3, 3) !! dv/dx [1/s]
        real(rk) :: face(3), turn(3), across(3), along, area
        integer :: i, j

        face(1) = stress(1)*normal(1) + stress(4)*normal(2) + stress(6)*normal(3)
        face(2) = stress(4)*normal(1) + stress(2)*normal(2) + stress(5)*normal(3)
        face(3) = stress(6)*normal(1) + stress(5)*normal(2) + stress(3)*normal(3)
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
                h(i, j) = h(i, j) + ((along - area)*normal(i) - turn(i) - rate*face(i) &
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
        real(rk) :: normal(3), c(3), size, largest
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
        call lie_in_layer(normal, t)
    end subroutine stay_in_layer
end module brz_lone_layer
