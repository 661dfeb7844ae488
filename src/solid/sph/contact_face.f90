! SPDX-License-Identifier: MIT
!> The face of a particle in contact: how it is strained, and the stress that contact brings by it.
!> Point physics.
!>
!> Bodies meet at their faces, half a layer outside the particles of their outermost layers. The
!> half layer is strained as its particle is, so the face moves along the normal n by share*spacing
!> times the strain e, e' = (1 + e) n.L n. The springs of contact see the gap between faces: their
!> force R on a face does work on that motion, which the stress R share*spacing (1 + e)/V n (x) n
!> gives back in the forces of pairs. So the outermost layer meets the whole traction, where forces
!> on particles alone give it half (see brz_face_stress), and no energy is made.
!>
!> Source: docs/theory/contact.md, faces in contact
module brz_contact_face
    use brz_kinds, only: real32, rk
    implicit none
    private
    public :: strain_face, add_push_by_face, turn_normal

    real(rk), parameter :: most_strain = 0.3_rk, least_strain = -0.7_rk !! then the face stays

contains

    !> Strain the half layer over a step, and find what a unit force on its face adds to the row of
    !> the particle: n (x) row.
    !@cuf attributes(host,device) &
    pure subroutine strain_face(dt, h, normal, along, reach, volume, strain, past, row)
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        real(rk), intent(in) :: h(3, 3) !! velocity gradient [1/s]
        real(rk), intent(in) :: normal(3)
        real(rk), intent(in) :: along(3, 3) !! the stress n (x) n as the row has it
        real(rk), intent(in) :: reach !! share*spacing; 0: the face stays where it is [m]
        real(rk), intent(in) :: volume !! [m3]
        real(real32), intent(inout) :: strain
        real(real32), intent(out) :: past !! a step before
        real(rk), intent(out) :: row(3) !! [Pa/N]
        real(rk) :: rate, later
        integer :: a, b

        past = strain
        row = 0
        if (.not. (dt > 0 .and. reach > 0)) return
        rate = 0
        do b = 1, 3
            do a = 1, 3
                rate = rate + normal(a)*h(a, b)*normal(b)
            end do
        end do
        later = strain + dt*(1 + strain)*rate
        if (later > most_strain .or. later < least_strain) return
        do b = 1, 3
            do a = 1, 3
                row(b) = row(b) + normal(a)*along(a, b)
            end do
        end do
        do b = 1, 3
            row(b) = reach*(1 + strain)/volume*row(b)
        end do
        strain = real(later, real32)
    end subroutine strain_face

    !> Add the stress of a force on the face to the row of a particle.
    !@cuf attributes(host,device) &
    pure subroutine add_push_by_face(push, normal, row, stress)
        real(rk), intent(in) :: push !! force of the springs along the normal [N]
        real(rk), intent(in) :: normal(3), row(3) !! of its face, see strain_face
        real(rk), intent(inout) :: stress(3, 3) !! times the correction of the gradient [Pa]
        integer :: a, b

        do b = 1, 3
            do a = 1, 3
                stress(a, b) = stress(a, b) + push*normal(a)*row(b)
            end do
        end do
    end subroutine add_push_by_face

    !> The normal of the face from the slope of the kernel sum over other bodies; as it was where
    !> none is near.
    !@cuf attributes(host,device) &
    pure subroutine turn_normal(slope, normal)
        real(rk), intent(in) :: slope(3) !! [1/m]
        real(rk), intent(inout) :: normal(3)
        real(rk) :: length
        integer :: a

        length = sqrt(slope(1)*slope(1) + slope(2)*slope(2) + slope(3)*slope(3))
        if (.not. length > tiny(length)) return
        do a = 1, 3
            normal(a) = slope(a)/length
        end do
    end subroutine turn_normal
end module brz_contact_face
