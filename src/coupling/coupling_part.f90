! SPDX-License-Identifier: MIT
!> What the coupling of one process has to do with the others where several share air and bodies.
!>
!> Cells and faces belong to the process in whose box of the air they are, particles to the process
!> that steps them. A process sees a window of the grid, its box and some layers around it, and gets
!> copies of all particles in it: its guests. So everything but what steps the bodies goes by cells,
!> and what is beside the box is computed twice, from the same numbers.
module brz_coupling_part
    use brz_boxes, only: box_t
    use brz_kinds, only: int32
    use brz_mail, only: mail_t
    use brz_solid_part, only: parcels_t
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: part_t, introduce

    type :: part_t
        type(box_t), allocatable :: boxes(:) !! (0:processes-1) cells of the grid that each has
        type(box_t), allocatable :: windows(:) !! likewise that each sees
        ! particles of this process in windows, those of this process as well
        type(parcels_t) :: out !! places of them
        logical, allocatable :: theirs(:) !! (out) in a cell of the process that gets it
        type(parcels_t) :: in !! places of the guests that came
        integer(int32), allocatable :: seat(:) !! 1, 2, 3, ... for as many as there is room for
        integer(int32), allocatable :: cell(:, :) !! (3, particles) cell of the grid, or 0: outside
        ! wall faces: impulses go from who has the gas to who has loads to hand out
        type(parcels_t) :: faces_out, faces_in
        type(mail_t) :: guest_mail, load_mail, face_mail, debt_mail
    end type part_t

contains

    !> What the coupling must know of the bodies as a whole.
    subroutine introduce(solid, guests)
        class(solid_t), intent(in) :: solid
        type(solid_t), intent(inout) :: guests
        integer :: b

        guests%time = solid%time
        do b = 1, size(solid%bodies)
            guests%bodies(b)%rigid = solid%bodies(b)%rigid
            guests%bodies(b)%asleep = solid%bodies(b)%asleep
        end do
    end subroutine introduce
end module brz_coupling_part
