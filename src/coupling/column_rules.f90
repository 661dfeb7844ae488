! SPDX-License-Identifier: MIT
!> Sides of a cell, and depths behind a wall face. Point physics: compiled for the CPU and for the
!> GPU.
module brz_column_rules
    use brz_kinds, only: dp
    implicit none
    private
    public :: side_of, direction_of, sign_of, image_row, height_of

contains

    !> Row of face_of: 1, 2: gas below, above in x; 3, 4 in y; 5, 6 in z.
    !@cuf attributes(host,device) &
    pure function side_of(direction, side) result(row)
        integer, intent(in) :: direction !! 1..3
        integer, intent(in) :: side !! +1: solid above the gas, -1: solid below
        integer :: row

        row = 2*direction - (1 + side)/2
    end function side_of

    !> Direction that a row of face_of belongs to.
    !@cuf attributes(host,device) &
    pure function direction_of(row) result(d)
        integer, intent(in) :: row !! 1..6
        integer :: d

        d = (row + 1)/2
    end function direction_of

    !> Side that a row of face_of belongs to: +1: solid above the gas, -1: solid below.
    !@cuf attributes(host,device) &
    pure function sign_of(row) result(s)
        integer, intent(in) :: row !! 1..6
        integer :: s

        s = 2*mod(row, 2) - 1
    end function sign_of

    !> The row that an image has in place of a row of face_of.
    !@cuf attributes(host,device) &
    pure function image_row(row, turned) result(image)
        integer, intent(in) :: row !! 1..6
        logical, intent(in) :: turned(3) !! directions in which it is an image
        integer :: image
        logical :: opposite

        opposite = (row < 3 .and. turned(1)) .or. (row > 4 .and. turned(3)) &
                   .or. ((row == 3 .or. row == 4) .and. turned(2))
        image = merge(side_of(direction_of(row), -sign_of(row)), row, opposite)
    end function image_row

    !> Distance of a coordinate from the middle of a face's gas cell, towards the solid [m].
    !@cuf attributes(host,device) &
    pure function height_of(x, lo, dx, n, wraps, gas, s) result(height)
        real(dp), intent(in) :: x !! along the direction of the face [m]
        real(dp), intent(in) :: lo, dx !! low end of the box, side of a cell [m]
        integer, intent(in) :: n !! cells along the direction
        logical, intent(in) :: wraps !! it is periodic
        integer, intent(in) :: gas !! index of the gas cell along it
        integer, intent(in) :: s !! +1: solid above the gas, -1: solid below
        real(dp) :: height, length

        height = s*(x - lo - (gas - 0.5_dp)*dx)
        if (wraps) then
            ! in front of the face there is only gas: what seems to lie there lies a box farther
            length = n*dx
            height = height - length*floor(height/length)
        end if
    end function height_of
end module brz_column_rules
