! SPDX-License-Identifier: MIT
!> What follows from the keys of a material, in words: derived constants, waves, Hugoniot.
module brz_material_report
    use brz_case, only: material_case_t
    use brz_kinds, only: dp, rk
    use brz_material, only: fails_at_once, material_t, point_t
    use brz_materials, only: derived_constants, material_remarks, start_point, update_material
    use brz_model, only: derived_t
    use brz_text, only: string_t, to_text
    implicit none
    private
    public :: material_report, shock_state

    character(*), parameter :: lf = new_line('a')
    character(*), parameter :: indent = repeat(' ', 13) !! beneath the name
    integer, parameter :: longest = 90 !! of a line

contains

    !> Lines on a material, each ended by a line feed.
    function material_report(input, material, up) result(text)
        type(material_case_t), intent(in) :: input
        type(material_t), intent(in) :: material
        real(dp), intent(in) :: up !! particle velocity of the Hugoniot; 0: none is told [m/s]
        character(:), allocatable :: text, line
        type(derived_t), allocatable :: list(:)
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: warning
        real(dp) :: us, p, mu
        integer :: i
        logical :: ok

        call derived_constants(material, list)
        line = 'material     '//trim(input%id)//': '//trim(input%model)
        text = ''
        call append('', material%density, 'kg/m3')
        call append('wave', material%c_wave, 'm/s')
        if (material%bulk > 0) call append('bulk sound', sqrt(material%bulk/material%density), &
                                           'm/s')
        do i = 1, size(list)
            call append(trim(list(i)%name), real(list(i)%value, rk), trim(list(i)%unit))
        end do
        call shock_state(material, up, us, p, mu, ok)
        if (ok) then
            text = text//line//lf
            line = indent//'one shock through z, up '//number(up)//' m/s'
            call append('us', real(us, rk), 'm/s')
            call append('stress', real(p, rk), 'Pa')
            call append('mu', real(mu, rk), '')
        end if
        text = text//line//lf
        call material_remarks(material, lines, warning)
        do i = 1, size(lines)
            text = text//indent//lines(i)%s//lf
        end do
        if (material%fails == fails_at_once) text = text//indent//'it breaks by strain, not by '// &
            'an energy: work and direction of a tear depend on'//lf//indent//'the spacing and '// &
            'on the lattice, a factor of 2 (docs/manual/cracks.md)'//lf
        text = text//unconfirmed_text(input)

    contains

        subroutine append(name, value, unit)
            character(*), intent(in) :: name, unit
            real(rk), intent(in) :: value
            character(:), allocatable :: part

            part = trim(name//' '//number(real(value, dp))//' '//unit)
            if (len(line) + len(part) + 2 > longest) then
                text = text//line//','//lf
                line = indent//adjustl(part)
            else
                line = line//', '//trim(adjustl(part))
            end if
        end subroutine append
    end function material_report

    !> Which constants of a preset nobody has looked up in their source.
    pure function unconfirmed_text(input) result(text)
        type(material_case_t), intent(in) :: input
        character(:), allocatable :: text
        integer :: i, n

        text = ''
        if (.not. allocated(input%unconfirmed)) return
        n = count([(input%unconfirmed(i:i) == ' ', i=1, len(input%unconfirmed))])
        if (n == 1) text = indent//'1 constant of this preset is unconfirmed:'
        if (n > 1) text = indent//to_text(n)//' constants of this preset are unconfirmed:'
        if (n > 0) text = text//input%unconfirmed//lf
        if (input%doubtful) text = text//indent//'where and when it breaks rests on '// &
            "guesses: compare with failure = 'none' (docs/manual/materials.md)"//lf
    end function unconfirmed_text

    !> Four digits: 3831, 0.1106, 1.541E+11.
    pure function number(x) result(text)
        real(dp), intent(in) :: x
        character(:), allocatable :: text
        character(16) :: buffer

        if (abs(x) >= 1e-3_dp .and. abs(x) < 1) then
            write (buffer, '(f8.4)') x
        else if (abs(x) >= 1 .and. abs(x) < 1e5_dp) then
            write (buffer, '(f8.0)') x
            buffer(index(buffer, '.'):) = ' '
        else
            write (buffer, '(es10.3)') x
        end if
        text = trim(adjustl(buffer))
    end function number

    !> State behind one plane shock along z, from rest: the model itself, in one step.
    !>
    !> A step adds the mean stress times the change of volume to the energy, as a shock does; the
    !> strain is bisected until stress times change of volume is up^2. `ok` is false without a
    !> velocity, under initial pressure, or beyond the range of the model.
    subroutine shock_state(material, up, us, p, mu, ok)
        type(material_t), intent(in) :: material
        real(dp), intent(in) :: up !! particle velocity [m/s]
        real(dp), intent(out) :: us !! shock speed [m/s]
        real(dp), intent(out) :: p !! stress along z, compression positive [Pa]
        real(dp), intent(out) :: mu !! compression [-]
        logical, intent(out) :: ok
        type(point_t) :: point
        real(dp) :: low, high, strain, dv
        integer :: i, status
        real(dp), parameter :: most = 0.999_dp

        us = 0
        p = 0
        mu = 0
        call start_point(material, 0.0_rk, 'z', point)
        ok = up > 0 .and. .not. any(abs(point%stress) > 0)
        if (.not. ok) return
        low = 0
        high = most
        do i = 1, 60
            strain = (low + high)/2
            call squeeze(material, strain, point, status)
            p = -point%stress(3)
            mu = point%mu
            dv = mu/(material%density*(1 + mu))
            if (status <= 0 .and. p*dv < up**2) then
                low = strain
            else
                high = strain
            end if
        end do
        ok = status <= 0 .and. high < most
        if (ok) us = up*(1 + mu)/mu
    end subroutine shock_state

    !> One step of a microsecond at most, over a length on which nothing fails in that time.
    subroutine squeeze(material, strain, point, status)
        type(material_t), intent(in) :: material
        real(dp), intent(in) :: strain
        type(point_t), intent(out) :: point
        integer, intent(out) :: status
        real(rk) :: l(3, 3)
        real(rk), parameter :: rate = 1e6_rk, length = 1e3_rk

        call start_point(material, 0.0_rk, 'z', point)
        l = 0
        l(3, 3) = -rate
        call update_material(material, real(strain, rk)/rate, length, l, point, status)
    end subroutine squeeze
end module brz_material_report
