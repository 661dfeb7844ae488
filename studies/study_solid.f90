! SPDX-License-Identifier: MIT
!> Where each formulation of the solids fails, and what its accuracy costs, as CSV.
!>
!> usage: study_solid stability|drawn|charts|plates [formulation]   all, or the one of that number
!>        study_solid bars   rows of the chart for bars that strike a wall
program study_solid
    use solid_problems, only: cantilever, patch, planar_impact, plate, pulled_bar, spin, &
                              taylor_bar, zigzag
    use solid_scenes, only: form_t, forms, solid_result_t
    use brz_kinds, only: dp
    use drawn_bodies, only: crack, elastic_bar, rebar, rebar_t, ring, ring_t
    use taylor_bars, only: copper, particle_bar, remains_t
    use taylor_elements, only: element_bar
    implicit none

    character(20) :: what, which
    integer :: first, last

    call get_command_argument(1, what)
    call get_command_argument(2, which)
    first = 1
    last = size(forms)
    if (which /= '') then
        read (which, *) first
        last = first
    end if
    select case (what)
    case ('stability', 'drawn')
        call stability()
    case ('charts')
        call charts()
    case ('plates')
        call plates()
    case ('bars')
        call bars()
    case default
        error stop 'usage: study_solid stability|drawn|charts|plates|bars'
    end select

