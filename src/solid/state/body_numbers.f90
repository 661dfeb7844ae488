! SPDX-License-Identifier: MIT
!> The numbers of a body that loops over its particles read.
module brz_body_numbers
    use brz_formulation_names, only: artificial_none, form_bending
    use brz_kinds, only: rk
    implicit none
    private
    public :: body_numbers_t

    !> What of a body pairs and gradients need, which a GPU is told as it is.
    type :: body_numbers_t
        integer :: first = 1, last = 0 !! particles; ahead of all others
        integer :: formulation = form_bending
        integer :: artificial = artificial_none !! artificial stress, see brz_artificial_stress
        integer :: layer = 0 !! normal of a body of a single layer that is a membrane; 0: none
        real(rk) :: h = 0 !! smoothing length of the unloaded body [m]
        real(rk) :: h_range(2) = 1 !! bounds over h, where it follows the density
        real(rk) :: crack = 0 !! width of a smeared crack, over which a fracture energy is spent [m]
        real(rk) :: alpha = 1, beta = 2 !! of the viscosity
        real(rk) :: cfl = 0.4_rk
        real(rk) :: tensile_control = 0 !! stiffness of the tensile control over the tension, 0: no
                                        !! tensile control
        real(rk) :: artificial_power = 0
        real(rk) :: shape_at_spacing = 1 !! W(dx)/W(0)
        real(rk) :: at_rest = 2 !! sum of the squares of the two smaller parts of `stretch`
        real(rk) :: normal(3) = 0 !! of its plies, or of a plate of metal, in the unloaded body;
                                  !! 0: no tilted gradients
        real(rk) :: lift = 0 !! of its faces over their tilt, see brz_one_sided_arm
        real(rk) :: layer_stiffness(9) = 0 !! C11, C22, C33, C12, C23, C13, G12, G23, G13 [Pa]
        real(rk) :: contraction = 0 !! along the normal over the growth of the area
        real(rk) :: face_share = 0 !! of the stress of loaded faces, see brz_face_stress; 0: none
    end type body_numbers_t
end module brz_body_numbers
