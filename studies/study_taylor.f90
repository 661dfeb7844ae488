! SPDX-License-Identifier: MIT
!> Taylor bars: convergence of the particles towards finite elements of the same constants, as CSV.
!>
!> usage: study_taylor shapes [copper|steel [RADIUS FORM]]   lengths, feet, bulges, energies; both
!>            bars if absent; RADIUS 0: the elements alone, else one row of the table
!>        study_taylor profiles   surfaces of the copper bar, six per radius
program study_taylor
    use brz_kinds, only: dp
    use omp_lib, only: omp_set_num_threads
    use solid_scenes, only: form_t, solid_result_t
    use taylor_bars, only: bar_t, copper, particle_bar, remains_t, steel
    use taylor_elements, only: element_bar
    implicit none

    type(form_t), parameter :: forms(5) = [ &
        form_t('corrected_hourglass, alpha 1', 'corrected_hourglass', alpha=1), &
        form_t('corrected_hourglass, alpha 0.3', 'corrected_hourglass', alpha=0.3_dp), &
        form_t('corrected_hourglass, balsara', 'corrected_hourglass', alpha=1, &
               limiter='balsara'), &
        form_t('bending, zeta 0.02, balsara', 'bending', alpha=1, zeta=0.02_dp, &
               limiter='balsara'), &
        form_t('total_lagrangian, zeta 0.02, alpha 0.3', 'total_lagrangian', alpha=0.3_dp, &
               zeta=0.02_dp)]
    character(20) :: what, which, word
    integer :: only(2) !! particles per radius and form of the one row, -1: all

    call omp_set_num_threads(1)
    call get_command_argument(1, what)
    call get_command_argument(2, which)
    only = -1
    call get_command_argument(3, word)
    if (word /= '') read (word, *) only(1)
    call get_command_argument(4, word)
    if (word /= '') read (word, *) only(2)
    select case (what)
    case ('shapes')
        if (which /= 'steel' .and. only(1) < 0) &
            print '(a)', 'bar,method,per radius,L/L0,D/D0,W/D0,viscous,'// &
            'kinetic,energy error,hottest K,plastic strain,seconds'
        if (which /= 'steel') call shapes(copper)
        if (which /= 'copper') call shapes(steel)
    case ('profiles')
        call profiles()
    case default
        error stop 'usage: study_taylor shapes [copper|steel [RADIUS FORM]] | profiles'
    end select

contains

    subroutine shapes(bar)
        type(bar_t), intent(in) :: bar
        type(remains_t) :: shape
        type(solid_result_t) :: seen
        integer :: f, k

        do k = 0, merge(2, -1, only(1) <= 0)
            call element_bar(bar, 3*2**k, 'johnson_cook', shape)
            call report(bar, 'elements', 3*2**k, shape)
        end do
        if (bar%name == copper%name .and. only(1) <= 0) then
            call element_bar(bar, 12, 'zerilli_armstrong', shape)
            call report(bar, 'elements, Zerilli-Armstrong', 12, shape)
        end if
        do k = 6, 12, 3
            if (all(only(1) /= [-1, k])) cycle
            do f = 1, size(forms)
                if (all(only(2) /= [-1, f])) cycle
                call particle_bar(bar, forms(f), k, shape, seen)
                call report(bar, forms(f)%label, k, shape)
            end do
        end do
    end subroutine shapes

    subroutine report(bar, method, across, shape)
        type(bar_t), intent(in) :: bar
        character(*), intent(in) :: method
        integer, intent(in) :: across
        type(remains_t), intent(in) :: shape

        print '(a,",""",a,""",",i0,3(",",f7.4),3(",",es10.2),",",f6.1,",",f6.3,",",f7.1)', &
            trim(bar%name), trim(method), across, shape%length, shape%foot, shape%bulge, &
            shape%viscous, shape%kinetic, shape%error, shape%hottest, shape%strain, shape%seconds
        flush (6)
    end subroutine report

    subroutine profiles()
        type(remains_t) :: shape
        type(solid_result_t) :: seen

        print '(a)', 'method,radius mm,height mm'
        call element_bar(copper, 6, 'johnson_cook', shape)
        call outline('finite elements', shape)
        call element_bar(copper, 6, 'zerilli_armstrong', shape)
        call outline('finite elements, Zerilli-Armstrong', shape)
        call particle_bar(copper, forms(5), 6, shape, seen)
        call outline(forms(5)%label, shape)
    end subroutine profiles

    subroutine outline(method, shape)
        character(*), intent(in) :: method
        type(remains_t), intent(in) :: shape
        integer :: k

        do k = 1, size(shape%profile, 2)
            print '("""",a,"""",2(",",f8.4))', trim(method), 1e3_dp*shape%profile(:, k)
        end do
        flush (6)
    end subroutine outline
end program study_taylor