contains

    subroutine stability()
        type(solid_result_t) :: seen
        integer :: f

        if (first == 1) print '(a)', 'test,formulation,seen,quantity,value,energy error,'// &
            'longest link,shortest link'
        do f = first, last
            if (what == 'drawn' .and. forms(f)%wide > 1) cycle
            if (what == 'drawn') then
                call drawn(forms(f))
                cycle
            end if
            call spin(forms(f), 5.0_dp, 2.0_dp, seen)
            call report('slow spin', 'angular momentum lost', forms(f), seen, 1e-3_dp)
            call spin(forms(f), 50.0_dp, 3.0_dp, seen)
            call report('fast spin', 'angular momentum lost', forms(f), seen, 1e-3_dp)
            call cantilever(forms(f), 5, seen)
            call report('cantilever', 'period error', forms(f), seen, 0.05_dp)
            call plate(forms(f), 3, seen)
            call report('clamped plate', 'period error', forms(f), seen, 0.05_dp)
            call patch(forms(f), 0.95_dp, seen)
            call report('compressed 5 %', 'noise left', forms(f), seen, 1.0_dp)
            call patch(forms(f), 1.005_dp, seen)
            call report('stretched 0.5 %', 'noise left', forms(f), seen, 1.0_dp)
            call patch(forms(f), 1.05_dp, seen)
            call report('stretched 5 %', 'noise left', forms(f), seen, 1.0_dp)
            call zigzag(forms(f), seen)
            call report('zig-zag mode', 'energy left', forms(f), seen, 0.5_dp)
            call pulled_bar(forms(f), 0.1_dp, seen)
            call report('pulled bar 10 %', 'longest link', forms(f), seen, 1.25_dp)
            if (forms(f)%wide > 1) cycle ! what follows is thick, or drawn to pieces
            call planar_impact(forms(f), 2e-4_dp, seen)
            call report('impact 2 km/s', 'pressure error', forms(f), seen, 0.03_dp)
            call taylor_bar(forms(f), 6, seen)
            call report('Taylor bar', 'shape error', forms(f), seen, 0.1_dp)
            call drawn(forms(f))
        end do
    end subroutine stability

    !> Bodies that are drawn (drawn_bodies). A total Lagrangian body cannot part.
    subroutine drawn(form)
        type(form_t), intent(in) :: form
        type(solid_result_t) :: seen
        type(rebar_t) :: bar
        type(ring_t) :: parts
        real(dp) :: found
        integer :: across

        call elastic_bar(form, 2e-3_dp, found, seen)
        seen%value = found - 1
        call report('elastic bar 1.8 %', 'stress error', form, seen, 0.05_dp)
        seen = solid_result_t()
        do across = 2, 5
            call rebar(across, 100.0_dp, 0.03_dp, changed(form, '')//whole(form), bar)
            if (abs(bar%stress - 1) > abs(seen%value)) seen%value = bar%stress - 1
            seen%energy = max(seen%energy, abs(bar%energy))
            seen%ended = seen%ended .or. bar%ended
        end do
        call report('rebar of 2 to 5', 'stress error', form, seen, 0.02_dp)
        if (form%formulation == 'total_lagrangian') return
        seen = solid_result_t()
        call ring(changed(form, ''), 4, parts)
        seen%value = 1 - min(parts%through, 1.0_dp)
        seen%energy = parts%energy
        seen%ended = parts%ended
        if (parts%pieces > 1 .and. seen%value > 0.35_dp) seen%longest = 2 ! parted, and sound there
        call report('ring of 4340', 'sound where it parted', form, seen, 0.35_dp)
        seen = solid_result_t()
        call crack(changed(form, '(strip)'), seen%value, seen%ended)
        seen%value = seen%value - 1
        call report('notched strip', 'error of gf', form, seen, 0.15_dp)
    end subroutine drawn

    !> What a deck says of a formulation, as changes.
    function changed(form, body) result(words)
        type(form_t), intent(in) :: form
        character(*), intent(in) :: body !! (its name), or nothing: the only one
        character(:), allocatable :: words

        words = 'body'//body//'.formulation='//trim(form%formulation)//' body'//body// &
                '.artificial_stress='//trim(form%artificial)
        if (form%hold >= 0) words = words//' body'//body//'.tensile_control=0'
    end function changed

    !> Metal that does not fail, where a formulation demands that.
    function whole(form) result(words)
        type(form_t), intent(in) :: form
        character(:), allocatable :: words

        words = ''
        if (form%formulation == 'total_lagrangian') words = ' material.failure_strain=none'
    end function whole

    !> One line of the map. Fractured: lattice neighbours came apart; clumped: they met.
    subroutine report(test, quantity, form, seen, bound)
        character(*), intent(in) :: test, quantity
        type(form_t), intent(in) :: form
        type(solid_result_t), intent(in) :: seen
        real(dp), intent(in) :: bound !! of the value of a sound result
        character(10) :: word

        word = what_happened(test, seen, bound)
        print '(8(a, :, ","))', test, trim(form%label), trim(word), quantity, number(seen%value), &
            number(seen%energy), number(seen%longest), number(seen%shortest)
        flush (6)
    end subroutine report

    character(10) function what_happened(test, seen, bound)
        character(*), intent(in) :: test
        type(solid_result_t), intent(in) :: seen
        real(dp), intent(in) :: bound !! of the value of a sound result

        if (index(test, 'Taylor bar') == 1) then
            what_happened = verdict(seen, bound, 6.0_dp, 0.05_dp)
        else
            what_happened = verdict(seen, bound, 1.5_dp, 0.4_dp)
        end if
    end function what_happened

    character(10) function verdict(seen, bound, longest, shortest)
        type(solid_result_t), intent(in) :: seen
        real(dp), intent(in) :: bound, longest, shortest

        if (seen%ended .or. .not. abs(seen%value) < huge(bound)) then
            verdict = 'failed'
        else if (seen%longest > longest) then
            verdict = 'fractured'
        else if (seen%shortest < shortest) then
            verdict = 'clumped'
        else if (abs(seen%value) > bound .or. abs(seen%energy) > 0.02_dp) then
            verdict = 'noisy'
        else
            verdict = 'stable'
        end if
    end function verdict

    function number(x) result(text)
        real(dp), intent(in) :: x
        character(:), allocatable :: text
        character(12) :: digits

        write (digits, '(es11.3)') x
        text = trim(adjustl(digits))
    end function number

    !> Error against seconds, resolution by resolution, of the formulations from 'paper' on.
    subroutine charts()
        integer, parameter :: across(3) = [3, 4, 6]
        type(solid_result_t) :: seen
        integer :: f, k

        if (first == 1) print '(a)', 'test,formulation,resolution,seen,error,energy error,'// &
            'seconds,particle steps'
        do f = max(first, 2), last
            if (index(forms(f)%label, 'gray') > 0 .or. forms(f)%wide > 1) cycle
            do k = 1, size(across)
                call cantilever(forms(f), across(k), seen)
                call point('cantilever', forms(f), across(k), seen)
            end do
            do k = 1, 4
                call planar_impact(forms(f), 1.6e-3_dp/2**k, seen)
                call point('impact 2 km/s', forms(f), nint(0.03_dp/1.6e-3_dp*2**k), seen)
            end do
        end do
    end subroutine charts

    !> Rows of the same table for clamped plates: isotropic, few layers where they are wrong anyway,
    !> and laminates.
    subroutine plates()
        integer, parameter :: layers(4) = [2, 3, 5, 7]
        type(solid_result_t) :: seen
        integer :: f, k, most

        do f = max(first, 2), last
            if (index(forms(f)%label, 'gray') > 0 .or. forms(f)%wide > 1) cycle
            most = 2
            if (forms(f)%formulation == 'total_lagrangian') most = 3
            if (forms(f)%formulation == 'bending') most = 4
            do k = 1, most
                call plate(forms(f), layers(k), seen)
                call point('clamped plate', forms(f), layers(k), seen)
            end do
            if (forms(f)%formulation /= 'bending') cycle
            do k = 1, 2
                call plate(forms(f), 3*k, seen, 3)
                call point('plate of 3 plies', forms(f), 3*k, seen)
            end do
            do k = 5, 7, 2
                call plate(forms(f), k, seen, k)
                call point('plate of '//achar(iachar('0') + k)//' plies', forms(f), k, seen)
            end do
        end do
    end subroutine plates

    !> Taylor bar of copper: errors of its length and of its foot against finite elements of the
    !> same constants, 12 per radius (docs/data/taylor_bars.csv), and the coarser of these elements.
    subroutine bars()
        real(dp), parameter :: length = 0.6805_dp, foot = 1.9053_dp
        type(form_t), parameter :: metals(3) = [ &
            form_t('corrected_hourglass', 'corrected_hourglass'), &
            form_t('bending, zeta 0.02', 'bending', zeta=0.02_dp), &
            form_t('total_lagrangian, zeta 0.02', 'total_lagrangian', zeta=0.02_dp)]
        type(form_t), parameter :: elements = form_t('finite elements')
        type(remains_t) :: shape
        type(solid_result_t) :: seen
        integer :: f, k

        do k = 3, 12, 3
            seen = solid_result_t()
            if (k <= 6) then
                call element_bar(copper, k, 'johnson_cook', shape)
                seen%energy = shape%error
                seen%seconds = shape%seconds
                call shape_errors(elements, k, shape%length/length - 1, shape%foot/foot - 1, seen)
            end if
            if (k == 3) cycle
            do f = 1, size(metals)
                call particle_bar(copper, metals(f), k, shape, seen)
                call shape_errors(metals(f), k, shape%length/length - 1, shape%foot/foot - 1, seen)
            end do
        end do
    end subroutine bars

    !> Two rows of the table: length and foot of a bar.
    subroutine shape_errors(form, across, length, foot, seen)
        type(form_t), intent(in) :: form
        integer, intent(in) :: across !! particles or elements per radius
        real(dp), intent(in) :: length, foot !! over the reference, less 1
        type(solid_result_t), intent(inout) :: seen

        seen%value = length
        call point('Taylor bar, length', form, across, seen)
        seen%value = foot
        call point('Taylor bar, foot', form, across, seen)
    end subroutine shape_errors

    subroutine point(test, form, resolution, seen)
        character(*), intent(in) :: test
        type(form_t), intent(in) :: form
        integer, intent(in) :: resolution
        type(solid_result_t), intent(in) :: seen
        character(12) :: word

        write (word, '(i0)') resolution
        print '(8(a, :, ","))', '"'//test//'"', '"'//trim(form%label)//'"', trim(word), &
            trim(what_happened(test, seen, huge(seen%value))), number(seen%value), &
            number(seen%energy), number(seen%seconds), number(seen%particle_steps)
        flush (6)
    end subroutine point
end program study_solid
