! SPDX-License-Identifier: MIT
!> The coupling on the GPU: what it keeps there. Walls, bins, ledgers and debts are built and held
!> on the GPU; the host learns how many there are.
!>
!> Cells of the air go by their number in memory order, ghosts left out; solid cells and wall faces
!> by their places in lists, in the order of the CPU.
module brz_gpu_coupling_state
    use brz_carrier_rules, only: carrier_t
    use brz_coupling_part, only: listing_t
    use brz_coupling_state, only: coupling_known_t, coupling_t, n_sums
    use brz_boxes, only: cells_t
    use brz_buffers, only: buffer_t, bytes_t, doubles_t, from, integers_t, reals_t
    use brz_device, only: allocate_buffer, copy_in, copy_out, put_buffer
    use brz_errors, only: error_t
    use brz_gpu_exact_sum, only: gpu_exact_t
    use brz_air_device, only: wall_device_t
    use brz_gpu_air_state, only: bytes_of_real
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_fetch, only: gpu_fetch_t
    use brz_gpu_parcels, only: gpu_parcels_t
    use brz_gpu_places, only: gpu_marks_t, gpu_places_t
    use brz_ranks, only: ranks_t
    use brz_kinds, only: dp, int64
    use brz_solid_state, only: solid_t
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: gpu_coupling_t, seen_t, range_t, open_memory
    public :: count_moved, count_outside, count_covered, count_uncovered, count_own, count_over, &
        count_kept, count_missed, book_threads, book_work, book_images, book_low, book_high, n_book
    public :: book_at, count_at, read_counts, put_carriers

    ! what the kernels count
    integer, parameter :: count_moved = 1 !! particles that have changed their cell
    integer, parameter :: count_outside = 2 !! particles outside the box
    integer, parameter :: count_covered = 3, count_uncovered = 4 !! cells
    integer, parameter :: count_own = 4 !! + 1..2: both, of this process
    integer, parameter :: count_over = 7 !! ledgers beyond their band
    integer, parameter :: count_kept = 8 !! buried ledgers that found no taker
    integer, parameter :: count_missed = 9 !! particles that should be guests
    integer, parameter :: n_count = 9

    ! the books, as partial results of `book_threads` threads: part(book_threads, n_book)
    integer, parameter :: book_threads = tally_threads
    integer, parameter :: book_work = 1 !! to 8: work and impulses, as sums_in has them
    integer, parameter :: book_images = 9 !! to 11: what images took
    integer, parameter :: book_low = n_sums + 1, book_high = n_sums + 2 !! least, largest ledger
    integer, parameter :: n_book = n_sums + 2

    type :: range_t
        integer :: first = 1, last = 0 !! particles of a body
    end type range_t

    !> Particles as the steps see them, see solid_t.
    type :: seen_t
        integer :: n = 0, wide = 4, step_d = 0, step_p = 1, step_t = 1
        type(doubles_t) :: x
        type(reals_t) :: v, mass, load, face_stress
        type(integers_t) :: fixed, id
        type(range_t), allocatable :: bodies(:)
        ! on several processes
        type(reals_t) :: v_before
        integer(int64) :: rebuilds = 0 !! how often their places have become others
    end type seen_t

    !> What it has to do with those of other processes, as coupling_part_t has it, and its window.
    type :: gpu_coupling_part_t
        type(cells_t), allocatable :: boxes(:), windows(:), near(:) !! (0:processes - 1)
        type(integers_t) :: windows_at, boxes_at, near_at
        type(gpu_fetch_t) :: window !! gas and ledgers of others in the window
        integer(int64) :: rebuilds = -1
        type(gpu_parcels_t) :: parcels
        type(gpu_places_t) :: out, in, home
        type(gpu_marks_t) :: listed, marks
        type(listing_t) :: since
        type(integers_t) :: bodies_at, first_at, seat
        type(reals_t) :: loads, stresses
        type(gpu_places_t) :: faces_out, faces_in, debts_out, debts_in
    end type gpu_coupling_part_t

    !> Names are those of coupling_t where there is such an array.
    type, extends(coupling_known_t) :: gpu_coupling_t
        type(wall_device_t) :: wall !! those of the air, as they were put up last
        logical :: walls_fetched = .false. !! no cell has changed hands since the last fetch
        type(buffer_t) :: shells !! shells_t
        type(bytes_t) :: mark !! (cells) what the particles make of a cell
        type(integers_t) :: slot !! (cells) place among the debts, or 0
        type(integers_t) :: counts !! see count_moved, ...
        type(doubles_t) :: book !! likewise
        type(integers_t) :: felt
        type(carrier_t), allocatable :: carrier(:) !! on the host
        type(buffer_t) :: carrier_there !! the same
        real(dp), allocatable :: shift(:, :) !! on the host
        type(gpu_exact_t) :: exact !! sums over one of them
        type(gpu_coupling_part_t) :: part !! on several processes
        type(seen_t) :: guests !! as in coupling_t
        type(solid_t) :: crowd !! what the host knows of the bodies of the guests
        type(integers_t) :: cell_of, place_of, binned !! (particles) cell, its place, bins
        type(reals_t) :: v_before !! (3, particles by id) velocity a step of the air before [m/s]
        type(integers_t) :: ends !! (n_cells + 1) of the bins
        type(integers_t) :: cell !! (n_cells) number of each solid cell
        type(integers_t) :: above !! (6, n_cells) face that loads the column of a cell, or 0
        type(reals_t) :: ledger, excess !! (max_var, n_cells), (n_cells)
        type(integers_t) :: gas, rows !! (n_faces) gas cell, side
        type(doubles_t) :: surface !! (n_faces) as in coupling_t
        type(reals_t) :: weight, force, impedance !! (n_faces) likewise
        type(integers_t) :: start !! counts that become places in lists
        type(integers_t) :: uncovered, listed !! cells that the solid has left, of a kind
        type(integers_t) :: donor, donor_shell !! as in coupling_t
        type(reals_t) :: donation !! likewise
        type(integers_t) :: debt_cell, next_cell !! the list, and room for the next one
        type(reals_t) :: debt, next_debt
        type(gpu_common_t) :: common
    end type gpu_coupling_t

