! SPDX-License-Identifier: MIT
!> What `--check` says of pairs of bodies: by which law they meet, and why.
module brz_print_interactions
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_case, only: case_t, interaction_case_t
    use brz_interaction_setup, only: find_rule
    use brz_kinds, only: dp, real32
    use brz_text, only: to_text
    implicit none
    private
    public :: print_interactions

    integer, parameter :: most_named = 4 !! pairs of a kind that are named

    !> Pairs that meet by the same law for the same reason.
    type :: kind_t
        character(:), allocatable :: law, names
        integer :: pairs = 0
    end type kind_t

contains

    !> A line for each law and reason, with the first pairs of bodies that meet so; what stress the
    !> faces have of contact and of the air.
    subroutine print_interactions(case)
        type(case_t), intent(in) :: case
        type(kind_t), allocatable :: kinds(:)
        type(interaction_case_t) :: rule
        integer :: a, b, k

        allocate (kinds(0))
        do a = 1, size(case%bodies) - 1
            do b = a + 1, size(case%bodies)
                call find_rule(case, a, b, rule)
                call count_pair(kinds, law_text(rule), trim(case%bodies(a)%id)//'+'// &
                                trim(case%bodies(b)%id))
            end do
        end do
        do k = 1, size(kinds)
            if (kinds(k)%pairs > most_named) kinds(k)%names = kinds(k)%names//' and '// &
                to_text(kinds(k)%pairs - most_named)//' more pairs'
            write (output_unit, '(4a)') 'interaction  ', kinds(k)%law, ': ', kinds(k)%names
        end do
    end subroutine print_interactions

    !> Law of a pair, its friction, and where that is said.
    function law_text(rule) result(text)
        type(interaction_case_t), intent(in) :: rule
        character(:), allocatable :: text

        text = trim(rule%law)
        if (rule%law == 'contact' .and. rule%friction > 0) &
            text = text//', friction '//to_text(real(rule%friction, real32))
        if (rule%law == 'bonded' .and. min(rule%tensile_strength, rule%shear_strength) &
            < huge(1.0_dp)/2) text = text//' until the bond breaks'
        if (allocated(rule%place)) then
            text = text//' ('//rule%place(:max(len_trim(rule%place) - 1, 0))//')'
        else if (rule%law == 'bonded') then
            text = text//' (default: one cuts the other)'
        else
            text = text//' (default)'
        end if
    end function law_text

    subroutine count_pair(kinds, law, name)
        type(kind_t), allocatable, intent(inout) :: kinds(:)
        character(*), intent(in) :: law, name
        integer :: k

        do k = 1, size(kinds)
            if (kinds(k)%law == law) exit
        end do
        if (k > size(kinds)) kinds = [kinds, kind_t(law, '', 0)]
        kinds(k)%pairs = kinds(k)%pairs + 1
        if (kinds(k)%pairs > most_named) return
        if (kinds(k)%pairs > 1) kinds(k)%names = kinds(k)%names//', '
        kinds(k)%names = kinds(k)%names//name
    end subroutine count_pair
end module brz_print_interactions
