! SPDX-License-Identifier: MIT
!> What a gauge can measure: the one table of quantities.
!>
!> A new quantity is one row here and one case of `value_of_gas` or `value_of_particle` in
!> brz_gauges. Where a GPU computes, the motion of a few particles is cheap to read; for whatever
!> else a quantity reads of a body the whole state is brought to the host.
module brz_gauge_quantities
    implicit none
    private
    public :: quantity_t, quantities, find_quantity, quantity_choices, from_impulse

    type :: quantity_t
        character(16) :: name
        character(8) :: unit
        logical :: of_air, of_body
        logical :: moves = .false. !! of a particle it needs place, velocity and acceleration alone
        integer :: whole = 0 !! of a whole body: place among the sums of brz_force_items, or
                             !! from_impulse and the next ones; 0: of a point
    end type quantity_t

    integer, parameter :: from_impulse = 13
    type(quantity_t), parameter :: quantities(36) = [ &
        quantity_t('pressure', 'Pa', .true., .true.), &
        quantity_t('overpressure', 'Pa', .true., .false.), &
        quantity_t('density', 'kg/m3', .true., .true.), &
        quantity_t('speed', 'm/s', .true., .true., moves=.true.), &
        quantity_t('velocity_x', 'm/s', .true., .true., moves=.true.), &
        quantity_t('velocity_y', 'm/s', .true., .true., moves=.true.), &
        quantity_t('velocity_z', 'm/s', .true., .true., moves=.true.), &
        quantity_t('displacement_x', 'm', .false., .true., moves=.true.), &
        quantity_t('displacement_y', 'm', .false., .true., moves=.true.), &
        quantity_t('displacement_z', 'm', .false., .true., moves=.true.), &
        quantity_t('strain', '-', .false., .true., moves=.true.), &
        quantity_t('stress_xx', 'Pa', .false., .true.), &
        quantity_t('stress_yy', 'Pa', .false., .true.), &
        quantity_t('stress_zz', 'Pa', .false., .true.), &
        quantity_t('stress_xy', 'Pa', .false., .true.), &
        quantity_t('stress_yz', 'Pa', .false., .true.), &
        quantity_t('stress_xz', 'Pa', .false., .true.), &
        quantity_t('von_mises', 'Pa', .false., .true.), &
        quantity_t('plastic_strain', '-', .false., .true.), &
        quantity_t('temperature', 'K', .false., .true.), &
        quantity_t('damage', '-', .false., .true.), &
        quantity_t('reaction_x', 'N', .false., .true., whole=1), &
        quantity_t('reaction_y', 'N', .false., .true., whole=2), &
        quantity_t('reaction_z', 'N', .false., .true., whole=3), &
        quantity_t('moment_x', 'N m', .false., .true., whole=4), &
        quantity_t('moment_y', 'N m', .false., .true., whole=5), &
        quantity_t('moment_z', 'N m', .false., .true., whole=6), &
        quantity_t('load_x', 'N', .false., .true., whole=7), &
        quantity_t('load_y', 'N', .false., .true., whole=8), &
        quantity_t('load_z', 'N', .false., .true., whole=9), &
        quantity_t('contact_x', 'N', .false., .true., whole=10), &
        quantity_t('contact_y', 'N', .false., .true., whole=11), &
        quantity_t('contact_z', 'N', .false., .true., whole=12), &
        quantity_t('impulse_x', 'N s', .false., .true., whole=13), &
        quantity_t('impulse_y', 'N s', .false., .true., whole=14), &
        quantity_t('impulse_z', 'N s', .false., .true., whole=15)]

contains

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
