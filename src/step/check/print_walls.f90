! SPDX-License-Identifier: MIT
!> What `--check` says of a body as a wall to the air: cells across, and the error to expect.
!>
!> Measured with the impulse of a shock of Mach 2 on a held sphere until it has passed: 22, 11 and
!> 3 % too large with 3.3, 6.7 and 13.3 cells across. Faces along the grid are within 1 %.
module brz_print_walls
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_body_geometries, only: body_box
    use brz_case, only: case_t, is_from_file
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: print_wall

    real(dp), parameter :: of_cuts = 73 !! error in %, times cells across

contains

    !> Print the line of body b of a scene with air; of bars and files there is none.
    subroutine print_wall(case, b)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b
        character(20) :: across
        real(dp) :: cells, hi(3), lo(3)
        character(:), allocatable :: text

        select case (case%bodies(b)%shape)
        case ('box', 'sphere', 'cylinder')
            if (is_from_file(case%bodies(b)) .or. case%bodies(b)%start_file /= '') return
        case default
            return
        end select
        call body_box(case%bodies(b), lo, hi)
        associate (air => case%air)
            cells = minval((hi - lo)*air%cells/(air%hi - air%lo), air%cells > 1)
        end associate
        write (across, '(f20.1)') cells
        text = '             in the air '//trim(adjustl(across))//' cells across '// &
               'its smallest side: '
        if (case%bodies(b)%shape == 'box') then
            text = text//'the impulse of a blast on its faces is within 1 %'
        else
            text = text//'the impulse of a blast is within '//percent(of_cuts/cells)
        end if
        write (output_unit, '(a)') text
    end subroutine print_wall

    !> A number of per cent, at least 1.
    function percent(x) result(text)
        real(dp), intent(in) :: x
        character(:), allocatable :: text

        text = to_text(max(1, nint(min(x, 1e4_dp))))//' %'
    end function percent
end module brz_print_walls
