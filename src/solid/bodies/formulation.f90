! SPDX-License-Identifier: MIT
!> How a body is computed: the settings of the deck, completed by what follows from them.
module brz_formulation
    use brz_body, only: body_t
    use brz_case, only: body_case_t, label
    use brz_crack_band, only: crack_width
    use brz_errors, only: error_t, exit_deck, raise
    use brz_face_stress, only: face_share
    use brz_formulation_names, only: artificial_gray, artificial_monaghan, artificial_none, &
        form_bending, form_corrected, form_corrected_hourglass, form_rigid, form_total, &
        form_uncorrected
    use brz_gradient, only: limiter_balsara, limiter_compression, limiter_none, limiter_slope
    use brz_hourglass_axes, only: lay_axes
    use brz_kernel, only: kernel_shape
    use brz_kinds, only: dp, rk
    use brz_material, only: class_crumbling, class_elastic, class_fluid, class_metal, material_t
    implicit none
    private
    public :: settle_formulation, fast

    real(dp), parameter :: fast = 1000 !! bodies that meet faster send strong shocks [m/s]
    real(rk), parameter :: usual_control = 3 !! an infinite lattice under tension is stable from
                                             !! 1.25

contains

    !> Fill the numbers of a body's formulation from the deck.
    subroutine settle_formulation(input, material, dimension, speed, body, err)
        type(body_case_t), intent(in) :: input
        type(material_t), intent(in) :: material
        integer, intent(in) :: dimension
        real(dp), intent(in) :: speed !! largest of two bodies towards each other [m/s]
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err

        body%h = real(input%smoothing*input%spacing, rk)
        body%zeta_viscous = real(input%zeta_viscous, rk)
        body%cfl = real(input%cfl, rk)
        call settle_class(input, int(material%class), speed, body)
        select case (input%formulation)
        case ('auto')
            if (any(input%aspect > 1)) body%formulation = form_total ! brz_wide_lattice
        case ('corrected')
            body%formulation = form_corrected
        case ('corrected_hourglass')
            body%formulation = form_corrected_hourglass
        case ('bending')
            body%formulation = form_bending
        case ('total_lagrangian')
            body%formulation = form_total
        case ('uncorrected', 'paper')
            body%formulation = form_uncorrected
        case ('rigid')
            body%formulation = form_rigid
        case default
            call refuse(input, "unknown formulation '"//trim(input%formulation)//"'", err)
        end select
        if (body%formulation == form_total .and. material%fails > 0) call refuse(input, &
            "formulation='total_lagrangian' is for what never breaks, and its material fails; "// &
            "give that failure = 'none' (metals and plies), or take 'bending' or "// &
            "'corrected_hourglass'", err)
        if (body%limiter == limiter_slope .and. body%formulation /= form_corrected_hourglass) &
            call refuse(input, "limiter='slope' goes with formulation='corrected_hourglass' "// &
                        "alone; leave it out, or take 'balsara'", err)
        body%crack = real(crack_width(body%formulation, input%spacing), rk)
        call settle_artificial(input, body, err)
        call settle_stiffness(input, material, dimension, body)
        call settle_control(input, int(material%class), body, err)
        if (body%formulation /= form_uncorrected .and. body%formulation /= form_rigid) &
            body%face_share = face_share(dimension, body%h/real(input%spacing, rk))
        body%variable = input%variable_h
        body%h_range = real(input%h_range, rk)
        if (body%variable .and. body%formulation == form_total) &
            call refuse(input, 'variable_h has no meaning in a total-Lagrangian body', err)
    end subroutine settle_formulation

    !> Stiff hourglass force: along the axes of a ply in 'bending', without axes elsewhere; of plies
    !> also the normal, about which the gradients of the outermost layers are tilted.
    subroutine settle_stiffness(input, material, dimension, body)
        type(body_case_t), intent(in) :: input
        type(material_t), intent(in) :: material
        integer, intent(in) :: dimension
        type(body_t), intent(inout) :: body
        integer :: axis

        body%directional = body%formulation == form_bending .and. material%axial(1) > 0 .and. &
                           input%hourglass_axes
        body%zeta = 2
        if (input%zeta >= 0) body%zeta = real(input%zeta, rk)
        if (.not. body%directional) return
        allocate (body%axes(3, 4, 0:max(input%n_plies, 0)))
        axis = index('xyz', input%ply_axis)
        if (axis <= dimension) body%normal(axis) = 1
        call lay_axes(body%zeta, material, input%ply_axis, &
                      real(input%ply_angle(:max(input%n_plies, 0))*acos(-1.0_dp)/180, rk), &
                      real(input%spacing, rk)/body%h, axis <= dimension, body%axes)
    end subroutine settle_stiffness

    !> The tensile control, a stiff hourglass force in proportion to the tension: of what keeps
    !> together.
    subroutine settle_control(input, class, body, err)
        type(body_case_t), intent(in) :: input
        integer, intent(in) :: class !! of the material
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err

        body%tensile_control = 0
        if (body%formulation /= form_corrected_hourglass) then
            if (input%tensile_control > 0) call refuse(input, 'tensile_control goes with '// &
                "formulation='corrected_hourglass' alone; leave it out", err)
            return
        end if
        if (class /= class_fluid) body%tensile_control = usual_control
        if (input%tensile_control >= 0) body%tensile_control = real(input%tensile_control, rk)
    end subroutine settle_control

    !> Formulation and viscosity where the deck gives none, by what a material does: it bends until
    !> it breaks, it flows (metals), or it crumbles. In metals at moderate speed the viscosity
    !> spares plastic shear: else a coarse Taylor bar loses a third of its energy to it.
    pure subroutine settle_class(input, class, speed, body)
        type(body_case_t), intent(in) :: input
        integer, intent(in) :: class !! of the material
        real(dp), intent(in) :: speed !! see settle_formulation [m/s]
        type(body_t), intent(inout) :: body

        body%formulation = form_corrected_hourglass
        if (class == class_elastic) body%formulation = form_bending
        body%alpha = 1
        body%beta = 2
        body%limiter = limiter_none
        if (class == class_metal .and. speed <= fast) body%limiter = limiter_balsara
        if (class == class_crumbling) body%limiter = limiter_compression
        if (input%formulation == 'paper') then
            body%alpha = 2
            body%beta = 10
        end if
        if (input%alpha >= 0) body%alpha = real(input%alpha, rk)
        if (input%alpha >= 0 .or. input%formulation == 'paper') body%limiter = limiter_none
        select case (input%limiter)
        case ('none'); body%limiter = limiter_none
        case ('balsara'); body%limiter = limiter_balsara
        case ('compression'); body%limiter = limiter_compression
        case ('slope'); body%limiter = limiter_slope
        end select
        if (input%beta >= 0) body%beta = real(input%beta, rk)
    end subroutine settle_class

    !> Artificial stress: where it may act, and its strength, 0.2 (Monaghan) or 0.3 (Gray).
    subroutine settle_artificial(input, body, err)
        type(body_case_t), intent(in) :: input
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err

        body%artificial = artificial_none
        if (input%artificial_stress == 'monaghan' .or. &
            (input%formulation == 'paper' .and. input%artificial_stress == 'auto')) &
            body%artificial = artificial_monaghan
        if (input%artificial_stress == 'gray') body%artificial = artificial_gray
        if (body%artificial == artificial_none) return
        if (body%formulation /= form_uncorrected .and. body%formulation /= form_corrected) &
            call refuse(input, 'artificial_stress goes with formulation=''uncorrected'', '// &
                        '''paper'' or ''corrected''; the hourglass forces replace it', err)
        body%artificial_strength = merge(0.3_rk, 0.2_rk, body%artificial == artificial_gray)
        if (input%artificial_strength >= 0) &
            body%artificial_strength = real(input%artificial_strength, rk)
        body%shape_at_spacing = kernel_shape(1/(2*body%h), real(input%spacing, rk))
        body%artificial_power = 1/body%shape_at_spacing
    end subroutine settle_artificial

    subroutine refuse(input, what, err)
        type(body_case_t), intent(in) :: input
        character(*), intent(in) :: what
        type(error_t), intent(inout) :: err

        call raise(err, exit_deck, label('body', input%id, input%place)//what)
    end subroutine refuse
end module brz_formulation
