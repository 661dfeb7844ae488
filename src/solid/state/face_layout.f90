! SPDX-License-Identifier: MIT
!> The face of a particle in contact: the places of its numbers in a row of `face`, see
!> brz_contact_face.
module brz_face_layout
    implicit none
    private
    public :: n_face, face_normal, face_strain, face_past, face_edge

    integer, parameter :: face_normal = 0 !! + 1..3: unit normal; 0: nothing is near
    integer, parameter :: face_strain = 4 !! of the half layer; a step before
    integer, parameter :: face_past = 5
    integer, parameter :: face_edge = 6 !! share of the springs near the edge of a flat face
    integer, parameter :: n_face = 6
end module brz_face_layout
