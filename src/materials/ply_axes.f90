! SPDX-License-Identifier: MIT
!> The axes of a ply: how they are kept, and how they turn over one step.
!>
!> The axes are the columns of a rotation, kept as three modified Rodrigues parameters
!> n tan(angle/4). Over a step they turn by R_new = exp(w dt/2) R exp(x dt): exactly with the spin
!> w of the material, and besides with x in their own frame, by the choice of the deck:
!>     spin    x = 0
!>     polar   x = (d e - e d)/2: the polar rotation of the stretch 1 + e, to the fourth order of
!>             the strain e
!>     fibre   x_ij = d_ij for i > j: axis 1 stays on the fibre, axis 3 normal to the ply
!> d is the rate of deformation in the axes at mid-step, so that a step can be taken back.
!> Point physics: compiled for the CPU and for the GPU.
module brz_ply_axes
    use brz_algebra, only: rotate_voigt, to_voigt, turn_ratios
    use brz_kinds, only: rk
    implicit none
    private
    public :: turn_ply, axes_matrix, axes_of_matrix

    integer, parameter, public :: axes_polar = 1, axes_spin = 2, axes_fibre = 3

contains

    !> Turn the axes over one step; the rate of deformation in the axes of mid-step.
    !@cuf attributes(host,device) &
    pure subroutine turn_ply(kind, l, dt, strain, axes, d, last)
        integer, intent(in) :: kind !! axes_polar, ...
        real(rk), intent(in) :: l(3, 3) !! velocity gradient at mid-step [1/s]
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: strain(6) !! at the start, engineering shears
        real(rk), intent(inout) :: axes(3)
        real(rk), intent(out) :: d(6) !! 11, 22, 33, 12, 23, 13, tensor shears [1/s]
        real(rk), intent(out) :: last(3, 3) !! axes at the end of the step
        real(rk) :: turn(4), first(4), own(4), r(3, 3), x(3), start(6)
        integer :: i, pass

        x(1) = (l(3, 2) - l(2, 3))*dt/4
        x(2) = (l(1, 3) - l(3, 1))*dt/4
        x(3) = (l(2, 1) - l(1, 2))*dt/4
        call quaternion_of_turn(x, turn)
        call quaternion_of_axes(axes, own)
        call product(turn, own, first)
        call matrix(first, r)
        call rate_in(r, l, d)
        call product(turn, first, own)
        if (kind /= axes_spin) then
            start = d
            do pass = 1, merge(2, 4, kind == axes_polar)
                call own_turn(kind, strain, dt, d, x)
                call turned_back(start, x, d)
            end do
            do i = 1, 3
                x(i) = 2*x(i)
            end do
            call quaternion_of_turn(x, turn)
            call product(own, turn, first)
            own = first
        end if
        call matrix(own, last)
        call axes_of_quaternion(own, axes)
    end subroutine turn_ply

    !> Turn of the axes relative to the spin in half a step [rad].
    !@cuf attributes(host,device) &
    pure subroutine own_turn(kind, strain, dt, d, x)
        integer, intent(in) :: kind
        real(rk), intent(in) :: strain(6), dt, d(6)
        real(rk), intent(out) :: x(3)
        real(rk) :: e(6)
        integer :: i

        if (kind == axes_polar) then
            do i = 1, 3
                e(i) = strain(i)*dt/4
                e(i + 3) = strain(i + 3)*dt/8
            end do
            call skew_commutator(d, e, x)
        else
            x(1) = d(5)*dt/2
            x(2) = -d(6)*dt/2
            x(3) = d(4)*dt/2
        end if
    end subroutine own_turn

    !> A tensor in axes that are turned by the small rotation vector x.
    !@cuf attributes(host,device) &
    pure subroutine turned_back(a, x, b)
        real(rk), intent(in) :: a(6), x(3)
        real(rk), intent(out) :: b(6)
        real(rk) :: once(6), twice(6)
        integer :: i

        call commutator(a, x, once)
        call commutator(once, x, twice)
        do i = 1, 6
            b(i) = a(i) + once(i) + twice(i)/2
        end do
    end subroutine turned_back

    !> b = a X - X a, where X is the skew tensor of x.
    !@cuf attributes(host,device) &
    pure subroutine commutator(a, x, b)
        real(rk), intent(in) :: a(6), x(3)
        real(rk), intent(out) :: b(6)

        b(1) = 2*(a(4)*x(3) - a(6)*x(2))
        b(2) = 2*(a(5)*x(1) - a(4)*x(3))
        b(3) = 2*(a(6)*x(2) - a(5)*x(1))
        b(4) = (a(2) - a(1))*x(3) + a(6)*x(1) - a(5)*x(2)
        b(5) = (a(3) - a(2))*x(1) + a(4)*x(2) - a(6)*x(3)
        b(6) = (a(1) - a(3))*x(2) + a(5)*x(3) - a(4)*x(1)
    end subroutine commutator

    !> Rate of deformation in the axes r: r^T d r.
    !@cuf attributes(host,device) &
    pure subroutine rate_in(r, l, d)
        real(rk), intent(in) :: r(3, 3), l(3, 3)
        real(rk), intent(out) :: d(6)
        real(rk) :: back(3, 3)
        integer :: i

        call to_voigt(l, d)
        do i = 1, 3
            back(i, 1) = r(1, i)
            back(i, 2) = r(2, i)
            back(i, 3) = r(3, i)
        end do
        call rotate_voigt(back, d)
    end subroutine rate_in

    !> Axial vector of a b - b a, which is skew.
    !@cuf attributes(host,device) &
    pure subroutine skew_commutator(a, b, x)
        real(rk), intent(in) :: a(6), b(6)
        real(rk), intent(out) :: x(3)

        x(1) = a(6)*b(4) + a(5)*(b(2) - b(3)) + a(3)*b(5) - b(6)*a(4) - b(5)*a(2)
        x(2) = a(1)*b(6) + a(4)*b(5) + a(6)*(b(3) - b(1)) - b(4)*a(5) - b(6)*a(3)
        x(3) = a(4)*(b(1) - b(2)) + a(2)*b(4) + a(5)*b(6) - b(4)*a(1) - b(5)*a(6)
    end subroutine skew_commutator

    !> Quaternion of a rotation vector (axis times angle).
    !@cuf attributes(host,device) &
    pure subroutine quaternion_of_turn(a, q)
        real(rk), intent(in) :: a(3) !! [rad]
        real(rk), intent(out) :: q(4)
        real(rk) :: t2, s

        t2 = (a(1)*a(1) + a(2)*a(2) + a(3)*a(3))/4
        call turn_ratios(t2, s, q(1))
        q(1) = 1 - t2*q(1)
        s = s/2
        q(2) = s*a(1)
        q(3) = s*a(2)
        q(4) = s*a(3)
    end subroutine quaternion_of_turn

    !> c = a b: first b, then a.
    !@cuf attributes(host,device) &
    pure subroutine product(a, b, c)
        real(rk), intent(in) :: a(4), b(4)
        real(rk), intent(out) :: c(4)

        c(1) = a(1)*b(1) - a(2)*b(2) - a(3)*b(3) - a(4)*b(4)
        c(2) = a(1)*b(2) + a(2)*b(1) + a(3)*b(4) - a(4)*b(3)
        c(3) = a(1)*b(3) + a(3)*b(1) + a(4)*b(2) - a(2)*b(4)
        c(4) = a(1)*b(4) + a(4)*b(1) + a(2)*b(3) - a(3)*b(2)
    end subroutine product

    !> Rotation matrix of a quaternion of length 1.
    !@cuf attributes(host,device) &
    pure subroutine matrix(q, r)
        real(rk), intent(in) :: q(4)
        real(rk), intent(out) :: r(3, 3)

        r(1, 1) = 1 - 2*(q(3)*q(3) + q(4)*q(4))
        r(2, 1) = 2*(q(2)*q(3) + q(1)*q(4))
        r(3, 1) = 2*(q(2)*q(4) - q(1)*q(3))
        r(1, 2) = 2*(q(2)*q(3) - q(1)*q(4))
        r(2, 2) = 1 - 2*(q(2)*q(2) + q(4)*q(4))
        r(3, 2) = 2*(q(3)*q(4) + q(1)*q(2))
        r(1, 3) = 2*(q(2)*q(4) + q(1)*q(3))
        r(2, 3) = 2*(q(3)*q(4) - q(1)*q(2))
        r(3, 3) = 1 - 2*(q(2)*q(2) + q(3)*q(3))
    end subroutine matrix

    !@cuf attributes(host,device) &
    pure subroutine quaternion_of_axes(axes, q)
        real(rk), intent(in) :: axes(3)
        real(rk), intent(out) :: q(4)
        real(rk) :: s

        s = 2/(1 + axes(1)*axes(1) + axes(2)*axes(2) + axes(3)*axes(3))
        q(1) = s - 1
        q(2) = s*axes(1)
        q(3) = s*axes(2)
        q(4) = s*axes(3)
    end subroutine quaternion_of_axes

    !> The parameters of length 1 at most; takes the rounding off the length of q (near 1).
    !@cuf attributes(host,device) &
    pure subroutine axes_of_quaternion(q, axes)
        real(rk), intent(in) :: q(4)
        real(rk), intent(out) :: axes(3)
        real(rk) :: length

        length = (1 + q(1)*q(1) + q(2)*q(2) + q(3)*q(3) + q(4)*q(4))/2
        length = sign(1.0_rk, q(1))/(length + abs(q(1)))
        axes(1) = length*q(2)
        axes(2) = length*q(3)
        axes(3) = length*q(4)
    end subroutine axes_of_quaternion

    !> The axes as the columns of a matrix.
    !@cuf attributes(host,device) &
    pure subroutine axes_matrix(axes, r)
        real(rk), intent(in) :: axes(3)
        real(rk), intent(out) :: r(3, 3)
        real(rk) :: q(4)

        call quaternion_of_axes(axes, q)
        call matrix(q, r)
    end subroutine axes_matrix

    !> The parameters of a rotation matrix.
    pure subroutine axes_of_matrix(r, axes)
        real(rk), intent(in) :: r(3, 3)
        real(rk), intent(out) :: axes(3)
        real(rk) :: q(4), s(4)
        integer :: i, j, k

        s = [r(1, 1) + r(2, 2) + r(3, 3), r(1, 1), r(2, 2), r(3, 3)]
        i = maxloc(s, 1)
        if (i == 1) then
            q = [1 + s(1), r(3, 2) - r(2, 3), r(1, 3) - r(3, 1), r(2, 1) - r(1, 2)]
        else
            i = i - 1
            j = modulo(i, 3) + 1
            k = modulo(j, 3) + 1
            q(1) = r(k, j) - r(j, k)
            q(i + 1) = 1 + r(i, i) - r(j, j) - r(k, k)
            q(j + 1) = r(j, i) + r(i, j)
            q(k + 1) = r(k, i) + r(i, k)
        end if
        call axes_of_quaternion(q/norm2(q), axes)
    end subroutine axes_of_matrix
end module brz_ply_axes
