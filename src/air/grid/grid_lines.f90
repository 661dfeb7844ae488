! SPDX-License-Identifier: MIT
!> Lines of cells: how the sweeps number them, and which axes they see as normal and tangential.
!>
!> The lines of direction d are numbered with the first transverse index running fastest, and go in
!> blocks of `lines_per_block`, so that a block is the same set of lines whatever the threads do.
module brz_grid_lines
    use brz_air_state, only: lines_per_block
    implicit none
    private
    public :: across, turned, n_lines, n_blocks, first_cell_of

    integer, parameter :: across(2, 3) = reshape([2, 3, 1, 3, 1, 2], [2, 3])
    !! transverse directions, fastest first
    integer, parameter :: turned(6, 3) = reshape( &
        [1, 2, 3, 4, 5, 6, 1, 3, 4, 2, 5, 6, 1, 4, 2, 3, 5, 6], [6, 3])
    !! conserved variable in slot m of a state turned into direction d (cyclic)

contains

    !> Number of lines in direction d.
    pure integer function n_lines(n, d)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: d !! direction

        n_lines = n(across(1, d))*n(across(2, d))
    end function n_lines

    !> Number of blocks of lines in direction d.
    pure integer function n_blocks(n, d)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: d !! direction

        n_blocks = (n_lines(n, d) + lines_per_block - 1)/lines_per_block
    end function n_blocks

    !> Indices of the first interior cell of a line.
    pure subroutine first_cell_of(n, d, line, cell)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: d !! direction
        integer, intent(in) :: line !! number of the line
        integer, intent(out) :: cell(3) !! i, j, k

        cell(d) = 1
        cell(across(1, d)) = mod(line - 1, n(across(1, d))) + 1
        cell(across(2, d)) = (line - 1)/n(across(1, d)) + 1
    end subroutine first_cell_of
end module brz_grid_lines
