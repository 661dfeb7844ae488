! SPDX-License-Identifier: MIT
!> What air, solids and coupling do alike on the GPU: running sums, and sums and largest numbers in
!> a fixed order.
module brz_gpu_common
    use brz_buffers, only: buffer_t, doubles_t, from, integers_t
    use brz_common_launches, only: common_kernels
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, copy_out, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_tallies, only: pick_chunk
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: gpu_common_t, partials_of, pick

    integer, parameter :: first_fold = 32768, last_fold = 1024 !! of the largest number
    integer, parameter :: most_rows = 8192 !! partial results that are folded at once
    integer, parameter :: rows_between = 2048
    integer, parameter :: most_left = 32, all_left = 1024 !! for the host: of a set; of all, nearly
    integer, parameter :: each_adds = 16 !! numbers that a thread adds up, see partials_of
    integer, parameter :: many = 2**18 !! numbers of a scan that fill the GPU
    integer, parameter :: chunks(2) = [64, 8]
    !! numbers that a thread of a scan adds: of few, so that it is done in few launches, and of
    !! many, so that threads side by side read the same lines of memory

    type :: gpu_common_t
        type(integers_t) :: levels !! of running sums
        type(doubles_t) :: part, folded !! partial results
        type(buffer_t) :: asked, told !! what the host looks up, and the answer
        integer :: left = most_left !! partial results of a set that the host adds up
    contains
        procedure :: open, ask, running_sum, fold, fold_sets, read_sums, fold_boxes, read_boxes
        procedure :: largest
    end type gpu_common_t

