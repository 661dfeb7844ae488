! SPDX-License-Identifier: MIT
!> When a new state of the gas is none: the tests of the fallback. Point physics.
module brz_positivity
    use brz_kinds, only: rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: is_sound, is_physical, stray, lost_mark

    integer, parameter :: lost_mark = 100 !! of a cell of which nothing can be saved
    real(rk), parameter :: stray = 1e3_rk*epsilon(1.0_rk) !! allowed of a mass fraction beyond 0..1

contains

    !> True if a step leaves more than a part of density and pressure, and mass fractions in 0..1.
    !>
    !> Divisions are avoided by multiplying with densities. False for what is no number.
    !@cuf attributes(host,device) &
    pure function is_sound(n_var, floor, old, new) result(sound)
        integer, intent(in) :: n_var !! conserved variables, 5 or 6
        real(rk), intent(in) :: floor !! least ratio of new to old density and pressure
        real(rk), intent(in) :: old(max_var), new(max_var) !! conserved variables
        logical :: sound

        sound = new(1) > floor*old(1) .and. inner(new)*old(1) > floor*inner(old)*new(1)
        if (n_var == 6) sound = sound .and. new(6) >= -stray*new(1) .and. &
            new(6) <= (1 + stray)*new(1)
    end function is_sound

    !> True if a state has a positive density and is a number.
    !@cuf attributes(host,device) &
    pure function is_physical(q) result(physical)
        real(rk), intent(in) :: q(max_var) !! conserved variables
        logical :: physical

        physical = q(1) > 0 .and. abs(inner(q)) <= huge(1.0_rk)
    end function is_physical

    !> Internal energy per volume times density.
    !@cuf attributes(host,device) &
    pure function inner(q) result(energy)
        real(rk), intent(in) :: q(max_var) !! conserved variables
        real(rk) :: energy

        energy = q(5)*q(1) - 0.5_rk*(q(2)*q(2) + q(3)*q(3) + q(4)*q(4))
    end function inner
end module brz_positivity
