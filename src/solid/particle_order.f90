! SPDX-License-Identifier: MIT
!> Bring every array of the particles into a new order, without allocating.
!>
!> `pair`, which is written afresh after a sort, serves as buffer for one array after the other.
module brz_particle_order
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
    use brz_kinds, only: int8
    use brz_solid_state, only: solid_t, worth_threads
    implicit none
    private
    public :: reorder_particles

contains

    !> Particle `solid%search%order(k)` moves to place k, first <= k <= last, among which it is.
    subroutine reorder_particles(solid, first, last)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: first, last

        associate (s => solid)
            call reorder(storage_size(s%x)/8*3, s%x)
            call reorder(storage_size(s%x_ref)/8*3, s%x_ref)
            call reorder(storage_size(s%v)/8*3, s%v)
            call reorder(storage_size(s%a)/8*3, s%a)
            if (allocated(s%load)) call reorder(storage_size(s%load)/8*3, s%load)
            call reorder(storage_size(s%mass)/8, s%mass)
            call reorder(storage_size(s%mu)/8, s%mu)
            call reorder(storage_size(s%energy)/8, s%energy)
            call reorder(storage_size(s%stress)/8*6, s%stress)
            call reorder(storage_size(s%hist)/8*s%n_hist, s%hist)
            call reorder(storage_size(s%damage)/8, s%damage)
            call reorder(storage_size(s%volume)/8, s%volume)
            if (size(s%h) > 0) call reorder(storage_size(s%h)/8, s%h)
            if (allocated(s%tilt)) call reorder(storage_size(s%tilt)/8, s%tilt)
            if (allocated(s%owed)) call reorder(storage_size(s%owed)/8, s%owed)
            call reorder(storage_size(s%id)/8, s%id)
            call reorder(storage_size(s%ply)/8, s%ply)
            call reorder(storage_size(s%support)/8, s%support)
            call reorder(1, s%fixed)
            call reorder(1, s%cut)
            if (.not. s%links%present) return
            call reorder(storage_size(s%links%touch)/8, s%links%touch)
            call reorder(storage_size(s%links%weight)/8, s%links%weight)
            call reorder(1, s%links%bond)
        end associate

    contains

        !> An array of so many bytes per particle, at most those of a row of `pair`.
        subroutine reorder(bytes, q)
            integer, intent(in) :: bytes
            type(*), intent(inout), target, contiguous :: q(..)

            if (bytes > 0) call gather(bytes, solid%n, first, last, &
                                       solid%search%order, q, solid%pair)
        end subroutine reorder
    end subroutine reorder_particles

    !> Bring q, of so many bytes per particle, into the order, by way of the buffer.
    subroutine gather(bytes, n, first, last, order, q, buffer)
        integer, intent(in) :: bytes, n, first, last, order(n)
        type(*), intent(inout), target, contiguous :: q(..), buffer(..)
        integer(int8), pointer :: old(:, :), new(:, :)

        call c_f_pointer(c_loc(q), old, [bytes, n])
        call c_f_pointer(c_loc(buffer), new, [bytes, n])
        call gather_bytes(bytes, n, first, last, order, old, new)
    end subroutine gather

    subroutine gather_bytes(bytes, n, first, last, order, old, new)
        integer, intent(in) :: bytes, n, first, last, order(n)
        integer(int8), intent(inout) :: old(bytes, n), new(bytes, n)
        integer :: i

        !$omp parallel if(last - first >= worth_threads)
        !$omp do schedule(static)
        do i = first, last
            new(:, i) = old(:, order(i))
        end do
        !$omp do schedule(static)
        do i = first, last
            old(:, i) = new(:, i)
        end do
        !$omp end parallel
    end subroutine gather_bytes
end module brz_particle_order
