! SPDX-License-Identifier: MIT
!> The history of gas that comes in through an open face, see brz_inflow.
module brz_inflow_history
    use brz_kinds, only: dp
    implicit none
    private
    public :: inflow_t

    type :: inflow_t
        integer :: axis = 1, side = 1 !! of the face; 1: low, 2: high
        real(dp) :: gamma = 1.4_dp, rest(2) = 0 !! undisturbed air: density, pressure
        real(dp), allocatable :: time(:) !! none where nothing changes [s]
        real(dp), allocatable :: state(:, :) !! (points, 5) density, velocity, pressure; or
        real(dp), allocatable :: overpressure(:) !! (points) of a wave [Pa]
        logical :: wave = .false. !! the overpressure is given
        logical :: marked = .false. !! its bricks count as reached
    end type inflow_t
end module brz_inflow_history
