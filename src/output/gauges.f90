! SPDX-License-Identifier: MIT
!> Gauges: the history of one quantity at one point of the air, of one particle of a body, or of a
!> whole body.
!>
!> A gauge of a body follows the particle that is nearest to its point in the unloaded body, or the
!> particles in a box about it, by their numbers, as the solver sorts them anew during a run.
!> A quantity is a row of brz_gauge_quantities: a place in what is known of the gas at a point of
!> the air (`value_of_gas`), or in a source of a particle (`value_of_particle`).
module brz_gauges
    use brz_air_probe, only: gas_state_at, has_point, sees_gas
    use brz_air_state, only: air_t, wall_t
    use brz_case, only: case_t, gauge_case_t, label, name_len
    use brz_gauge_box, only: points_of_gauge
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_formulation_names, only: form_rigid
    use brz_gauge_places, only: choose_particle, choose_particles, find_places, strain_between
    use brz_gauge_samples, only: add_sample, means_of, samples_t
    use brz_gauge_quantities, only: find_quantity, from_impulse, is_motion, is_of_body, &
        of_displacement, of_history, of_state, of_strain, of_stress, of_velocity, quantities, &
        quantity_t
    use brz_interaction, only: law_contact
    use brz_kinds, only: dp, int64
    use brz_material, only: n_hist
    use brz_materials, only: history_names
    use brz_particle_marks, only: is_free
    use brz_ranks, only: several, sum_of_all
    use brz_force_driver, only: n_forces
    use brz_bodies, only: bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_step_velocity, only: velocity_at_step
    use brz_tensile_control, only: largest_tension
    use brz_wide_lattice, only: unloaded_place
    implicit none
    private
    public :: gauges_t, gauge_t, set_up_gauges, gauge_names, gauge_points, gauge_particles, &
        gauge_places
    public :: gauge_row, gauges_need_state
    public :: early_gauge_row

    type :: gauge_t
        character(name_len) :: id = ''
        type(quantity_t) :: of = quantity_t('', '') !! what it measures
        real(dp) :: at(3) = 0 !! [m]
        integer :: body = 0 !! 0: the air
        integer :: with = 0 !! what this other body does to it; 0: whatever acts on it
        real(dp) :: force(n_forces) = 0 !! on the whole body, where it asks for one of them
        real(dp), allocatable :: points(:, :) !! (3, n) where it looks in the air [m]
        integer, allocatable :: particle(:) !! numbers of the particles that it follows
        integer, allocatable :: place(:) !! where those were found last
        real(dp), allocatable :: weight(:) !! of each in the mean; of a strain: both ends
        integer :: pair = 0 !! place among those of solid%between
        integer :: region = 0 !! motion of the body on which the force is; 0: all that holds it
        integer :: slot = 0 !! in the history of the material
    end type gauge_t

    type :: gauges_t
        integer :: n = 0
        type(gauge_t), allocatable :: list(:) !! (n)
        real(dp) :: rest = 0 !! pressure of the undisturbed air [Pa]
        real(dp) :: charge_mass = 0 !! of the charge if there is just one, else 0 [kg]
        real(dp) :: charge_at(3) = 0 !! its centre [m]
    end type gauges_t

