! SPDX-License-Identifier: MIT
!> What a gauge can measure: the one table of quantities.
!>
!> A new quantity is one row here and one case of `value_of_gas` or `value_of_particle` in
!> brz_gauges. Where a GPU computes, the motion of a few particles is cheap to read; for whatever
!> else a quantity reads of a body the whole state is brought to the host.
module brz_gauge_quantities
    implicit none
    private
    public :: quantity_t, quantities, find_quantity, quantity_choices

    type :: quantity_t
        character(16) :: name
        character(8) :: unit
        logical :: of_air, of_body
        logical :: moves = .false. !! of a particle it needs place, velocity and acceleration alone
    end type quantity_t

    type(quantity_t), parameter :: quantities(11) = [ &
        quantity_t('pressure', 'Pa', .true., .false.), &
        quantity_t('overpressure', 'Pa', .true., .false.), &
        quantity_t('density', 'kg/m3', .true., .false.), &
        quantity_t('speed', 'm/s', .true., .true., moves=.true.), &
        quantity_t('velocity_x', 'm/s', .true., .true., moves=.true.), &
        quantity_t('velocity_y', 'm/s', .true., .true., moves=.true.), &
        quantity_t('velocity_z', 'm/s', .true., .true., moves=.true.), &
        quantity_t('displacement_x', 'm', .false., .true., moves=.true.), &
        quantity_t('displacement_y', 'm', .false., .true., moves=.true.), &
        quantity_t('displacement_z', 'm', .false., .true., moves=.true.), &
        quantity_t('damage', '-', .false., .true.)]

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
