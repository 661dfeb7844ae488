! SPDX-License-Identifier: MIT
!> The state of the coupling, a moving immersed boundary: cut cells in the air, what bodies carry,
!> and what air and bodies have exchanged.
module brz_coupling_state
    use brz_air_state, only: wall_t
    use brz_driven_body_rules, only: driven_body_t
    use brz_bodies, only: bodies_t
    use brz_coupling_box, only: box_t
    use brz_coupling_device, only: coupling_device_t, n_sums
    use brz_coupling_part, only: coupling_part_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_ranks, only: ranks_t
    implicit none
    private
    public :: coupling_t, coupling_diagnostics_t, sums_in, put_sums
    public :: n_sums

    !> What the air has given to the bodies, and other sums over all steps.
    type :: coupling_diagnostics_t
        real(dp) :: work = 0 !! sum of J.v_w: energy that the air spent on moving walls [J]
        real(dp) :: work_reference = 0 !! part of it that the reference pressure did [J]
        real(dp) :: impulse(3) = 0 !! given to the solid, reference pressure taken off [N s]
        real(dp) :: impulse_reference(3) = 0 !! what was taken off [N s]
    end type coupling_diagnostics_t

    type :: coupling_t
        logical :: present = .false.
        logical :: on_gpu = .false.
        !! it is computed there: cut cells and velocities before are fetched
        type(coupling_device_t), pointer :: device => null() !! what it has there besides
        type(ranks_t) :: ranks !! of the air
        integer :: n_var = 5 !! conserved variables of the air
        type(box_t) :: box !! of the air
        integer :: bodies = 0 !! that may carry particles
        real(dp) :: dt_before = 0 !! last step of the air, 0: none yet [s]
        type(coupling_diagnostics_t) :: diagnostics
        logical :: paper = .false. !! as the paper prints it, see brz_coupling_paper
        real(rk) :: reference_pressure = 0 !! taken off every load [Pa]
        logical :: wraps(3) = .false. !! periodic directions of the air
        type(wall_t) :: wall
        ! several processes: what this one sees of the bodies, and what it has to do with others
        type(bodies_t), allocatable :: ghosts !! copies of the particles near the cells of the box
        type(bodies_t) :: ghost_bodies !! their bodies
        type(coupling_part_t) :: part
        integer(int32), allocatable :: cell_of(:) !! (particles) number of the air cell, 0: outside
        integer(int32), allocatable :: start(:) !! counts that become places in lists
        ! loads
        type(driven_body_t), allocatable :: driven(:) !! (bodies) how those move that carry
                                                      !! particles
        integer(int32), allocatable :: felt(:) !! (bodies) 1: has a load beyond rounding
        real(rk), allocatable :: v_before(:, :) !! (3, particles by id) velocity a step before [m/s]
    end type coupling_t

contains

    !> Work and impulses of the diagnostics in a row, in the order of the columns on a GPU.
    pure function sums_in(diagnostics) result(sums)
        type(coupling_diagnostics_t), intent(in) :: diagnostics
        real(dp) :: sums(n_sums)

        sums = [diagnostics%work, diagnostics%work_reference, diagnostics%impulse, &
                diagnostics%impulse_reference]
    end function sums_in

    !> The same from a row.
    pure subroutine put_sums(sums, diagnostics)
        real(dp), intent(in) :: sums(n_sums)
        type(coupling_diagnostics_t), intent(inout) :: diagnostics

        diagnostics%work = sums(1)
        diagnostics%work_reference = sums(2)
        diagnostics%impulse = sums(3:5)
        diagnostics%impulse_reference = sums(6:8)
    end subroutine put_sums
end module brz_coupling_state
