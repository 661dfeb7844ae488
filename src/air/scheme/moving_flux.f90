! SPDX-License-Identifier: MIT
!> Flux through a face that moves, for any equation of state (HLLC).
!>
!> Source: Toro, Spruce, Speares 1994; wave speeds of Davis 1988. A contact that moves with the face
!> is kept exactly: no mass crosses it.
module brz_moving_flux
    use brz_kinds, only: dp
    implicit none
    private
    public :: moving_flux

contains

    !> Mass, momentum without the pressure, and energy through the face, and the pressure on it.
    !>
    !> States are density, velocity, pressure, energy per volume (internal and kinetic) and speed of
    !> sound.
    !@cuf attributes(host,device) &
    pure subroutine moving_flux(below, above, w, flux, p)
        real(dp), intent(in) :: below(5), above(5) !! states on the two sides
        real(dp), intent(in) :: w !! velocity of the face [m/s]
        real(dp), intent(out) :: flux(3) !! per area and time [kg, kg m/s, J]
        real(dp), intent(out) :: p !! [Pa]
        real(dp) :: slowest, fastest, contact, left, right

        slowest = min(below(2) - below(5), above(2) - above(5))
        fastest = max(below(2) + below(5), above(2) + above(5))
        left = below(1)*(slowest - below(2))
        right = above(1)*(fastest - above(2))
        if (w <= slowest) then
            call one_side(below, w, flux, p)
        else if (w >= fastest) then
            call one_side(above, w, flux, p)
        else
            contact = (above(3) - below(3) + left*below(2) - right*above(2))/(left - right)
            if (w <= contact) then
                call star(below, slowest, contact, w, flux, p)
            else
                call star(above, fastest, contact, w, flux, p)
            end if
        end if
    end subroutine moving_flux

    !> All waves run to one side.
    !@cuf attributes(host,device) &
    pure subroutine one_side(state, w, flux, p)
        real(dp), intent(in) :: state(5), w
        real(dp), intent(out) :: flux(3), p

        p = state(3)
        flux(1) = state(1)*(state(2) - w)
        flux(2) = flux(1)*state(2)
        flux(3) = state(4)*(state(2) - w) + p*state(2)
    end subroutine one_side

    !> Between a sound wave and the contact.
    !@cuf attributes(host,device) &
    pure subroutine star(state, wave, contact, w, flux, p)
        real(dp), intent(in) :: state(5), wave, contact, w
        real(dp), intent(out) :: flux(3), p
        real(dp) :: inflow, energy

        inflow = wave - state(2)
        p = state(3) + state(1)*inflow*(contact - state(2))
        energy = (inflow*state(4) - state(3)*state(2) + p*contact)/(wave - contact)
        flux(1) = state(1)*inflow/(wave - contact)*(contact - w)
        flux(2) = flux(1)*contact
        flux(3) = energy*(contact - w) + p*contact
    end subroutine star
end module brz_moving_flux
