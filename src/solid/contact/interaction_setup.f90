! SPDX-License-Identifier: MIT
!> The table of laws between bodies, from the deck and the bodies themselves.
module brz_interaction_setup
    use brz_body, only: body_t
    use brz_case, only: case_t, interaction_case_t, label, means
    use brz_errors, only: error_t, exit_deck, raise
    use brz_flat_surface, only: flat_sum
    use brz_formulation_names, only: form_corrected_hourglass, form_rigid, form_total
    use brz_gradient, only: limiter_slope
    use brz_interaction, only: law_bonded, law_cohesive, law_contact, law_none, law_shared, &
        interaction_t
    use brz_kernel, only: kernel_scale
    use brz_kinds, only: dp, real32, rk
    use brz_material, only: material_t
    use brz_materials, only: unloaded_speed
    use brz_approach_speed, only: closing_speed
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: set_up_interactions, find_rule, rule_of

    real(dp), parameter :: most_ratio = 2, good_ratio = 1.1_dp !! of spacings across a bond
    real(dp), parameter :: slow = 0.04_dp !! of the speed of sound, where faces in contact move, see
                                         !! brz_contact_face
    real(dp), parameter :: most_contrast = 6 !! of bonded materials whose pairs count as all others

contains

    !> Laws of all pairs of bodies; `solid%links%present` where any two of them meet.
    subroutine set_up_interactions(case, solid, err)
        type(case_t), intent(in) :: case
        class(listed_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(interaction_case_t) :: rule
        real(dp) :: sound !! speed of the slower material [m/s]
        integer :: a, b

        associate (n => size(solid%bodies))
            if (n < 2) return
            allocate (solid%links%table(n, n))
            do b = 1, n
                do a = 1, n
                    call find_rule(case, a, b, rule)
                    if (a == b) rule%law = 'none'
                    call make_interaction(solid, rule, a, b, solid%links%table(a, b))
                    sound = min(unloaded_speed(solid%materials(solid%bodies(a)%material)), &
                                unloaded_speed(solid%materials(solid%bodies(b)%material)))
                    if (.not. may_touch(solid%links%table(a, b)) .or. closing_speed( &
                        case%bodies(a), case%bodies(b)) > slow*sound) &
                        solid%links%table(a, b)%steep = 0
                    if (a >= b) cycle
                    if (rule%law == 'bonded' .or. rule%law == 'shared') &
                        call shorten_step(solid, a, b, solid%links%table(a, b))
                    if (rule%law == 'bonded') call judge_bond(solid, a, b, label('body', &
                        case%bodies(b)%id, case%bodies(b)%place)//'it is bonded to', err)
                    if (rule%law == 'shared') call judge_bond(solid, a, b, label('body', &
                        case%bodies(b)%id, case%bodies(b)%place)//'it shares its sums with', err)
                end do
            end do
        end associate
        solid%links%present = any(solid%links%table%law /= law_none)
        solid%links%bonds = any(solid%links%table%law == law_bonded .or. &
                                solid%links%table%law == law_shared)
        if (.not. solid%links%present) return
        solid%links%faces = any(solid%links%table%steep > 0)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), laws => solid%links%table(:, b)%law)
                if (any(laws == law_bonded .or. laws == law_shared .or. laws == law_cohesive)) &
                    body%rigid%steps(1) = real(body%cfl*body%h, dp) &
                                           /solid%materials(body%material)%c_wave
            end associate
        end do
        solid%links%cell = [(real(1/(solid%materials(solid%bodies(b)%material)%density &
                                     *solid%bodies(b)%volume_scale), rk), b=1, size(solid%bodies))]
    end subroutine set_up_interactions

    !> True where contact may ever act.
    pure logical function may_touch(m)
        type(interaction_t), intent(in) :: m

        may_touch = m%law == law_contact .or. m%law == law_cohesive .or. &
                    (m%law == law_bonded .and. min(m%tensile, m%shear) < huge(m%shear))
    end function may_touch

    !> The last rule of the deck that fits; else bonded where one cuts the other, else contact.
    pure subroutine find_rule(case, a, b, rule)
        type(case_t), intent(in) :: case
        integer, intent(in) :: a, b
        type(interaction_case_t), intent(out) :: rule
        integer :: i

        if (any(means(case%bodies(a)%cuts, case%bodies(b)%id)) .or. &
            any(means(case%bodies(b)%cuts, case%bodies(a)%id))) rule%law = 'bonded'
        i = rule_of(case, a, b)
        if (i > 0) rule = case%interactions(i)
    end subroutine find_rule

    !> Place of the last rule of the deck that fits bodies a and b; 0: there is none.
    pure integer function rule_of(case, a, b)
        type(case_t), intent(in) :: case
        integer, intent(in) :: a, b
        integer :: i

        rule_of = 0
        if (.not. allocated(case%interactions)) return
        do i = 1, size(case%interactions)
            associate (first => case%interactions(i)%body, last => case%interactions(i)%last)
                if ((fits(first(1), last(1), a) .and. fits(first(2), last(2), b)) .or. &
                    (fits(first(1), last(1), b) .and. fits(first(2), last(2), a))) rule_of = i
            end associate
        end do
    end function rule_of

    pure logical function fits(first, last, body)
        integer, intent(in) :: first, last !! 0, 0: every body
        integer, intent(in) :: body

        fits = first == 0 .or. first == body .or. (body > first .and. body <= last)
    end function fits

    !> The numbers of a law between bodies a (of particle i) and b.
    subroutine make_interaction(solid, rule, a, b, m)
        class(bodies_t), intent(in) :: solid
        type(interaction_case_t), intent(in) :: rule
        integer, intent(in) :: a, b
        type(interaction_t), intent(out) :: m
        real(dp) :: bulk, density, touch, slope

        associate (p => solid%bodies(a), q => solid%bodies(b), &
                   s => solid%materials(solid%bodies(a)%material), &
                   t => solid%materials(solid%bodies(b)%material))
            select case (rule%law)
            case ('none'); m%law = law_none
            case ('bonded'); m%law = law_bonded
            case ('shared'); m%law = law_shared
            case ('cohesive'); m%law = law_cohesive
            case default; m%law = law_contact
            end select
            m%h = (p%h + q%h)/2
            m%scale = kernel_scale(m%h, solid%dimension)
            m%half_over_h = 1/(2*m%h)
            m%spacing = real((p%spacing + q%spacing)/2, rk)
            call flat_sum(solid%dimension, q%spacing, m, real(m%spacing, dp), touch, slope)
            m%touch = real(touch, rk)
            m%slope = real(slope*m%spacing, rk)
            m%steep = real(slope/touch, rk)
            m%reach = [p%face_share*real(p%spacing, rk), q%face_share*real(q%spacing, rk)]
            bulk = 2*real(s%bulk, dp)*t%bulk/(real(s%bulk, dp) + t%bulk)*rule%stiffness
            density = 2*real(s%density, dp)*t%density/(real(s%density, dp) + t%density)
            m%stiffness = real(bulk/2*(touch/(slope*m%spacing))**2, rk)
            m%core = real(bulk*m%spacing**(solid%dimension - 1)*solid%depth, rk)
            m%stick = real(sqrt(bulk*density), rk)
            m%impedance = real(rule%damping/2, rk)*(p%alpha + q%alpha)/2*m%stick
            m%friction = real(rule%friction, rk)
            m%shared = rule%shared_pressure
            m%rigid = p%formulation == form_rigid
            m%formulation = merge(p%formulation, 0, p%formulation == q%formulation)
            m%spares = merge(1, 0, p%limiter == limiter_slope .and. q%limiter == limiter_slope)
            m%directional = p%directional .and. q%directional
            if (p%directional .neqv. q%directional) m%formulation = 0
            call weigh_bond(p, q, s, t, m)
            m%normal = reshape([p%normal, q%normal], [3, 2])
            m%lift = [p%lift, q%lift]
            m%curved = [p%curved, q%curved]
            m%middle = reshape([p%round%centre, q%round%centre], [3, 2])
            m%rest = [1/s%density, 1/t%density]
            m%weight = 2*[s%bulk, t%bulk]/(s%bulk + t%bulk)
            m%arm = real([p%spacing, q%spacing]/(p%spacing + q%spacing), rk)
            where ([p%formulation, q%formulation] /= form_rigid) m%arm = 0
        end associate
        m%tensile = real(min(rule%tensile_strength, real(huge(1.0_rk), dp)), rk)
        m%shear = real(min(rule%shear_strength, real(huge(1.0_rk), dp)), rk)
        m%quadratic = rule%bond_law == 'quadratic'
        m%bit = 0
    end subroutine make_interaction

    !> Weights of a bonded pair in the gradients of both, and shares of its viscosity.
    !>
    !> The stress of a heavy, stiff body pushes light particles at rates that go with its stiffness
    !> over their density, of which the time step of neither knows. Beyond `most_contrast` pairs
    !> count less in the gradients of the heavy body, and as much more in those of the light one:
    !> gradients stay exact for linear fields, forces their adjoint, and the rates are those of the
    !> bodies. Both weights add up to two, so that a uniform stress pulls as before.
    !>
    !> Source: docs/theory/contact.md; 2 Z_j/(Z_i + Z_j) in Parshikov and Medin 2002
    pure subroutine weigh_bond(p, q, s, t, m)
        type(body_t), intent(in) :: p, q
        type(material_t), intent(in) :: s, t !! theirs
        type(interaction_t), intent(inout) :: m
        real(dp) :: excess

        m%part = 1
        m%viscous = 1
        if (m%rigid .or. q%formulation == form_rigid) return
        m%viscous = min([t%density/s%density, s%density/t%density], 1.0_rk)
        excess = contrast(s, t)/most_contrast
        if (.not. excess > 1) return
        if (p%thin .or. q%thin) then ! a single layer has no gradient across without its partner
            if (m%formulation == form_corrected_hourglass) m%formulation = 0
            return
        end if
        m%part = real([1/excess, 2 - 1/excess], rk)
        if (s%density < t%density) m%part = m%part([2, 1])
    end subroutine weigh_bond

    !> How much heavier one of two materials is, or how much larger its impedance, if that is less;
    !> below 1 where the heavier one has the smaller impedance.
    pure real(dp) function contrast(s, t)
        type(material_t), intent(in) :: s, t
        real(dp) :: density(2), z(2)

        density = [s%density, t%density]
        z = density*[s%c_wave, t%c_wave]
        contrast = maxval(density)/minval(density)
        contrast = min(contrast, z(maxloc(density, 1))/z(3 - maxloc(density, 1)))
    end function contrast

    !> A bond to a single layer is not weighted; where it is too stiff for the light body's waves
    !> both take shorter steps.
    subroutine shorten_step(solid, a, b, m)
        class(bodies_t), intent(inout) :: solid
        integer, intent(in) :: a, b
        type(interaction_t), intent(in) :: m
        real(dp) :: share

        associate (p => solid%bodies(a), q => solid%bodies(b), &
                   s => solid%materials(solid%bodies(a)%material), &
                   t => solid%materials(solid%bodies(b)%material))
            if (m%rigid .or. q%formulation == form_rigid .or. .not. (p%thin .or. q%thin)) return
            share = sqrt(most_contrast/contrast(s, t))
            if (share >= 1) return
            p%cfl = real(share, rk)*p%cfl
            q%cfl = real(share, rk)*q%cfl
            solid%notes = solid%notes//"bodies '"//trim(p%id)//"' and '"//trim(q%id)//"' are "// &
                'joined, one a single layer of particles, with densities that differ by a '// &
                'factor of '//to_text(real(max(s%density/t%density, t%density/s%density), &
                real32))//': their time step is '//to_text(real(share, real32))//' of what it '// &
                'is alone; two layers or more need no shorter one'//new_line('a')
        end associate
    end subroutine shorten_step

    !> A bond joins one continuum: lattices must not differ too much.
    subroutine judge_bond(solid, a, b, start, err)
        class(bodies_t), intent(inout) :: solid
        integer, intent(in) :: a, b
        character(*), intent(in) :: start !! of a message
        type(error_t), intent(inout) :: err
        real(dp) :: ratio

        associate (p => solid%bodies(a), q => solid%bodies(b))
            if (p%formulation == form_total .or. q%formulation == form_total .or. p%variable .or. &
                q%variable) call raise(err, exit_deck, start//" '"//trim(p%id)// &
                "', and that goes neither with formulation="// &
                "'total_lagrangian' nor with variable_h; take 'bending' and a constant h")
            ratio = max(p%h/q%h, q%h/p%h)
            if (ratio > most_ratio) call raise(err, exit_deck, start//" '"// &
                trim(p%id)//"', but their smoothing lengths "// &
                'differ by a factor of '//to_text(ratio)//'; at most '//to_text(most_ratio))
            if (ratio > good_ratio) solid%notes = solid%notes//"bodies '"//trim(p%id)//"' and '"// &
                trim(q%id)//"' are joined with smoothing lengths that differ by a factor of "// &
                to_text(nint(100*ratio)/100.0_dp)//': waves are reflected at the bond'// &
                new_line('a')
        end associate
    end subroutine judge_bond
end module brz_interaction_setup
