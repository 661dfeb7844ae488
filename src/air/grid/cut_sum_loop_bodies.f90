! SPDX-License-Identifier: MIT
!> What cut cells lack, against whole cells, in sums over the air.
module brz_cut_sum_loop_bodies
    use brz_air_grid, only: is_between
    use brz_cut_cells, only: node_grid_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: cut_lack

contains

    !> What a cell holds less than a whole one; what waits in it is gas all the same.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_lack(s, nodes, n_var, apart, cell, place, shut, volume, kept, u, less)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: n_var !! conserved variables
        integer(int64), intent(in) :: apart !! distance of two variables in memory
        integer(int32), intent(in) :: cell(*), place(*), shut(*)
        real(rk), intent(in) :: volume(*), kept(max_var + 1, *)
        real(rk), intent(in) :: u(*)
        real(dp), intent(inout) :: less(7) !@exact kinetic energy, conserved variables; per volume
        real(dp) :: q(max_var), short
        integer :: c

        if (.not. is_between(nodes%n, nodes%own, cell(s))) return
        do c = 1, max_var
            less(1 + c) = less(1 + c) + kept(c, s)
        end do
        if (place(s) == 0 .or. shut(s) /= 0) return
        do c = 1, max_var
            q(c) = 0
            if (c <= n_var) q(c) = u(place(s) + (c - 1)*apart)
        end do
        short = volume(s) - 1
        less(1) = less(1) + short*(q(2)**2 + q(3)**2 + q(4)**2)/(2*q(1))
        do c = 1, max_var
            less(1 + c) = less(1 + c) + short*q(c)
        end do
    end subroutine cut_lack
end module brz_cut_sum_loop_bodies
