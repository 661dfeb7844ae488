! SPDX-License-Identifier: MIT
!> The air of several processes in checkpoints: each writes the cells of its box into a file of its
!> own, `chk_001230.part003.h5`, and the checkpoint itself says which boxes there are. Any number of
!> processes can go on from it, and several from the checkpoint of one.
module brz_air_parts
    use brz_air_diagnostics, only: air_diagnostics_t, carry_diagnostics, keep_in_air
    use brz_air_state, only: air_t, brick, n_ghost
    use brz_boxes, only: cells_t, common, is_empty
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_files, only: file_exists, list_folder, name_len, remove_file, rename_file
    use brz_hdf5_array, only: h5_read, h5_shape, h5_write
    use brz_hdf5_box, only: h5_read_box
    use brz_hdf5_file, only: h5_close, h5_create, h5_has, h5_open, h5_plain, h5_t
    use brz_kinds, only: int8, int64, rk
    use brz_seal, only: check_seal
    use brz_text, only: to_text
    implicit none
    private
    public :: part_name, write_air_box, write_boxes, read_air_boxes, check_parts, is_in_parts
    public :: remove_parts, rename_parts

    character(*), parameter :: boxes_name = 'air/boxes'

contains

    !> Name of the file of a process beside a file, e.g. chk_001230.part003.h5.
    pure function part_name(path, part) result(name)
        character(*), intent(in) :: path !! ends in .h5 or .vtkhdf
        integer, intent(in) :: part !! process, from 1
        character(:), allocatable :: name
        character(12) :: digits

        write (digits, '(i0.3)') part
        name = path(:index(path, '.', back=.true.))//'part'//trim(digits)//'.h5'
    end function part_name

    !> Write the cells of this process beside the checkpoint `path`.
    subroutine write_air_box(path, title, air, err)
        character(*), intent(in) :: path, title
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        type(h5_t) :: file

        call h5_create(file, part_name(path, air%part%ranks%rank + 1), h5_plain, err, title)
        call h5_write(file, 'air/u', air%u(1:air%n(1), 1:air%n(2), 1:air%n(3), :), err)
        call h5_write(file, 'air/reached', air%reached, err)
        call h5_close(file, err)
    end subroutine write_air_box

    !> Write what all processes have in common into the checkpoint; the first does.
    subroutine write_boxes(file, air, diagnostics, err)
        type(h5_t), intent(in) :: file
        type(air_t), intent(in) :: air
        type(air_diagnostics_t), intent(inout) :: diagnostics !! of all
        type(error_t), intent(inout) :: err
        integer :: boxes(6, size(air%part%boxes)), r

        do r = 1, size(boxes, 2)
            associate (box => air%part%boxes(r - 1))
                boxes(:, r) = [box%lo, box%hi]
            end associate
        end do
        call h5_write(file, boxes_name, boxes, err)
        call carry_diagnostics(file, diagnostics, err)
    end subroutine write_boxes

    !> True if a checkpoint holds its air in parts.
    logical function is_in_parts(file)
        type(h5_t), intent(in) :: file

        is_in_parts = .false.
        if (h5_has(file, 'air')) is_in_parts = h5_has(file, boxes_name)
    end function is_in_parts

    !> Read the cells of this process from a checkpoint in one file or in parts.
    subroutine read_air_boxes(file, air, err)
        type(h5_t), intent(in) :: file !! the checkpoint
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        type(h5_t) :: part
        type(cells_t), allocatable :: boxes(:)
        type(air_diagnostics_t) :: diagnostics
        integer :: r

        if (is_in_parts(file)) then
            call read_boxes(file, air, boxes, err)
            if (failed(err)) return
            do r = 1, size(boxes)
                if (is_empty(common(boxes(r), own_box(air)))) cycle
                call h5_open(part, part_name(file%path, r), err)
                call read_common(part, boxes(r), [0, 0, 0], air, err)
                call h5_close(part, err)
            end do
        else
            call read_common(file, cells_t([1, 1, 1], air%whole), &
                             merge(n_ghost, 0, air%whole > 1), air, err)
        end if
        call carry_diagnostics(file, diagnostics, err)
        ! the first keeps what all have counted
        if (air%part%ranks%rank > 0) diagnostics = air_diagnostics_t()
        call keep_in_air(diagnostics, air)
    end subroutine read_air_boxes

    !> The boxes of a checkpoint in parts, which must be a cut of the same grid.
    subroutine read_boxes(file, air, boxes, err)
        type(h5_t), intent(in) :: file
        type(air_t), intent(in) :: air
        type(cells_t), allocatable, intent(out) :: boxes(:)
        type(error_t), intent(inout) :: err
        integer(int64), allocatable :: there(:)
        integer, allocatable :: numbers(:, :)
        integer :: r

        call h5_shape(file, boxes_name, there, err)
        if (failed(err)) return
        allocate (numbers(6, there(size(there))), source=0)
        call h5_read(file, boxes_name, numbers, err)
        allocate (boxes(size(numbers, 2)))
        do r = 1, size(boxes)
            boxes(r) = cells_t(numbers(1:3, r), numbers(4:6, r))
            if (any(boxes(r)%lo < 1 .or. boxes(r)%hi > air%whole)) call raise(err, exit_io, &
                file%path//": '"//boxes_name//"' is out of its range: Brisance did not write it")
        end do
    end subroutine read_boxes

    !> The box of this process.
    pure type(cells_t) function own_box(air)
        type(air_t), intent(in) :: air

        own_box = cells_t(air%before + 1, air%before + air%n)
    end function own_box

    !> Read the cells that a file and this process have in common.
    subroutine read_common(file, box, ghosts, air, err)
        type(h5_t), intent(in) :: file
        type(cells_t), intent(in) :: box !! of the file
        integer, intent(in) :: ghosts(3) !! layers around it in the file
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        type(cells_t) :: both
        real(rk), allocatable :: u(:, :, :, :)
        integer(int8), allocatable :: reached(:, :, :)
        integer :: lo(3), hi(3), n(3)

        both = common(box, own_box(air))
        n = both%hi - both%lo + 1
        lo = both%lo - air%before
        hi = both%hi - air%before
        allocate (u(n(1), n(2), n(3), air%n_var), source=0.0_rk)
        call h5_read_box(file, 'air/u', [both%lo - box%lo + 1 + ghosts, 1], u, err)
        air%u(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), :) = u
        lo = (lo - 1)/brick + 1
        hi = (hi - 1)/brick + 1
        n = hi - lo + 1
        allocate (reached(n(1), n(2), n(3)), source=0_int8)
        call h5_read_box(file, 'air/reached', (both%lo - box%lo)/brick + 1, reached, err)
        air%reached(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) = reached
    end subroutine read_common

    !> Remove the parts of a file, if it has any.
    subroutine remove_parts(folder, name)
        character(*), intent(in) :: folder
        character(*), intent(in) :: name !! ends in .h5 or .vtkhdf
        character(name_len), allocatable :: names(:)
        integer :: i

        call list_folder(folder, name(:index(name, '.', back=.true.))//'part', '.h5', names)
        do i = 1, size(names)
            call remove_file(folder//'/'//trim(names(i)))
        end do
    end subroutine remove_parts

    !> Rename the parts of a file as it is renamed, if it has any.
    subroutine rename_parts(folder, name, new, err)
        character(*), intent(in) :: folder
        character(*), intent(in) :: name, new !! end in .h5
        type(error_t), intent(inout) :: err
        character(name_len), allocatable :: names(:)
        character(:), allocatable :: stem
        integer :: i

        stem = name(:index(name, '.', back=.true.))
        call list_folder(folder, stem//'part', '.h5', names)
        do i = 1, size(names)
            call rename_file(folder//'/'//trim(names(i)), folder//'/'// &
                             new(:index(new, '.', back=.true.))//trim(names(i) (len(stem) + 1:)), &
                             err)
        end do
    end subroutine rename_parts

    !> Raise an error if a part of a checkpoint is missing or not what was written.
    subroutine check_parts(path, title, err)
        character(*), intent(in) :: path, title !! of the checkpoint, whose own seal is right
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        integer(int64), allocatable :: there(:)
        integer :: r

        call h5_open(file, path, err)
        if (failed(err)) return
        allocate (there(0))
        if (is_in_parts(file)) call h5_shape(file, boxes_name, there, err)
        call h5_close(file, err)
        if (failed(err) .or. size(there) == 0) return
        do r = 1, int(there(size(there)))
            if (.not. file_exists(part_name(path, r))) call raise(err, exit_io, &
                part_name(path, r)//': is lost, one of the '//to_text(int(there(size(there))))// &
                ' parts of '//path//'; bring it back, or go on from another checkpoint')
            call check_seal(part_name(path, r), title, err)
        end do
    end subroutine check_parts
end module brz_air_parts
