! SPDX-License-Identifier: MIT
!> The columns of the table that `brisance mat` writes.
module brz_point_table
    use brz_kinds, only: dp
    use brz_algebra, only: double_dot
    use brz_material, only: material_t, point_t, n_hist
    use brz_materials, only: history_names
    implicit none
    private
    public :: slots_t, point_columns, point_row

    ! xx, yy, zz, yz, xz, xy in a table; xx, yy, zz, xy, yz, xz in a point
    integer, parameter :: order(6) = [1, 2, 3, 5, 6, 4]
    character(*), parameter :: shared(22) = [character(20) :: 'time[s]', 'rho[kg/m3]', 'e[J/kg]', &
        'p[Pa]', 'q[Pa]', 'sxx[Pa]', 'syy[Pa]', 'szz[Pa]', 'syz[Pa]', 'sxz[Pa]', 'sxy[Pa]', &
        'eps_xx[-]', 'eps_yy[-]', 'eps_zz[-]', 'eps_yz[-]', 'eps_xz[-]', 'eps_xy[-]', &
        'eps_p[-]', 'damage[-]', 'T[K]', &
        'plastic_work[J/kg]', 'damage_work[J/kg]']
    ! history that has a column of its own among them
    character(*), parameter :: strain_name = 'plastic_strain', temperature_name = 'temperature'

    !> Which history goes where.
    type :: slots_t
        integer :: strain = 0, temperature = 0 !! slots; 0: the model has none
        integer :: n = 0
        integer :: own(n_hist) = 0 !! slots of the last n columns
    end type slots_t

contains

    !> Names and units: those of every material, then the history of this one by name.
    subroutine point_columns(material, columns, names)
        type(material_t), intent(in) :: material
        type(slots_t), intent(out) :: columns
        character(48), allocatable, intent(out) :: names(:)
        character(32) :: history(n_hist)
        character(12) :: unit(n_hist)
        character(48) :: name
        integer :: i

        call history_names(material, history, unit)
        allocate (names(size(shared)))
        names = shared
        do i = 1, n_hist
            select case (history(i))
            case ('')
                cycle
            case (strain_name)
                columns%strain = i
            case (temperature_name)
                columns%temperature = i
            case default
                columns%n = columns%n + 1
                columns%own(columns%n) = i
                name = trim(history(i))//'['//trim(unit(i))//']'
                names = [names, name]
            end select
        end do
    end subroutine point_columns

    !> One row. Plastic strain and temperature are 0 where the model has none.
    pure subroutine point_row(material, columns, point, passed, strain, row)
        type(material_t), intent(in) :: material
        type(slots_t), intent(in) :: columns
        type(point_t), intent(in) :: point
        real(dp), intent(in) :: passed(3) !! time [s], plastic work and work of damage so far [J/kg]
        real(dp), intent(in) :: strain(6) !! in the order of a point
        real(dp), allocatable, intent(out) :: row(:)
        real(dp) :: plastic, temperature

        plastic = 0
        temperature = 0
        if (columns%strain > 0) plastic = point%hist(columns%strain)
        if (columns%temperature > 0) temperature = point%hist(columns%temperature)
        allocate (row(size(shared) + columns%n))
        row = [passed(1), material%density*(1 + real(point%mu, dp)), real(point%energy, dp), &
               pressure(point), mises(point), real(point%stress(order), dp), strain(order), &
               plastic, real(point%damage, dp), temperature, passed(2:3), &
               real(point%hist(columns%own(:columns%n)), dp)]
    end subroutine point_row

    pure real(dp) function pressure(point)
        type(point_t), intent(in) :: point

        pressure = 0 - sum(real(point%stress(:3), dp))/3 ! 0 - x: never a negative zero
    end function pressure

    !> Stress of von Mises.
    pure real(dp) function mises(point)
        type(point_t), intent(in) :: point
        real(kind(point%stress)) :: s(6)

        s = point%stress
        s(:3) = s(:3) - sum(s(:3))/3
        mises = sqrt(1.5_dp*double_dot(s, s))
    end function mises
end module brz_point_table
