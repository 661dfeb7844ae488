! SPDX-License-Identifier: MIT
!> Rigid and driven bodies, which carry their particles. Their velocity is known at every place, and
!> is the velocity of the walls there. Point physics: compiled for the CPU and for the GPU.
module brz_driven_body_rules
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: driven_body_t, carries_none, carries_held, carries_all
    public :: driven_body_at, is_carried, carried_velocity
    public :: add_force, add_yield, n_push, push_force, push_torque, push_yield, push_turn

    integer, parameter :: carries_none = 0, carries_held = 1, carries_all = 2

    ! what the gas does to a body, sums over its particles; + 1..3, or + 1..9
    integer, parameter :: push_force = 0, push_torque = 3 !! [N, N m]
    integer, parameter :: push_yield = 6 !! loss of force per velocity, by axes [N s/m]
    integer, parameter :: push_turn = 9 !! loss of torque per spin, column by column [N m s]
    integer, parameter :: n_push = 18

    !> A body, and the velocity that it gives its walls: v + spin x (x - centre).
    type :: driven_body_t
        integer :: first = 1, last = 0 !! particles
        integer :: carries = carries_none !! which of them
        real(dp) :: centre(3) = 0 !! [m]
        real(dp) :: v(3) = 0 !! [m/s]
        real(dp) :: spin(3) = 0 !! [1/s]
    end type driven_body_t

contains

    !> Place of the driven body that a particle belongs to.
    !@cuf attributes(host,device) &
    pure function driven_body_at(n, driven_bodies, p) result(b)
        integer, intent(in) :: n !! driven bodies, in the order of their particles
        type(driven_body_t), intent(in) :: driven_bodies(n)
        integer, intent(in) :: p !! particle
        integer :: b, low, high

        low = 1
        high = n
        do while (low < high)
            b = (low + high + 1)/2
            if (driven_bodies(b)%first > p) then
                high = b - 1
            else
                low = b
            end if
        end do
        b = low
    end function driven_body_at

    !> True for a particle whose velocity its body gives.
    !@cuf attributes(host,device) &
    pure function is_carried(carries, held) result(carried)
        integer, intent(in) :: carries !! of the body
        logical, intent(in) :: held !! the particle is
        logical :: carried

        carried = carries == carries_all .or. (carries == carries_held .and. held)
    end function is_carried

    !> Velocity that a driven body gives the walls of a cell that holds a particle of it [m/s].
    !@cuf attributes(host,device) &
    pure function carried_velocity(driven, middle) result(v)
        type(driven_body_t), intent(in) :: driven
        real(dp), intent(in) :: middle(3) !! of the cell [m]
        real(rk) :: v(3)
        integer :: d, i, j

        do d = 1, 3
            i = mod(d, 3) + 1
            j = mod(d + 1, 3) + 1
            v(d) = real(driven%v(d) + driven%spin(i)*(middle(j) - driven%centre(j)) &
                        - driven%spin(j)*(middle(i) - driven%centre(i)), rk)
        end do
    end function carried_velocity

    !> Add force and torque of the gas on a particle to the sums over its body.
    !>
    !> The arm is that of the middle of the cell, as the velocity of the wall is: so what the walls
    !> take from the gas is what the body gets, and an even pressure does not turn it.
    !@cuf attributes(host,device) &
    pure subroutine add_force(arm, force, sums)
        real(dp), intent(in) :: arm(3) !! middle of the cell, from the centre of the body [m]
        real(rk), intent(in) :: force(3) !! [N]
        real(dp), intent(inout) :: sums(6) !! force and torque [N, N m]
        integer :: d, i, j

        do d = 1, 3
            i = mod(d, 3) + 1
            j = mod(d + 1, 3) + 1
            sums(d) = sums(d) + force(d)
            sums(3 + d) = sums(3 + d) + (arm(i)*force(j) - arm(j)*force(i))
        end do
    end subroutine add_force

    !> Add how force and torque on a particle fall with velocity and spin to the sums of its body.
    !@cuf attributes(host,device) &
    pure subroutine add_yield(arm, impedance, sums)
        real(dp), intent(in) :: arm(3) !! middle of the cell, from the centre of the body [m]
        real(rk), intent(in) :: impedance(3) !! loss of force per velocity, by axes [N s/m]
        real(dp), intent(inout) :: sums(n_push)
        real(dp) :: lever(3) !! torque of a unit force along d
        integer :: at, d, i, j, k

        do d = 1, 3
            i = mod(d, 3) + 1
            j = mod(d + 1, 3) + 1
            sums(push_yield + d) = sums(push_yield + d) + impedance(d)
            lever(d) = 0
            lever(i) = arm(j)
            lever(j) = -arm(i)
            do k = 1, 3
                do i = 1, 3
                    at = push_turn + 3*(k - 1) + i
                    sums(at) = sums(at) + impedance(d)*lever(i)*lever(k)
                end do
            end do
        end do
    end subroutine add_yield
end module brz_driven_body_rules
