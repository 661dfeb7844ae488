! SPDX-License-Identifier: MIT
!> Level the ledgers of neighbours on the same side of a body.
!>
!> A surface that is oblique to the grid, or moves obliquely, lets gas in through the faces of one
!> direction and out through those of another: the fluxes cancel over a few cells of surface, but
!> not in each. What a single ledger cannot hold would have to go back into the gas, as noise.
module brz_coupling_level
    use brz_air_state, only: air_t
    use brz_cell_shells, only: neighbour, touching
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: rk
    use brz_solid_state, only: worth_threads
    implicit none
    private
    public :: level_ledgers

contains

    !> Exchange a part of the difference with each neighbour that has faces of a common direction.
    !>
    !> What one takes the other gives, to the bit. In one dimension there are no such neighbours.
    subroutine level_ledgers(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: c, ijk(3)
        real(rk) :: gain(air%n_var), part

        if (coupling%shells%n < 3 .or. count(air%n > 1) == 1) return
        part = 1/3.0_rk**count(air%n > 1)
        !$omp parallel if(coupling%wall%n_cells >= worth_threads)
        !$omp do schedule(static) private(ijk)
        do c = 1, coupling%wall%n_cells
            ijk = coupling%wall%cell(:, c)
            coupling%ledger(:, c) = air%u(ijk(1), ijk(2), ijk(3), :)
        end do
        !$omp do schedule(dynamic, 64) private(ijk, gain)
        do c = 1, coupling%wall%n_cells
            if (.not. any(coupling%face_of(:, c) > 0)) cycle
            call gain_of(air, coupling, c, gain)
            ijk = coupling%wall%cell(:, c)
            air%u(ijk(1), ijk(2), ijk(3), :) = coupling%ledger(:, c) + part*gain
        end do
        !$omp end parallel
    end subroutine level_ledgers

    !> Sum of the differences to the neighbours.
    pure subroutine gain_of(air, coupling, c, gain)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk), intent(out) :: gain(:) !! (n_var)
        integer :: at, m, to(3)
        logical :: inside

        gain = 0
        do m = 1, coupling%shells%first(touching + 1) - 1
            if (any(abs(coupling%shells%offset(:, m)) > 1)) cycle
            call neighbour(air%n, coupling%wraps, coupling%wall%cell(:, c), &
                           coupling%shells%offset(:, m), to, inside)
            if (.not. inside) cycle
            if (coupling%wall%solid(to(1), to(2), to(3)) == 0) cycle
            at = coupling%wall%index(to(1), to(2), to(3))
            if (.not. any(coupling%face_of(:, c) > 0 .and. coupling%face_of(:, at) > 0)) cycle
            gain = gain + (coupling%ledger(:, at) - coupling%ledger(:, c))
        end do
    end subroutine gain_of
end module brz_coupling_level
