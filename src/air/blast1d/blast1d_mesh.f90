! SPDX-License-Identifier: MIT
!> The moving mesh of a blast in one dimension: it follows the shock, and air cells are halved when
!> they have grown longer than those of the charge.
module brz_blast1d_mesh
    use brz_blast1d_state, only: blast1d_t, n_ahead
    use brz_kinds, only: dp
    implicit none
    private
    public :: follow_front, refine_air

    real(dp), parameter :: reached = 1e-6_dp !! change of pressure that tells a front, relative
    integer, parameter :: behind = 10 !! cells behind the front whose speed counts
    real(dp), parameter :: longer = 1 + 1e-9_dp !! than this: all cells are as long at the start

contains

    !> Find the front, and the velocity of the last face that keeps it ahead of the shock.
    subroutine follow_front(blast, outer)
        type(blast1d_t), intent(inout) :: blast
        real(dp), intent(out) :: outer !! [m/s]
        real(dp) :: speed
        integer :: i, n

        n = blast%n
        do i = n, blast%n_in + 1, -1
            if (abs(blast%state(3, i) - blast%input%pressure) > reached*blast%input%pressure) exit
        end do
        blast%front = i
        ! a shock is slower than sound in the gas behind it
        speed = max(blast%contact, blast%state(5, n + 1))
        do i = max(blast%n_in + 1, blast%front - behind), n
            speed = max(speed, blast%state(2, i) + blast%state(5, i))
        end do
        outer = speed*min(max(2 - (n - blast%front)/real(n_ahead, dp), 0.0_dp), 2.0_dp)
    end subroutine follow_front

    !> Halve all cells of air where they have become longer than those of the products.
    subroutine refine_air(blast)
        type(blast1d_t), intent(inout) :: blast
        integer :: n_air

        n_air = blast%n - blast%n_in
        if (blast%n_in + 2*n_air > ubound(blast%r, 1)) return
        associate (air => blast%r(blast%n) - blast%r(blast%n_in), inside => blast%r(blast%n_in))
            if (air/n_air <= longer*inside/blast%n_in) return
        end associate
        call halve(blast, n_air)
    end subroutine refine_air

    !> Halve the cells of air from the last inwards; each half takes what a linear course of the
    !> sums per volume gives it, with the smaller of the slopes to both sides.
    subroutine halve(blast, n_air)
        type(blast1d_t), intent(inout) :: blast
        integer, intent(in) :: n_air
        integer :: i, k, power
        real(dp) :: whole, low, middle, mean(3), up(3), down(3), change(3)

        power = blast%input%power
        up = 0 ! no slope in the last cell
        do i = blast%n, blast%n_in + 1, -1
            k = blast%n_in + 2*(i - blast%n_in)
            middle = (blast%r(i - 1) + blast%r(i))/2
            whole = blast%xi(i) - blast%xi(i - 1)
            low = middle**(power + 1)/(power + 1) - blast%xi(i - 1)
            mean = blast%q(:, i)/whole
            down = 0
            if (i > blast%n_in + 1) &
                down = mean - blast%q(:, i - 1)/(blast%xi(i - 1) - blast%xi(i - 2))
            change = 0
            where (up*down > 0) change = sign(min(abs(up), abs(down)), up)/2
            up = down
            blast%r(k) = blast%r(i)
            blast%xi(k) = blast%xi(i)
            blast%q(:, k) = (mean + change*low/whole)*(whole - low)
            blast%q(:, k - 1) = (mean - change*(whole - low)/whole)*low
            blast%r(k - 1) = middle
            blast%xi(k - 1) = blast%xi(i - 1) + low
        end do
        blast%n = blast%n_in + 2*n_air
    end subroutine halve
end module brz_blast1d_mesh
