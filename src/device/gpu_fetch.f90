! SPDX-License-Identifier: MIT
!> Exchanges of fields between the GPUs of several processes: a kernel packs, messages go straight
!> into the memory of the other GPUs (brz_gpu_peers), or by pinned memory of the host and MPI, which
!> always works, and a kernel unpacks. Whoever has an error takes part with what there is, so that
!> nobody waits for ever.
module brz_gpu_fetch
    use brz_boxes, only: cells_t
    use brz_buffers, only: bytes_t, integers_t, reals_t
    use brz_cell_lists, only: list_cells
    use brz_device, only: copy_in, pin, reserve_buffer
    use brz_errors, only: error_t
    use brz_fetch, only: fetch_t, field_message_t
    use brz_lists, only: put_list
    use brz_present_table, only: on_device
    use brz_gpu_peers, only: peers_t
    use brz_kinds, only: int32, int64, int8, rk
    use brz_message_exchange, only: tell_all
    use brz_place_launches, only: place_kernels
    use brz_places, only: message_buffers_t
    use brz_ranks, only: ranks_t, several
    implicit none
    private
    public :: gpu_fetch_t

    type :: gpu_fetch_t
        integer :: wide = 1 !! numbers of each cell
        type(message_buffers_t) :: out, in !! cells
        integer(int32), allocatable :: out_block(:), in_block(:) !! of each in a map
        type(bytes_t) :: near !! that map: cells of blocks that are not marked stay as they are
        type(peers_t) :: peers
        type(reals_t) :: row !! where the messages of an exchange lie
    contains
        procedure :: open, reals_of_others, offer_reals, take_reals, bytes_of_others
    end type gpu_fetch_t

contains

    !> Get ready to fetch into arrays that hold the cells `box` of the whole grid. All cells are in
    !> one block, which is marked.
    subroutine open (self, ranks, plan, box, numbers, err)
        class(gpu_fetch_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        type(fetch_t), intent(in) :: plan
        type(cells_t), intent(in) :: box
        integer, intent(in) :: numbers !! of a cell, real(rk); 0: a byte
        type(error_t), intent(inout) :: err
        integer(int64) :: all(1, ranks%n, ranks%n), number(1, ranks%n)
        type(integers_t) :: row
        integer :: of_cell

        if (.not. several(ranks)) return
        self%wide = numbers
        of_cell = max(numbers*storage_size(1.0_rk)/8, 1)
        call list(plan%out, self%out, self%out_block)
        call list(plan%in, self%in, self%in_block)
        call reserve_buffer(self%near, 1_int64, err)
        call copy_in([1_int8], self%near, 1_int64, err)
        call self%peers%open(ranks, 0_int64, err)
        number(1, :) = self%out%first(1:) - self%out%first(:ranks%n - 1)
        call tell_all(ranks, number, all)
        call self%peers%aim(all(1, :, :), of_cell, self%out, err)
        if (self%peers%linked) return
        call self%peers%begin(self%out, self%in, of_cell, row, err)
        call pin(self%peers%exchange%out)
        call pin(self%peers%exchange%in)

    contains

        subroutine list(messages, there, block)
            type(field_message_t), intent(in) :: messages(:)
            type(message_buffers_t), intent(inout) :: there
            integer(int32), allocatable, intent(inout) :: block(:)
            type(message_buffers_t) :: here

            here = list_cells(ranks%n, messages, box)
            there%first = here%first
            there%all = .true.
            call put_list(.true., here%place, there%place, err)
            if (numbers > 0) call put_list(.true., spread(1, 1, size(here%place)), block, err)
        end subroutine list
    end subroutine open

    !> Fill the cells of a field that others own; `apart` numbers lie between those of a cell.
    subroutine reals_of_others(self, apart, field, err)
        class(gpu_fetch_t), intent(inout) :: self
        integer(int64), intent(in) :: apart
        type(reals_t), intent(in) :: field
        type(error_t), intent(inout) :: err

        call self%offer_reals(apart, field, err)
        call self%take_reals(apart, field, .false., err)
    end subroutine reals_of_others

    !> The first half of it: others get what they see of a field. It may be repeated.
    subroutine offer_reals(self, apart, field, err)
        class(gpu_fetch_t), intent(inout) :: self
        integer(int64), intent(in) :: apart
        type(reals_t), intent(in) :: field
        type(error_t), intent(inout) :: err

        if (.not. several(self%peers%ranks)) return
        call self%peers%begin(self%out, self%in, self%wide*storage_size(1.0_rk)/8, self%row, err)
        if (self%out%tiled > 0) call place_kernels%pick_cells(self%out%tiled, self%wide, apart, &
            self%out%messages, at(self%out%place), at(self%out_block), self%near, field, self%row, &
            err)
        call self%peers%finish(err)
    end subroutine offer_reals

    !> The second half.
    subroutine take_reals(self, apart, field, met, err)
        class(gpu_fetch_t), intent(inout) :: self
        integer(int64), intent(in) :: apart
        type(reals_t), intent(in) :: field
        logical, intent(in) :: met !! see swap
        type(error_t), intent(inout) :: err

        if (.not. several(self%peers%ranks)) return
        call self%peers%swap(met, err)
        if (self%in%tiled > 0) call place_kernels%put_cells(self%in%tiled, self%wide, apart, &
            self%in%messages, at(self%in%place), at(self%in_block), self%near, self%row, field, err)
    end subroutine take_reals

    !> The same of marks.
    subroutine bytes_of_others(self, field, err)
        class(gpu_fetch_t), intent(inout) :: self
        type(bytes_t), intent(in) :: field
        type(error_t), intent(inout) :: err
        type(integers_t) :: row

        if (.not. several(self%peers%ranks)) return
        call self%peers%begin(self%out, self%in, 1, row, err)
        if (self%out%tiled > 0) call place_kernels%pick_marks(self%out%tiled/4, &
            self%out%messages, at(self%out%place), field, row, err)
        call self%peers%finish(err)
        call self%peers%swap(.false., err)
        if (self%in%tiled > 0) call place_kernels%put_marks(self%in%tiled/4, &
            self%in%messages, at(self%in%place), row, field, err)
    end subroutine bytes_of_others

    !> The copy of a list.
    type(integers_t) function at(list)
        integer(int32), intent(in), target :: list(:)

        at = integers_t(address=on_device(list))
    end function at
end module brz_gpu_fetch
