! SPDX-License-Identifier: MIT
!> What the coupling on the GPU of one process has to do with those of others, as
!> brz_coupling_part has it: windows, parcels, lists of what is in them.
module brz_gpu_coupling_part
    use brz_boxes, only: box_t
    use brz_buffers, only: integers_t, reals_t
    use brz_gpu_fetch, only: gpu_fetch_t
    use brz_gpu_marks, only: gpu_marks_t
    use brz_gpu_parcels, only: gpu_parcels_t, gpu_places_t
    use brz_kinds, only: int64
    implicit none
    private
    public :: gpu_part_t

    type :: gpu_part_t
        type(box_t), allocatable :: boxes(:), windows(:) !! (0:processes - 1)
        type(gpu_fetch_t) :: window !! gas and ledgers of others in the window
        type(gpu_parcels_t) :: parcels
        integer(int64) :: laid = -1 !! of the particles, when guests were listed
        type(gpu_places_t) :: out, in !! particles of this process near windows, guests
        type(gpu_marks_t) :: listed !! which particles those are
        type(integers_t) :: bodies_at !! (2, bodies) first and last particle
        type(integers_t) :: asks_at !! (6, 3*processes) windows, boxes, windows and a layer
        type(integers_t) :: missed !! 1: a particle is in a window and not listed for it
        type(gpu_places_t) :: faces_out, faces_in
        type(gpu_places_t) :: debts_out, debts_in
        type(gpu_marks_t) :: marks
        type(integers_t) :: seat !! 1, 2, 3, ...
        type(reals_t) :: loads !! (3, particles) that have come from a process
    end type gpu_part_t
end module brz_gpu_coupling_part
