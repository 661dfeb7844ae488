! SPDX-License-Identifier: MIT
!> Which bodies are a single layer of particles, and what that takes: brz_membrane.
module brz_layer_setup
    use brz_body, only: body_t
    use brz_body_shape, only: shape_t
    use brz_case, only: case_t
    use brz_formulation_names, only: form_bending
    use brz_hourglass_axes, only: fourth_moment, lay_layer_axes
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t
    use brz_ply_stress, only: p_c11, p_c13, p_c23, p_c33, p_g12, p_g13, p_g23
    use brz_thin_bodies, only: is_bonded
    implicit none
    private
    public :: settle_layer

contains

    !> Make body b a membrane if it is a box of one layer in 'bending' that no bond makes thicker,
    !> with its plies in the layer.
    subroutine settle_layer(case, b, shape, material, body)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b
        type(shape_t), intent(in) :: shape
        type(material_t), intent(in) :: material
        type(body_t), intent(inout) :: body
        real(rk) :: young
        integer :: axis

        if (body%formulation /= form_bending .or. case%bodies(b)%shape /= 'box') return
        associate (d => shape%dimension)
            if (count(shape%n(:d) == 1) /= 1 .or. d == 1) return
            axis = findloc(shape%n(:d), 1, 1)
        end associate
        if (material%axial(1) > 0 .and. index('xyz', case%bodies(b)%ply_axis) /= axis) return
        if (shape%on_plane(axis)) return
        if (is_bonded(case, b)) return
        body%layer = axis
        body%normal = 0 ! nothing is tilted
        body%face_share = 0 ! it has no stress across
        call set_elastic(material, body)
        if (body%directional) then
            call lay_layer_axes(body%zeta, material, case%bodies(b)%ply_axis, angles(case, b), &
                                shape%dimension, real(body%spacing, rk), body%h, body%axes)
        else if (case%bodies(b)%zeta < 0) then
            associate (k => material%bulk, g => material%shear)
                young = 4*g*(3*k + g)/(3*k + 4*g) ! E/(1 - nu^2)
                body%zeta = max(1.0_rk, young*real(body%spacing, rk)**2/(3*g*fourth_moment( &
                    shape%dimension, real(body%spacing, rk), body%h)))
            end associate
        end if
    end subroutine settle_layer

    !> Stiffness of the intact material, and its contraction; of plies in their plane.
    pure subroutine set_elastic(material, body)
        type(material_t), intent(in) :: material
        type(body_t), intent(inout) :: body

        associate (k => material%bulk, g => material%shear)
            body%layer_stiffness(1:3) = k + 4*g/3
            body%layer_stiffness(4:6) = k - 2*g/3
            body%layer_stiffness(7:9) = g
            body%contraction = (k - 2*g/3)/(k + 4*g/3)
        end associate
        if (.not. all(material%axial > 0)) return
        body%layer_of_ply = .true.
        body%layer_stiffness = material%par([p_c11, p_c11 + 1, p_c33, p_c33 + 1, p_c23, p_c13, &
                                             p_g12, p_g23, p_g13])
        body%contraction = (material%par(p_c13) + material%par(p_c23))/2/material%par(p_c33)
    end subroutine set_elastic

    !> Angles of the plies of a body [rad].
    pure function angles(case, b)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b
        real(rk), allocatable :: angles(:)

        associate (n => max(case%bodies(b)%n_plies, 0))
            angles = real(case%bodies(b)%ply_angle(:n)*acos(-1.0_dp)/180, rk)
        end associate
    end function angles
end module brz_layer_setup
