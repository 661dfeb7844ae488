! SPDX-License-Identifier: MIT
!> A blast in the plane through an axis, (r, z): its cells, what they hold, and the charge in them.
!>
!> The plane has n cells along r and n on either side of the centre of the charge along z, which is
!> the face between rows 0 and 1 at first; a floor cuts the rows below it off. Whatever the blast,
!> its front lies n/2 to n cells from the centre: when it nears the edge, two by two cells are made
!> one.
module brz_axial_state
    use brz_axial_products, only: axial_gas_t
    use brz_jwl, only: jwl_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: axial_t, axial_input_t, start_axial, axial_totals, find_lighting, margin_cells, top_of
    public :: v_rho, v_r, v_z, v_energy, v_products, w_rho, w_r, w_z, w_p, w_energy, w_part, w_sound

    integer, parameter :: v_rho = 1, v_r = 2, v_z = 3, v_energy = 4, v_products = 5 !! rows of u
    integer, parameter :: w_rho = 1, w_r = 2, w_z = 3, w_p = 4, w_energy = 5, w_part = 6, &
                          w_sound = 7 !! rows of w
    integer, parameter :: margin_cells = 6 !! between the front and the edge
    integer, parameter :: n_sub = 20 !! points per direction in a cell that a ball cuts
    real(dp), parameter :: room = 1.25_dp !! edge of the plane at the start, over that of the charge
    real(dp), parameter :: never = huge(1.0_dp)

    !> What a blast starts from.
    type :: axial_input_t
        logical :: ball = .false. !! else a cylinder
        real(dp) :: radius = 0 !! [m]
        real(dp) :: half = 0 !! half the length of a cylinder, the radius of a ball [m]
        type(jwl_t) :: eos !! products; rho0 and e0 are those of the charge
        real(dp) :: velocity = 0 !! of the detonation; 0: burnt at once at constant volume [m/s]
        real(dp) :: ignition = 0 !! place on the axis where the detonation begins, over z [m]
        real(dp) :: density = 1.225_dp, pressure = 101325, gamma = 1.4_dp !! undisturbed air
        real(dp) :: floor = never !! distance of a rigid floor below the centre of the charge [m]
        integer :: n = 160 !! cells from the axis to the edge
        integer :: n_charge = 0 !! cells in the smaller of radius and half length; 0: a quarter of n
        real(dp) :: cfl = 0.5_dp
    end type axial_input_t

    type :: axial_t
        type(axial_input_t) :: input
        type(axial_gas_t) :: gas
        integer :: n = 0 !! cells along r, and on either side of the centre along z
        integer :: low = 0 !! lowest row
        integer :: below = -1 !! rows below row 1 down to the floor; negative: no floor
        real(dp) :: rise = 0 !! of the face below row 1 over the centre of the charge [m]
        real(dp) :: dr = 0, dz = 0 !! [m]
        real(dp) :: time = 0 !! [s]
        integer :: cycle = 0
        integer :: merged = 0 !! how often cells were made one
        logical :: burning = .false.
        real(dp) :: rest(5) = 0 !! undisturbed air
        integer :: reach = 0, first = 0, last = 0 !! column and rows of the front
        integer, allocatable :: reached(:) !! (low:n) last column of the front in each row
        real(dp), allocatable :: u(:, :, :)
        !! (n, 5, rows) mass, momentum, energy, products per volume
        real(dp), allocatable :: u_start(:, :, :) !! of the step
        real(dp), allocatable :: lit_at(:, :) !! (n, rows) when it burns; -never: is burnt [s]
        ! what follows is derived from u before each stage, with two ghosts on each side
        real(dp), allocatable :: w(:, :, :)
        !! (-1:n+2, 7, rows) density, velocity, pressure, internal energy per volume, mass fraction
        !! of products, speed of sound
        real(dp), allocatable :: slope(:, :, :) !! (n, 6, rows) along z, per half cell
        real(dp), allocatable :: flux_r(:, :, :), flux_z(:, :, :)
        !! (0:n, 6, rows) of mass, momentum without pressure along and across, energy, products, and
        !! the pressure, through the upper face of a cell
        real(dp), allocatable :: smooth(:, :) !! (0:n+1, rows) 0: no slopes in this step, else 1
        real(dp), allocatable :: x(:) !! (-1:n+2) centres of mass of even cells over dr
    end type axial_t

