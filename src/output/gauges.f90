! SPDX-License-Identifier: MIT
!> Gauges: the history of one quantity at one point of the air, or of one particle of a body.
!>
!> A gauge of a body follows the particle that is nearest to its point in the unloaded body, by
!> the particle's number, as the solver sorts the particles anew during a run.
!> A new quantity is one row of brz_gauge_quantities and one case of `value_of_gas` or
!> `value_of_particle`.
module brz_gauges
    use brz_air_probe, only: gas_state_at
    use brz_air_state, only: air_t, wall_t
    use brz_case, only: case_t, gauge_case_t, name_len
    use brz_check_start, only: is_radial
    use brz_errors, only: error_t, raise, exit_deck
    use brz_gauge_quantities, only: find_quantity, quantities
    use brz_kinds, only: dp
    use brz_ranks, only: bits_of_all, least_of_all, several
    use brz_solid_state, only: solid_t
    use brz_solid_step, only: velocity_at_step
    implicit none
    private
    public :: gauges_t, gauge_t, set_up_gauges, gauge_names, gauge_points, gauge_particles
    public :: gauge_row, gauges_need_state
    public :: radial_gauge_row

    type :: gauge_t
        character(name_len) :: id = ''
        character(16) :: quantity = ''
        character(8) :: unit = ''
        real(dp) :: at(3) = 0 !! [m]
        logical :: moves = .false. !! the motion of its particle is all that it needs
        integer :: body = 0 !! 0: the air
        integer :: particle = 0 !! number of the particle
        integer :: place = 0 !! where that particle was found last
    end type gauge_t

    type :: gauges_t
        integer :: n = 0
        type(gauge_t), allocatable :: list(:) !! (n)
        real(dp) :: rest = 0 !! pressure of the undisturbed air [Pa]
        logical :: active(3) = .true. !! directions in which the air is modelled
        real(dp) :: charge_mass = 0 !! of the charge if there is just one, else 0 [kg]
        real(dp) :: charge_at(3) = 0 !! its centre [m]
    end type gauges_t

