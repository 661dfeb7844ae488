! SPDX-License-Identifier: MIT
!> How a process says which ghosts it needs of a body: ways to need one, a row for each.
module brz_want_rows
    implicit none
    private
    public :: n_want, want_corners, want_reach

    ! a way to need a ghost: what is added to its place, how far that may be from a box, its corners
    integer, parameter :: want_reach = 4, want_corners = 5, n_want = 10
end module brz_want_rows
