! SPDX-License-Identifier: MIT
!> What a run prints of its charges: a blast that began in one or two dimensions, and what bodies
!> take of charges on the grid.
module brz_print_early
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_air_state, only: charge_report_t
    use brz_case, only: case_t
    use brz_check_ground, only: burst_text
    use brz_kinds, only: dp
    use brz_early, only: early_t
    implicit none
    private
    public :: is_too_early, print_early, print_charges

    real(dp), parameter :: worth_a_warning = 0.05_dp !! mean change of the products' pressure

contains

    !> How far the blast ran, and the balances of the mapping.
    subroutine print_early(early)
        type(early_t), intent(in) :: early
        character(12), parameter :: name(6) = [character(12) :: 'mass [kg]', 'x [N s]', 'y', 'z', &
                                               'energy [J]', 'of products']
        integer :: c

        write (output_unit, '(a, i0, a, es11.4, a, es11.4, a, i0, a)') 'blast in ', &
            early%dimensions, '-D until', early%time, ' s, front at', early%radius, ' m (', &
            early%steps, ' steps)'
        write (output_unit, '(a)') 'mapped       over undisturbed air: blast, cells, difference'
        do c = 1, merge(6, 5, early%products)
            write (output_unit, '(13x, a, 2es24.15, es10.2)') name(c), early%before(c), &
                early%after(c), early%after(c) - early%before(c)
        end do
        if (.not. early%products) write (output_unit, '(13x, a, es9.2, a)') 'of the mass', &
            early%before(6), ' kg are products; as gamma is that of air, they go on as air'
        write (output_unit, '(a, f8.3, a, f8.3, a)') '             pressure of the products as '// &
            'an ideal gas: changes by', 100*early%pressure_mean, ' % in the mean,', &
            100*early%pressure_change, ' % at most'
        if (early%beyond > 0) write (output_unit, '(a, f8.3, a)') &
            '             beyond open sides, and gone: ', 100*early%beyond, ' % of the energy'
        if (early%dimensions == 2) write (output_unit, '(a, es9.2, a)') &
            '             the points of the cells missed its sums by', early%off, ' at most'
        if (is_too_early(early)) write (error_unit, '(a)') &
            'warning: the blast is mapped so early that the products are no ideal gas yet; '// &
            'their energy is kept, their pressure is not'
    end subroutine print_early

    !> Is a blast mapped while its products are far from an ideal gas?
    pure logical function is_too_early(early)
        type(early_t), intent(in) :: early

        is_too_early = early%pressure_mean > worth_a_warning
    end function is_too_early

    !> Charges on the ground, and what charges on the grid lose to bodies.
    subroutine print_charges(case, report)
        type(case_t), intent(in) :: case
        type(charge_report_t), intent(in) :: report(:) !! (charges)
        integer :: c

        do c = 1, size(case%charges)
            if (case%charges(c)%on_ground) write (output_unit, '(4a)') 'charge       ', &
                trim(case%charges(c)%id), ': ', burst_text(case, case%charges(c))
            if (report(c)%lost > 0) write (output_unit, '(3a, 2(es10.3, a))') 'charge       ', &
                trim(case%charges(c)%id), ':', report(c)%lost, ' kg of', report(c)%mass, &
                ' lie in cells that bodies fill, and are lost'
        end do
    end subroutine print_charges
end module brz_print_early
