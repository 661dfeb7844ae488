! SPDX-License-Identifier: MIT
!> A blast in one dimension: plane, cylindrical or spherical, on a mesh that moves with it.
!>
!> Cells 1..n_in hold the products of the explosive, the others air. The face between them is the
!> contact itself, the last face runs just ahead of the shock; between these the faces are evenly
!> spaced. So the charge keeps its cells however far it expands, and nothing mixes.
module brz_blast1d_state
    use brz_jwl, only: jwl_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: blast1d_t, blast1d_input_t, start_blast1d, place_faces, area_at, whole_angle, &
        blast1d_totals, n_ahead, burn_width

    integer, parameter :: n_ahead = 8 !! cells of undisturbed air ahead of the shock
    real(dp), parameter :: burn_width = 1 !! of the front of the detonation, in mean cells

    real(dp), parameter :: grading = 0.8_dp
    !! length of the first, last cell of products: 1 + this, 1 - this times the mean

    !> What a blast starts from.
    type :: blast1d_input_t
        integer :: power = 2 !! of the radius in the area: 0 plane, 1 cylinder, 2 sphere
        real(dp) :: radius = 0 !! of the charge; plane: half its thickness [m]
        type(jwl_t) :: eos !! products; rho0 and e0 are those of the charge
        real(dp) :: velocity = 0 !! of the detonation; 0: burnt at once at constant volume [m/s]
        real(dp) :: density = 1.225_dp, pressure = 101325, gamma = 1.4_dp !! undisturbed air
        integer :: n_in = 240 !! cells in the charge, at all times
        integer :: n_air = 720 !! most cells in the air
        real(dp) :: cfl = 0.6_dp
        real(dp) :: afterburn = 0 !! energy that the products set free in the air [J/kg]
        real(dp) :: afterburn_time = 0 !! at a constant rate from the start, for so long [s]
    end type blast1d_input_t

    type :: blast1d_t
        type(blast1d_input_t) :: input
        real(dp) :: time = 0 !! [s]
        integer :: cycle = 0
        logical :: burning = .false. !! the detonation has not reached the surface
        real(dp) :: burnt_on = 0 !! energy that the products have set free in the air [J/kg]
        integer :: n_in = 0 !! cells of products
        integer :: n = 0 !! all cells
        integer :: front = 0 !! last cell that the blast has reached
        real(dp) :: contact = 0 !! velocity of the contact [m/s]
        real(dp) :: contact_pressure = 0 !! [Pa]
        real(dp), allocatable :: r(:) !! (0:) faces [m]
        real(dp), allocatable :: xi(:) !! (0:) r**(power+1)/(power+1)
        real(dp), allocatable :: q(:, :)
        !! (3, :) mass, radial momentum, energy of the cells, per unit angle (area, for a plane)
        ! what follows is derived from r and q at the start of each stage
        real(dp), allocatable :: x(:) !! (0:) centres of mass of even cells [m]
        real(dp), allocatable :: state(:, :)
        !! (5, 0:) density, velocity, pressure, internal energy per volume, speed of sound
        real(dp), allocatable :: slope(:, :) !! (4, :) of the first four, over r
        real(dp), allocatable :: swept(:) !! (0:) dxi/dt of the faces
        real(dp), allocatable :: flux(:, :)
        !! (4, 0:) mass, momentum without pressure, energy; pressure, not times area
        real(dp), allocatable :: r_new(:), xi_old(:), q_old(:, :) !! of a stage
        real(dp), allocatable :: r_start(:), xi_start(:), q_start(:, :) !! of the step
    end type blast1d_t

contains

    !> Charge and air at rest, at time zero.
    subroutine start_blast1d(input, blast)
        type(blast1d_input_t), intent(in) :: input
        type(blast1d_t), intent(out) :: blast
        integer :: i, n
        real(dp) :: e_air

        blast%input = input
        blast%burning = input%velocity > 0
        blast%n_in = input%n_in
        blast%n = input%n_in + 2*n_ahead
        n = input%n_in + max(input%n_air, 2*n_ahead)
        allocate (blast%r(0:n), blast%xi(0:n), blast%r_new(0:n), blast%xi_old(0:n), &
            blast%r_start(0:n), blast%xi_start(0:n), blast%swept(0:n), source=0.0_dp)
        allocate (blast%q(3, n), blast%q_old(3, n), blast%q_start(3, n), blast%slope(4, n), &
            blast%flux(4, 0:n), blast%state(5, 0:n + 1), source=0.0_dp)
        allocate (blast%x(0:n + 1), source=0.0_dp)
        call place_faces(blast, input%radius, input%radius*(1 + 2.0_dp*n_ahead/blast%n_in))
        blast%r = blast%r_new
        blast%xi = blast%r**(input%power + 1)/(input%power + 1)
        e_air = input%pressure/(input%gamma - 1)
        do i = 1, blast%n
            associate (volume => blast%xi(i) - blast%xi(i - 1))
                if (i <= blast%n_in) then
                    blast%q(:, i) = [input%eos%rho0, 0.0_dp, input%eos%e0]*volume
                else
                    blast%q(:, i) = [input%density, 0.0_dp, e_air]*volume
                end if
            end associate
        end do
    end subroutine start_blast1d

    !> Spread the faces on both sides of the contact, into r_new: evenly in the air; in the products
    !> they get closer towards the contact, where a cell expands most.
    subroutine place_faces(blast, contact, outside)
        type(blast1d_t), intent(inout) :: blast
        real(dp), intent(in) :: contact, outside !! radius of the contact and of the last face [m]
        real(dp) :: s
        integer :: i

        do i = 0, blast%n_in
            s = real(i, dp)/blast%n_in
            blast%r_new(i) = contact*s*(1 + grading*(1 - s))
        end do
        do i = blast%n_in + 1, blast%n
            blast%r_new(i) = contact + (outside - contact)*(i - blast%n_in)/(blast%n - blast%n_in)
        end do
    end subroutine place_faces

    !> Area at a radius per unit angle.
    pure elemental real(dp) function area_at(power, r)
        integer, intent(in) :: power
        real(dp), intent(in) :: r !! [m]

        area_at = r**power
    end function area_at

    !> What a sum per unit angle is multiplied with to get the whole blast, both sides of a plane.
    pure real(dp) function whole_angle(power)
        integer, intent(in) :: power
        real(dp), parameter :: pi = acos(-1.0_dp), whole(0:2) = [2.0_dp, 2*pi, 4*pi]

        whole_angle = whole(power)
    end function whole_angle

    !> Mass of the products, mass of the air, radial momentum and energy of a zone of cells, less
    !> what undisturbed air in the same place would have; all per unit angle.
    pure function blast1d_totals(blast) result(total)
        type(blast1d_t), intent(in) :: blast
        real(dp) :: total(4)

        associate (q => blast%q, n_in => blast%n_in, n => blast%n, in => blast%input)
            total(1) = sum(q(1, :n_in))
            total(2) = sum(q(1, n_in + 1:n)) - in%density*blast%xi(n)
            total(3) = sum(q(2, :n))
            total(4) = sum(q(3, :n)) - in%pressure/(in%gamma - 1)*blast%xi(n)
        end associate
    end function blast1d_totals
end module brz_blast1d_state
