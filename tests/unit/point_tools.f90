! SPDX-License-Identifier: MIT
!> What the tests of the material models share: a material from its keys, and ways to move a point.
module point_tools
    use brz_build_point, only: build_point
    use brz_case, only: point_case_t
    use brz_deck, only: deck_t
    use brz_errors, only: error_t, failed
    use brz_key, only: key_t
    use brz_key_table, only: all_keys
    use brz_kinds, only: rk
    use brz_material, only: material_t, point_t
    use brz_materials, only: make_material, start_point, update_material
    use brz_scanner, only: read_deck_text
    use brz_text, only: string_t
    implicit none
    private
    public :: any_numbers, material_from, fault_of, fresh, press_to, shear, move, strain_by, &
              pressure, mises

    real(rk), parameter, public :: h_test = 1e-3_rk !! smoothing length of all tests [m]

contains

    !> Nine numbers between -1 and 1 without order, others for each n.
    pure function any_numbers(n) result(l)
        integer, intent(in) :: n
        real(rk) :: l(3, 3)
        integer :: i, j

        do j = 1, 3
            do i = 1, 3
                l(1 + modulo(i, 3), j) = sin(real((i + 3*(j - 1) + n)**2, rk))
            end do
        end do
    end function any_numbers

    !> A material from keys as they stand in a deck.
    subroutine material_from(keys_text, material, err)
        character(*), intent(in) :: keys_text !! "preset='hjc_48', t=3e6"
        type(material_t), intent(out) :: material
        type(error_t), intent(inout) :: err
        type(key_t), allocatable :: keys(:)
        type(deck_t) :: deck
        type(point_case_t) :: point
        character(*), parameter :: lf = new_line('a')

        call all_keys(keys)
        call read_deck_text('deck.nml', "&material id='m', "//keys_text//' /'//lf// &
                            "&point material='m' /"//lf//'&segment duration=1, l=9*0.0 /', keys, &
                            [string_t::], deck, err)
        call build_point(deck, keys, point, err)
        if (.not. failed(err)) call make_material(point%material, material, err)
    end subroutine material_from

    !> What the program says of keys that are wrong; empty if nothing.
    function fault_of(keys_text) result(text)
        character(*), intent(in) :: keys_text
        character(:), allocatable :: text
        type(material_t) :: material
        type(error_t) :: err

        call material_from(keys_text, material, err)
        text = ''
        if (failed(err)) text = err%text
    end function fault_of

    function fresh(material) result(point)
        type(material_t), intent(in) :: material
        type(point_t) :: point

        call start_point(material, 0.0_rk, 'z', point)
    end function fresh

    !> Compress a point to mu in one step of a second, the same in all directions.
    subroutine press_to(material, mu, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: mu
        type(point_t), intent(inout) :: point
        real(rk) :: l(3, 3)
        integer :: i, status

        l = 0
        do i = 1, 3
            l(i, i) = -log((1 + mu)/(1 + point%mu))/3
        end do
        call update_material(material, 1.0_rk, h_test, l, point, status)
        if (status /= 0) error stop 'press_to: the material refused'
    end subroutine press_to

    !> Pure shear in x and y without spin.
    subroutine shear(material, strain, rate, steps, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: strain, rate !! engineering, in all; [1/s]
        integer, intent(in) :: steps
        type(point_t), intent(inout) :: point
        real(rk) :: l(3, 3)

        l = 0
        l(1, 2) = rate/2
        l(2, 1) = rate/2
        call move(material, l, strain/rate, steps, point)
    end subroutine shear

    !> Equal steps with one velocity gradient.
    subroutine move(material, l, time, steps, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: l(3, 3), time
        integer, intent(in) :: steps
        type(point_t), intent(inout) :: point
        integer :: i, status

        do i = 1, steps
            call update_material(material, time/steps, h_test, l, point, status)
            if (status > 0) error stop 'move: the material refused'
        end do
    end subroutine move

    !> Velocity gradient of uniaxial strain along an axis [1/s].
    pure function strain_by(axis, rate) result(l)
        integer, intent(in) :: axis
        real(rk), intent(in) :: rate
        real(rk) :: l(3, 3)

        l = 0
        l(axis, axis) = rate
    end function strain_by

    pure real(rk) function pressure(point)
        type(point_t), intent(in) :: point

        pressure = -sum(point%stress(:3))/3
    end function pressure

    !> Equivalent stress of von Mises.
    pure real(rk) function mises(point)
        type(point_t), intent(in) :: point
        real(rk) :: s(6)

        s = point%stress
        s(:3) = s(:3) + pressure(point)
        mises = sqrt(1.5_rk*(sum(s(:3)**2) + 2*sum(s(4:)**2)))
    end function mises
end module point_tools
