! SPDX-License-Identifier: MIT
!> The whole state of the solids: the bodies, and where they are computed: on which processes, and
!> what they have on a GPU. For drivers, and for what moves particles between processes or to a GPU;
!> `make lint` bounds how many files use it. Others name the layer that they need.
module brz_solid_state
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_device, only: solid_device_t
    use brz_solid_part, only: solid_part_t
    implicit none
    private
    public :: solid_t

    type, extends(interacting_bodies_t) :: solid_t
        type(solid_part_t) :: part !! what this process has to do with others
        type(solid_device_t), pointer :: device => null() !! what it has on a GPU besides
    end type solid_t
end module brz_solid_state
