! SPDX-License-Identifier: MIT
!> Crack band: the width over which a smeared crack spends its energy, and whether it can.
!>
!> Source: Bazant & Oh 1983.
module brz_crack_band
    use, intrinsic :: iso_fortran_env, only: real32
    use brz_body, only: body_t
    use brz_case, only: body_case_t, label
    use brz_errors, only: error_t, exit_deck, raise
    use brz_formulation_names, only: form_bending, form_rigid
    use brz_kinds, only: dp
    use brz_material, only: material_t
    use brz_text, only: to_text
    implicit none
    private
    public :: crack_report, crack_width, judge_crack

    !> Width over the spacing, by notched strips of a ply and of concrete: two rows of particles,
    !> and something of their neighbours in bodies that hold their shape.
    real(dp), parameter :: width = 2.1_dp, width_held = 2.35_dp

contains

    !> Width of a smeared crack [m].
    pure real(dp) function crack_width(formulation, spacing)
        integer, intent(in) :: formulation
        real(dp), intent(in) :: spacing !! [m]

        crack_width = merge(width_held, width, formulation == form_bending)*spacing
    end function crack_width

    !> Report or refuse a body whose cracks are too wide for their energy: they keep it and lose
    !> strength.
    subroutine judge_crack(input, body, material, notes, err)
        type(body_case_t), intent(in) :: input
        type(body_t), intent(in) :: body
        type(material_t), intent(in) :: material
        character(:), allocatable, intent(inout) :: notes
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text
        real(dp) :: ratio

        if (.not. material%crack > 0 .or. body%formulation == form_rigid) return
        if (body%crack <= material%crack) return
        ratio = sqrt(real(material%crack/body%crack, dp))
        text = 'a crack is '//millimetres(real(body%crack, dp))//' wide, too wide for its '// &
               'fracture energy: the strength falls to '//to_text(nint(100*ratio))// &
               ' %; spacing for full strength: '//millimetres(input%spacing*ratio**2)
        if (input%crack_band == 'refuse') then
            call raise(err, exit_deck, label('body', input%id, input%place)//text)
        else
            notes = notes//label('body', input%id, input%place)//'warning: '//text//new_line('a')
        end if
    end subroutine judge_crack

    !> The largest spacing that the fracture energies of a body allow; empty if there are none.
    function crack_report(body, material) result(text)
        type(body_t), intent(in) :: body
        type(material_t), intent(in) :: material
        character(:), allocatable :: text

        text = ''
        if (.not. material%crack > 0 .or. body%formulation == form_rigid) return
        text = 'cracks '//millimetres(real(body%crack, dp))// &
               ' wide; full strength with spacings up to '// &
               millimetres(body%spacing*real(material%crack/body%crack, dp))
    end function crack_report

    !> A length as text.
    pure function millimetres(length) result(text)
        real(dp), intent(in) :: length !! [m]
        character(:), allocatable :: text

        text = to_text(real(1e3_dp*length, real32))//' mm'
    end function millimetres
end module brz_crack_band