contains

    !> Gauges of a scene. The particles must have their places in the unloaded body (x_ref).
    subroutine set_up_gauges(case, solid, gauges, err)
        type(case_t), intent(in) :: case
        type(solid_t), intent(in) :: solid
        type(gauges_t), intent(out) :: gauges
        type(error_t), intent(inout) :: err
        integer :: g

        gauges%rest = case%air%pressure
        gauges%active = case%air%cells > 1 .or. is_radial(case)
        if (allocated(case%charges)) then
            if (size(case%charges) == 1) then
                gauges%charge_mass = case%charges(1)%mass
                gauges%charge_at = case%charges(1)%at
            end if
        end if
        if (allocated(case%gauges)) gauges%n = size(case%gauges)
        allocate (gauges%list(gauges%n))
        do g = 1, gauges%n
            call set_up_gauge(case%gauges(g), case%air%present, solid, gauges%list(g), err)
        end do
    end subroutine set_up_gauges

    !> Places of the gauges in the air.
    pure function gauge_points(gauges) result(points)
        type(gauges_t), intent(in) :: gauges
        real(dp) :: points(3, count(gauges%list%body == 0)) !! [m]
        integer :: d

        do d = 1, 3
            points(d, :) = pack(gauges%list%at(d), gauges%list%body == 0)
        end do
    end function gauge_points

    subroutine set_up_gauge(input, with_air, solid, gauge, err)
        type(gauge_case_t), intent(in) :: input
        logical, intent(in) :: with_air
        type(solid_t), intent(in) :: solid
        type(gauge_t), intent(inout) :: gauge
        type(error_t), intent(inout) :: err
        integer :: q
        logical :: possible

        gauge%id = input%id
        gauge%quantity = input%quantity(:len(gauge%quantity))
        gauge%at = input%at
        gauge%body = input%body_index
        q = find_quantity(gauge%quantity)
        possible = q > 0
        if (possible) then
            gauge%unit = quantities(q)%unit
            gauge%moves = quantities(q)%moves
            possible = merge(quantities(q)%of_body, quantities(q)%of_air .and. with_air, &
                             gauge%body > 0)
        end if
        if (.not. possible) call raise(err, exit_deck, "&gauge id='"//trim(input%id)// &
                                       "': there is no '"//trim(input%quantity)// &
                                       "' to measure here; there is "// &
                                       known_quantities(gauge%body > 0, with_air))
        if (gauge%body > 0) call choose_particle(solid, gauge)
    end subroutine set_up_gauge

    !> What can be measured, for a message.
    pure function known_quantities(of_body, with_air) result(text)
        logical, intent(in) :: of_body, with_air
        character(:), allocatable :: text
        integer :: q

        text = ''
        do q = 1, size(quantities)
            if (.not. merge(quantities(q)%of_body, quantities(q)%of_air .and. with_air, &
                            of_body)) cycle
            if (text /= '') text = text//', '
            text = text//trim(quantities(q)%name)
        end do
        if (text == '') text = 'nothing without air'
    end function known_quantities

    !> The particle of the body that is nearest to the gauge; the lowest number among equals.
    subroutine choose_particle(solid, gauge)
        type(solid_t), intent(in) :: solid
        type(gauge_t), intent(inout) :: gauge
        real(dp) :: distance, least, nearest(1), number(1)
        integer :: i

        least = huge(least)
        do i = solid%bodies(gauge%body)%first, solid%bodies(gauge%body)%last
            distance = sum((solid%x_ref(:, i) - gauge%at)**2)
            if (distance > least .or. (distance >= least .and. solid%id(i) > gauge%particle)) cycle
            least = distance
            gauge%particle = solid%id(i)
            gauge%place = i
        end do
        if (.not. several(solid%ranks)) return
        nearest = least
        call least_of_all(solid%ranks, nearest)
        number = gauge%particle
        if (least > nearest(1)) number = huge(1)
        call least_of_all(solid%ranks, number)
        gauge%particle = nint(number(1))
    end subroutine choose_particle

    !> Columns of the history: time[s] and, for each gauge, id:quantity[unit].
    subroutine gauge_names(gauges, names)
        type(gauges_t), intent(in) :: gauges
        character(64), allocatable, intent(out) :: names(:) !! (n + 1)
        integer :: g

        allocate (names(gauges%n + 1))
        names(1) = 'time[s]'
        do g = 1, gauges%n
            associate (gauge => gauges%list(g))
                names(g + 1) = trim(gauge%id)//':'//trim(gauge%quantity)//'['//trim(gauge%unit)//']'
            end associate
        end do
    end subroutine gauge_names

    !> Numbers of the particles that gauges follow.
    pure function gauge_particles(gauges) result(id)
        type(gauges_t), intent(in) :: gauges
        integer, allocatable :: id(:)

        id = pack(gauges%list%particle, gauges%list%body > 0)
    end function gauge_particles

    !> True if gauges of bodies need more than the motion of their particles.
    pure logical function gauges_need_state(gauges)
        type(gauges_t), intent(in) :: gauges

        gauges_need_state = any(gauges%list%body > 0 .and. .not. gauges%list%moves)
    end function gauges_need_state

    !> One row of the history.
    subroutine gauge_row(gauges, time, air, wall, solid, row)
        type(gauges_t), intent(inout) :: gauges
        real(dp), intent(in) :: time !! [s]
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(solid_t), intent(in) :: solid
        real(dp), intent(out) :: row(:) !! (n + 1)
        real(dp) :: state(5)
        integer :: g, m

        row(1) = time
        m = 0
        do g = 1, gauges%n
            associate (gauge => gauges%list(g))
                if (gauge%body > 0) then
                    call find_particle(solid, gauge)
                    row(g + 1) = 0
                    if (gauge%place > 0) &
                        row(g + 1) = value_of_particle(solid, gauge%place, gauge%quantity)
                else
                    m = m + 1
                    if (several(air%part%ranks)) then
                        call gas_state_at(air, wall, gauge%at, state, air%part%seen(:, :, m))
                    else
                        call gas_state_at(air, wall, gauge%at, state)
                    end if
                    row(g + 1) = value_of_gas(state, real(air%p_rest, dp), gauge%quantity)
                end if
            end associate
        end do
        if (several(solid%ranks)) call bits_of_all(solid%ranks, row(2:))
    end subroutine gauge_row

    !> One row of the history, but its time, while the air is a blast in one dimension; bodies wait.
    subroutine radial_gauge_row(gauges, seen, centre, solid, row)
        type(gauges_t), intent(in) :: gauges
        real(dp), intent(in) :: seen(:, :) !! (3, n) density, radial velocity, pressure
        real(dp), intent(in) :: centre(3) !! of the charge [m]
        type(solid_t), intent(in) :: solid
        real(dp), intent(inout) :: row(:) !! (n + 1)
        real(dp) :: state(5), arm(3)
        integer :: g

        do g = 1, gauges%n
            associate (gauge => gauges%list(g))
                if (gauge%body > 0) then
                    row(g + 1) = value_of_particle(solid, gauge%place, gauge%quantity)
                    cycle
                end if
                arm = merge(gauge%at - centre, 0.0_dp, gauges%active)
                arm = arm/max(norm2(arm), tiny(arm))
                state = [seen(1, g), seen(2, g)*arm, seen(3, g)]
                row(g + 1) = value_of_gas(state, gauges%rest, gauge%quantity)
            end associate
        end do
    end subroutine radial_gauge_row

    !> Look a particle up again if it has been moved by sorting; place 0: another process has it.
    subroutine find_particle(solid, gauge)
        type(solid_t), intent(in) :: solid
        type(gauge_t), intent(inout) :: gauge

        associate (body => solid%bodies(gauge%body))
            if (gauge%place >= body%first .and. gauge%place <= body%last) then
                if (solid%id(gauge%place) == gauge%particle) return
            end if
            gauge%place = findloc(solid%id(body%first:body%last), gauge%particle, dim=1)
            if (gauge%place > 0) gauge%place = body%first - 1 + gauge%place
        end associate
    end subroutine find_particle

    pure real(dp) function value_of_gas(state, rest, quantity) result(value)
        real(dp), intent(in) :: state(5) !! density, velocity, pressure
        real(dp), intent(in) :: rest !! pressure of the undisturbed air [Pa]
        character(*), intent(in) :: quantity

        select case (quantity)
        case ('pressure'); value = state(5)
        case ('overpressure'); value = state(5) - rest
        case ('density'); value = state(1)
        case ('speed'); value = norm2(state(2:4))
        case default; value = state(1 + axis_of(quantity))
        end select
    end function value_of_gas

    !> Velocities are those at the time of the step.
    pure real(dp) function value_of_particle(solid, i, quantity) result(value)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        character(*), intent(in) :: quantity
        real(dp) :: v(3), d(3)

        v = velocity_at_step(solid, i)
        d = solid%x(:, i) - solid%x_ref(:, i)
        select case (quantity)
        case ('speed'); value = norm2(v)
        case ('damage'); value = solid%damage(i)
        case ('displacement_x', 'displacement_y', 'displacement_z'); value = d(axis_of(quantity))
        case default; value = v(axis_of(quantity))
        end select
    end function value_of_particle

    !> Axis that the last letter names.
    pure integer function axis_of(quantity)
        character(*), intent(in) :: quantity

        axis_of = index('xyz', quantity(len_trim(quantity):len_trim(quantity)))
    end function axis_of
end module brz_gauges
