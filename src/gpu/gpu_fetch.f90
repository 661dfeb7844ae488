! SPDX-License-Identifier: MIT
!> Exchanges of fields between the GPUs of several processes: a kernel packs, parcels go straight
!> into the memory of the other GPUs (brz_gpu_peers), or by pinned memory of the host and MPI, which
!> always works, and a kernel unpacks. Whoever has an error takes part with what there is, so that
!> nobody waits for ever.
module brz_gpu_fetch
    use brz_boxes, only: cells_t
    use brz_buffers, only: buffer_t, bytes_t, from, integers_t, reals_t
    use brz_cell_lists, only: cell_list_t, list_cells
    use brz_device, only: allocate_buffer, pin, put_buffer
    use brz_errors, only: error_t
    use brz_fetch, only: fetch_t
    use brz_gpu_peers, only: begins, peers_t
    use brz_kinds, only: int64, rk
    use brz_mail, only: tell_all
    use brz_place_launches, only: place_kernels
    use brz_ranks, only: ranks_t, several
    implicit none
    private
    public :: gpu_fetch_t

    type :: gpu_fetch_t
        type(ranks_t) :: ranks
        integer :: n_out = 0, n_in = 0 !! cells
        integer :: wide = 1 !! numbers of each
        integer :: of_cell = 1 !! bytes of each
        type(cell_list_t) :: list
        type(buffer_t) :: out_place, in_place
        type(integers_t) :: out_block, in_block !! of each cell in a map, where there is one
        type(bytes_t) :: near !! that map: cells of blocks that are not marked stay as they are
        type(buffer_t) :: row !! parcels, where they go by the host
        type(buffer_t) :: came !! parcels from others
        type(peers_t) :: peers
        integer(int64), allocatable :: there(:) !! (0:processes - 1) cells before its parcel there
    contains
        procedure :: open, reals_of_others, bytes_of_others
    end type gpu_fetch_t

contains

    !> Get ready to fetch into arrays that hold the cells `box` of the whole grid.
    subroutine open (self, ranks, plan, box, numbers, err)
        class(gpu_fetch_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        type(fetch_t), intent(in) :: plan
        type(cells_t), intent(in) :: box
        integer, intent(in) :: numbers !! of a cell, real(rk); 0: a byte
        type(error_t), intent(inout) :: err
        integer(int64) :: all(1, ranks%n, ranks%n), most, number(1, ranks%n)

        self%ranks = ranks
        if (.not. several(ranks)) return
        self%wide = max(numbers, 1)
        self%of_cell = max(numbers*storage_size(1.0_rk)/8, 1)
        call list_cells(ranks, plan, box, self%of_cell, self%list)
        self%n_out = size(self%list%out)
        self%n_in = size(self%list%in)
        call put_buffer(self%list%out, self%out_place, 8_int64*self%n_out, err)
        call put_buffer(self%list%in, self%in_place, 8_int64*self%n_in, err)
        associate (mail => self%list%mail)
            number(1, :) = (mail%out_first(1:) - mail%out_first(:ranks%n - 1))/self%of_cell
            call tell_all(ranks, number, all)
            call begins(ranks%rank, all(1, :, :), self%there, most)
            call self%peers%open(ranks, most*self%of_cell, err)
            if (self%peers%linked) return
            call allocate_buffer(self%row, int(self%of_cell, int64)*max(self%n_out, self%n_in), err)
            call pin(mail%out)
            call pin(mail%in)
        end associate
    end subroutine open

    !> Fill the cells of a field that others own; `apart` numbers lie between those of a cell.
    subroutine reals_of_others(self, apart, field, err)
        class(gpu_fetch_t), intent(inout) :: self
        integer(int64), intent(in) :: apart
        type(reals_t), intent(in) :: field
        type(error_t), intent(inout) :: err
        type(reals_t) :: row
        integer :: before, n, r

        if (.not. several(self%ranks)) return
        associate (mail => self%list%mail)
            do r = 0, self%ranks%n - 1
                call cells_of_parcel(self, mail%out_first, r, before, n)
                if (n == 0) cycle
                call self%peers%aim_at(r, self%there(r)*self%of_cell, &
                                       part_of(self%row, before, self%of_cell), row)
                if (self%near%address == 0) call place_kernels%pick_reals(n, n, self%wide, 1, &
                    apart, part_of(self%out_place, before, 8), field, row, err)
                if (self%near%address /= 0) call place_kernels%pick_near(n, n, self%wide, apart, &
                    part_of(self%out_place, before, 8), &
                    from(self%out_block, before + 1_int64), self%near, field, row, err)
            end do
            call self%peers%swap(self%ranks, mail, self%row, self%came, err)
            do r = 0, self%ranks%n - 1
                call cells_of_parcel(self, mail%in_first, r, before, n)
                if (n == 0) cycle
                row%address = self%came%address + int(before, int64)*self%of_cell
                if (self%near%address == 0) call place_kernels%put_reals(n, n, self%wide, 1, &
                    apart, part_of(self%in_place, before, 8), row, field, err)
                if (self%near%address /= 0) call place_kernels%put_near(n, n, self%wide, apart, &
                    part_of(self%in_place, before, 8), &
                    from(self%in_block, before + 1_int64), self%near, row, field, err)
            end do
        end associate
    end subroutine reals_of_others

    !> The same of marks.
    subroutine bytes_of_others(self, field, err)
        class(gpu_fetch_t), intent(inout) :: self
        type(bytes_t), intent(in) :: field
        type(error_t), intent(inout) :: err
        type(bytes_t) :: row
        integer :: before, n, r

        if (.not. several(self%ranks)) return
        do r = 0, self%ranks%n - 1
            call cells_of_parcel(self, self%list%mail%out_first, r, before, n)
            if (n == 0) cycle
            call self%peers%aim_at(r, self%there(r), part_of(self%row, before, 1), row)
            call place_kernels%pick_bytes(n, part_of(self%out_place, before, 8), field, row, err)
        end do
        call self%peers%swap(self%ranks, self%list%mail, self%row, self%came, err)
        row%address = self%came%address
        if (self%n_in > 0) call place_kernels%put_bytes(self%n_in, self%in_place, row, field, err)
    end subroutine bytes_of_others

    !> The cells of the parcel to or from a process.
    pure subroutine cells_of_parcel(self, first, r, before, n)
        type(gpu_fetch_t), intent(in) :: self
        integer(int64), intent(in) :: first(0:) !! (processes + 1) bytes
        integer, intent(in) :: r
        integer, intent(out) :: before, n !! cells of others before, of this one

        before = int((first(r) - 1)/self%of_cell)
        n = int((first(r + 1) - first(r))/self%of_cell)
    end subroutine cells_of_parcel

    !> A buffer behind its first elements.
    pure type(buffer_t) function part_of(buffer, before, bytes) result(part)
        class(buffer_t), intent(in) :: buffer
        integer, intent(in) :: before, bytes !! elements; bytes of each

        part%address = buffer%address + int(before, int64)*bytes
    end function part_of
end module brz_gpu_fetch
