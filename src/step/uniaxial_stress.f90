! SPDX-License-Identifier: MIT
!> One step of a material point under uniaxial stress.
!>
!> The rate of deformation along one axis is given; the five other rates (two lateral, three
!> shears) are found so that their five stresses vanish at the end of the step. Newton's method
!> with a Jacobian by differences and a line search, on copies of the point; where it fails, the
!> lateral rate common to both directions is bracketed and bisected first. There is no spin.
!> Where any rate would do (a material without stress) the volume stays the same.
module brz_uniaxial_stress
    use brz_kinds, only: rk
    use brz_algebra, only: to_matrix
    use brz_material, only: material_t, point_t
    use brz_materials, only: update_material
    implicit none
    private
    public :: uniaxial_t, stretch

    integer, parameter :: n = 5 !! rates that are solved for
    real(rk), parameter :: least_strain = 1e-9_rk, most_strain = 0.2_rk !! of a step, in the bracket
    integer, parameter :: most_iterations = 40, most_halvings = 12, most_bisections = 100

    !> The problem of one step.
    type :: uniaxial_t
        integer :: axis = 1 !! 1, 2, 3
        integer :: free(n) = 0 !! components (xx, yy, zz, xy, yz, xz) that are solved for
        real(rk) :: rate = 0 !! along the axis [1/s]
        real(rk) :: dt = 0, h = 0 !! step [s], smoothing length [m]
        real(rk) :: small = 0 !! stress that counts as zero [Pa]
    end type uniaxial_t

