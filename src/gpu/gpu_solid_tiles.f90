! SPDX-License-Identifier: MIT
!> Launches over all bodies of a kind: those that the same kernels suit. Scenes of many small bodies
!> cost a launch for each kind, not for each body.
!>
!> The particles of a body are cut into tiles, one for a block of threads: a block looks up its body
!> and how many particles of it come before its own. Tiles of a kind lie side by side. Those of
!> threads that add up numbers of the particles are others, for all bodies.
module brz_gpu_solid_tiles
    use brz_buffers, only: from, integers_t
    use brz_device, only: copy_in, reserve_buffer, threads_per_block
    use brz_errors, only: error_t
    use brz_gpu_common, only: partials_of
    use brz_gpu_solid_layout, only: list_offsets_t, n_diag
    use brz_kinds, only: int64
    use brz_lists, only: put_changed => put_changed_table
    use brz_motion_loop_bodies, only: n_sum
    use brz_solid_device, only: body_device_t, body_kind_t, solid_device_t
    implicit none
    private
    public :: adders_of, find_kinds, lay_adders, lay_tiles, tiles_of, threads_of_kind, &
        threads_of_kinds

contains

    !> Sort the bodies into kinds; rigid ones have no neighbours to look at, and no kind.
    subroutine find_kinds(gpu)
        type(solid_device_t), intent(inout) :: gpu
        integer :: b, k, like(size(gpu%bodies)), n

        if (.not. allocated(gpu%kind_of)) allocate (gpu%kind_of(size(gpu%bodies)))
        n = 0
        do b = 1, size(gpu%bodies)
            gpu%kind_of(b) = 0
            if (gpu%bodies(b)%rigid) cycle
            do k = 1, n
                if (same_kernels(gpu%bodies(b), gpu%bodies(like(k)))) exit
            end do
            if (k > n) like(k) = b
            n = max(k, n)
            gpu%kind_of(b) = k
        end do
        gpu%kinds = [(body_kind_t(like=like(k)), k=1, n)]
    end subroutine find_kinds

    !> May two bodies go in one launch?
    pure logical function same_kernels(a, b) result(same)
        type(body_device_t), intent(in) :: a, b

        same = a%moments%name == b%moments%name .and. a%update%name == b%update%name &
            .and. a%forces%name == b%forces%name .and. (a%total .eqv. b%total) &
            .and. (a%layer .eqv. b%layer)
    end function same_kernels

    !> Tiles of the bodies that are active, or of the others, and where lists lie; unless those on
    !> the GPU are right.
    subroutine lay_tiles(gpu, err, of_sleepers)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: of_sleepers
        integer :: counts(size(gpu%bodies))

        call put_offsets(gpu, err)
        counts = merge(gpu%bodies%last - gpu%bodies%gone - gpu%bodies%first + 1, 0, &
            gpu%kind_of > 0 .and. (gpu%bodies%inactive .eqv. present(of_sleepers)))
        if (allocated(gpu%tiles_there)) then
            if (all(gpu%tiles_there == counts)) return
        end if
        gpu%tiles_there = counts
        call put_tiles(gpu, counts, err)
    end subroutine lay_tiles

    !> Write the tiles of bodies with these numbers of particles.
    subroutine put_tiles(gpu, counts, err)
        type(solid_device_t), intent(inout) :: gpu
        integer, intent(in) :: counts(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer, allocatable :: tiles(:, :)
        integer :: b, before, k, n

        allocate (tiles(2, sum((counts - 1)/threads_per_block + 1, counts > 0)))
        n = 0
        do k = 1, size(gpu%kinds)
            gpu%kinds(k)%first = n + 1
            do b = 1, size(counts)
                if (gpu%kind_of(b) /= k) cycle
                do before = 0, counts(b) - 1, threads_per_block
                    n = n + 1
                    tiles(:, n) = [b, before]
                end do
            end do
            gpu%kinds(k)%tiles = n + 1 - gpu%kinds(k)%first
        end do
        call reserve_buffer(gpu%tiles, 4_int64*size(tiles), err)
        call copy_in(tiles, gpu%tiles, 4_int64*size(tiles), err)
    end subroutine put_tiles

    !> Where the lists of the bodies lie, from `count` on.
    subroutine put_offsets(gpu, err)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(list_offsets_t) :: offsets(size(gpu%bodies))

        offsets%slice = behind(gpu%bodies%slice%address)
        offsets%list = behind(gpu%bodies%list%address)
        offsets%pairs = behind(gpu%bodies%pairs%address)
        call put_changed(transfer(offsets, [0]), gpu%offsets_there, gpu%offsets, err)

    contains

        elemental integer(int64) function behind(address)
            integer(int64), intent(in) :: address

            behind = (address - gpu%count%address)/4
        end function behind
    end subroutine put_offsets

    !> Threads that add up numbers of the particles of each body, some of them each, and their
    !> tiles; unless those on the GPU are right. Of m threads t has the particles t, t + m, ... of
    !> the body.
    subroutine lay_adders(gpu, err)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: b, before, n, sets(4, size(gpu%bodies))
        integer, allocatable :: tiles(:, :)

        sets(1, :) = gpu%bodies%first
        sets(2, :) = gpu%bodies%last
        sets(4, :) = partials_of(sets(2, :) - sets(1, :) + 1)
        sets(3, :) = [(sum(sets(4, :b - 1)), b=1, size(gpu%bodies))]
        associate (adders => gpu%adders)
            if (allocated(adders%sets_there)) then
                if (all(adders%sets_there == [sets])) return
            end if
            call put_changed([sets], adders%sets_there, adders%sets, err)
            call reserve_buffer(adders%part, &
                                8_int64*max(n_diag, n_sum)*max(1, sum(sets(4, :))), err)
            allocate (tiles(2, sum((sets(4, :) - 1)/threads_per_block + 1, sets(4, :) > 0)))
            adders%first = [(0, b=1, size(gpu%bodies) + 1)]
            n = 0
            do b = 1, size(gpu%bodies)
                adders%first(b) = n + 1
                do before = 0, sets(4, b) - 1, threads_per_block
                    n = n + 1
                    tiles(:, n) = [b, before]
                end do
            end do
            adders%first(size(adders%first)) = n + 1
            call reserve_buffer(adders%tiles, 4_int64*size(tiles), err)
            call copy_in(tiles, adders%tiles, 4_int64*size(tiles), err)
        end associate
    end subroutine lay_adders

    !> The tiles of threads that add up numbers of the bodies first..last, and a block for each.
    pure subroutine adders_of(gpu, first, last, tiles, threads)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: first, last !! bodies
        type(integers_t), intent(out) :: tiles
        integer, intent(out) :: threads(3)

        associate (begin => gpu%adders%first)
            tiles = from(gpu%adders%tiles, 2_int64*begin(first) - 1)
            threads = [(begin(last + 1) - begin(first))*threads_per_block, 1, 1]
        end associate
    end subroutine adders_of

    !> The tiles of a kind.
    pure type(integers_t) function tiles_of(gpu, kind)
        type(solid_device_t), intent(in) :: gpu
        type(body_kind_t), intent(in) :: kind

        tiles_of = from(gpu%tiles, 2_int64*kind%first - 1)
    end function tiles_of

    !> A block of threads for each of them.
    pure function threads_of_kind(kind) result(n)
        type(body_kind_t), intent(in) :: kind
        integer :: n(3)

        n = [kind%tiles*threads_per_block, 1, 1]
    end function threads_of_kind

    !> The same for the tiles of some kinds, which lie side by side.
    pure function threads_of_kinds(kinds) result(n)
        type(body_kind_t), intent(in) :: kinds(:)
        integer :: n(3)

        n = [sum(kinds%tiles)*threads_per_block, 1, 1]
    end function threads_of_kinds
end module brz_gpu_solid_tiles
