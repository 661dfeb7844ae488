! SPDX-License-Identifier: MIT
!> What a gauge can measure: the one table of quantities.
!>
!> A quantity is a number in a source of brz_gauges: what is known at a point of the gas, or of a
!> particle. Where the source holds it already, as the history of a material model holds what the
!> model names, a new quantity is one row here; else the source gets one number more. Where a GPU
!> computes, the motion of a few particles is cheap to read; for whatever else a quantity reads of
!> a body the whole state is brought to the host.
module brz_gauge_quantities
    implicit none
    private
    public :: quantity_t, quantities, find_quantity, quantity_choices, from_impulse
    public :: is_motion, is_of_body
    public :: of_velocity, of_displacement, of_strain, of_stress, of_state, of_history

    ! sources of a body; where a quantity has no row the source knows it by its name
    integer, parameter :: of_velocity = 1, of_displacement = 2, of_strain = 3, of_stress = 4, &
                          of_state = 5, of_history = 6

    type :: quantity_t
        character(24) :: name
        character(8) :: unit
        integer :: gas = 0 !! its place in what is known at a point of the gas; 0: not of the air
        integer :: body = 0 !! its source in a particle; 0: not of a particle
        integer :: row = 0 !! its place in that source
        integer :: whole = 0 !! of a whole body: place among the sums of brz_force_loop_bodies, or
                             !! from_impulse and the next ones; 0: of a point
    end type quantity_t

    integer, parameter :: from_impulse = 13
    type(quantity_t), parameter :: quantities(*) = [ &
        quantity_t('pressure', 'Pa', gas=5, body=of_stress, row=7), &
        quantity_t('overpressure', 'Pa', gas=6), &
        quantity_t('density', 'kg/m3', gas=1, body=of_state, row=1), &
        quantity_t('speed', 'm/s', gas=7, body=of_velocity, row=4), &
        quantity_t('velocity_x', 'm/s', gas=2, body=of_velocity, row=1), &
        quantity_t('velocity_y', 'm/s', gas=3, body=of_velocity, row=2), &
        quantity_t('velocity_z', 'm/s', gas=4, body=of_velocity, row=3), &
        quantity_t('displacement_x', 'm', body=of_displacement, row=1), &
        quantity_t('displacement_y', 'm', body=of_displacement, row=2), &
        quantity_t('displacement_z', 'm', body=of_displacement, row=3), &
        quantity_t('strain', '-', body=of_strain), &
        quantity_t('stress_xx', 'Pa', body=of_stress, row=1), &
        quantity_t('stress_yy', 'Pa', body=of_stress, row=2), &
        quantity_t('stress_zz', 'Pa', body=of_stress, row=3), &
        quantity_t('stress_xy', 'Pa', body=of_stress, row=4), &
        quantity_t('stress_yz', 'Pa', body=of_stress, row=5), &
        quantity_t('stress_xz', 'Pa', body=of_stress, row=6), &
        quantity_t('von_mises', 'Pa', body=of_stress, row=8), &
        quantity_t('principal_tension', 'Pa', body=of_stress, row=9), &
        quantity_t('plastic_strain', '-', body=of_history), &
        quantity_t('temperature', 'K', body=of_history), &
        quantity_t('damage', '-', body=of_state, row=2), &
        quantity_t('damage_hjc', '-', body=of_history), &
        quantity_t('damage_tension', '-', body=of_history), &
        quantity_t('damage_fibre_tension', '-', body=of_history), &
        quantity_t('damage_fibre_compression', '-', body=of_history), &
        quantity_t('damage_matrix_cracking', '-', body=of_history), &
        quantity_t('damage_matrix_crushing', '-', body=of_history), &
        quantity_t('damage_delamination', '-', body=of_history), &
        quantity_t('reaction_x', 'N', whole=1), &
        quantity_t('reaction_y', 'N', whole=2), &
        quantity_t('reaction_z', 'N', whole=3), &
        quantity_t('moment_x', 'N m', whole=4), &
        quantity_t('moment_y', 'N m', whole=5), &
        quantity_t('moment_z', 'N m', whole=6), &
        quantity_t('load_x', 'N', whole=7), &
        quantity_t('load_y', 'N', whole=8), &
        quantity_t('load_z', 'N', whole=9), &
        quantity_t('contact_x', 'N', whole=10), &
        quantity_t('contact_y', 'N', whole=11), &
        quantity_t('contact_z', 'N', whole=12), &
        quantity_t('impulse_x', 'N s', whole=13), &
        quantity_t('impulse_y', 'N s', whole=14), &
        quantity_t('impulse_z', 'N s', whole=15)]

contains

    !> True if place, velocity and acceleration of its particles are all that it needs.
    pure elemental logical function is_motion(quantity)
        type(quantity_t), intent(in) :: quantity

        is_motion = any(quantity%body == [of_velocity, of_displacement, of_strain])
    end function is_motion

    !> True of what a body has, at one of its particles or as a whole.
    pure elemental logical function is_of_body(quantity)
        type(quantity_t), intent(in) :: quantity

        is_of_body = quantity%body > 0 .or. quantity%whole > 0
    end function is_of_body

    !> Row of a quantity, 0 where there is none.
    pure integer function find_quantity(name) result(row)
        character(*), intent(in) :: name

        do row = 1, size(quantities)
            if (quantities(row)%name == name) return
        end do
        row = 0
    end function find_quantity

    !> All names as choices of a key.
    pure function quantity_choices() result(text)
        character(:), allocatable :: text
        integer :: row

        text = trim(quantities(1)%name)
        do row = 2, size(quantities)
            text = text//'|'//trim(quantities(row)%name)
        end do
    end function quantity_choices
end module brz_gauge_quantities
