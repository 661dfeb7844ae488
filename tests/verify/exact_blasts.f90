! SPDX-License-Identifier: MIT
!> Exact flows to measure the air against: the blast of a point source, and where its front is.
module exact_blasts
    use brz_kinds, only: dp
    implicit none
    private
    public :: sedov_state, sedov_energy, front_radius

    real(dp), parameter :: sedov_energy = 0.851072_dp
    !! of a point source whose shock is at radius 1 at time 1 in a gas of density 1, gamma 1.4
    integer, parameter :: n = 4000
    real(dp), save :: table(3, n) = -1

contains

    !> Density, velocity over that of the shock and pressure over density times its square, at a
    !> radius over that of the shock; gamma 1.4, density 1.
    function sedov_state(x) result(s)
        real(dp), intent(in) :: x
        real(dp) :: s(3)
        integer :: i

        if (table(1, 1) < 0) call integrate()
        s = [1.0_dp, 0.0_dp, 0.0_dp]
        if (x > 1) return
        i = min(n, max(1, n - int((1 - x)*n)))
        s = table(:, i)
    end function sedov_state

    !> The similarity equations (Sedov 1959), from the shock inwards by the midpoint rule. With the
    !> radius over that of the shock as x, and R'' R = -3/2 R'**2, mass, momentum and entropy give
    !> three linear equations for the slopes.
    subroutine integrate()
        real(dp) :: s(3), x, h
        integer :: i, m
        integer, parameter :: parts = 10

        s = [6.0_dp, 5/6.0_dp, 5/6.0_dp]
        h = -1.0_dp/(n*parts)
        table(:, n) = s
        x = 1
        do i = n - 1, 1, -1
            do m = 1, parts
                s = s + h*slope(x + h/2, s + h/2*slope(x, s))
                x = x + h
            end do
            table(:, i) = s
        end do
    end subroutine integrate

    !> Slopes of density, velocity, pressure.
    pure function slope(x, s) result(d)
        real(dp), intent(in) :: x, s(3)
        real(dp) :: d(3), w
        real(dp), parameter :: g = 1.4_dp

        w = s(2) - x
        d(2) = (3*s(3) - 1.5_dp*s(1)*s(2)*w - 2*g*s(3)*s(2)/x)/(g*s(3) - s(1)*w*w)
        d(1) = -s(1)*(d(2) + 2*s(2)/x)/w
        d(3) = s(1)*(1.5_dp*s(2) - w*d(2))
    end function slope

    !> Radius in cells where the pressure of an octant, averaged over shells half a cell thick,
    !> falls to half of its peak.
    pure real(dp) function front_radius(p) result(radius)
        real(dp), intent(in) :: p(:, :, :)
        real(dp) :: mean(2*size(p, 1)), half
        integer :: cells(2*size(p, 1)), i, j, k, shell

        mean = 0
        cells = 0
        do k = 1, size(p, 3)
            do j = 1, size(p, 2)
                do i = 1, size(p, 1)
                    shell = ceiling(norm2([i, j, k] - 0.5_dp)*2)
                    if (shell > size(mean)) cycle
                    mean(shell) = mean(shell) + p(i, j, k)
                    cells(shell) = cells(shell) + 1
                end do
            end do
        end do
        mean = mean/max(cells, 1)
        half = maxval(mean)/2
        shell = maxloc(mean, 1)
        do while (mean(shell) > half .and. shell < size(mean))
            shell = shell + 1
        end do
        radius = (shell - 0.5_dp + (half - mean(shell))/(mean(shell) - mean(shell - 1)))/2
    end function front_radius
end module exact_blasts