contains

    !> Reserve what does not grow, and find the kernels.
    subroutine open_memory(ranks, coupling, particles, gpu, err)
        type(ranks_t), intent(in) :: ranks
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: particles
        type(gpu_coupling_t), intent(out) :: gpu
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        gpu%coupling_known_t = coupling%coupling_known_t
        gpu%rebuilds = -1
        gpu%n_debts = 0 ! see put_debts
        gpu%bodies = size(coupling%carrier)
        call gpu%common%open(1, 1, err)
        call put_buffer(coupling%shells, gpu%shells, storage_size(coupling%shells)/8_int64, err)
        call allocate_buffer(gpu%mark, int(gpu%box%cells, int64), err)
        call allocate_buffer(gpu%slot, 4_int64*gpu%box%cells, err)
        call allocate_buffer(gpu%counts, 4_int64*n_count, err)
        call allocate_buffer(gpu%book, 8_int64*book_threads*n_book, err)
        call allocate_buffer(gpu%cell_of, 4_int64*particles, err)
        call allocate_buffer(gpu%place_of, 4_int64*particles, err)
        call allocate_buffer(gpu%binned, 4_int64*particles, err)
        call allocate_buffer(gpu%v_before, 3*bytes_of_real*particles, err)
        gpu%carrier = coupling%carrier
        bytes = storage_size(coupling%carrier)/8
        call put_buffer(gpu%carrier, gpu%carrier_there, gpu%bodies*bytes, err)
        call gpu%exact%open(ranks, err)
    end subroutine open_memory

    !> A column of the books, as an item adds to it and to those behind.
    pure type(doubles_t) function book_at(gpu, column)
        type(gpu_coupling_t), intent(in) :: gpu
        integer, intent(in) :: column

        book_at = from(gpu%book, book_threads*(column - 1_int64) + 1)
    end function book_at

    pure type(integers_t) function count_at(gpu, number)
        type(gpu_coupling_t), intent(in) :: gpu
        integer, intent(in) :: number

        count_at = from(gpu%counts, int(number, int64))
    end function count_at

    !> What the kernels have counted; 0 where the GPU fails.
    subroutine read_counts(gpu, first, err, n1, n2, n3, n4)
        type(gpu_coupling_t), intent(in) :: gpu
        integer, intent(in) :: first
        type(error_t), intent(inout) :: err
        integer, intent(out) :: n1
        integer, intent(out), optional :: n2, n3, n4
        integer :: words(4)

        words = 0
        call copy_out(count_at(gpu, first), words, merge(16_int64, 4_int64, present(n2)), err)
        n1 = words(1)
        if (present(n2)) n2 = words(2)
        if (present(n3)) n3 = words(3)
        if (present(n4)) n4 = words(4)
    end subroutine read_counts

    !> The carriers of the host.
    subroutine put_carriers(gpu, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err

        call copy_in(gpu%carrier, gpu%carrier_there, &
                     gpu%bodies*(storage_size(gpu%carrier)/8_int64), err)
    end subroutine put_carriers
end module brz_gpu_coupling_state
