! SPDX-License-Identifier: MIT
!> Bins of a counting sort in the order of the numbers of what is in them, so that sums over a bin
!> depend neither on where particles are in memory nor on threads and processes.
module brz_bin_loop_bodies
    use brz_kinds, only: int32
    implicit none
    private
    public :: sort_bin

contains

    !> Bring the particles of a bin, ends(c) + 1..ends(c + 1) of `binned`, into the order of their
    !> numbers; most are in it but for some runs.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine sort_bin(c, id, ends, binned)
        integer, intent(in) :: c !! bins
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
