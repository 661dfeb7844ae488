! SPDX-License-Identifier: MIT
!> Cohesive interfaces, from the deck and the particles: points, stiffness, stable step.
module brz_cohesive_setup
    use brz_bond_marks, only: loose_by
    use brz_case, only: case_t, interaction_case_t, label
    use brz_cohesive_faces, only: drop_faces, faces_t, find_faces
    use brz_cohesive_layers, only: add_layers, keep_energy
    use brz_cohesive_law, only: mode_of, slide_range
    use brz_cohesive_numbers, only: cohesive_law_t, mixed_bk, mixed_power
    use brz_cohesive_points, only: begin_points, lay_points, link_nodes
    use brz_cohesive_state, only: cohesive_t
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_interaction, only: law_cohesive, law_contact
    use brz_interaction_setup, only: find_rule
    use brz_kinds, only: dp, int32, real32
    use brz_material, only: material_t
    use brz_particle_marks, only: is_fixed
    use brz_bodies, only: bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: interface_name, set_up_cohesive, zone_over_spacing

    real(dp), parameter :: usual_stiffness = 10 !! times the modulus of one spacing
    real(dp), parameter :: stable_share = 0.8_dp !! of the stable step of a spring, 2/omega
    real(dp), parameter :: least_step = 0.5_dp !! of the bodies' step, with the usual stiffness
    real(dp), parameter :: most_ratio = 2.01_dp !! of the spacings of two bodies
    integer, parameter :: most_bits = loose_by !! of a body
    real(dp), parameter :: resolved = 3 !! spacings in a cohesive zone

