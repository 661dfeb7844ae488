! SPDX-License-Identifier: MIT
!> Arrays that are shuffled and deflated: cut into chunks, which several threads pack at once.
!>
!> HDF5's own filters pack one chunk after the other on one core. Here each thread packs a chunk as
!> they would, and HDF5 stores it as it is (H5Dwrite_chunk); every reader of HDF5 unpacks it.
module brz_hdf5_packed
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_int32_t, c_int64_t, c_loc, &
        c_long, c_ptr, c_size_t
    use brz_kinds, only: int8, int64
    use hdf5, only: hid_t, h5p_default_f
    use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: choose_chunk, write_chunks, deflate_level

    integer, parameter :: deflate_level = 1 !! the fastest
    integer(int64), parameter :: chunk_elements = 131072 !! at most: a megabyte of real64
    integer, parameter :: per_thread = 2 !! chunks that are packed before they are stored

    interface
        integer(c_long) function c_room_for(bytes) bind(c, name='compressBound')
            import :: c_long
            integer(c_long), value :: bytes
        end function c_room_for
        integer(c_int) function c_deflate(to, n_to, from, n_from, level) bind(c, name='compress2')
            import :: c_int, c_long, c_ptr
            type(c_ptr), value :: to, from
            integer(c_long), intent(inout) :: n_to
            integer(c_long), value :: n_from
            integer(c_int), value :: level
        end function c_deflate
        integer(c_int) function c_write_chunk(set, transfer, skipped, offset, n, data) &
            bind(c, name='H5Dwrite_chunk')
            import :: c_int, c_int32_t, c_int64_t, c_ptr, c_size_t
            integer(c_int64_t), value :: set, transfer
            integer(c_int32_t), value :: skipped !! filters
            integer(c_int64_t), intent(in) :: offset(*)
            integer(c_size_t), value :: n
            type(c_ptr), value :: data
        end function c_write_chunk
    end interface

contains

    !> Shape of the chunks of an array: each lies in one piece in memory, and they are about even.
    pure function choose_chunk(dims) result(chunk)
        integer(int64), intent(in) :: dims(:) !! none is 0
        integer(int64) :: chunk(size(dims)), inner, most
        integer :: i

        chunk = dims
        do i = size(dims), 1, -1 ! the last index varies slowest
            inner = product(dims(:i - 1))
            if (inner*dims(i) <= chunk_elements) return
            most = max(1_int64, chunk_elements/inner)
            chunk(i) = up(dims(i), up(dims(i), most))
            if (inner <= chunk_elements) return
        end do
    end function choose_chunk

    !> n/m, rounded up.
    elemental integer(int64) function up(n, m)
        integer(int64), intent(in) :: n, m

        up = (n + m - 1)/m
    end function up

    !> Pack the elements at `data` and store them. `status` is not 0 where that fails.
    subroutine write_chunks(set, data, dims, chunk, width, status)
        integer(hid_t), intent(in) :: set !! with the filters shuffle and deflate
        type(c_ptr), intent(in) :: data
        integer(int64), intent(in) :: dims(:), chunk(:) !! of choose_chunk
        integer, intent(in) :: width !! of an element [bytes]
        integer, intent(out) :: status
        integer(int8), pointer :: bytes(:)
        integer(int8), allocatable, target :: packed(:, :)
        integer(c_long), allocatable :: n(:)
        integer(int64) :: at(size(dims)), first, k, last, pieces(size(dims)), room, whole
        integer :: m

        call c_f_pointer(data, bytes, [product(dims)*width])
        pieces = up(dims, chunk)
        whole = product(chunk)*width
        room = c_room_for(int(whole, c_long))
        m = int(min(product(pieces), int(per_thread*omp_get_max_threads(), int64)))
        allocate (packed(room, m), n(m))
        status = 0
        do first = 0, product(pieces) - 1, m
            last = min(first + m, product(pieces)) - 1
            !$omp parallel do schedule(dynamic, 1) private(at)
            do k = first, last
                at = origin(k, pieces, chunk)
                call pack_chunk(bytes, dims, chunk, at, width, packed(:, k - first + 1), &
                                n(k - first + 1))
            end do
            do k = first, last
                at = origin(k, pieces, chunk)
                if (n(k - first + 1) > 0) status = c_write_chunk( &
                    int(set, c_int64_t), int(h5p_default_f, c_int64_t), 0_c_int32_t, &
                    at(size(at):1:-1), int(n(k - first + 1), c_size_t), &
                    c_loc(packed(:, k - first + 1)))
                if (n(k - first + 1) == 0) status = -1
                if (status /= 0) return
            end do
        end do
    end subroutine write_chunks

    !> Where chunk k begins, from 0.
    pure function origin(k, pieces, chunk) result(at)
        integer(int64), intent(in) :: k, pieces(:), chunk(:)
        integer(int64) :: at(size(pieces)), left
        integer :: i

        left = k
        do i = 1, size(pieces)
            at(i) = mod(left, pieces(i))*chunk(i)
            left = left/pieces(i)
        end do
    end function origin

    !> Shuffle and deflate a chunk; what the last ones lack is zeros.
    subroutine pack_chunk(bytes, dims, chunk, at, width, packed, n)
        integer(int8), intent(in) :: bytes(:) !! of the whole array
        integer(int64), intent(in) :: dims(:), chunk(:), at(:)
        integer, intent(in) :: width
        integer(int8), intent(out), target, contiguous :: packed(:)
        integer(c_long), intent(out) :: n !! bytes, 0: it could not be packed
        integer(int8), allocatable, target :: plain(:)
        integer(int64) :: elements, i, here, start
        integer :: b

        elements = product(chunk)
        here = product(min(chunk, dims - at))
        start = sum(at*[(product(dims(:b - 1)), b=1, size(dims))])*width
        allocate (plain(elements*width))
        do b = 1, width
            do i = 1, here
                plain((b - 1)*elements + i) = bytes(start + (i - 1)*width + b)
            end do
            plain((b - 1)*elements + here + 1:b*elements) = 0_int8
        end do
        n = size(packed, kind=c_long)
        if (c_deflate(c_loc(packed), n, c_loc(plain), size(plain, kind=c_long), &
                      int(deflate_level, c_int)) /= 0) n = 0
    end subroutine pack_chunk
end module brz_hdf5_packed
