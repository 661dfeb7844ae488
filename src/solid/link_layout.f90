! SPDX-License-Identifier: MIT
!> How lists of particles are written: an entry is a particle plus mask_unit times the mask of the
!> axes in which it is mirrored, bits 0..2.
module brz_link_layout
    implicit none
    private
    public :: mask_unit

    integer, parameter :: mask_unit = 2**28
end module brz_link_layout
