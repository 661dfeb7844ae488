! SPDX-License-Identifier: MIT
!> Bring every array of the particles into a new order, without allocating.
!>
!> `x_built` and `pair`, which are written afresh after a sort, serve as buffers.
module brz_particle_order
    use brz_kinds, only: dp, int32, int8, rk
    use brz_solid_state, only: solid_t, worth_threads
    implicit none
    private
    public :: reorder_particles

contains

    !> Particle `solid%search%order(k)` moves to place k.
    subroutine reorder_particles(solid)
        type(solid_t), intent(inout) :: solid

        associate (s => solid%search, n => solid%n)
            call reorder_d(n, s%order, solid%x, solid%x_built)
            call reorder_d(n, s%order, solid%x_ref, solid%x_built)
            call reorder_r(3, n, s%order, solid%v, solid%pair)
            call reorder_r(3, n, s%order, solid%a, solid%pair)
            call reorder_r(3, n, s%order, solid%load, solid%pair)
            call reorder_r(1, n, s%order, solid%mass, solid%pair)
            call reorder_r(1, n, s%order, solid%mu, solid%pair)
            call reorder_r(1, n, s%order, solid%energy, solid%pair)
            call reorder_r(6, n, s%order, solid%stress, solid%pair)
            call reorder_r(solid%n_hist, n, s%order, solid%hist, solid%pair)
            call reorder_r(1, n, s%order, solid%damage, solid%pair)
            call reorder_r(1, n, s%order, solid%volume, solid%pair)
            if (allocated(solid%h)) call reorder_r(1, n, s%order, solid%h, solid%pair)
            call reorder_i(n, s%order, solid%id, s%cell)
            call reorder_i(n, s%order, solid%ply, s%cell)
            call reorder_i(n, s%order, solid%support, s%cell)
            call reorder_b(n, s%order, solid%fixed, s%b)
            call reorder_b(n, s%order, solid%cut, s%b)
            if (.not. solid%links%present) return
            call reorder_r(1, n, s%order, solid%links%touch, solid%pair)
            call reorder_b(n, s%order, solid%links%bond, s%b)
        end associate
    end subroutine reorder_particles

    subroutine reorder_d(n, order, q, buffer)
        integer, intent(in) :: n, order(n)
        real(dp), intent(inout) :: q(3, n)
        real(dp), intent(inout) :: buffer(3, n)
        integer :: i

        !$omp parallel if(n >= worth_threads)
        !$omp do schedule(static)
        do i = 1, n
            buffer(:, i) = q(:, order(i))
        end do
        !$omp do schedule(static)
        do i = 1, n
            q(:, i) = buffer(:, i)
        end do
        !$omp end parallel
    end subroutine reorder_d

    subroutine reorder_r(k, n, order, q, buffer)
        integer, intent(in) :: k, n, order(n)
        real(rk), intent(inout) :: q(k, n)
        real(rk), intent(inout) :: buffer(k, n)
        integer :: i

        !$omp parallel if(n >= worth_threads)
        !$omp do schedule(static)
        do i = 1, n
            buffer(:, i) = q(:, order(i))
        end do
        !$omp do schedule(static)
        do i = 1, n
            q(:, i) = buffer(:, i)
        end do
        !$omp end parallel
    end subroutine reorder_r

    subroutine reorder_i(n, order, q, buffer)
        integer, intent(in) :: n, order(n)
        integer(int32), intent(inout) :: q(n), buffer(n)

        buffer = q(order)
        q = buffer
    end subroutine reorder_i

    subroutine reorder_b(n, order, q, buffer)
        integer, intent(in) :: n, order(n)
        integer(int8), intent(inout) :: q(n), buffer(n)

        buffer = q(order)
        q = buffer
    end subroutine reorder_b
end module brz_particle_order
