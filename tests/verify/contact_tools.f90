! SPDX-License-Identifier: MIT
!> Scenes of two bodies, for the tests of contact, bonds and rigid bodies.
module contact_tools
    use brz_case, only: body_case_t, case_t, interaction_case_t, material_case_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp
    use brz_solid_state, only: solid_t
    use brz_solid_start, only: solid_time_step
    use brz_solid_driver, only: solid_step
    use shared_steps, only: solid_totals_t
    implicit none
    private
    public :: elastic, aluminium, two_boxes, energy, run_until

contains

    subroutine elastic(material, density, young, poisson)
        type(material_case_t), intent(out) :: material
        real(dp), intent(in) :: density, young, poisson

        material%model = 'linear_elastic'
        material%n = 5
        material%key = [character(24) :: 'density', 'youngs_modulus', 'poisson_ratio', &
                        'bulk_modulus', 'shear_modulus']
        material%value = [density, young, poisson, 0.0_dp, 0.0_dp]
        material%word = [character(32) :: '', '', '', '', '']
        material%given = [.true., .true., .true., .false., .false.]
    end subroutine elastic

    !> Two boxes of density 1, Young's modulus 1 and spacing 1, `gap` apart along x.
    subroutine two_boxes(case, n, gap)
        type(case_t), intent(out) :: case
        integer, intent(in) :: n(3) !! layers
        real(dp), intent(in) :: gap

        allocate (case%materials(1), case%bodies(2), case%interactions(1))
        case%solid%present = .true.
        call elastic(case%materials(1), 1.0_dp, 1.0_dp, 0.0_dp)
        case%bodies%id = ['a', 'b']
        case%bodies%material_index = 1
        case%bodies%spacing = 1
        case%bodies%formulation = 'corrected'
        case%bodies(1)%lo = [-n(1) - gap/2, 0.0_dp, 0.0_dp]
        case%bodies(1)%hi = [-gap/2, real(n(2), dp), real(n(3), dp)]
        case%bodies(2)%lo = [gap/2, 0.0_dp, 0.0_dp]
        case%bodies(2)%hi = [n(1) + gap/2, real(n(2), dp), real(n(3), dp)]
    end subroutine two_boxes

    real(dp) function energy(t)
        type(solid_totals_t), intent(in) :: t

        energy = t%kinetic + t%internal + t%hourglass + t%contact
    end function energy

    subroutine run_until(solid, t_end, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: t_end
        type(error_t), intent(inout) :: err
        real(dp) :: time, dt

        time = 0
        do while (time < t_end .and. .not. failed(err))
            dt = solid_time_step(solid)
            call solid_step(solid, dt, err)
            time = time + dt
        end do
    end subroutine run_until

    subroutine aluminium(material)
        type(material_case_t), intent(out) :: material

        material%model = 'gruneisen'
        material%n = 10
        material%key = [character(24) :: 'density', 'sound_speed', 's1', 's2', 's3', &
            'gruneisen_gamma', 'gruneisen_a', 'pressure_cutoff', 'shear_modulus', 'yield_stress']
        material%value = [2785.0_dp, 5328.0_dp, 1.338_dp, 0.0_dp, 0.0_dp, 2.0_dp, 0.0_dp, 0.0_dp, &
                          27.6e9_dp, 0.29e9_dp]
        material%word = [character(32) :: '', '', '', '', '', '', '', '', '', '']
        material%given = [.true., .true., .true., .false., .false., .true., .false., .false., &
                          .true., .true.]
    end subroutine aluminium
end module contact_tools