contains

    subroutine open (self, columns, sets, err)
        class(gpu_common_t), intent(inout) :: self
        integer, intent(in) :: columns !! most that are folded; of more than most_rows: 16
        integer, intent(in) :: sets !! of columns that are folded before the host reads them
        type(error_t), intent(inout) :: err

        self%left = max(1, min(most_left, all_left/sets))
        call allocate_buffer(self%part, 8_int64*first_fold, err)
        call allocate_buffer(self%folded, 8_int64*max(self%left*columns*sets, last_fold), err)
    end subroutine open

    !> Hand over which places or particles the host looks up, with room for what it is told.
    subroutine ask(self, what, bytes, answer, err)
        class(gpu_common_t), intent(inout) :: self
        type(*), intent(in), target, contiguous :: what(..)
        integer(int64), intent(in) :: bytes, answer !! of the question, of the answer
        type(error_t), intent(inout) :: err

        call reserve_buffer(self%asked, bytes, err)
        call reserve_buffer(self%told, answer, err)
        call copy_in(what, self%asked, bytes, err)
    end subroutine ask

    !> Every one of n integers becomes the sum of those before it; one more, behind them, becomes
    !> the sum of all and is brought to the host if asked for.
    subroutine running_sum(self, x, n, err, total)
        class(gpu_common_t), intent(inout) :: self
        type(integers_t), intent(in) :: x !! (n + 1)
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        integer, intent(out), optional :: total
        type(integers_t) :: level(0:8)
        integer :: length(0:8), l, last, word(1)

        call clear_buffer(from(x, n + 1_int64), err, 4_int64)
        length(0) = n + 1
        level(0) = x
        last = 0
        call reserve_buffer(self%levels, 4_int64*(n/chunk_of(n + 1) + 1)*2 + 1024, err)
        level(1) = self%levels
        do while (length(last) > chunk_of(length(last)))
            length(last + 1) = chunks_of(length(last))
            call common_kernels%scan_up([length(last + 1), 1, 1], length(last), &
                chunk_of(length(last)), level(last), level(last + 1), err)
            last = last + 1
            level(last + 1) = from(level(last), (length(last)/64 + 1)*64_int64 + 1)
        end do
        do l = last, 0, -1
            call common_kernels%scan_down([chunks_of(length(l)), 1, 1], length(l), &
                chunk_of(length(l)), level(l + 1), level(l), err)
        end do
        if (.not. present(total)) return
        word = 0
        call copy_out(from(x, n + 1_int64), word, 4_int64, err)
        total = word(1)
    end subroutine running_sum

    !> List which of n marks are above 0, as numbers from `before` + 1, in any order; their
    !> number is added to `found`.
    subroutine pick(mark, before, n, list, found, err)
        type(integers_t), intent(in) :: mark !! (n)
        integer, intent(in) :: before, n
        type(integers_t), intent(in) :: list !! (n)
        type(integers_t), intent(in) :: found !! (1)
        type(error_t), intent(inout) :: err

        call common_kernels%pick_marked([(n - 1)/pick_chunk + 1, 1, 1], n, before, mark, found, &
                                        list, err)
    end subroutine pick

    !> Numbers that a thread of a scan of n numbers adds.
    pure integer function chunk_of(n)
        integer, intent(in) :: n

        chunk_of = merge(chunks(2), chunks(1), n > many)
    end function chunk_of

    pure integer function chunks_of(n)
        integer, intent(in) :: n

        chunks_of = (n - 1)/chunk_of(n) + 1
    end function chunks_of

    !> Sums over the m rows of `part`, column by column, in a fixed order: what is left waits in a
    !> set for read_sums.
    subroutine fold(self, part, m, columns, set, err)
        class(gpu_common_t), intent(in) :: self
        type(doubles_t), intent(in) :: part !! (m, columns)
        integer, intent(in) :: m, columns
        integer, intent(in) :: set !! from 1
        type(error_t), intent(inout) :: err
        type(doubles_t) :: to

        to = from(self%folded, self%left*columns*(set - 1_int64) + 1)
        if (m > most_rows) then
            call common_kernels%fold_columns([rows_between, columns, 1], m, rows_between, part, &
                                             self%part, err)
            call common_kernels%fold_columns([self%left, columns, 1], rows_between, self%left, &
                                             self%part, to, err)
        else
            call common_kernels%fold_columns([self%left, columns, 1], m, self%left, part, to, err)
        end if
    end subroutine fold

    !> How many partial results of n numbers there are to fold.
    elemental integer function partials_of(n) result(m)
        integer, intent(in) :: n

        m = min((n + each_adds - 1)/each_adds, most_rows)
    end function partials_of

    !> Sums over the partial results of several sets, column by column, in a fixed order: what is
    !> left waits for read_sums.
    subroutine fold_sets(self, part, sets, first, last, columns, err)
        class(gpu_common_t), intent(in) :: self
        type(doubles_t), intent(in) :: part !! set by set (partial results, columns)
        type(integers_t), intent(in) :: sets !! (4, sets) 3, 4: partial results before, of the set
        integer, intent(in) :: first, last !! sets
        integer, intent(in) :: columns
        type(error_t), intent(inout) :: err

        call common_kernels%fold_sets([self%left, columns, last - first + 1], self%left, &
            from(sets, 4_int64*first - 3), part, &
            from(self%folded, self%left*columns*(first - 1_int64) + 1), err)
    end subroutine fold_sets

    !> The sums of the sets that wait, from a first one on.
    subroutine read_sums(self, first, sums, err)
        class(gpu_common_t), intent(in) :: self
        integer, intent(in) :: first !! set
        real(dp), intent(out), contiguous :: sums(:, :) !! (columns, sets)
        type(error_t), intent(inout) :: err
        real(dp) :: folded(self%left, size(sums, 1), size(sums, 2))

        folded = 0
        call copy_out(from(self%folded, self%left*size(sums, 1)*(first - 1_int64) + 1), folded, &
                      8_int64*size(folded), err)
        sums = sum(folded, 1)
    end subroutine read_sums

    !> Corners of the boxes that hold the boxes of each set: what is left waits for read_boxes.
    subroutine fold_boxes(self, part, sets, first, last, err)
        class(gpu_common_t), intent(in) :: self
        type(doubles_t), intent(in) :: part !! see fold_sets: minus the low corners, the high ones
        type(integers_t), intent(in) :: sets !! see fold_sets
        integer, intent(in) :: first, last !! sets
        type(error_t), intent(inout) :: err

        call common_kernels%most_of_sets([self%left, 6, last - first + 1], self%left, &
            from(sets, 4_int64*first - 3), part, &
            from(self%folded, self%left*6*(first - 1_int64) + 1), err)
    end subroutine fold_boxes

    !> The boxes that wait, from that of a first set on [m].
    subroutine read_boxes(self, first, box, err)
        class(gpu_common_t), intent(in) :: self
        integer, intent(in) :: first !! set
        real(dp), intent(out), contiguous :: box(:, :, :) !! (3, 2, sets)
        type(error_t), intent(inout) :: err
        real(dp) :: folded(self%left, 3, 2, size(box, 3))

        folded = 0
        call copy_out(from(self%folded, self%left*6*(first - 1_int64) + 1), folded, &
                      8_int64*size(folded), err)
        box = maxval(folded, 1)
        box(:, 1, :) = -box(:, 1, :)
    end subroutine read_boxes

    !> The largest of n numbers and 0; huge if one of them is no number, or if the GPU fails.
    real(dp) function largest(self, x, n, err)
        class(gpu_common_t), intent(in) :: self
        type(doubles_t), intent(in) :: x !! (n)
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        real(dp) :: folded(last_fold)

        if (n > first_fold) then
            call common_kernels%largest([first_fold, 1, 1], n, first_fold, x, self%part, err)
            call common_kernels%largest([last_fold, 1, 1], first_fold, last_fold, self%part, &
                                      self%folded, err)
        else
            call common_kernels%largest([last_fold, 1, 1], n, last_fold, x, self%folded, err)
        end if
        folded = 0
        call copy_out(self%folded, folded, 8_int64*last_fold, err)
        largest = huge(largest)
        if (all(folded <= huge(largest)) .and. .not. failed(err)) largest = maxval(folded)
    end function largest
end module brz_gpu_common