contains

    !> All interfaces of a scene whose particles are placed and in the order of their numbers.
    subroutine set_up_cohesive(case, apart, solid, err)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: apart(:, :) !! (3, bodies) of the lattices [m]
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(interaction_case_t) :: rule
        integer :: a, b, n

        if (.not. solid%links%present .or. failed(err)) return
        n = count(solid%links%table%law == law_cohesive)/2
        if (n == 0) return
        allocate (solid%cohesive%law(n), solid%cohesive%body(2, n), solid%cohesive%bit(n), &
                  solid%cohesive%facing(n), solid%cohesive%limit(n), solid%cohesive%softened(n))
        call begin_points(solid%cohesive)
        n = 0
        do b = 1, size(solid%bodies)
            do a = 1, b - 1
                if (solid%links%table(a, b)%law /= law_cohesive) cycle
                call find_rule(case, a, b, rule)
                call lay_interface(case, rule, [a, b], apart, solid, n, err)
                if (failed(err)) return
            end do
        end do
        call keep_first(solid%cohesive, n)
        if (n == 0) return
        solid%cohesive%present = .true.
        solid%cohesive%farthest = maxval(abs(solid%x_ref(:, :solid%n)))
        call link_nodes(solid%cohesive, solid%n)
        allocate (solid%links%joined(solid%n), source=0_int32)
        call settle_stiffness(solid, err)
        do n = 1, size(solid%cohesive%law)
            if (.not. failed(err)) call keep_energy(solid, n)
            call judge_interface(case, n, solid, err)
        end do
    end subroutine set_up_cohesive

    !> Points of one interface. Bodies that do not touch meet by contact, or are refused where the
    !> deck names both.
    subroutine lay_interface(case, rule, pair, apart, solid, k, err)
        type(case_t), intent(in) :: case
        type(interaction_case_t), intent(in) :: rule
        integer, intent(in) :: pair(2) !! bodies
        real(dp), intent(in) :: apart(:, :)
        class(interacting_bodies_t), intent(inout) :: solid
        integer, intent(inout) :: k !! interfaces so far
        type(error_t), intent(inout) :: err
        type(faces_t) :: faces
        real(dp) :: layers(3, 2), spacing(2)
        integer :: a, b, i

        a = pair(1)
        b = pair(2)
        if (solid%bodies(b)%spacing < (1 - 1e-6_dp)*solid%bodies(a)%spacing) then
            a = pair(2)
            b = pair(1)
        end if
        layers = apart(:, [a, b])
        spacing = maxval(layers(:solid%dimension, :), dim=1)
        call find_faces(solid, a, b, layers, faces)
        do i = 1, rule%n_open_boxes
            call drop_faces(faces, rule%open_box(:, i), solid%dimension)
        end do
        if (faces%n == 0) then
            solid%links%table(a, b)%law = law_contact
            solid%links%table(b, a)%law = law_contact
            if (all(rule%body > 0 .and. rule%last == 0)) &
                call raise(err, exit_deck, name_of(case, rule)//"bodies '"// &
                trim(solid%bodies(a)%id)//"' and '"//trim(solid%bodies(b)%id)// &
                "' have no faces that meet: their sides must lie on each other (at most half a "// &
                'spacing apart), and not all of them in an open_box; or take another '// &
                'law')
            return
        end if
        if (spacing(2) > most_ratio*spacing(1)) then
            call raise(err, exit_deck, name_of(case, rule)//"the spacings of '"// &
                trim(solid%bodies(a)%id)//"' and '"//trim(solid%bodies(b)%id)//"' differ by a "// &
                'factor of '//to_text(real(spacing(2)/spacing(1), real32))// &
                '; at most 2 across a cohesive interface')
            return
        end if
        k = k + 1
        associate (cohesive => solid%cohesive)
            cohesive%body(:, k) = [a, b]
            cohesive%facing(k) = merge(faces%axis(1), 0, all(faces%axis == faces%axis(1)))
            cohesive%law(k) = law_of(rule)
            call choose_bit(cohesive%body(:, :k), cohesive%bit(:k), err)
            solid%links%table(a, b)%bit = cohesive%bit(k)
            solid%links%table(b, a)%bit = cohesive%bit(k)
        end associate
        call lay_points(solid, k, faces, spacing)
    end subroutine lay_interface

    !> How messages about an interaction begin.
    function name_of(case, rule) result(text)
        type(case_t), intent(in) :: case
        type(interaction_case_t), intent(in) :: rule
        character(:), allocatable :: text

        text = label('interaction', '', rule%place)
        if (size(case%bodies) == 0) text = ''
    end function name_of

    pure type(cohesive_law_t) function law_of(rule) result(law)
        type(interaction_case_t), intent(in) :: rule

        law%stiffness = rule%interface_stiffness
        law%strength = [rule%tensile_strength, rule%shear_strength]
        law%energy = [rule%gi, rule%gii]
        law%mixed = merge(mixed_power, mixed_bk, rule%mixed == 'power')
        law%exponent = rule%mixed_exponent
        if (.not. law%exponent > 0) law%exponent = merge(1, 2, law%mixed == mixed_power)
    end function law_of

    !> The lowest bit that no other interface of the two bodies has, for the last one.
    subroutine choose_bit(body, bit, err)
        integer, intent(in) :: body(:, :) !! (2, interfaces)
        integer(int32), intent(inout) :: bit(:)
        type(error_t), intent(inout) :: err
        integer(int32) :: taken
        integer :: j, k

        k = size(bit)
        taken = 0
        do j = 1, k - 1
            if (any(body(:, j) == body(1, k)) .or. any(body(:, j) == body(2, k))) &
                taken = ior(taken, bit(j))
        end do
        j = 0
        do while (btest(taken, j) .and. j < most_bits)
            j = j + 1
        end do
        if (j == most_bits) call raise(err, exit_deck, 'a body has more than '// &
            to_text(most_bits)//' cohesive interfaces; join some of its partners in one body')
        bit(k) = ibset(0_int32, min(j, most_bits - 1))
    end subroutine choose_bit

    !> Interfaces of bodies that touch.
    subroutine keep_first(cohesive, n)
        type(cohesive_t), intent(inout) :: cohesive
        integer, intent(in) :: n

        cohesive%law = cohesive%law(:n)
        cohesive%body = cohesive%body(:, :n)
        cohesive%facing = cohesive%facing(:n)
        cohesive%bit = cohesive%bit(:n)
        cohesive%limit = cohesive%limit(:n)
        cohesive%softened = cohesive%softened(:n)
    end subroutine keep_first

    !> Least modulus of a material [Pa].
    pure real(dp) function modulus(m)
        type(material_t), intent(in) :: m

        modulus = m%bulk
        if (m%shear > 0) modulus = 9*real(m%bulk, dp)*m%shear/(3*real(m%bulk, dp) + m%shear)
        if (all(m%axial > 0)) modulus = minval(m%axial)
    end function modulus

    !> The lesser modulus of the two sides of interface k [Pa].
    pure real(dp) function weaker(solid, k)
        class(interacting_bodies_t), intent(in) :: solid
        integer, intent(in) :: k

        associate (b => solid%cohesive%body(:, k))
            weaker = min(modulus(solid%materials(solid%bodies(b(1))%material)), &
                         modulus(solid%materials(solid%bodies(b(2))%material)))
        end associate
    end function weaker

    !> Stiffness of the interfaces for which the deck gives none, and the stable step of all.
    !>
    !> The square of the frequency of the springs is at most the largest sum of a row of J M^-1 J^T
    !> K, in absolute values (Gershgorin).
    subroutine settle_stiffness(solid, err)
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: fastest(size(solid%cohesive%law)), allowed
        logical :: usual(size(solid%cohesive%law))
        integer :: k

        if (failed(err)) return
        associate (cohesive => solid%cohesive)
            usual = .not. cohesive%law%stiffness > 0
            do k = 1, size(cohesive%law)
                if (usual(k)) cohesive%law(k)%stiffness = usual_stiffness*weaker(solid, k) &
                    /solid%bodies(cohesive%body(1, k))%spacing
                call add_layers(solid, k, usual(k))
            end do
            cohesive%softened = .false.
            call find_fastest(solid, fastest)
            do k = 1, size(cohesive%law)
                allowed = (2*stable_share/(least_step*step_of_bodies(solid, &
                    cohesive%body(:, k))))**2
                cohesive%softened(k) = usual(k) .and. fastest(k) > allowed
                if (cohesive%softened(k)) &
                    cohesive%law(k)%stiffness = cohesive%law(k)%stiffness*allowed/fastest(k)
            end do
            call find_fastest(solid, fastest)
            cohesive%limit = 2*stable_share/sqrt(max(fastest, tiny(1.0_dp)))
            cohesive%dt_limit = minval(cohesive%limit)
        end associate
    end subroutine settle_stiffness

    !> First time step of two bodies [s].
    pure real(dp) function step_of_bodies(solid, pair) result(dt)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: pair(2)
        integer :: s

        dt = huge(dt)
        do s = 1, 2
            associate (body => solid%bodies(pair(s)))
                dt = min(dt, real(body%cfl*body%h, dp)/solid%materials(body%material)%c_wave)
            end associate
        end do
    end function step_of_bodies

    !> Bound of the square of the frequency of the springs of each interface [1/s2].
    subroutine find_fastest(solid, fastest)
        class(interacting_bodies_t), intent(in) :: solid
        real(dp), intent(out) :: fastest(:)
        real(dp), allocatable :: of_node(:)
        real(dp) :: row
        integer :: e, k, p

        associate (cohesive => solid%cohesive)
            allocate (of_node(cohesive%nodes), source=0.0_dp)
            do p = 1, cohesive%n
                do e = cohesive%first(p), cohesive%first(p + 1) - 1
                    of_node(cohesive%node(e)) = of_node(cohesive%node(e)) &
                        + share(cohesive, p, &
                        e)*stiffest(cohesive%law(cohesive%of(p)))*cohesive%area(p)
                end do
            end do
            do k = 1, solid%n ! particles are in the order of their numbers
                if (cohesive%row(k) == 0) cycle
                of_node(cohesive%row(k)) = of_node(cohesive%row(k))/solid%mass(k)
                if (solid%fixed(k) == is_fixed) of_node(cohesive%row(k)) = 0
            end do
            fastest = 0
            do p = 1, cohesive%n
                row = 0
                do e = cohesive%first(p), cohesive%first(p + 1) - 1
                    row = row + share(cohesive, p, e)*of_node(cohesive%node(e))
                end do
                fastest(cohesive%of(p)) = max(fastest(cohesive%of(p)), row)
            end do
        end associate
    end subroutine find_fastest

    !> The larger of the stiffnesses of both modes [Pa/m].
    pure real(dp) function stiffest(law)
        type(cohesive_law_t), intent(in) :: law

        stiffest = law%stiffness*maxval([law%stretch(1), slide_range(law)])**2
    end function stiffest

    !> Most that an opening changes by an entry.
    pure real(dp) function share(cohesive, p, e)
        type(cohesive_t), intent(in) :: cohesive
        integer, intent(in) :: p, e !! point, entry

        share = abs(cohesive%weight(1, e)) + abs(cohesive%gap(p))*norm2(cohesive%weight(2:3, e))
    end function share

    !> Length of the cohesive zone of a mode, E G/T^2, over the spacing of the finer side.
    pure real(dp) function zone_over_spacing(solid, k, mode) result(zone)
        class(interacting_bodies_t), intent(in) :: solid
        integer, intent(in) :: k, mode !! interface; 1: tension, 2: shear

        associate (law => solid%cohesive%law(k))
            zone = weaker(solid, k)*law%energy(mode)/law%strength(mode)**2 &
                   /solid%bodies(solid%cohesive%body(1, k))%spacing
        end associate
    end function zone_over_spacing

    !> Is the law possible with its stiffness, and its zone resolved?
    subroutine judge_interface(case, k, solid, err)
        type(case_t), intent(in) :: case
        integer, intent(in) :: k
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(interaction_case_t) :: rule
        real(dp) :: first, last, least, range(2), zone
        integer :: i

        if (failed(err)) return
        associate (law => solid%cohesive%law(k), b => solid%cohesive%body(:, k))
            call find_rule(case, b(1), b(2), rule)
            least = 0
            range = slide_range(law)
            do i = 0, 20
                call mode_of(law, i/20.0_dp, range(1), first, last)
                least = max(least, law%stiffness*first/last)
            end do
            zone = min(zone_over_spacing(solid, k, 1), zone_over_spacing(solid, k, 2))
            if (least > 0.95_dp*law%stiffness) then
                call raise(err, exit_deck, name_of(case, rule)//'with the stiffness '// &
                    to_text(real(law%stiffness, real32))//' Pa/m it would hold more energy at '// &
                    'its strength than gi or gii spends: take interface_stiffness of at least '// &
                    to_text(real(2*least, real32))//' Pa/m, or a smaller spacing')
            else if (zone < resolved) then
                solid%notes = solid%notes//name_of(case, rule)//'warning: the cohesive zone '// &
                    "between '"//trim(solid%bodies(b(1))%id)//"' and '"// &
                    trim(solid%bodies(b(2))%id)//"' is "//to_text(real(zone, real32))// &
                    ' spacings long (E G/T^2), and cracks need 3: use a spacing of at most '// &
                    to_text(real(zone/resolved*solid%bodies(b(1))%spacing, real32))// &
                    ' m, or a lower strength with the same energy'//new_line('a')
            end if
        end associate
    end subroutine judge_interface

    !> The two bodies of a cohesive interface: 'low+high'.
    pure function interface_name(solid, k) result(name)
        class(interacting_bodies_t), intent(in) :: solid
        integer, intent(in) :: k
        character(:), allocatable :: name

        associate (b => solid%cohesive%body(:, k))
            name = trim(solid%bodies(minval(b))%id)//'+'//trim(solid%bodies(maxval(b))%id)
        end associate
    end function interface_name
end module brz_cohesive_setup
