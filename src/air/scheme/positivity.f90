! SPDX-License-Identifier: MIT
!> Positivity limiter: when a new state of the gas is none, for the fallback. Point physics.
module brz_positivity
    use brz_kinds, only: rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: floors_of, is_sound, is_kept, is_number, is_physical, stray, margin, vacuum
    public :: lost_mark, new_mark, limit_step, most_holds, is_lowered, is_fixed

    integer, parameter :: lost_mark = 127 !! of a cell of which nothing can be saved
    integer, parameter :: new_mark = 7 !! of a cell found bad after the last pass that lowers faces
    integer, parameter :: limit_step = 8 !! times the pass that held a cell, in its mark
    integer, parameter :: most_holds = 14 !! passes that hold cells
    real(rk), parameter :: stray = 1e3_rk*epsilon(1.0_rk) !! allowed of a mass fraction beyond 0..1
    real(rk), parameter :: margin = 32*epsilon(1.0_rk)
    !! least internal over total energy: rounding in a stage is a few epsilon of the total
    real(rk), parameter :: least_ratio = 1e-3_rk
    !! of new to old density or pressure of an Euler step, before a fallback
    real(rk), parameter :: vacuum(2) = [1e-8_rk, 1e-11_rk]
    !! least density and pressure over those at rest, so that products stay within range

contains

    !> What the Euler step must leave of a cell: part of its density and pressure, density
    !> [kg/m3], internal energy [J/m3].
    pure function floors_of(fallback, gamma, rho_rest, p_rest) result(floors)
        logical, intent(in) :: fallback
        real(rk), intent(in) :: gamma !! ratio of specific heats of the air [-]
        real(rk), intent(in) :: rho_rest, p_rest !! undisturbed air
        real(rk) :: floors(3)

        floors = 0
        if (fallback) floors = [least_ratio, vacuum(1)*rho_rest, vacuum(2)*p_rest/(gamma - 1)]
    end function floors_of

    !> True if a step leaves more than the floors, and mass fractions in 0..1.
    !>
    !> Divisions are avoided by multiplying with densities. False for what is no number.
    !@cuf attributes(host,device) &
    pure function is_sound(n_var, floors, old, new) result(sound)
        integer, intent(in) :: n_var !! conserved variables, 5 or 6
        real(rk), intent(in) :: floors(3) !! see floors_of
        real(rk), intent(in) :: old(max_var), new(max_var) !! conserved variables
        logical :: sound
        real(rk) :: e

        e = inner(new)
        sound = new(1) > floors(1)*old(1) .and. new(1) > floors(2) &
                .and. e*old(1) > floors(1)*inner(old)*new(1) &
                .and. e > (floors(3) + margin*new(5))*new(1)
        if (n_var == 6) sound = sound .and. new(6) >= -stray*new(1) .and. &
            new(6) <= (1 + stray)*new(1)
    end function is_sound

    !> True if a step leaves a gas above the floors of a vacuum, or no less of one than there was.
    !>
    !> A cell that does not change is kept if it is physical.
    !@cuf attributes(host,device) &
    pure function is_kept(floors, old, new) result(kept)
        real(rk), intent(in) :: floors(3) !! see floors_of
        real(rk), intent(in) :: old(max_var), new(max_var) !! conserved variables
        logical :: kept
        real(rk) :: e

        e = inner(new)
        kept = is_physical(new) .and. (new(1) > floors(2) .or. new(1) >= old(1)) &
               .and. (e > (floors(3) + margin*new(5))*new(1) .or. e*old(1) >= inner(old)*new(1))
    end function is_kept

    !> True if a state has a positive density and internal energy and is a number.
    !@cuf attributes(host,device) &
    pure function is_physical(q) result(physical)
        real(rk), intent(in) :: q(max_var) !! conserved variables
        logical :: physical

        physical = q(1) > 0 .and. inner(q) > 0 .and. inner(q) <= huge(1.0_rk)
    end function is_physical

    !> True if density, momentum and energy are numbers.
    !@cuf attributes(host,device) &
    pure function is_number(q) result(number)
        real(rk), intent(in) :: q(max_var) !! conserved variables
        logical :: number
        integer :: c

        number = .true.
        do c = 1, 5
            number = number .and. abs(q(c)) <= huge(1.0_rk)
        end do
    end function is_number

    !> Internal energy per volume times density.
    !@cuf attributes(host,device) &
    pure function inner(q) result(energy)
        real(rk), intent(in) :: q(max_var) !! conserved variables
        real(rk) :: energy

        energy = q(5)*q(1) - 0.5_rk*(q(2)*q(2) + q(3)*q(3) + q(4)*q(4))
    end function inner

    !> True if a mark says that the faces of a cell are lowered: it was made in a pass up to this.
    !>
    !> A mark is the number of the pass that lowered the faces of a cell, and limit_step times that
    !> of the pass that held it; so is the pass up to which marks count. What a pass marks is not
    !> seen in that pass, whatever the order of the threads.
    !@cuf attributes(host,device) &
    pure function is_lowered(pass, mark) result(lowered)
        integer, intent(in) :: pass
        integer, intent(in) :: mark !! of a cell; 0: none
        logical :: lowered

        lowered = mod(mark, limit_step) >= 1 .and. mod(mark, limit_step) <= mod(pass, limit_step)
    end function is_lowered

    !> True if a mark says that a cell is held, in the same way.
    !@cuf attributes(host,device) &
    pure function is_fixed(pass, mark) result(held)
        integer, intent(in) :: pass
        integer, intent(in) :: mark !! of a cell; 0: none
        logical :: held

        held = mark/limit_step >= 1 .and. mark/limit_step <= pass/limit_step
    end function is_fixed
end module brz_positivity
