! SPDX-License-Identifier: MIT
!> What the coupling of one process has to do with the others where several share air and bodies.
!>
!> Cells and faces belong to the process in whose box of the air they are, particles to the process
!> that steps them. A process sees a halo of the grid, its box and some layers around it, and gets
!> copies of all particles in it: its ghosts. So everything but what steps the bodies goes by cells,
!> and what is beside the box is computed twice, from the same numbers.
module brz_coupling_part
    use brz_boxes, only: cells_t
    use brz_formulation_names, only: form_total
    use brz_kinds, only: dp, int32, int64, rk
    use brz_message_buffers, only: courier_t
    use brz_places, only: marks_t, message_buffers_t
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: coupling_part_t, listing_t, introduce, list_now, may_have_come

    !> How far bodies had come when ghosts were listed.
    type :: listing_t
        integer(int64) :: rebuilds = -1 !! of the bodies' lists
        real(dp), allocatable :: drift(:, :) !! (3, bodies) see brz_list_drift [m]
    end type listing_t

    type :: coupling_part_t
        type(cells_t), allocatable :: boxes(:) !! (0:processes-1) cells of the grid that each has
        type(cells_t), allocatable :: halos(:) !! likewise that each sees
        type(cells_t), allocatable :: near(:) !! likewise halos and a layer around
        integer(int32), allocatable :: halos_at(:), boxes_at(:), near_at(:) !! for loop bodies
        integer(int64) :: rebuilds = -1 !! how often particles had got places, at a list of ghosts
        type(courier_t) :: messages
        ! ghosts: particles of this process near halos, its own as well
        type(message_buffers_t) :: out, in !! their places; those of the ghosts that came
        type(message_buffers_t) :: home !! 1, 2, 3, ... for what comes back
        type(marks_t) :: listed !! which particles those are
        type(listing_t) :: since
        integer(int32), allocatable :: bodies_at(:) !! (2*bodies) first and last particle
        integer(int32), allocatable :: first_at(:) !! (processes + 1) those of `out`
        integer(int32), allocatable :: seat(:) !! 1, 2, 3, ... for as many as there is room for
        real(rk), allocatable :: loads(:, :) !! (3, out) that have come back
        real(rk), allocatable :: stresses(:, :) !! (6, out) of loaded faces, likewise
        type(marks_t) :: marks
    end type coupling_part_t

contains

    !> What the coupling must know of the bodies as a whole.
    subroutine introduce(solid, copies)
        class(bodies_t), intent(in) :: solid
        class(bodies_t), intent(inout) :: copies
        integer :: b

        copies%time = solid%time
        do b = 1, size(solid%bodies)
            copies%bodies(b)%rigid = solid%bodies(b)%rigid
            copies%bodies(b)%inactive = solid%bodies(b)%inactive
        end do
    end subroutine introduce

    !> Ghosts are listed for the bodies of now.
    pure subroutine list_now(solid, since)
        class(bodies_t), intent(in) :: solid
        type(listing_t), intent(inout) :: since
        integer :: b

        since%rebuilds = solid%rebuilds
        since%drift = reshape([(solid%bodies(b)%drift, b=1, size(solid%bodies))], &
                              [3, size(solid%bodies)])
    end subroutine list_now

    !> False where no particle can have moved through the layer of cells around a halo since
    !> ghosts were listed: all lists of neighbours are those of then, so each has moved within its
    !> body by half a skin at most before, and now. All processes find the same.
    pure logical function may_have_come(solid, since, whole, dx) result(may)
        class(listed_bodies_t), intent(in) :: solid
        type(listing_t), intent(in) :: since
        integer, intent(in) :: whole(3) !! cells of the grid
        real(dp), intent(in) :: dx(3) !! sides of a cell [m]
        real(dp) :: layer
        integer :: b

        ! such bodies keep their lists however far their particles go
        may = solid%rebuilds /= since%rebuilds .or. &
              any(solid%bodies%formulation == form_total) .and. .not. solid%links%present
        if (may) return
        layer = minval(dx, mask=whole > 1)*(1 - 1e-6_dp)
        do b = 1, size(solid%bodies)
            may = may .or. &
                  norm2(solid%bodies(b)%drift - since%drift(:, b)) + solid%skin >= layer
        end do
    end function may_have_come
end module brz_coupling_part
