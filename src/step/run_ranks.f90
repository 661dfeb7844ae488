! SPDX-License-Identifier: MIT
!> A scene on several processes: what they can do, and what each of them gets.
module brz_run_ranks
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_air_grid, only: brick
    use brz_air_state, only: n_ghost
    use brz_boxes, only: box_t, cells_of, common, cut_grid, most_boxes, widened
    use brz_case, only: case_t
    use brz_check_start, only: is_radial
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp
    use brz_scene_size, only: scene_size_t
    use brz_text, only: to_text
    implicit none
    private
    public :: refuse_on_ranks, print_ranks

contains

    !> Refuse what is not distributed over processes, and more processes than the grid has boxes
    !> for, before anything is built.
    subroutine refuse_on_ranks(case, n, err)
        type(case_t), intent(in) :: case
        integer, intent(in) :: n !! processes
        type(error_t), intent(inout) :: err
        character(:), allocatable :: what

        if (n < 2 .or. failed(err)) return
        if (is_radial(case)) then
            what = "air along one line (geometry = '"//trim(case%air%geometry)//"')"
        else if (size(case%bodies) > 0) then
            what = 'scenes with bodies'
        else if (case%run%backend == 'gpu') then
            what = 'GPUs'
        end if
        if (allocated(what)) then
            call raise(err, exit_deck, 'this version does not have '//what//' on several '// &
                       'processes ('//to_text(n)//' are wanted): run one, with OMP_NUM_THREADS '// &
                       'threads'//trim(merge(', or --backend cpu', '                  ', &
                                             case%run%backend == 'gpu')))
        else if (n > most_boxes(case%air%cells, brick)) then
            call raise(err, exit_deck, to_text(n)//' processes are too many for '// &
                       to_text(case%air%cells(1))//' x '//to_text(case%air%cells(2))//' x '// &
                       to_text(case%air%cells(3))//' cells of air: a box has at least '// &
                       to_text(brick)//' cells in a direction; run '// &
                       to_text(most_boxes(case%air%cells, brick))//' at most')
        end if
    end subroutine refuse_on_ranks

    !> Print the box of each process, its memory and what it sends, without MPI.
    subroutine print_ranks(case, size_of, n)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(in) :: size_of
        integer, intent(in) :: n !! processes
        type(box_t) :: boxes(0:n - 1), wide
        real(dp) :: share, around
        integer :: r, layers(3)

        if (n < 2) return
        call cut_grid(case%air%cells, brick, boxes)
        layers = merge(n_ghost, 0, case%air%cells > 1)
        write (output_unit, '(a, i0, a, f0.3, a)') 'processes    ', n, &
            ', the largest box over the mean ', maxval(real(cells_of(boxes), dp))*n/size_of%cells
        do r = 0, n - 1
            wide = common(widened(boxes(r), layers), box_t([1, 1, 1], case%air%cells))
            share = real(cells_of(boxes(r)), dp)
            around = real(cells_of(wide), dp) - share
            write (output_unit, '(a, i5, a, 3(1x, i0, a, i0), a, i0, a, i0, a, f0.1, a)') &
                '     process', r + 1, ': cells', boxes(r)%lo(1), '-', boxes(r)%hi(1), &
                boxes(r)%lo(2), '-', boxes(r)%hi(2), boxes(r)%lo(3), '-', boxes(r)%hi(3), ', ', &
                cells_of(boxes(r)), ' of its own, ', nint(around), ' of neighbours, ', &
                1e-6_dp*size_of%air_bytes*(share + around)/size_of%cells, ' MB'
        end do
    end subroutine print_ranks
end module brz_run_ranks
