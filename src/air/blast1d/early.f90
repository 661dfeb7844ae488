! SPDX-License-Identifier: MIT
!> What happened in a blast in one or two dimensions before the run in the grid begins.
module brz_early
    use brz_air_state, only: air_t
    use brz_air_totals, only: gas_sums
    use brz_errors, only: error_t, exit_numerical, raise
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: early_t, watch_blast, next_due, keep_row, grid_totals, along_arm, lose_blast

    type :: early_t
        logical :: present = .false.
        integer :: dimensions = 1 !! of the blast: along its radius, or in the plane of its axis
        logical :: products = .false. !! the grid tells products from air
        real(dp) :: time = 0 !! at which the blast was put into the grid [s]
        real(dp) :: radius = 0 !! of its front then; in a plane the farthest place of it [m]
        real(dp) :: contact = 0, fastest = 0 !! of products; largest u + c beyond [m], [m/s]
        integer :: steps = 0
        real(dp) :: before(7) = 0 !! mass, momentum x, y, z, energy, products; radial momentum
        real(dp) :: after(6) = 0 !! the same of the cells; both less the undisturbed air
        real(dp) :: pressure_change = 0 !! largest, of products as ideal gas, relative
        real(dp) :: pressure_mean = 0 !! the same, mean over the mass of the products
        real(dp) :: beyond = 0 !! energy that open sides let out before, of all of it
        real(dp) :: off = 0 !! of the sums of points in the grid, before they were put right
        integer :: rows = 0
        real(dp), allocatable :: when(:) !! (rows) times of histories [s]
        real(dp), allocatable :: seen(:, :, :)
        !! (5, points of gauges, rows) density, velocity, pressure
    end type early_t

    abstract interface
        !> Told after every step how far the blast is.
        subroutine watch_blast(dimensions, time, radius, last)
            import :: dp
            integer, intent(in) :: dimensions !! of the blast
            real(dp), intent(in) :: time !! [s]
            real(dp), intent(in) :: radius, last !! of the front, now and when it is mapped [m]
        end subroutine watch_blast
    end interface

contains

    !> First whole multiple of an interval after a time; where it is none, at every step [s].
    pure real(dp) function next_due(time, every)
        real(dp), intent(in) :: time, every !! [s]

        next_due = time
        if (every > spacing(time)) next_due = (aint(time/every) + 1)*every
    end function next_due

    !> A step of the blast failed.
    subroutine lose_blast(where, time, err)
        character(*), intent(in) :: where !! 'one dimension', 'two dimensions'
        real(dp), intent(in) :: time !! [s]
        type(error_t), intent(inout) :: err

        call raise(err, exit_numerical, 'the blast in '//where//' is lost at t = '// &
                   to_text(time)//' s')
    end subroutine lose_blast

    !> Keep what the gauges of the air see.
    subroutine keep_row(early, time, seen)
        type(early_t), intent(inout) :: early
        real(dp), intent(in) :: time !! [s]
        real(dp), intent(in) :: seen(:, :) !! (5, points of gauges) density, velocity, pressure
        real(dp), allocatable :: when(:), more(:, :, :)
        integer :: n

        n = size(seen, 2)
        if (.not. allocated(early%when)) allocate (early%when(64), early%seen(5, n, 64))
        if (early%rows == size(early%when)) then
            allocate (when(2*early%rows), more(5, n, 2*early%rows))
            when(:early%rows) = early%when
            more(:, :, :early%rows) = early%seen
            call move_alloc(when, early%when)
            call move_alloc(more, early%seen)
        end if
        early%rows = early%rows + 1
        early%when(early%rows) = time
        early%seen(:, :, early%rows) = seen
    end subroutine keep_row

    !> A radial state as one with a vector.
    pure function along_arm(state, arm) result(seen)
        real(dp), intent(in) :: state(3) !! density, radial velocity, pressure
        real(dp), intent(in) :: arm(3) !! from the centre to the place [m]
        real(dp) :: seen(5)

        seen = [state(1), state(2)*arm/max(norm2(arm), tiny(arm)), state(3)]
    end function along_arm

    !> Mass, momentum, energy and products in all cells.
    subroutine grid_totals(air, sums)
        type(air_t), intent(inout) :: air
        real(dp), intent(out) :: sums(6)
        real(dp) :: all(0:6)

        call gas_sums(air, all)
        sums = all(1:)*product(air%dx)
    end subroutine grid_totals
end module brz_early
