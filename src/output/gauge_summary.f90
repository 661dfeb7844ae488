! SPDX-License-Identifier: MIT
!> What the gauges have seen, as a table: taken from the history file, so that a run that was
!> interrupted is summed up as a whole.
!>
!> Of a pressure: the peak over the undisturbed air, the arrival (the overpressure first passes a
!> tenth of its peak; linear between rows), the positive phase (from there to the first return to
!> the undisturbed pressure after the peak) and the impulse over it. A peak below half a percent
!> of the undisturbed pressure counts as no arrival. Of anything else: the extreme and its time. The
!> scaled distance of gauges in the air stands last if there is one charge.
module brz_gauge_summary
    use brz_errors, only: error_t, failed
    use brz_gauges, only: gauge_t, gauges_t
    use brz_history, only: read_history
    use brz_kinds, only: dp
    implicit none
    private
    public :: gauge_summary, pulse_t, measure_pulse

    real(dp), parameter :: front = 0.1_dp !! part of the peak that marks the arrival
    real(dp), parameter :: noise = 5e-3_dp !! part of the undisturbed pressure that is no blast
    character(*), parameter :: line_end = new_line('a')

    !> A blast wave at one point.
    type :: pulse_t
        logical :: arrived = .false.
        logical :: complete = .false. !! the positive phase ended within the record
        real(dp) :: peak = 0 !! overpressure [Pa]
        real(dp) :: peak_time = 0, arrival = 0 !! [s]
        real(dp) :: duration = 0 !! of the positive phase [s]
        real(dp) :: impulse = 0 !! over the positive phase [Pa s]
    end type pulse_t

contains

    !> The table, from the gauges' history file; '' without gauges.
    subroutine gauge_summary(gauges, path, text, err)
        type(gauges_t), intent(in) :: gauges
        character(*), intent(in) :: path !! of gauges.csv
        character(:), allocatable, intent(out) :: text
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: table(:, :)
        type(pulse_t) :: pulse
        integer :: g

        text = ''
        if (gauges%n == 0) return
        call read_history(path, gauges%n + 1, table, err)
        if (failed(err) .or. size(table, 2) == 0) return
        text = 'gauge            quantity               extreme      at [s]  arrival [s]'// &
               ' positive [s]  impulse [Pa s]'
        if (gauges%charge_mass > 0) text = text//' Z [m/kg^1/3]'
        text = text//line_end
        do g = 1, gauges%n
            if (index(gauges%list(g)%of%name, 'pressure') > 0 .and. gauges%list(g)%body == 0) then
                if (gauges%list(g)%of%name == 'pressure') &
                    table(g + 1, :) = table(g + 1, :) - gauges%rest
                call measure_pulse(table(1, :), table(g + 1, :), gauges%rest, pulse)
                call add_pulse(gauges, g, pulse, text)
            else
                call add_extreme(gauges%list(g), table(1, :), table(g + 1, :), text)
            end if
        end do
    end subroutine gauge_summary

    !> Peak, arrival, positive phase and impulse of an overpressure history.
    pure subroutine measure_pulse(time, over, rest, pulse)
        real(dp), intent(in) :: time(:) !! [s]
        real(dp), intent(in) :: over(:) !! overpressure at these times [Pa]
        real(dp), intent(in) :: rest !! pressure of the undisturbed air [Pa]
        type(pulse_t), intent(out) :: pulse
        real(dp) :: end
        integer :: i, top, first, last

        top = maxloc(over, dim=1)
        pulse%peak = over(top)
        pulse%peak_time = time(top)
        pulse%arrived = pulse%peak > noise*rest
        if (.not. pulse%arrived) return
        do first = 1, top ! the first row at or over the mark
            if (over(first) >= front*pulse%peak) exit
        end do
        pulse%arrival = time(first)
        if (first > 1) pulse%arrival = crossing(time(first - 1:first), over(first - 1:first), &
                                                front*pulse%peak)
        do last = top, size(over) - 1 ! the last row before the return
            if (over(last + 1) <= 0) exit
        end do
        pulse%complete = last < size(over)
        end = time(min(last, size(time)))
        if (pulse%complete) end = crossing(time(last:last + 1), over(last:last + 1), 0.0_dp)
        last = min(last, size(over))
        pulse%duration = end - pulse%arrival
        do i = first + 1, last
            pulse%impulse = pulse%impulse + (over(i) + over(i - 1))/2*(time(i) - time(i - 1))
        end do
        if (first > 1) pulse%impulse = pulse%impulse + (over(first) + front*pulse%peak)/2 &
                                       *(time(first) - pulse%arrival)
        pulse%impulse = pulse%impulse + over(last)/2*(end - time(last))
    end subroutine measure_pulse

    !> Time at which a straight line between two rows has a value.
    pure real(dp) function crossing(time, value, level)
        real(dp), intent(in) :: time(:), value(:) !! (2)
        real(dp), intent(in) :: level

        crossing = time(1) + (level - value(1))/(value(2) - value(1))*(time(2) - time(1))
    end function crossing

    !> One line of the table for a pressure.
    subroutine add_pulse(gauges, g, pulse, text)
        type(gauges_t), intent(in) :: gauges
        integer, intent(in) :: g !! gauge
        type(pulse_t), intent(in) :: pulse
        character(:), allocatable, intent(inout) :: text
        character(160) :: line

        associate (gauge => gauges%list(g))
            if (pulse%arrived) then
                write (line, '(2a16, es14.4, 1x, a5, 2es12.4, 2es14.4)') gauge%id, &
                    'overpressure', pulse%peak, 'Pa   ', pulse%peak_time, pulse%arrival, &
                    pulse%duration, pulse%impulse
            else
                write (line, '(2a16, es14.4, 1x, a5, es12.4, a12, a28)') gauge%id, &
                    'overpressure', pulse%peak, 'Pa   ', pulse%peak_time, 'no arrival', ''
            end if
            if (gauges%charge_mass > 0) write (line(105:), '(f12.3)') &
                norm2(gauge%at - gauges%charge_at)/gauges%charge_mass**(1/3.0_dp)
        end associate
        if (pulse%arrived .and. .not. pulse%complete) &
            line = trim(line)//' (still positive at the end)'
        text = text//trim(line)//line_end
    end subroutine add_pulse

    subroutine add_extreme(gauge, time, value, text)
        type(gauge_t), intent(in) :: gauge
        real(dp), intent(in) :: time(:), value(:)
        character(:), allocatable, intent(inout) :: text
        character(160) :: line
        integer :: i

        i = maxloc(abs(value), dim=1)
        write (line, '(a16, a, es14.4, 1x, a5, es12.4)') gauge%id, trim(gauge%of%name)// &
            repeat(' ', max(16 - len_trim(gauge%of%name), 1)), value(i), gauge%of%unit, time(i)
        text = text//trim(line)//line_end
    end subroutine add_extreme
end module brz_gauge_summary
