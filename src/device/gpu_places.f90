! SPDX-License-Identifier: MIT
!> Lists of places whose particles, cells or faces are in a message, on the GPU: as brz_places has
!> them, for steps that stand once.
module brz_gpu_places
    use brz_buffers, only: buffer_t, doubles_t, integers_t
    use brz_gpu_common, only: gpu_common_t
    use brz_kinds, only: int64
    implicit none
    private
    public :: gpu_places_t, gpu_marks_t

    !> What is in a message: parcel r is entries first(r) to first(r + 1) - 1. What a process has
    !> for itself mostly goes from array to array.
    type :: gpu_places_t
        integer, allocatable :: first(:) !! (0:processes)
        integer(int64), allocatable :: there(:)
        !! (0:processes - 1) entries in the other arena before those of this process
        type(integers_t) :: place
        logical :: all = .false. !! what a process has for itself goes the same way
        integer, allocatable :: run(:, :)
        !! (2, runs) first place and number of what it has for itself, where that lies in few runs
        integer :: tiled = 0 !! places in the tiles of all parcels
        type(buffer_t) :: parcels !! what kernels know of them, see brz_place_items
        integer, allocatable :: parcels_there(:) !! what the GPU has of that
    end type gpu_places_t

    type :: gpu_marks_t
        type(integers_t) :: mark, sent, joined, before, ends, sums, pieces, asks !! as in marks_t
        type(doubles_t) :: region, wants !! small tables
        integer, allocatable :: ends_there(:), region_there(:) !! what the GPU has of them
        type(gpu_common_t) :: common !! for running sums
    end type gpu_marks_t
end module brz_gpu_places
