! SPDX-License-Identifier: MIT
!> Ghost cells of the air: outflow copies the last cell, walls and symmetry planes mirror, a
!> periodic box goes on from the other end.
!>
!> Ghosts of gas at rest must be at rest to the bit: see brz_air_activity. Only ghosts straight
!> across a face are filled; no stencil reaches into edges or corners.
module brz_air_ghosts
    use brz_kinds, only: rk
    use brz_air_state, only: air_t, bc_symmetry, bc_wall, n_ghost
    use brz_air_walls, only: image_of
    implicit none
    private
    public :: fill_ghosts

contains

    !> Fill the ghosts of all directions that are modelled.
    subroutine fill_ghosts(air)
        type(air_t), intent(inout) :: air
        integer :: d, m, p, side
        real(rk) :: sign

        do d = 1, 3
            if (air%n(d) == 1) cycle
            do side = 1, 2
                sign = 1
                if (air%bc(side, d) == bc_wall .or. air%bc(side, d) == bc_symmetry) sign = -1
                do m = 1, n_ghost
                    p = merge(1 - m, air%n(d) + m, side == 1)
                    call copy_layer(air, d, p, image_of(air, d, p), sign)
                end do
            end do
        end do
    end subroutine fill_ghosts

    !> Copy one layer of cells normal to d; the normal momentum is multiplied by `sign`.
    subroutine copy_layer(air, d, to, from, sign)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: to, from !! indices of the layers along d
        real(rk), intent(in) :: sign
        integer :: i, j, k, c, lo(3), hi(3), shift(3)
        real(rk) :: s

        lo = 1
        hi = air%n
        lo(d) = to
        hi(d) = to
        shift = 0
        shift(d) = from - to
        do c = 1, air%n_var
            s = merge(sign, 1.0_rk, c == d + 1)
            do k = lo(3), hi(3)
                do j = lo(2), hi(2)
                    do i = lo(1), hi(1)
                        air%u(i, j, k, c) = s*air%u(i + shift(1), j + shift(2), k + shift(3), c)
                    end do
                end do
            end do
        end do
    end subroutine copy_layer
end module brz_air_ghosts
