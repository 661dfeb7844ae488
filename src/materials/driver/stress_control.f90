! SPDX-License-Identifier: MIT
!> One step of a material point of which stresses are given.
!>
!> Along one axis, or along none, the rate of deformation is given; the other five or six rates are
!> found so that their stresses have the wanted values at the end of the step. Newton's method with
!> a Jacobian by differences and a line search, on copies of the point. Damage bends the stress, and
!> Newton's method may run to and fro over such a bend: then, along one direction after another, the
!> root is bracketed and bisected, until Newton's method takes over. There is no spin. Where any
!> rate would do (a material without stress) the volume stays the same.
module brz_stress_control
    use brz_kinds, only: rk
    use brz_algebra, only: to_matrix
    use brz_material, only: material_t, point_t
    use brz_materials, only: update_material
    implicit none
    private
    public :: stress_control_t, controlled_step

    integer, parameter :: most = 6
    real(rk), parameter :: least_strain = 1e-9_rk, most_strain = 0.2_rk !! of a step, in a bracket
    real(rk), parameter :: first_bracket = 1/64.0_rk !! over the largest rate of the step
    real(rk), parameter :: small = 1e-9_rk !! stress that counts as none, over the largest
    !> the same after bisection: rounding of a damage that grows within a small part of the step
    real(rk), parameter :: nearly = 100
    integer, parameter :: most_iterations = 40, most_halvings = 12, most_bisections = 100, &
                          most_sweeps = 20, most_parts = 4096

    !> The problem of one step. Components are xx, yy, zz, xy, yz, xz.
    type :: stress_control_t
        integer :: axis = 1 !! 1, 2, 3: along it the rate is given; 0: all stresses are
        real(rk) :: rate = 0 !! along the axis [1/s]
        real(rk) :: stress(most) = 0 !! wanted at the end of the step; that of the axis is free [Pa]
        real(rk) :: dt = 0, crack = 0 !! step [s], width of a crack [m]
        real(rk) :: whole = 0 !! step of which this is a part: its strain says what rounding is [s]
        integer :: n = 0 !! rates that are solved for
        integer :: free(most) = 0 !! which they are
    end type stress_control_t

