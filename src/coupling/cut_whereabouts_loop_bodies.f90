! SPDX-License-Identifier: MIT
!> Where the particles of several processes are, in two numbers.
module brz_cut_whereabouts_loop_bodies
    use brz_air_grid, only: cell_at, is_between
    use brz_cut_cells, only: node_grid_t
    use brz_kinds, only: dp, int32, int64
    implicit none
    private
    public :: cut_hash

    integer(int64), parameter :: prime = 2147483647, factor_1 = 48271, factor_2 = 69621

contains

    !> Sums of hashes of the particles with their cells of the grid, each in the process in whose
    !> box its cell is.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_hash(p, nodes, number, id, hashes)
        integer, intent(in) :: p !! particles
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: number(*) !! of the cell in the grid of nodes, 0: outside
        integer(int32), intent(in) :: id(*)
        real(dp), intent(inout) :: hashes(2) !@exact of all particles
        integer(int64) :: hash_1, hash_2
        integer :: d, ijk(3)

        if (number(p) == 0) return
        if (.not. is_between(nodes%n, nodes%own, number(p))) return
        ijk = cell_at(nodes%n, number(p))
        hash_1 = id(p)
        hash_2 = id(p)
        do d = 1, 3
            hash_1 = mod(factor_1*hash_1 + ijk(d) + nodes%before(d), prime)
            hash_1 = mod(hash_1*hash_1 + d, prime)
            hash_2 = mod(factor_2*hash_2 + ijk(d) + nodes%before(d), prime)
            hash_2 = mod(hash_2*hash_2 + d, prime)
        end do
        hashes(1) = hashes(1) + hash_1
        hashes(2) = hashes(2) + hash_2
    end subroutine cut_hash
end module brz_cut_whereabouts_loop_bodies
