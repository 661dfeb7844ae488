! SPDX-License-Identifier: MIT
!> Bring every array of the particles into a new order, without allocating.
!>
!> `pair`, which is written afresh after a sort, serves as buffer for one array after the other.
module brz_particle_order
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc, c_ptr
    use brz_kinds, only: int8
    use brz_solid_fields, only: fields_of, fields_t, memory_of
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: find_place, reorder_particles

contains

    !> Particle `solid%search%order(k)` moves to place k, first <= k <= last, among which it is.
    subroutine reorder_particles(solid, first, last)
        class(listed_bodies_t), intent(inout), target :: solid
        integer, intent(in) :: first, last
        type(fields_t) :: fields
        integer :: k

        call fields_of(solid, fields)
        do k = 1, fields%n
            associate (field => fields%of(k))
                if (field%sorted .and. field%rows > 0) call gather(memory_of(field), solid%n, &
                    first, last, solid%search%order, field%values, solid%pair)
            end associate
        end do
    end subroutine reorder_particles

    !> Bring q, of so many bytes per particle, into the order, by way of the buffer.
    subroutine gather(bytes, n, first, last, order, q, buffer)
        integer, intent(in) :: bytes, n, first, last, order(n)
        type(c_ptr), intent(in) :: q
        type(*), intent(inout), target, contiguous :: buffer(..)
        integer(int8), pointer :: old(:, :), new(:, :)

        call c_f_pointer(q, old, [bytes, n])
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

    !> Look a particle up again if it has been moved by sorting; place 0: another process has it.
    pure subroutine find_place(solid, body, particle, place)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: body, particle
        integer, intent(inout) :: place

        associate (first => solid%bodies(body)%first, last => solid%bodies(body)%last)
            if (place >= first .and. place <= last) then
                if (solid%id(place) == particle) return
            end if
            place = findloc(solid%id(first:last), particle, dim=1)
            if (place > 0) place = first - 1 + place
        end associate
    end subroutine find_place
end module brz_particle_order
