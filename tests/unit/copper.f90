! SPDX-License-Identifier: MIT
!> Copper (OFHC) after Johnson and Cook, for tests.
module copper
    use brz_errors, only: error_t, failed
    use brz_kinds, only: rk
    use brz_material, only: material_t, point_t
    use point_tools, only: fresh, material_from
    implicit none
    private
    public :: make_copper, strength, hugoniot, linear

    real(rk), parameter, public :: density = 8960, g = 46e9_rk, a = 90e6_rk, b = 292e6_rk, &
                                   n = 0.31_rk, c = 0.025_rk, m = 1.09_rk, room = 293, &
                                   melt = 1356, cp = 383, c0 = 3940, s1 = 1.489_rk, &
                                   gamma = 2.02_rk, bulk = density*c0**2
    ! the same as a deck has them, without an equation of state, and two of these
    character(*), parameter :: strength = "model='johnson_cook', density=8960, "// &
        'shear_modulus=46e9, a=90e6, b=292e6, n=0.31, c=0.025, m=1.09, melt_temperature=1356, '// &
        'specific_heat=383'
    character(*), parameter :: hugoniot = 'sound_speed=3940, s1=1.489, gruneisen_gamma=2.02'
    character(*), parameter :: linear = "eos='linear', bulk_modulus=139091456e3"

contains

    !> A point of copper with other keys; a shock Hugoniot unless these choose an equation of state.
    subroutine make_copper(material, point, changes)
        type(material_t), intent(out) :: material
        type(point_t), intent(out) :: point
        character(*), intent(in), optional :: changes !! 'c=0, m=2'
        character(:), allocatable :: keys
        type(error_t) :: err

        keys = strength//', '//hugoniot
        if (present(changes)) then
            keys = strength
            if (index(changes, 'eos=') == 0) keys = keys//', '//hugoniot
            call drop_changed(keys, changes)
            keys = keys//', '//changes
        end if
        call material_from(keys, material, err)
        if (failed(err)) error stop err%text
        point = fresh(material)
    end subroutine make_copper

    !> Take out of a list of keys those that another list has as well.
    subroutine drop_changed(keys, changes)
        character(:), allocatable, intent(inout) :: keys
        character(*), intent(in) :: changes
        character(:), allocatable :: rest, one
        integer :: comma, equal

        rest = keys
        keys = ''
        do while (rest /= '')
            comma = index(rest//', ', ', ')
            one = rest(:comma - 1)
            rest = rest(min(comma + 2, len(rest) + 1):)
            equal = index(one, '=')
            if (index(', '//changes, ', '//one(:equal)) > 0) cycle
            if (keys /= '') keys = keys//', '
            keys = keys//one
        end do
    end subroutine drop_changed
end module copper
