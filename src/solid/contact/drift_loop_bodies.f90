! SPDX-License-Identifier: MIT
!> How a body drifts as a whole, and who has moved far within it, for its list of neighbours: see
!> brz_list_drift.
module brz_drift_loop_bodies
    use brz_cell_places, only: cell_along
    use brz_kinds, only: dp, int32, rk
    use brz_skin_level, only: level_of, renewed_level
    use brz_particle_marks, only: is_gone
    implicit none
    private
    public :: sum_drift, drift_of, renew_place, cell_at

    real(dp), parameter :: fine = 2.0_dp**17 !! parts of a mass, and of 1 m/s, that are counted
    real(dp), parameter :: fastest = 2.0_dp**17 !! what is faster does not count [m/s]

contains

    !> Add mass and momentum of a particle at the step, over the mass of one on its lattice, in
    !> whole parts: so the sums are the same in any order, by any number of threads and processes,
    !> as long as the particles of a process times their speed stay below 2^36 m/s.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_drift(p, first, wide, stride_d, half, per_mass, mass, v, accel, total)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of v
        integer, intent(in) :: stride_d !! distance of directions in accel
        real(rk), intent(in) :: half !! half of the last time step [s]
        real(dp), intent(in) :: per_mass !! 1/mass of a particle on the lattice [1/kg]
        real(rk), intent(in) :: mass(*)
        real(rk), intent(in) :: v(wide, *) !! half a step before [m/s]
        real(rk), intent(in) :: accel(*) !! [m/s2]
        real(dp), intent(inout) :: total(4) !@sum mass, momentum
        real(dp) :: share, u(3)
        integer :: c, i

        i = first - 1 + p
        share = fine*per_mass*mass(i)
        do c = 1, 3
            u(c) = v(c, i) + half*accel(i + (c - 1)*stride_d)
            if (.not. abs(u(c)) < fastest) u(c) = 0
        end do
        total(1) = total(1) + anint(share)
        total(2) = total(2) + anint(share*u(1))
        total(3) = total(3) + anint(share*u(2))
        total(4) = total(4) + anint(share*u(3))
    end subroutine sum_drift

    !> Give a particle that has moved far a new place x - D, mark the cells where it was and is, and
    !> count it.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine renew_place(p, first, wide, unit, dx, dy, dz, stride, nx, ny, nz, lx, ly, lz, &
                                size, code, fixed, x, built, marked, moved)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: unit !! of levels of motion [m]
        real(dp), intent(in) :: dx, dy, dz !! drift of the body [m]
        integer, intent(in) :: stride !! length of a table of codes
        integer, intent(in) :: nx, ny, nz !! cells along each axis
        real(dp), intent(in) :: lx, ly, lz, size !! low corner, side of a cell [m]
        integer, intent(in) :: code(*) !! (stride, 3) share of an axis in the number of a cell
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(in) :: x(wide, *)
        real(dp), intent(inout) :: built(wide, *)
        integer, intent(inout) :: marked(*) !! (cells) 1
        integer, intent(inout) :: moved !@count particles
        real(dp) :: y(3), z(3)
        integer :: c, i

        i = first - 1 + p
        if (fixed(i) == is_gone) return
        y(1) = x(1, i) - dx
        y(2) = x(2, i) - dy
        y(3) = x(3, i) - dz
        do c = 1, 3
            z(c) = built(c, i)
        end do
        if (level_of((y(1) - z(1))**2 + (y(2) - z(2))**2 + (y(3) - z(3))**2, unit) &
            < renewed_level) return
        marked(cell_at(stride, nx, ny, nz, lx, ly, lz, size, code, z)) = 1
        marked(cell_at(stride, nx, ny, nz, lx, ly, lz, size, code, y)) = 1
        do c = 1, 3
            built(c, i) = y(c)
        end do
        moved = moved + 1
    end subroutine renew_place

    !> Cell of a place, from 1.
    !@cuf attributes(host,device) &
    pure function cell_at(stride, nx, ny, nz, lx, ly, lz, size, code, x) result(c)
        integer, intent(in) :: stride, nx, ny, nz
        real(dp), intent(in) :: lx, ly, lz, size
        integer, intent(in) :: code(*)
        real(dp), intent(in) :: x(3)
        integer :: c

        c = 1 + code(1 + cell_along(x(1), lx, size, nx)) &
            + code(1 + stride + cell_along(x(2), ly, size, ny)) &
            + code(1 + 2*stride + cell_along(x(3), lz, size, nz))
    end function cell_at

    !> Mean velocity of what was added up [m/s].
    pure function drift_of(total) result(v)
        real(dp), intent(in) :: total(4)
        real(dp) :: v(3)

        v = total(2:4)/max(total(1), 1.0_dp)
    end function drift_of
end module brz_drift_loop_bodies
