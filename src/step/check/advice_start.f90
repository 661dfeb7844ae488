! SPDX-License-Identifier: MIT
!> Advice on a charge that begins on the grid of the air with few cells: along its radius or in the
!> plane through its axis the same blast is better resolved, and the box needs no steps until then.
module brz_advice_start
    use brz_advice_text, only: length_text, say_advice, say_more, time_text
    use brz_axial_start, only: axial_input, find_obstacles, frame_t, make_frame, obstacle_t
    use brz_axial_state, only: axial_input_t
    use brz_case, only: case_t
    use brz_charge_shape, only: make_shape, charge_shape_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, real32
    use brz_kingery_bulmash, only: blast_t, farthest, free_air_blast, nearest
    use brz_start_1d, only: free_way_1d => free_way
    use brz_start_2d, only: free_way_2d => free_way
    use brz_text, only: to_text
    implicit none
    private
    public :: advise_start

    real(dp), parameter :: wanted = 8 !! cells across the radius of a charge on the grid
    real(dp), parameter :: least_room = 3 !! radii, so that the front runs to four: the products are
    !! then an ideal gas within some per cent (docs/manual/blast.md)

contains

    !> `seconds`: of one core for all steps of the run.
    subroutine advise_start(case, seconds)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: seconds
        character(:), allocatable :: start
        type(charge_shape_t) :: shape
        type(error_t) :: err
        real(dp) :: cells, dx(3), room, share

        if (.not. case%air%present .or. size(case%charges) /= 1 .or. size(case%inflows) > 0) return
        if (any(case%air%cells < 2) .or. any(case%gas%file /= '')) return
        associate (charge => case%charges(1))
            if (charge%start /= '3d' .or. charge%shape == 'box') return
            dx = (case%air%hi - case%air%lo)/case%air%cells
            call make_shape(charge, spread(.true., 1, 3), 1.0_dp, shape, err)
            if (failed(err)) return
            cells = minval(shape%half/dx)
            if (cells >= wanted) return
            call find_start(case, shape, maxval(dx), start, room)
            if (start == '') return
            call say_advice("'"//trim(charge%id)//"' has "//to_text(real(anint(10*cells)/10, &
                            real32))//' cells in its radius, where '//to_text(nint(wanted))// &
                            " are wanted: start='"//start//"' computes its blast")
            share = arrival(charge%mass, minval(shape%half) + room)/case%run%t_end
            call say_more(trim(merge('along its radius             ', &
                                     'in the plane through its axis', start == '1d'))// &
                          ' until its front has run '//length_text(room)// &
                          ", with eos='jwl' as it detonates;")
            call say_more('of the box that saves '//time_text(min(share, 1.0_dp)*seconds)// &
                          ' of one core')
        end associate
    end subroutine advise_start

    !> The start that a charge has room for, '' for none, and how far its front may run [m].
    subroutine find_start(case, shape, cell, start, room)
        type(case_t), intent(in) :: case
        type(charge_shape_t), intent(in) :: shape
        real(dp), intent(in) :: cell !! largest side of a cell [m]
        character(:), allocatable, intent(out) :: start
        real(dp), intent(out) :: room
        type(axial_input_t) :: input
        type(error_t) :: err
        type(frame_t) :: frame
        type(obstacle_t), allocatable :: obstacles(:)

        start = ''
        if (case%charges(1)%shape == 'sphere') then
            room = free_way_1d(case, cell) - shape%half(1)
            if (room >= least_room*shape%half(1)) start = '1d'
            return
        end if
        frame = make_frame(case)
        call axial_input(case, frame, input, err)
        if (failed(err)) return
        call find_obstacles(case, frame, obstacles)
        room = free_way_2d(input, obstacles, cell)
        if (room >= least_room*max(input%radius, input%half)) start = '2d'
    end subroutine find_start

    !> When the front of a sphere of TNT of that mass is at a distance [s].
    real(dp) function arrival(mass, distance)
        real(dp), intent(in) :: mass, distance !! [kg], [m]
        type(blast_t) :: blast
        real(dp) :: scaled

        scaled = min(max(distance/mass**(1/3.0_dp), 1.01_dp*nearest), 0.99_dp*farthest)
        blast = free_air_blast(mass, scaled*mass**(1/3.0_dp))
        arrival = blast%arrival
    end function arrival
end module brz_advice_start
