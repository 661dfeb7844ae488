! SPDX-License-Identifier: MIT
!> Anisotropic spacing, particles wider in some directions than in others: a total-Lagrangian body
!> on a lattice that is mapped to one of cubes.
!>
!> With the spacings d_a of the layers and d their geometric mean, the lattice coordinates are
!> Y_a = X_a d/d_a, a map of determinant 1. A total-Lagrangian body may have any unloaded shape as
!> its reference: kernel, weights, corrections and tilts are those of Y, and dx/dY = dx/dX dX/dY
!> takes the place of dx/dX in them. x_ref of such a body holds Y. In the metric of the lattice are
!> further the artificial viscosity and the time step, and the hourglass force, whose stiffness for
!> displacements along axis a goes with d_a^2: bending by x z along the layers has the
!> displacement x^2/2 across them, which else would cost the square of the aspect times more.
!>
!> Source: docs/theory/plates.md
module brz_wide_lattice
    use brz_body, only: body_t
    use brz_body_shape, only: shape_t
    use brz_case, only: body_case_t, label
    use brz_errors, only: error_t, exit_deck, raise
    use brz_formulation_names, only: form_total
    use brz_hourglass_axes, only: lay_axes
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: settle_lattice, unloaded_place, is_wide

    real(rk), parameter :: usual_zeta = 0.02_rk !! of a body whose faces have tilted gradients

contains

    !> True where a body has wide particles.
    pure logical function is_wide(input)
        type(body_case_t), intent(in) :: input

        is_wide = any(input%aspect > 1)
    end function is_wide

    !> Lattice of a body with wide particles, or of a total-Lagrangian plate: its metric, and the
    !> axes and stiffness of its hourglass force.
    subroutine settle_lattice(input, material, shape, body, err)
        type(body_case_t), intent(in) :: input
        type(material_t), intent(in) :: material
        type(shape_t), intent(in) :: shape
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        real(dp) :: wide(3)
        integer :: a, n

        if (is_wide(input) .and. body%formulation /= form_total) call raise(err, exit_deck, &
            label('body', input%id, input%place)//'particles of unequal sides (aspect) need '// &
            "formulation='total_lagrangian'; take that, or leave aspect out")
        if (body%formulation /= form_total) return
        if (.not. is_wide(input) .and. index('xyz', trim(input%plate_axis)) == 0) return
        n = shape%dimension
        wide = 1
        if (is_wide(input)) wide(:n) = shape%spacing(:n)
        body%spacing = product(wide(:n))**(1/real(n, dp))
        if (.not. is_wide(input)) body%spacing = input%spacing
        if (is_wide(input)) body%stretch(:n) = body%spacing/wide(:n)
        body%h = real(input%smoothing*body%spacing, rk)
        body%at_rest = real(sum(body%stretch**2) - maxval(body%stretch)**2, rk)
        body%directional = .true.
        if (material%axial(1) > 0 .and. input%hourglass_axes) then
            call stiffen_plies(input, material, n, wide, body, err)
            return
        end if
        if (input%zeta < 0) body%zeta = usual_zeta
        allocate (body%axes(3, 4, 0:max(input%n_plies, 0)), source=0.0_rk)
        do a = 1, 3
            body%axes(a, a, :) = 1
            body%axes(a, 4, :) = body%zeta*material%shear
            if (a <= n) body%axes(a, 4, :) = body%axes(a, 4, :)* &
                                             real((wide(a)/maxval(wide(:n)))**2, rk)
        end do
    end subroutine settle_lattice

    !> Plies have a stiffness along the fibres that makes good what the sums miss of the bending of
    !> each layer about its own middle: K_x a_x^2 a_z^2 + 3/4 K_z a_x^4 = E dz^2/(12 m), with the
    !> widths a of a particle over those of a cube and m of brz_hourglass_axes.
    subroutine stiffen_plies(input, material, n, wide, body, err)
        type(body_case_t), intent(in) :: input
        type(material_t), intent(in) :: material
        integer, intent(in) :: n
        real(dp), intent(in) :: wide(3) !! spacings of the layers [m]
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        real(dp), parameter :: same = 0.05_dp
        real(dp) :: along
        integer :: across

        across = index('xyz', input%ply_axis)
        along = (sum(wide(:n)) - wide(across))/(n - 1)
        if (across > n .or. any(abs(wide(:n) - along) > same*along .and. &
                                [(across, across=1, n)] /= index('xyz', input%ply_axis))) then
            call raise(err, exit_deck, label('body', input%id, input%place)//'particles of '// &
                       'plies are as wide along x as along y, say, and ply_axis is across '// &
                       'them; change aspect')
            return
        end if
        across = index('xyz', input%ply_axis)
        body%normal = 0
        body%normal(across) = 1
        allocate (body%axes(3, 4, 0:max(input%n_plies, 0)))
        call lay_axes(body%zeta, material, input%ply_axis, &
                      real(input%ply_angle(:max(input%n_plies, 0))*acos(-1.0_dp)/180, rk), &
                      real(body%spacing/along*body%spacing/body%h, rk), .true., body%axes)
        body%axes(3, 4, :) = body%axes(3, 4, :)*real((wide(across)/along)**2, rk)
    end subroutine stiffen_plies

    !> Place of particle i of body b in the unloaded body [m].
    pure function unloaded_place(solid, b, i) result(x)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b, i
        real(dp) :: x(3)

        x = solid%x_ref(:, i)/solid%bodies(b)%stretch
    end function unloaded_place
end module brz_wide_lattice
