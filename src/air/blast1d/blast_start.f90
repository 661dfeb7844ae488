! SPDX-License-Identifier: MIT
!> From a charge of the deck to the blast in one dimension, and how far that may run.
module brz_blast_start
    use brz_blast1d_state, only: blast1d_input_t
    use brz_case, only: case_t, charge_case_t
    use brz_body_geometries, only: body_box
    use brz_explosives, only: explosives, find_explosive
    use brz_jwl, only: jwl_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: radial_input, centred_input, free_radius, charge_constants

    real(dp), parameter :: pi = acos(-1.0_dp)
    real(dp), parameter :: on_plane = 1e-6_dp
    !! how exactly a plane of symmetry must pass the centre, in cells

contains

    !> The charge in open air along the radius: its mass is per length of a cylinder, per area of a
    !> plane, both sides.
    function radial_input(case) result(input)
        type(case_t), intent(in) :: case
        type(blast1d_input_t) :: input

        input = common_input(case)
        associate (volume => case%charges(1)%mass/case%charges(1)%density)
            select case (case%air%geometry)
            case ('planar')
                input%power = 0
                input%radius = volume/2
            case ('cylindrical')
                input%power = 1
                input%radius = sqrt(volume/pi)
            case default
                input%power = 2
                input%radius = (3*volume/(4*pi))**(1/3.0_dp)
            end select
        end associate
    end function radial_input

    !> The charge of a scene with a box: a sphere, a disc or a slab by the number of dimensions.
    pure function centred_input(case, radius) result(input)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: radius !! of the charge [m]
        type(blast1d_input_t) :: input

        input = common_input(case)
        input%power = count(case%air%cells > 1) - 1
        input%radius = radius
    end function centred_input

    !> What does not depend on the geometry.
    pure function common_input(case) result(input)
        type(case_t), intent(in) :: case
        type(blast1d_input_t) :: input

        associate (charge => case%charges(1), air => case%air)
            input%density = air%density
            input%pressure = air%pressure
            input%gamma = air%gamma
            input%n_in = charge%radial_cells
            input%n_air = 3*charge%radial_cells
            input%afterburn = charge%afterburn
            input%afterburn_time = charge%afterburn_time
        end associate
        call charge_constants(case, input%eos, input%velocity)
    end function common_input

    !> Equation of state of the products, and the velocity of the detonation, 0: burnt at once.
    pure subroutine charge_constants(case, eos, velocity)
        type(case_t), intent(in) :: case
        type(jwl_t), intent(out) :: eos
        real(dp), intent(out) :: velocity !! [m/s]
        integer :: row

        velocity = 0
        associate (charge => case%charges(1))
            row = find_explosive(charge%explosive)
            eos = jwl_t(rho0=charge%density, omega=case%air%gamma - 1, &
                e0=charge%density*charge%energy)
            if (charge%gamma > 1) eos%omega = charge%gamma - 1
            if (charge%eos /= 'jwl' .or. row == 0) return
            eos = jwl_t(charge%density, explosives(row)%a, explosives(row)%b, &
                explosives(row)%r1, explosives(row)%r2, explosives(row)%omega, &
                charge%density*charge%energy)
            if (charge%burn == 'programmed') velocity = charge%velocity
        end associate
    end subroutine charge_constants

    !> Distance from the charge to the nearest thing that a blast would feel: a body, a box of gas,
    !> a face of the air other than a plane of symmetry through the centre [m].
    real(dp) function free_radius(case) result(radius)
        type(case_t), intent(in) :: case
        real(dp) :: lo(3), hi(3), dx(3), depth
        logical :: active(3)
        integer :: b, d, s

        active = case%air%cells > 1
        dx = (case%air%hi - case%air%lo)/case%air%cells
        radius = huge(radius)
        associate (at => case%charges(1)%at)
            do d = 1, 3
                if (.not. active(d)) cycle
                do s = 1, 2
                    depth = merge(at(d) - case%air%lo(d), case%air%hi(d) - at(d), s == 1)
                    if (case%air%bc(s, d) == 'symmetry' .and. abs(depth) <= on_plane*dx(d)) cycle
                    radius = min(radius, depth)
                end do
            end do
            do b = 1, size(case%bodies)
                call body_box(case%bodies(b), lo, hi)
                radius = min(radius, distance(at, lo, hi, active))
            end do
            do b = 1, size(case%gas)
                radius = min(radius, distance(at, case%gas(b)%lo, case%gas(b)%hi, active))
            end do
        end associate
    end function free_radius

    !> Distance from a point to a box, in the directions that are modelled.
    pure real(dp) function distance(at, lo, hi, active)
        real(dp), intent(in) :: at(3), lo(3), hi(3) !! [m]
        logical, intent(in) :: active(3)

        distance = norm2(merge(max(lo - at, at - hi, 0.0_dp), 0.0_dp, active))
    end function distance
end module brz_blast_start