contains

    !> Carry a point over one step; `free_rates` are those of the last step, and the start here.
    !>
    !> `left` is the largest stress that should be zero and is not, 0 where the step succeeded;
    !> otherwise the point is as it was. A positive `status`: the material refused every try.
    subroutine stretch(material, step, free_rates, point, left, status)
        type(material_t), intent(in) :: material
        type(uniaxial_t), intent(inout) :: step !! axis, rate, dt and h are given
        real(rk), intent(inout) :: free_rates(n) !! [1/s]
        type(point_t), intent(inout) :: point
        real(rk), intent(out) :: left !! [Pa]
        integer, intent(out) :: status !! of the material
        type(point_t) :: moved
        real(rk) :: x(n), l(3, 3)
        integer :: i, k
        logical :: ok

        k = 0
        do i = 1, 6
            if (i == step%axis) cycle
            k = k + 1
            step%free(k) = i
        end do
        step%small = max(1e-9_rk, 30*epsilon(1.0_rk))*max(maxval(abs(point%stress)), &
                     (material%bulk + material%shear)*abs(step%rate)*step%dt)
        x = free_rates
        if (maxval(abs(x)) > 2*abs(step%rate)) then ! a jump, or what carries no stress: afresh
            x = 0
            x(:2) = -step%rate/2
        end if
        call newton(material, step, point, x, left, status, ok)
        if (.not. ok) then
            call bisect(material, step, point, x)
            call newton(material, step, point, x, left, status, ok)
        end if
        if (.not. ok) return
        call gradient(step, x, l)
        moved = point
        call update_material(material, step%dt, step%h, l, moved, status)
        point = moved
        free_rates = x
        left = 0
    end subroutine stretch

    !> Newton's method from x. `ok`: all stresses are small.
    pure subroutine newton(material, step, point, x, left, status, ok)
        type(material_t), intent(in) :: material
        type(uniaxial_t), intent(in) :: step
        type(point_t), intent(in) :: point
        real(rk), intent(inout) :: x(n)
        real(rk), intent(out) :: left
        integer, intent(out) :: status
        logical, intent(out) :: ok
        real(rk) :: r(n), jacobian(n, n), direction(n)
        integer :: iteration

        call residual(material, step, point, x, r, status)
        do iteration = 1, most_iterations
            left = maxval(abs(r))
            ok = left <= step%small .and. status <= 0
            if (ok .or. status > 0) return
            call differences(material, step, point, x, r, jacobian, status)
            if (status > 0) return
            call solve(jacobian, -r, direction, ok)
            if (ok) call search(material, step, point, direction, x, r, ok)
            if (.not. ok) return
        end do
        ok = .false.
    end subroutine newton

    !> Jacobian by forward differences.
    pure subroutine differences(material, step, point, x, r, jacobian, status)
        type(material_t), intent(in) :: material
        type(uniaxial_t), intent(in) :: step
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: x(n), r(n)
        real(rk), intent(out) :: jacobian(n, n)
        integer, intent(inout) :: status
        real(rk) :: shifted(n), change(n), shift
        integer :: j

        shift = sqrt(epsilon(shift))*max(10*abs(step%rate), 10*maxval(abs(x)), 1e-3_rk/step%dt)
        do j = 1, n
            shifted = x
            shifted(j) = x(j) + shift
            call residual(material, step, point, shifted, change, status)
            jacobian(:, j) = (change - r)/shift
        end do
    end subroutine differences

    !> Go along a direction, half as far each time, until the residual falls.
    pure subroutine search(material, step, point, direction, x, r, ok)
        type(material_t), intent(in) :: material
        type(uniaxial_t), intent(in) :: step
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: direction(n)
        real(rk), intent(inout) :: x(n), r(n)
        logical, intent(out) :: ok
        real(rk) :: tried(n), found(n), part
        integer :: halving, status

        part = 1
        do halving = 1, most_halvings
            tried = x + part*direction
            call residual(material, step, point, tried, found, status)
            ok = status <= 0 .and. norm2(found) < norm2(r)
            if (ok) exit
            part = part/2
        end do
        if (.not. ok) return
        x = tried
        r = found
    end subroutine search

    !> Lateral rate, the same in both directions and without shear, of zero mean lateral stress.
    pure subroutine bisect(material, step, point, x)
        type(material_t), intent(in) :: material
        type(uniaxial_t), intent(in) :: step
        type(point_t), intent(in) :: point
        real(rk), intent(out) :: x(n)
        real(rk) :: low, high, middle, size
        integer :: i

        size = abs(step%rate)
        if (size*step%dt < least_strain) size = least_strain/step%dt
        do
            low = -size
            high = size
            if (lateral(material, step, point, low) < 0 .and. &
                lateral(material, step, point, high) > 0) exit
            if (size*step%dt > most_strain) exit
            size = 2*size
        end do
        do i = 1, most_bisections
            middle = (low + high)/2
            if (lateral(material, step, point, middle) < 0) then
                low = middle
            else
                high = middle
            end if
        end do
        x = 0
        x(:2) = (low + high)/2
    end subroutine bisect

    !> Mean lateral stress at a common lateral rate; one that the material refuses is far off.
    pure function lateral(material, step, point, rate) result(stress)
        type(material_t), intent(in) :: material
        type(uniaxial_t), intent(in) :: step
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: rate
        real(rk) :: stress
        real(rk) :: x(n), r(n)
        integer :: status

        x = 0
        x(:2) = rate
        call residual(material, step, point, x, r, status)
        stress = (r(1) + r(2))/2
        if (status > 0) stress = sign(huge(stress), rate)
    end function lateral

    !> The stresses that should vanish, after a step with the rates x.
    pure subroutine residual(material, step, point, x, r, status)
        type(material_t), intent(in) :: material
        type(uniaxial_t), intent(in) :: step
        type(point_t), intent(in) :: point
        real(rk), intent(in) :: x(n)
        real(rk), intent(out) :: r(n)
        integer, intent(out) :: status
        type(point_t) :: moved
        real(rk) :: l(3, 3)

        call gradient(step, x, l)
        moved = point
        call update_material(material, step%dt, step%h, l, moved, status)
        if (status > 0) moved%stress = huge(1.0_rk)/10
        r = moved%stress(step%free)
    end subroutine residual

    !> Symmetric velocity gradient of the given and the free rates.
    pure subroutine gradient(step, x, l)
        type(uniaxial_t), intent(in) :: step
        real(rk), intent(in) :: x(n)
        real(rk), intent(out) :: l(3, 3)
        real(rk) :: d(6)

        d(step%axis) = step%rate
        d(step%free) = x
        call to_matrix(d, l)
    end subroutine gradient

    !> Solution of a x = b by elimination with pivots. `ok`: a is not singular.
    pure subroutine solve(a, b, x, ok)
        real(rk), intent(in) :: a(n, n), b(n)
        real(rk), intent(out) :: x(n)
        logical, intent(out) :: ok
        real(rk) :: m(n, n + 1), row(n + 1)
        integer :: i, k

        m(:, :n) = a
        m(:, n + 1) = b
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
            x(k) = m(k, n + 1) - dot_product(m(k, k + 1:n), x(k + 1:))
        end do
    end subroutine solve
end module brz_uniaxial_stress