contains

    !> Gauges of a scene. The particles must have their places in the unloaded body (x_ref).
    subroutine set_up_gauges(case, solid, gauges, err)
        type(case_t), intent(in) :: case
        class(interacting_bodies_t), intent(in) :: solid
        type(gauges_t), intent(out) :: gauges
        type(error_t), intent(inout) :: err
        integer :: g

        gauges%rest = case%air%pressure
        if (allocated(case%charges)) then
            if (size(case%charges) == 1) then
                gauges%charge_mass = case%charges(1)%mass
                if (case%charges(1)%on_ground) gauges%charge_mass = gauges%charge_mass/2
                gauges%charge_at = case%charges(1)%at
            end if
        end if
        if (allocated(case%gauges)) gauges%n = size(case%gauges)
        allocate (gauges%list(gauges%n))
        do g = 1, gauges%n
            call set_up_gauge(case, case%gauges(g), solid, gauges%list(g), err)
            if (failed(err)) return
        end do
    end subroutine set_up_gauges

    !> Places of the gauges in the air.
    pure function gauge_points(gauges) result(points)
        type(gauges_t), intent(in) :: gauges
        real(dp), allocatable :: points(:, :) !! (3, n) [m]
        integer :: g, m, n

        n = 0
        do g = 1, gauges%n
            n = n + size(gauges%list(g)%points, 2)
        end do
        allocate (points(3, n))
        m = 0
        do g = 1, gauges%n
            n = size(gauges%list(g)%points, 2)
            points(:, m + 1:m + n) = gauges%list(g)%points
            m = m + n
        end do
    end function gauge_points

    subroutine set_up_gauge(case, input, solid, gauge, err)
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(in) :: input
        class(interacting_bodies_t), intent(in) :: solid
        type(gauge_t), intent(inout) :: gauge
        type(error_t), intent(inout) :: err
        integer :: q
        logical :: possible

        gauge%id = input%id
        gauge%at = input%at
        gauge%body = input%body_index
        gauge%with = input%with_index
        gauge%region = input%motion_index
        allocate (gauge%points(3, 0), gauge%particle(0), gauge%place(0), gauge%weight(0))
        q = find_quantity(trim(input%quantity))
        possible = q > 0
        if (possible) then
            gauge%of = quantities(q)
            possible = merge(is_of_body(gauge%of), gauge%of%gas > 0 .and. case%air%present, &
                             gauge%body > 0)
        end if
        if (.not. possible) call raise(err, exit_deck, "&gauge id='"//trim(input%id)// &
                                       "': there is no '"//trim(input%quantity)// &
                                       "' to measure here; there is "// &
                                       known_quantities(gauge%body > 0, &
                                       case%air%present))
        if (failed(err)) return
        if (gauge%body == 0) then
            call points_of_gauge(case, input, gauge%points)
            return
        end if
        if (gauge%with > 0) call find_pair(input, solid, gauge%pair, err)
        if (gauge%of%whole > 0) then
            if (any(index(gauge%of%name, ['reaction', 'moment  ']) == 1)) &
                call find_support(input, solid, err)
            return
        end if
        call choose_particles(solid, gauge%body, gauge%at, input%width, &
                              case%run%dimension, gauge%particle, gauge%weight)
        gauge%place = 0*gauge%particle
        call find_places(solid, gauge%body, gauge%particle, gauge%place)
        if (gauge%of%body == of_strain) call find_end(input, solid, gauge, err)
        if (gauge%of%body == of_history) call find_slot(input, solid, gauge, err)
        if (gauge%of%name == 'damage' .and. &
            solid%materials(solid%bodies(gauge%body)%material)%fails == 0) call raise(err, &
            exit_deck, label('gauge', input%id, input%place)//'the material of body '// &
            trim(input%body)//' has no strength that it could lose; take the gauge out')
    end subroutine set_up_gauge

    !> The two bodies of a force between them: they must meet by contact.
    subroutine find_pair(input, solid, pair, err)
        type(gauge_case_t), intent(in) :: input
        class(interacting_bodies_t), intent(in) :: solid
        integer, intent(out) :: pair
        type(error_t), intent(inout) :: err
        logical :: meets

        associate (a => input%body_index, b => input%with_index)
            do pair = 1, size(solid%between)
                if (all(solid%between(pair)%body == [a, b])) exit
            end do
            meets = solid%links%present
            if (meets) meets = solid%links%table(a, b)%law == law_contact
            if (.not. meets) call raise(err, exit_deck, label('gauge', input%id, input%place)// &
                'bodies '//trim(input%body)//' and '//trim(input%with)//" do not meet by "// &
                "law='contact', and no other force between them is measured; take with out")
        end associate
    end subroutine find_pair

    !> A force on what holds a body needs that.
    subroutine find_support(input, solid, err)
        type(gauge_case_t), intent(in) :: input
        class(bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer(int64) :: held(1)

        associate (body => solid%bodies(input%body_index))
            if (body%motion%n > 0 .or. allocated(body%regions)) return
            if (body%formulation == form_rigid) then
                if (any([body%rigid%moves, body%rigid%turns] < 1)) return
            else
                held = count(solid%fixed(body%first:body%last) /= is_free)
                call sum_of_all(solid%ranks, held)
                if (held(1) > 0) return
            end if
        end associate
        call raise(err, exit_deck, label('gauge', input%id, input%place)//'nothing holds body '// &
                   trim(input%body)//'; measure contact, load or impulse')
    end subroutine find_support

    !> The other end of a strain gauge.
    subroutine find_end(input, solid, gauge, err)
        type(gauge_case_t), intent(in) :: input
        class(bodies_t), intent(in) :: solid
        type(gauge_t), intent(inout) :: gauge
        type(error_t), intent(inout) :: err

        integer :: other, place

        call choose_particle(solid, gauge%body, input%to, other, place)
        gauge%particle = [gauge%particle, other]
        gauge%place = [gauge%place, place]
        if (gauge%particle(1) == gauge%particle(2)) call raise(err, exit_deck, label('gauge', &
            input%id, input%place)//'both ends of the strain gauge are one particle; move them '// &
            'apart')
    end subroutine find_end

    !> The slot of a quantity in the history of the material.
    subroutine find_slot(input, solid, gauge, err)
        type(gauge_case_t), intent(in) :: input
        class(bodies_t), intent(in) :: solid
        type(gauge_t), intent(inout) :: gauge
        type(error_t), intent(inout) :: err
        character(32) :: names(n_hist)
        character(12) :: units(n_hist)

        call history_names(solid%materials(solid%bodies(gauge%body)%material), names, units)
        gauge%slot = findloc(names, gauge%of%name, dim=1)
        if (gauge%slot == 0) call raise(err, exit_deck, label('gauge', input%id, input%place)// &
            'the material of body '//trim(input%body)//' keeps no '//trim(gauge%of%name)// &
            '; take another quantity')
    end subroutine find_slot

    !> What can be measured, for a message.
    pure function known_quantities(of_body, with_air) result(text)
        logical, intent(in) :: of_body, with_air
        character(:), allocatable :: text
        integer :: q

        text = ''
        do q = 1, size(quantities)
            if (.not. merge(is_of_body(quantities(q)), quantities(q)%gas > 0 .and. with_air, &
                            of_body)) cycle
            if (text /= '') text = text//', '
            text = text//trim(quantities(q)%name)
        end do
        if (text == '') text = 'nothing without air'
    end function known_quantities

    !> Columns of the history: time[s] and, for each gauge, id:quantity[unit].
    subroutine gauge_names(gauges, names)
        type(gauges_t), intent(in) :: gauges
        character(64), allocatable, intent(out) :: names(:) !! (n + 1)
        integer :: g

        allocate (names(gauges%n + 1))
        names(1) = 'time[s]'
        do g = 1, gauges%n
            associate (gauge => gauges%list(g))
                names(g + 1) = trim(gauge%id)//':'//trim(gauge%of%name)//'['// &
                    trim(gauge%of%unit)//']'
            end associate
        end do
    end subroutine gauge_names

    !> Numbers of the particles that gauges follow.
    pure function gauge_particles(gauges) result(id)
        type(gauges_t), intent(in) :: gauges
        integer, allocatable :: id(:)
        integer :: g

        id = [integer ::]
        do g = 1, gauges%n
            id = [id, gauges%list(g)%particle]
        end do
    end function gauge_particles

    !> Where these lay on this process when a row was last written.
    pure function gauge_places(gauges) result(place)
        type(gauges_t), intent(in) :: gauges
        integer, allocatable :: place(:)
        integer :: g

        place = [integer ::]
        do g = 1, gauges%n
            place = [place, gauges%list(g)%place]
        end do
    end function gauge_places

    !> True if gauges of bodies need more than the motion of their particles.
    pure logical function gauges_need_state(gauges)
        type(gauges_t), intent(in) :: gauges

        integer :: g

        gauges_need_state = .false.
        do g = 1, gauges%n
            associate (gauge => gauges%list(g))
                gauges_need_state = gauges_need_state .or. &
                                    size(gauge%particle) > 0 .and. .not. is_motion(gauge%of)
            end associate
        end do
    end function gauges_need_state

    !> One row of the history. On several processes each has the values at some places, and all
    !> form the same means of them, in the same order.
    subroutine gauge_row(gauges, time, air, wall, solid, row)
        type(gauges_t), intent(inout) :: gauges
        real(dp), intent(in) :: time !! [s]
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        class(interacting_bodies_t), intent(in) :: solid
        real(dp), intent(out) :: row(:) !! (n + 1)
        type(samples_t) :: all
        integer :: g, m

        row(1) = time
        m = 0
        do g = 1, gauges%n
            associate (gauge => gauges%list(g))
                if (gauge%body > 0) then
                    call look_at_body(solid, gauge, g, all)
                else
                    call look_at_air(air, wall, gauge, [g, m], all)
                    m = m + size(gauge%points, 2)
                end if
            end associate
        end do
        call means_of(all, solid%ranks, row(2:))
    end subroutine gauge_row

    !> One row of the history, but its time, while the air is a blast in one or two dimensions;
    !> bodies wait.
    subroutine early_gauge_row(gauges, seen, solid, row)
        type(gauges_t), intent(inout) :: gauges
        real(dp), intent(in) :: seen(:, :) !! (5, n) density, velocity, pressure at their points
        class(interacting_bodies_t), intent(in) :: solid
        real(dp), intent(inout) :: row(:) !! (n + 1)
        type(samples_t) :: all
        integer :: g, k, m

        m = 0
        do g = 1, gauges%n
            associate (gauge => gauges%list(g))
                if (gauge%body > 0) then
                    call look_at_body(solid, gauge, g, all)
                else
                    do k = 1, size(gauge%points, 2)
                        m = m + 1
                        call add_sample(all, g, value_of_gas(seen(:, m), gauges%rest, gauge%of), &
                                        1.0_dp)
                    end do
                end if
            end associate
        end do
        call means_of(all, solid%ranks, row(2:))
    end subroutine early_gauge_row

    !> What a gauge sees at its points in the air. Points in solid do not count in its mean.
    subroutine look_at_air(air, wall, gauge, at, all)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(gauge_t), intent(in) :: gauge
        integer, intent(in) :: at(2) !! its number; points of gauges before
        type(samples_t), intent(inout) :: all
        real(dp) :: state(5)
        integer :: k

        do k = 1, size(gauge%points, 2)
            associate (point => gauge%points(:, k))
                if (several(air%part%ranks) .and. .not. wall%present) then
                    call gas_state_at(air, wall, point, state, air%part%seen(:, :, at(2) + k))
                else if (several(air%part%ranks) .and. .not. has_point(air, point)) then
                    call add_sample(all, at(1), 0.0_dp, 0.0_dp) ! another process has it
                    cycle
                else
                    call gas_state_at(air, wall, point, state)
                end if
                call add_sample(all, at(1), &
                    value_of_gas(state, real(air%p_rest, dp), gauge%of), &
                    merge(1.0_dp, 0.0_dp, sees_gas(air, wall, point)))
            end associate
        end do
    end subroutine look_at_air

    !> What a gauge sees of a body: one number of all of it, or one of each of its particles.
    subroutine look_at_body(solid, gauge, g, all)
        class(interacting_bodies_t), intent(in) :: solid
        type(gauge_t), intent(inout) :: gauge
        integer, intent(in) :: g !! its number
        type(samples_t), intent(inout) :: all
        real(dp) :: value
        integer :: k

        call find_places(solid, gauge%body, gauge%particle, gauge%place)
        if (size(gauge%particle) == 0 .or. gauge%of%body == of_strain) then
            call add_sample(all, g, value_of_body(solid, gauge), 1.0_dp)
            return
        end if
        do k = 1, size(gauge%particle)
            value = 0 ! another process has the particle
            if (gauge%place(k) > 0) value = value_of_particle(solid, gauge, gauge%place(k))
            call add_sample(all, g, value, gauge%weight(k))
        end do
    end subroutine look_at_body

    !> A force on a whole body or its impulse, or the strain between two particles.
    real(dp) function value_of_body(solid, gauge) result(value)
        class(interacting_bodies_t), intent(in) :: solid
        type(gauge_t), intent(in) :: gauge

        associate (whole => gauge%of%whole)
            if (gauge%with > 0) then
                associate (between => solid%between(gauge%pair), axis => modulo(whole - 1, 3) + 1)
                    value = merge(between%impulse(axis), between%force(axis), whole >= from_impulse)
                end associate
            else if (gauge%region > 0) then
                value = solid%bodies(gauge%body)%regions(gauge%region)%reaction_force(whole)
            else if (whole >= from_impulse) then
                value = solid%bodies(gauge%body)%impulse(whole - from_impulse + 1)
            else if (whole > 0) then
                value = gauge%force(whole)
            else
                value = strain_between(solid, gauge%body, gauge%place)
            end if
        end associate
    end function value_of_body

    pure real(dp) function value_of_gas(state, rest, quantity) result(value)
        real(dp), intent(in) :: state(5) !! density, velocity, pressure
        real(dp), intent(in) :: rest !! pressure of the undisturbed air [Pa]
        type(quantity_t), intent(in) :: quantity
        real(dp) :: known(7)

        known = [state, state(5) - rest, norm2(state(2:4))]
        value = known(quantity%gas)
    end function value_of_gas

    !> Velocities are those at the time of the step.
    pure real(dp) function value_of_particle(solid, gauge, i) result(value)
        class(bodies_t), intent(in) :: solid
        type(gauge_t), intent(in) :: gauge
        integer, intent(in) :: i !! where the particle lies
        real(dp) :: known(9), d(3), v(3)

        associate (s => real(solid%stress(:, i), dp))
            select case (gauge%of%body)
            case (of_velocity)
                v = velocity_at_step(solid, i)
                known(:4) = [v, norm2(v)]
            case (of_displacement)
                d = solid%x(:, i) - unloaded_place(solid, gauge%body, i)
                known(:3) = d
            case (of_stress)
                known = [s, -sum(s(1:3))/3, sqrt(((s(1) - s(2))**2 + (s(2) - s(3))**2 &
                    + (s(3) - s(1))**2)/2 + 3*sum(s(4:6)**2)), &
                    real(largest_tension(solid%stress(:, i)), dp)]
            case (of_state)
                known(:2) = [solid%materials(solid%bodies(gauge%body)%material)%density &
                             *(1 + real(solid%mu(i), dp)), real(solid%damage(i), dp)]
            case default ! of_history
                value = solid%hist(gauge%slot, i)
                return
            end select
        end associate
        value = known(gauge%of%row)
    end function value_of_particle
end module brz_gauges
