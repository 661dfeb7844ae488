! SPDX-License-Identifier: MIT
!> Boundary conditions of the air by name: the one table, in the order of the codes in
!> brz_air_boundary.
module brz_boundary_names
    implicit none
    private
    public :: boundary_names, boundary_choices

    character(8), parameter :: boundary_names(4) = [character(8) :: 'outflow', 'wall', 'symmetry', &
                                                    'periodic']

contains

    !> All of them, separated as choices of a key are.
    pure function boundary_choices() result(text)
        character(:), allocatable :: text
        integer :: k

        text = trim(boundary_names(1))
        do k = 2, size(boundary_names)
            text = text//'|'//trim(boundary_names(k))
        end do
    end function boundary_choices
end module brz_boundary_names
