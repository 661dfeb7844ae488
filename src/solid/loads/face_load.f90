! SPDX-License-Identifier: MIT
!> Pressures on faces of bodies and forces on whole bodies, in scenes without air.
!>
!> A face is the outermost layer of a lattice, seen along an axis. Each of its particles carries a
!> loaded segment: the vectors to its neighbours in the layer span its area and show its normal, so
!> that the load follows the face as it stretches, bends and turns.
!>
!> Source: docs/manual/blast.md, loads without air
module brz_face_load
    use brz_kinds, only: dp, int32
    use brz_loads, only: loaded_segments_t, load_history_t, loads_t
    use brz_time_table, only: mean_over
    implicit none
    private
    public :: lay_out, mean_pressures, pushes, find_places
    public :: arrival_of, first_arrival

contains

    !> Room for n loaded segments.
    subroutine lay_out(segments, n)
        type(loaded_segments_t), intent(out) :: segments
        integer, intent(in) :: n

        segments%n = n
        allocate (segments%id(n), segments%load(n), segments%side(n), segments%beside(4, n), &
                  segments%mirror(4, n), segments%width(2, n), segments%most(2, n), &
                  segments%wave(6, n))
        segments%wave = 0
    end subroutine lay_out

    !> Mean pressure of each load over a step; 0 of pushes and of blasts [Pa].
    pure function mean_pressures(loads, time, dt) result(p)
        type(loads_t), intent(in) :: loads
        real(dp), intent(in) :: time, dt !! start of the step, its length [s]
        real(dp) :: p(size(loads%of))
        integer :: k

        p = 0
        do k = 1, size(loads%of)
            if (loads%of(k)%body == 0 .and. .not. loads%of(k)%blast) &
                p(k) = mean_of(loads%of(k), time, dt)
        end do
    end function mean_pressures

    !> Mean acceleration of the bodies by all that pushes them, over a step [m/s2].
    pure function pushes(loads, bodies, time, dt) result(a)
        type(loads_t), intent(in) :: loads
        integer, intent(in) :: bodies
        real(dp), intent(in) :: time, dt !! [s]
        real(dp) :: a(3, bodies)
        integer :: k

        a = 0
        do k = 1, size(loads%of)
            associate (b => loads%of(k)%body)
                if (b > 0) a(:, b) = a(:, b) + mean_of(loads%of(k), time, dt)*loads%of(k)%push
            end associate
        end do
    end function pushes

    !> When a load begins to act: the first wave at its loaded segments, or the last point of its
    !> history before a value that is not 0; huge where there is none, -huge where it acts all the
    !> time [s].
    pure real(dp) function arrival_of(loads, k) result(arrival)
        type(loads_t), intent(in) :: loads
        integer, intent(in) :: k !! place of the load
        integer :: i

        arrival = huge(arrival)
        if (loads%of(k)%blast) then
            associate (segments => loads%segments)
                arrival = minval([arrival, pack(segments%wave(1, :), segments%load == k &
                                                .and. segments%wave(2, :) > 0)])
            end associate
            return
        end if
        associate (time => loads%of(k)%time, value => loads%of(k)%pressure)
            i = findloc(abs(value) > 0, .true., dim=1)
            if (i == 0) return
            arrival = -huge(arrival)
            if (size(time) > 0) arrival = time(max(i - 1, 1))
        end associate
    end function arrival_of

    !> When the first of all loads begins to act [s].
    pure real(dp) function first_arrival(loads) result(arrival)
        type(loads_t), intent(in) :: loads
        integer :: k

        arrival = huge(arrival)
        if (.not. allocated(loads%of)) return
        do k = 1, size(loads%of)
            if (.not. loads%of(k)%blast) arrival = min(arrival, arrival_of(loads, k))
        end do
        associate (wave => loads%segments%wave) ! of all blasts at once
            if (any(loads%of%blast)) arrival = min(arrival, minval(wave(1, :), wave(2, :) > 0))
        end associate
    end function first_arrival

    pure real(dp) function mean_of(history, time, dt) result(mean)
        type(load_history_t), intent(in) :: history
        real(dp), intent(in) :: time, dt !! [s]

        mean = mean_over(history%time, history%pressure, time, dt, .false.)
    end function mean_of

    !> Find the particles by their ids, after the lists were sorted.
    pure subroutine find_places(loads, id)
        type(loads_t), intent(inout) :: loads
        integer(int32), intent(in) :: id(:) !! of the particles, in their order
        integer :: i

        do i = 1, size(id)
            loads%place(id(i)) = i
        end do
    end subroutine find_places
end module brz_face_load
