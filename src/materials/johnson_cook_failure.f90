! SPDX-License-Identifier: MIT
!> Failure strain of Johnson and Cook, and what its constants come to.
!>
!> eps_f = (d1 + d2 exp(d3 s)) (1 + d4 ln max(rate/rate0, 1)) (1 + d5 T*), at least a floor; s is
!> the mean stress over that of von Mises, positive in tension.
!> Source: Johnson & Cook 1985
module brz_johnson_cook_failure
    use brz_kinds, only: real32, rk
    use brz_text, only: string_t, to_text
    implicit none
    private
    public :: failure_strain, failure_lines, failure_fault, failure_warning

    ! Where the constants are looked at: shear, a bar in tension, ahead of a notch; quasi-static
    ! tests, a Hopkinson bar, a plate that is struck.
    real(rk), parameter :: at(3) = [0.0_rk, 1/3.0_rk, 1.0_rk] !! triaxialities
    real(rk), parameter :: rates(3) = [1.0_rk, 1e3_rk, 1e5_rk] !! [1/s]
    character(*), parameter :: names(3) = [character(3) :: '1', '1e3', '1e5']
    integer, parameter :: nearly_all = 7 !! of the nine

contains

    !> Plastic strain at which the material fails in this state.
    !@cuf attributes(host,device) &
    pure function failure_strain(d, least, triaxiality, ratio, hot) result(limit)
        real(rk), intent(in) :: d(5), least !! d1 to d5, floor
        real(rk), intent(in) :: triaxiality, ratio !! mean over equivalent stress; rate over rate0
        real(rk), intent(in) :: hot !! T*
        real(rk) :: limit

        limit = d(1) + d(2)*exp(d(3)*triaxiality)
        if (ratio > 1) limit = limit*(1 + d(4)*log(ratio))
        limit = max(limit*(1 + d(5)*hot), least)
    end function failure_strain

    !> Failure strains of the cold material, a line for each rate.
    pure subroutine failure_lines(d, least, rate0, lines)
        real(rk), intent(in) :: d(5), least, rate0 !! d1 to d5, floor, reference rate [1/s]
        type(string_t), allocatable, intent(out) :: lines(:)
        character(40) :: values
        integer :: i, k

        allocate (lines(size(rates)))
        do i = 1, size(rates)
            write (values, '(3f8.4)') &
                (failure_strain(d, least, at(k), rates(i)/rate0, 0.0_rk), k=1, size(at))
            lines(i)%s = 'failure strain at '//trim(names(i))//' 1/s and triaxiality 0, 1/3, 1:'// &
                         trim(values)
        end do
    end subroutine failure_lines

    !> How many of the nine states are at the floor.
    pure integer function at_floor(d, least, rate0) result(n)
        real(rk), intent(in) :: d(5), least, rate0
        integer :: i, k

        n = 0
        do i = 1, size(rates)
            do k = 1, size(at)
                if (.not. failure_strain(d, least, at(k), rates(i)/rate0, 0.0_rk) > least) n = n + 1
            end do
        end do
    end function at_floor

    !> Why the constants cannot be meant: nearly everywhere the floor alone is left.
    pure subroutine failure_fault(d, least, rate0, fault)
        real(rk), intent(in) :: d(5), least, rate0
        character(:), allocatable, intent(inout) :: fault

        if (at_floor(d, least, rate0) < nearly_all) return
        fault = 'the failure strain is at its floor, '//to_text(real(least, real32))// &
                ', nearly everywhere'//causes(d, least, rate0)//"; mend them, give "// &
                "least_failure_strain to have it so, or failure = 'none'"
    end subroutine failure_fault

    !> What is to be warned of; empty where all is well.
    pure function failure_warning(d, least, rate0) result(warning)
        real(rk), intent(in) :: d(5), least, rate0
        character(:), allocatable :: warning
        integer :: n

        warning = ''
        n = at_floor(d, least, rate0)
        if (n > 0) then
            warning = 'the failure strain is at its floor, '//to_text(real(least, real32))// &
                      ', in '//to_text(n)//' of 9 states (rates of 1, 1e3, 1e5 1/s, '// &
                      'triaxialities of 0, 1/3, 1), where it breaks like glass'
        else if (d(2)*d(3) > 0) then
            warning = 'tension makes it tougher'
        end if
        if (warning /= '') warning = warning//causes(d, least, rate0)// &
            "; mend the constants, or leave failure out with failure = 'none'"
    end function failure_warning

    !> Which constants are odd, and how.
    pure function causes(d, least, rate0) result(text)
        real(rk), intent(in) :: d(5), least, rate0
        character(:), allocatable :: text

        text = ''
        if (d(4) < 0) text = text//': by d4 < 0 it falls to nothing at '// &
            to_text(real(rate0*exp(-1/d(4)), real32))//' 1/s, with a reference_rate of '// &
            to_text(real(rate0, real32))//' 1/s'
        if (.not. minval(d(1) + d(2)*exp(d(3)*at)) > least) &
            text = text//': d1 + d2 exp(d3 s) is '// &
                   to_text(real(minval(d(1) + d(2)*exp(d(3)*at)), real32))//' at its least'
        if (d(2)*d(3) > 0) text = text//': d3 > 0, which the law exp(d3 s) with s positive in '// &
            'tension seldom has (another sign is printed with exp(-d3 s))'
    end function causes
end module brz_johnson_cook_failure