contains

    !> Carry a point over one step; `rates` are those of the last step, and the start here.
    !>
    !> `left` is the largest distance from a wanted stress, 0 where the step succeeded; otherwise
    !> the point is as it was. A positive `status`: the material refused every try. A step that
    !> has no solution is tried again in two, four, ... parts; the rates are then their mean.
    subroutine controlled_step(material, control, rates, point, left, status)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        real(rk), intent(inout) :: rates(most) !! of deformation [1/s]
        type(point_t), intent(inout) :: point
        real(rk), intent(out) :: left !! [Pa]
        integer, intent(out) :: status !! of the material
        type(stress_control_t) :: part
        type(point_t) :: moved
        real(rk) :: now(most), mean(most), work(2)
        integer :: i, parts

        parts = 1
        do
            part = control
            part%dt = control%dt/parts
            part%whole = control%dt
            call list_free(part)
            moved = point
            now = rates
            mean = 0
            work = 0
            do i = 1, parts
                call move_part(material, part, now, moved, left, status)
                if (status > 0 .or. left > 0) exit
                mean = mean + now/parts
                work = work + moved%work
            end do
            if (i > parts) exit
            parts = 2*parts
            if (parts > most_parts) return
        end do
        rates = mean
        point = moved
        point%work = work
    end subroutine controlled_step

    !> One part of a step; where it fails `left` is positive, and the point is as it was.
    subroutine move_part(material, control, rates, point, left, status)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        real(rk), intent(inout) :: rates(most)
        type(point_t), intent(inout) :: point
        real(rk), intent(out) :: left
        integer, intent(out) :: status
        real(rk) :: x(most), tried(most), l(3, 3), none
        integer :: i

        none = max(small, 100*epsilon(1.0_rk))*max(maxval(abs(point%stress)), &
            maxval(abs(control%stress)), &
            (material%bulk + material%shear)*abs(control%rate)*control%whole)
        x = 0
        x(:control%n) = rates(control%free(:control%n))
        if (control%axis > 0 .and. maxval(abs(x)) > 2*abs(control%rate)) then
            x = 0 ! after a jump, or what carries no stress: afresh
            x(:2) = -control%rate/2
        end if
        do i = 0, most_sweeps
            if (i > 0) call sweep(material, control, point, x)
            tried = x
            call newton(material, control, point, none, tried, left, status)
            if (status <= 0 .and. left <= none*merge(nearly, 1.0_rk, i > 0)) exit
        end do
        if (i > most_sweeps) return
        call gradient(control, tried, l)
        call update_material(material, control%dt, control%crack, l, point, status)
        if (control%axis > 0) rates(control%axis) = control%rate
        rates(control%free(:control%n)) = tried(:control%n)
        left = 0
    end subroutine move_part

    pure subroutine list_free(control)
        type(stress_control_t), intent(inout) :: control
        integer :: i

        control%n = 0
        do i = 1, most
            if (i == control%axis) cycle
            control%n = control%n + 1
            control%free(control%n) = i
        end do
    end subroutine list_free

    !> Newton's method from x, as far as it goes; `left` is the largest stress that remains.
    pure subroutine newton(material, control, point, none, x, left, status)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: none !! stress that counts as none [Pa]
        real(rk), intent(inout) :: x(most)
        real(rk), intent(out) :: left
        integer, intent(out) :: status
        real(rk) :: r(most), jacobian(most, most), direction(most)
        integer :: iteration
        logical :: ok

        call residual(material, control, point, x, r, status)
        do iteration = 1, most_iterations
            left = maxval(abs(r))
            if (status > 0 .or. left <= none) return
            call differences(material, control, point, x, r, jacobian, status)
            if (status > 0) return
            call solve(control%n, jacobian, -r, direction, ok)
            if (ok) call search(material, control, point, direction, x, r, ok)
            if (.not. ok) return
        end do
    end subroutine newton

    !> Jacobian by forward differences.
    pure subroutine differences(material, control, point, x, r, jacobian, status)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: x(most), r(most)
        real(rk), intent(out) :: jacobian(most, most)
        integer, intent(inout) :: status
        real(rk) :: shifted(most), change(most), shift
        integer :: j

        jacobian = 0
        shift = sqrt(epsilon(shift))*max(10*abs(control%rate), 10*maxval(abs(x)), &
                                         1e-3_rk/control%dt)
        do j = 1, control%n
            shifted = x
            shifted(j) = x(j) + shift
            call residual(material, control, point, shifted, change, status)
            jacobian(:, j) = (change - r)/shift
        end do
    end subroutine differences

    !> Go along a direction, half as far each time, until the residual falls.
    pure subroutine search(material, control, point, direction, x, r, ok)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: direction(most)
        real(rk), intent(inout) :: x(most), r(most)
        logical, intent(out) :: ok
        real(rk) :: tried(most), found(most), part
        integer :: halving, status

        part = 1
        do halving = 1, most_halvings
            tried = x + part*direction
            call residual(material, control, point, tried, found, status)
            ok = status <= 0 .and. norm2(found) < norm2(r)
            if (ok) exit
            part = part/2
        end do
        if (.not. ok) return
        x = tried
        r = found
    end subroutine search

    !> Rates nearer to the root: along one direction after another the stress in that direction is
    !> made to vanish, first along a rate common to all free sides, then along each rate.
    pure subroutine sweep(material, control, point, x)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        type(point_t), intent(in) :: point
        real(rk), intent(inout) :: x(most)
        real(rk) :: direction(most)
        integer :: j

        direction = 0
        direction(:control%n - 3) = 1
        call bracket(material, control, point, direction, x)
        do j = 1, control%n
            direction = 0
            direction(j) = 1
            call bracket(material, control, point, direction, x)
        end do
    end subroutine sweep

    !> Go along a direction to where the stress in that direction changes its sign.
    pure subroutine bracket(material, control, point, direction, x)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: direction(most)
        real(rk), intent(inout) :: x(most)
        real(rk) :: low, high, middle, size
        integer :: i

        size = max(maxval(abs(x)), abs(control%rate), least_strain/control%dt)*first_bracket
        do
            low = -size
            high = size
            if (along(low) < 0 .and. along(high) > 0) exit
            if (size*control%dt > most_strain) return ! any rate would do, or none
            size = 2*size
        end do
        do i = 1, most_bisections
            middle = (low + high)/2
            if (.not. (middle > low .and. middle < high)) exit
            if (along(middle) < 0) then
                low = middle
            else
                high = middle
            end if
        end do
        x = x + (low + high)/2*direction

    contains

        !> Stress in the direction; where the material refuses the step it is far off.
        pure function along(shift) result(stress)
            real(rk), intent(in) :: shift
            real(rk) :: stress, r(most)
            integer :: status

            call residual(material, control, point, x + shift*direction, r, status)
            stress = dot_product(r, direction)
            if (status > 0) stress = sign(huge(stress), shift)
        end function along
    end subroutine bracket

    !> How far the stresses are from the wanted ones after a step with the rates x.
    pure subroutine residual(material, control, point, x, r, status)
        type(material_t), intent(in) :: material
        type(stress_control_t), intent(in) :: control
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: x(most)
        real(rk), intent(out) :: r(most)
        integer, intent(out) :: status
        type(point_t) :: moved
        real(rk) :: l(3, 3)

        call gradient(control, x, l)
        moved = point
        call update_material(material, control%dt, control%crack, l, moved, status)
        if (status > 0) moved%stress = huge(1.0_rk)/10
        r = 0
        associate (free => control%free(:control%n))
            r(:control%n) = moved%stress(free) - control%stress(free)
        end associate
    end subroutine residual

    !> Symmetric velocity gradient of the given and the free rates.
    pure subroutine gradient(control, x, l)
        type(stress_control_t), intent(in) :: control
        real(rk), intent(in) :: x(most)
        real(rk), intent(out) :: l(3, 3)
        real(rk) :: d(6)

        if (control%axis > 0) d(control%axis) = control%rate
        d(control%free(:control%n)) = x(:control%n)
        call to_matrix(d, l)
    end subroutine gradient

    !> Solution of a x = b of order n by elimination with pivots. `ok`: a is not singular.
    pure subroutine solve(n, a, b, x, ok)
        integer, intent(in) :: n
        real(rk), intent(in) :: a(most, most), b(most)
        real(rk), intent(out) :: x(most)
        logical, intent(out) :: ok
        real(rk) :: m(n, n + 1), row(n + 1)
        integer :: i, k

        m(:, :n) = a(:n, :n)
        m(:, n + 1) = b(:n)
        x = 0
        do k = 1, n
            i = k - 1 + maxloc(abs(m(k:, k)), 1)
            ok = abs(m(i, k)) > epsilon(1.0_rk)*maxval(abs(a))
            if (.not. ok) return
            row = m(i, :)
            m(i, :) = m(k, :)
            m(k, :) = row/row(k)
            do i = k + 1, n
                m(i, :) = m(i, :) - m(i, k)*m(k, :)
            end do
        end do
        do k = n, 1, -1
            x(k) = m(k, n + 1) - dot_product(m(k, k + 1:n), x(k + 1:n))
        end do
    end subroutine solve
end module brz_stress_control