contains

    !> Charge and air at rest, at time zero.
    subroutine start_axial(input, blast)
        type(axial_input_t), intent(in) :: input
        type(axial_t), intent(out) :: blast
        integer :: i, n

        blast%input = input
        blast%burning = input%velocity > 0
        n = 2*((input%n + 1)/2)
        blast%n = n
        call choose_cells(blast)
        blast%rest = [input%density, 0.0_dp, 0.0_dp, input%pressure/(input%gamma - 1), 0.0_dp]
        blast%gas = axial_gas_t(input%eos, input%gamma, input%density, input%pressure, &
            (input%eos%e0 - blast%rest(v_energy))/input%eos%rho0)
        associate (low => blast%low)
            allocate (blast%u(n, 5, low:n), blast%u_start(n, 5, low:n), &
                blast%slope(n, 6, low - 1:n + 1), blast%flux_r(0:n, 6, low:n), &
                blast%flux_z(0:n, 6, low - 1:n), &
                blast%w(-1:n + 2, 7, low - 2:n + 2), source=0.0_dp)
            allocate (blast%lit_at(n, low:n), source=-never)
            allocate (blast%smooth(0:n + 1, low - 1:n + 1), source=1.0_dp)
            allocate (blast%reached(low:n), source=0)
        end associate
        allocate (blast%x(-1:n + 2))
        do i = 1, n + 2
            blast%x(i) = (i*i - i + 1/3.0_dp)/(i - 0.5_dp)
        end do
        blast%x(-1:0) = -blast%x([2, 1])
        call place_charge(blast)
        call find_lighting(blast)
    end subroutine start_axial

    !> Height of the upper face of a row over the centre of the charge [m].
    elemental real(dp) function top_of(blast, j)
        type(axial_t), intent(in) :: blast
        integer, intent(in) :: j

        top_of = blast%rise + j*blast%dz
    end function top_of

    !> Sides of the cells: whole numbers of them fill radius and half length, or, with a floor, the
    !> distance to it.
    subroutine choose_cells(blast)
        type(axial_t), intent(inout) :: blast
        real(dp) :: side
        integer :: n

        associate (in => blast%input)
            n = in%n_charge
            if (n <= 0) n = max(blast%n/4, 1)
            side = max(min(in%radius, in%half)/n, room*max(in%radius, in%half)/blast%n)
            blast%dr = in%radius/nint(in%radius/side)
            blast%dz = in%half/nint(in%half/side)
            blast%low = 1 - blast%n
            blast%below = -1
            if (.not. in%floor < never) return
            blast%below = 0
            if (in%floor > 0) then
                blast%below = nint(in%floor/side)
                blast%dz = in%floor/blast%below
            end if
            blast%low = max(1 - blast%below, blast%low)
        end associate
    end subroutine choose_cells

    !> Fill the cells; those that the surface cuts are mixed by volume, the mass is exact.
    subroutine place_charge(blast)
        type(axial_t), intent(inout) :: blast
        real(dp), parameter :: pi = acos(-1.0_dp)
        real(dp) :: filled, sums(5), volume, hot(5)
        integer :: i, j

        associate (in => blast%input)
            volume = merge(2*pi/3, pi, in%ball)*in%radius**2*in%half/pi ! per radian
            if (blast%below == 0) volume = volume/2
            hot = [in%eos%rho0, 0.0_dp, 0.0_dp, blast%gas%held_back*in%eos%rho0, in%eos%rho0]
            do j = blast%low, blast%n
                do i = 1, blast%n
                    filled = part_filled(blast, i, j)
                    blast%u(i, :, j) = filled*hot + blast%rest*[1 - filled, 0.0_dp, 0.0_dp, &
                        1.0_dp, 0.0_dp]
                end do
            end do
            sums = plain_sums(blast)
            hot = hot*(in%eos%rho0*volume/sums(v_products) - 1)
            do j = blast%low, blast%n
                do i = 1, blast%n
                    filled = blast%u(i, v_products, j)/in%eos%rho0
                    if (filled > 0) blast%u(i, :, j) = blast%u(i, :, j) + filled*hot
                end do
            end do
        end associate
    end subroutine place_charge

    !> Part of a cell that the charge fills, exact for a cylinder.
    pure real(dp) function part_filled(blast, i, j) result(filled)
        type(axial_t), intent(in) :: blast
        integer, intent(in) :: i, j
        real(dp) :: r(2), z(2), at(2)
        integer :: a, b, hits

        associate (in => blast%input)
            r = [i - 1, i]*blast%dr
            z = sort_ends([top_of(blast, j - 1), top_of(blast, j)])
            filled = 0
            if (r(1) >= in%radius .or. z(1) >= in%half) return
            if (.not. in%ball) then
                filled = (min(r(2), in%radius)**2 - r(1)**2)/(r(2)**2 - r(1)**2) &
                    *(min(z(2), in%half) - z(1))/(z(2) - z(1))
                if (filled > 1 - 1e-9_dp) filled = 1
                return
            end if
            if (norm2([r(1), z(1)]) >= in%radius) return
            filled = 1
            if (norm2([r(2), z(2)]) <= in%radius) return
            hits = 0
            do b = 1, n_sub
                do a = 1, n_sub ! rings of equal volume
                    at(1) = sqrt(r(1)**2 + (a - 0.5_dp)/n_sub*(r(2)**2 - r(1)**2))
                    at(2) = z(1) + (b - 0.5_dp)/n_sub*(z(2) - z(1))
                    if (norm2(at) < in%radius) hits = hits + 1
                end do
            end do
            filled = hits/real(n_sub**2, dp)
        end associate
    end function part_filled

    !> Distances of the two ends of a row from the centre, the nearer first.
    pure function sort_ends(z) result(ends)
        real(dp), intent(in) :: z(2)
        real(dp) :: ends(2)

        ends = [max(z(1), -z(2), 0.0_dp), maxval(abs(z))]
    end function sort_ends

    !> When the explosive burns: the detonation runs straight from its point. What lies outside of
    !> the charge has come there burnt.
    subroutine find_lighting(blast)
        type(axial_t), intent(inout) :: blast
        integer :: i, j

        blast%lit_at = -never
        if (.not. blast%burning) return
        do j = blast%low, blast%n
            do i = 1, blast%n
                if (.not. part_filled(blast, i, j) > 0) cycle
                associate (z => top_of(blast, j) - blast%dz/2 - blast%input%ignition, &
                           r => (i - 0.5_dp)*blast%dr)
                    blast%lit_at(i, j) = norm2([r, z])/blast%input%velocity
                end associate
            end do
        end do
    end subroutine find_lighting

    !> Sums over all cells, per radian.
    pure function plain_sums(blast) result(sums)
        type(axial_t), intent(in) :: blast
        real(dp) :: sums(5)
        integer :: i, j

        sums = 0
        do j = blast%low, blast%n
            do i = 1, blast%n
                sums = sums + (i - 0.5_dp)*blast%u(i, :, j)
            end do
        end do
        sums = sums*blast%dr**2*blast%dz
    end function plain_sums

    !> Mass, radial and axial momentum, energy and products, less what undisturbed air in the same
    !> place would have; of the whole circle.
    pure function axial_totals(blast) result(sums)
        type(axial_t), intent(in) :: blast
        real(dp) :: sums(5)
        real(dp), parameter :: pi = acos(-1.0_dp)
        real(dp) :: row(5)
        integer :: i, j

        sums = 0
        do j = blast%low, blast%n
            row = 0
            do i = 1, blast%n
                row = row + (i - 0.5_dp)*(blast%u(i, :, j) - blast%rest)
            end do
            sums = sums + row
        end do
        sums = 2*pi*sums*blast%dr**2*blast%dz
    end function axial_totals
end module brz_axial_state
