! SPDX-License-Identifier: MIT
!> A scene on several processes: what they can do, and what each of them gets.
module brz_run_ranks
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_air_grid, only: brick
    use brz_air_part, only: layers_seen
    use brz_air_state, only: n_ghost
    use brz_boxes, only: cells_t, cells_of, common, cut_grid, most_boxes, widened
    use brz_case, only: case_t
    use brz_check_start, only: is_radial
    use brz_cohesive_loop_bodies, only: mark_glued, own_node, see_point
    use brz_cores, only: cores_for
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp, int32, int64
    use brz_ranks, only: ranks_t
    use brz_scene_size, only: cut_bytes, scene_size_t
    use brz_solid_arrays, only: bytes_per_particle
    use brz_ghost_wants, only: find_lowest, has_boxes, owners_of, is_needed, wants_of
    use brz_solid_regions, only: cut_regions, region_of
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_part, only: solid_part_t
    use brz_text, only: to_text
    use omp_lib, only: omp_get_max_threads, omp_get_num_procs, omp_set_num_threads
    implicit none
    private
    public :: refuse_on_ranks, settle_threads, cut_air, print_ranks, print_regions

contains

    !> Refuse what is not distributed over processes, and more processes than the grid has boxes
    !> for, before anything is built.
    subroutine refuse_on_ranks(case, n, err)
        type(case_t), intent(in) :: case
        integer, intent(in) :: n !! processes
        type(error_t), intent(inout) :: err
        integer(int64) :: most

        if (n < 2 .or. failed(err) .or. .not. case%air%present) return
        if (is_radial(case)) return ! the first one does it
        most = most_boxes(case%air%cells, brick, uncut(case))
        if (size(case%bodies) > 0 .and. case%coupling%scheme == 'paper') then
            call raise(err, exit_deck, "this version does not have the coupling scheme='paper' "// &
                       'on several processes ('//to_text(n)//' are wanted): run one, with '// &
                       'OMP_NUM_THREADS threads')
        else if (n > most) then
            call raise(err, exit_deck, to_text(n)//' processes are too many for '// &
                       to_text(case%air%cells(1))//' x '//to_text(case%air%cells(2))//' x '// &
                       to_text(case%air%cells(3))//' cells of air: a box has at least '// &
                       to_text(brick)//' cells in a direction'// &
                       trim(merge(', and with bodies no periodic one is cut', &
                                  '                                        ', &
                                  any(uncut(case))))//'; run '//to_text(most)//' at most')
        end if
    end subroutine refuse_on_ranks

    !> Threads of each of several processes, unless OMP_NUM_THREADS tells: they share the cores of a
    !> machine. Say where they have fewer cores than threads: mpirun binds each of two to one core.
    !> What a GPU leaves to the host wants more than one thread.
    subroutine settle_threads(ranks, on_gpu)
        type(ranks_t), intent(in) :: ranks
        logical, intent(in) :: on_gpu
        integer :: cores, length, threads

        if (ranks%n < 2) return
        call get_environment_variable('OMP_NUM_THREADS', length=length)
        if (length == 0) call omp_set_num_threads(cores_for(ranks%here))
        if (ranks%rank > 0) return
        cores = omp_get_num_procs()
        threads = omp_get_max_threads()
        if (threads <= cores .and. .not. (on_gpu .and. cores == 1 .and. length == 0)) return
        write (error_unit, '(a, i0, a, i0, a)') 'threads of a process: ', threads, &
            ', cores that it is bound to: ', cores, &
            '; set-up and output will be slow: mpirun --bind-to none gives it all cores'
    end subroutine settle_threads

    !> A box of the air for each process.
    subroutine cut_air(case, n, size_of, err)
        type(case_t), intent(in) :: case
        integer, intent(in) :: n !! processes
        type(scene_size_t), intent(inout) :: size_of
        type(error_t), intent(in) :: err

        if (failed(err) .or. .not. case%air%present) return
        allocate (size_of%boxes(0:n - 1))
        call cut_grid(case%air%cells, brick, size_of%boxes, size_of%crowds, uncut(case))
    end subroutine cut_air

    !> Directions of the air that are not cut: with bodies in it those that are periodic, as the
    !> halo of a process has no cells beyond the ends of the grid.
    pure function uncut(case)
        type(case_t), intent(in) :: case
        logical :: uncut(3)

        uncut = case%air%bc(1, :) == 'periodic' .and. size(case%bodies) > 0
    end function uncut

    !> Print the box of each process, its memory and what it sends, without MPI.
    subroutine print_ranks(case, size_of, n)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(in) :: size_of
        integer, intent(in) :: n !! processes
        type(cells_t) :: boxes(0:n - 1), wide
        real(dp) :: share, around
        integer :: r, layers(3)

        if (n < 2 .or. .not. case%air%present) return
        boxes = size_of%boxes
        layers = merge(n_ghost, 0, case%air%cells > 1)
        if (size(case%bodies) > 0) & ! the halo
            layers = merge(layers_seen, 0, case%air%cells > 1)
        write (output_unit, '(a, i0, a, f0.3, a)') 'processes    ', n, &
            ', the largest box over the mean ', maxval(real(cells_of(boxes), dp))*n/size_of%cells
        do r = 0, n - 1
            wide = common(widened(boxes(r), layers), cells_t([1, 1, 1], case%air%cells))
            share = real(cells_of(boxes(r)), dp)
            around = real(cells_of(wide), dp) - share
            write (output_unit, '(a, i5, a, 3(1x, i0, a, i0), a, i0, a, i0, a, f0.1, a)') &
                '     process', r + 1, ': cells', boxes(r)%lo(1), '-', boxes(r)%hi(1), &
                boxes(r)%lo(2), '-', boxes(r)%hi(2), boxes(r)%lo(3), '-', boxes(r)%hi(3), ', ', &
                cells_of(boxes(r)), ' of its own, ', nint(around), ' of neighbours, ', &
                1e-6_dp*(size_of%air_bytes*(share + around)/size_of%cells &
                         + cut_bytes(case, size_of, wide)), ' MB'
        end do
    end subroutine print_ranks

    !> Print the particles of each process and their memory, without MPI.
    subroutine print_regions(case, size_of, solid, n)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(in) :: size_of
        class(interacting_bodies_t), intent(inout) :: solid !! built
        integer, intent(in) :: n !! processes
        real(dp) :: region(3, 2, 0:n - 1)
        integer :: ghosts(0:n - 1), copies(0:n - 1), own(0:n - 1), r

        if (n < 2 .or. .not. solid%present) return
        call cut_regions(solid%ranks, solid%x_built(:, :solid%n), region)
        call count_in_regions(solid, region, own, ghosts)
        write (output_unit, '(a, i0, a, f0.3, a)') 'processes    ', n, &
            ', the most particles over the mean ', real(maxval(own), dp)*n/solid%n
        do r = 0, n - 1
            write (output_unit, '(a, i5, 2(a, i0), a, f0.1, a)') '     process', r + 1, ': ', &
                own(r), ' particles of its own, ', ghosts(r), ' of neighbours, ', &
                1e-6_dp*bytes_per_particle(solid)*(own(r) + ghosts(r)), ' MB'
        end do
        if (.not. case%air%present) return
        call count_coupling_ghosts(case, size_of%boxes, solid, copies)
        do r = 0, n - 1
            write (output_unit, '(a, i5, a, i0, a)') '     process', r + 1, ': ', copies(r), &
                ' particles in its window of the air and a cell around, copies'
        end do
    end subroutine print_regions

    !> Particles in the halo of each process and one layer of cells around.
    subroutine count_coupling_ghosts(case, boxes, solid, copies)
        type(case_t), intent(in) :: case
        type(cells_t), intent(in) :: boxes(0:) !! (processes)
        class(bodies_t), intent(in) :: solid
        integer, intent(out) :: copies(0:) !! (processes)
        type(cells_t) :: halos(0:ubound(copies, 1))
        integer :: b, cell(3), i, r

        do r = 0, ubound(copies, 1)
            halos(r) = widened(boxes(r), spread(layers_seen, 1, 3))
            halos(r) = common(halos(r), cells_t([1, 1, 1], case%air%cells))
            halos(r) = widened(halos(r), [1, 1, 1])
        end do
        copies = 0
        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                cell = merge(floor((solid%x(:, i) - case%air%lo)*case%air%cells &
                                   /(case%air%hi - case%air%lo)) + 1, 1, case%air%cells > 1)
                do r = 0, ubound(copies, 1)
                    if (all(cell >= halos(r)%lo .and. cell <= halos(r)%hi)) &
                        copies(r) = copies(r) + 1
                end do
            end do
        end do
    end subroutine count_coupling_ghosts

    !> Particles in each region, and those of others that its lists may reach or its points of
    !> interfaces see.
    subroutine count_in_regions(solid, region, own, ghosts)
        class(interacting_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: region(:, :, 0:) !! (3, 2, regions) [m]
        integer, intent(out) :: own(0:), ghosts(0:) !! (regions)
        type(solid_part_t) :: part !! what each has to do with others
        real(dp), allocatable :: want(:, :, :)
        integer(int32) :: marked(solid%n, 0:ubound(region, 3)) !! 1: needed as a ghost
        integer :: b, home(solid%n), i, r

        call find_owners(solid, region, home, part%boxes)
        call find_lowest(solid, part)
        own = [(count(home == r), r=0, ubound(region, 3))]
        marked = 0
        do b = 1, size(solid%bodies)
            want = wants_of(solid, part, b, region)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                do r = 0, ubound(region, 3)
                    if (is_needed(solid, want(:, :, r + 1), b, i)) marked(i, r) = 1
                end do
            end do
        end do
        if (solid%cohesive%present) call mark_seen(solid, home, marked)
        ghosts = [(count(marked(:, r) == 1 .and. home /= r), r=0, ubound(region, 3))]
    end subroutine count_in_regions

    !> Mark the particles that the points of each process see.
    subroutine mark_seen(solid, home, marked)
        class(interacting_bodies_t), intent(inout) :: solid
        integer, intent(in) :: home(:) !! (particles) process, from 0
        integer(int32), intent(inout) :: marked(:, 0:) !! (particles, processes)
        integer(int32) :: sent(size(marked))
        integer :: i, p, r

        sent = 0
        associate (cohesive => solid%cohesive)
            do i = 1, solid%n
                call own_node(i, 1, home(i) + 1, solid%id, cohesive%row, cohesive%owner)
            end do
            do p = 1, cohesive%n
                call see_point(p, 1, cohesive%first, cohesive%entry, cohesive%owner, &
                    cohesive%seen_by, cohesive%mine)
            end do
            do r = 0, ubound(marked, 2)
                do i = 1, solid%n
                    call mark_glued(i, 1, solid%n, r, solid%id, cohesive%row, cohesive%back_first, &
                                    cohesive%back, cohesive%seen_by, sent, marked)
                end do
            end do
        end associate
    end subroutine mark_seen

    !> The region of each particle, and the boxes of what is in each.
    subroutine find_owners(solid, region, home, boxes)
        class(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: region(:, :, 0:) !! (3, 2, regions) [m]
        integer, intent(out) :: home(:) !! (particles)
        real(dp), allocatable, intent(out) :: boxes(:, :, :, :)
        !! (3, 2, bodies, 0:regions-1), where links want them [m]
        real(dp), pointer, contiguous :: x(:, :)
        integer :: b, i

        if (has_boxes(solid)) allocate (boxes(3, 2, size(solid%bodies), 0:ubound(region, 3)))
        do b = 1, size(solid%bodies)
            x => owners_of(solid, b)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                home(i) = region_of(region, x(:, i))
            end do
            if (has_boxes(solid)) call fill_boxes(b)
        end do

    contains

        subroutine fill_boxes(b)
            integer, intent(in) :: b
            integer :: i

            boxes(:, 1, b, :) = huge(1.0_dp)
            boxes(:, 2, b, :) = -huge(1.0_dp)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                associate (box => boxes(:, :, b, home(i)))
                    box(:, 1) = min(box(:, 1), solid%x_built(:, i))
                    box(:, 2) = max(box(:, 2), solid%x_built(:, i))
                end associate
            end do
        end subroutine fill_boxes
    end subroutine find_owners
end module brz_run_ranks
