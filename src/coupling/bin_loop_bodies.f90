! SPDX-License-Identifier: MIT
!> Particles by solid cell: a counting sort, and within a cell by their numbers, so that sums over a
!> cell depend neither on where particles are in memory nor on threads and processes.
module brz_bin_loop_bodies
    use brz_coupling_box, only: box_t, place_at
    use brz_kinds, only: int32
    implicit none
    private
    public :: find_home, sort_bin

contains

    !> Place of the cell of a particle in the list of solid cells.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine find_home(p, box, cell, cell_of, home)
        integer, intent(in) :: p !! particles
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*) !! 0: outside
        integer, intent(in) :: cell_of(*)
        integer(int32), intent(inout) :: home(*) !! 0: outside

        home(p) = 0
        if (cell(p) > 0) home(p) = cell_of(place_at(box, cell(p)))
    end subroutine find_home

    !> Bring the particles of a cell, ends(c) + 1..ends(c + 1) of `binned`, into the order of their
    !> numbers; most are in it but for some runs.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine sort_bin(c, id, ends, binned)
        integer, intent(in) :: c !! solid cells
        integer(int32), intent(in) :: id(*), ends(*)
        integer(int32), intent(inout) :: binned(*)
        integer(int32) :: before, number
        integer :: first, gap, i, j, last, place

        first = ends(c) + 1
        last = ends(c + 1)
        if (last <= first) return
        number = id(binned(first)) ! in a register: a GPU would read it again for every test
        do i = first + 1, last
            before = number
            number = id(binned(i))
            if (number < before) exit
        end do
        if (i > last) return
        gap = 1
        do while (9*gap < last - first)
            gap = 3*gap + 1
        end do
        do while (gap > 0)
            do i = first + gap, last
                place = binned(i)
                number = id(place)
                j = i - gap
                do while (j >= first)
                    if (id(binned(j)) < number) exit
                    binned(j + gap) = binned(j)
                    j = j - gap
                end do
                binned(j + gap) = place
            end do
            gap = gap/3
        end do
    end subroutine sort_bin
end module brz_bin_loop_bodies
