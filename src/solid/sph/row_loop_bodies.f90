! SPDX-License-Identifier: MIT
!> Between the passes: what pass 2 gathers of a particle, from its gradients and its stress.
module brz_row_loop_bodies
    use brz_algebra, only: copy_matrix, inverse3, multiply3, to_matrix
    use brz_artificial_stress, only: artificial_stress
    use brz_body, only: body_t
    use brz_contact_face, only: strain_face
    use brz_face_layout, only: face_normal, face_past, face_strain
    use brz_formulation_names, only: artificial_none, form_bending, form_corrected_hourglass, &
        form_total
    use brz_gradient, only: piola, shear_limiter
    use brz_hold_layout, only: control_affine, control_energy, control_stiffness, control_whole, &
        n_control
    use brz_kinds, only: int32, real32, rk
    use brz_link_layout, only: n_press
    use brz_membrane, only: face_power
    use brz_material, only: material_t
    use brz_pair_force, only: axial_stiffness
    use brz_pair_layout, only: n_pair, pair_affine, pair_keep, pair_linear, pair_quadratic, &
        pair_stress, pair_tilt, pair_volume, pair_zeta
    use brz_tensile_control, only: stiffness_of_control
    implicit none
    private
    public :: row_rules_t, rules_of, fill_row, stiffen_along, fill_control, free_face, move_face

    real(rk), parameter :: most_stretch = 1e6_rk !! no particle is drawn so far and control

    !> What is the same for all particles of a body.
    type :: row_rules_t
        integer :: formulation, limiter, artificial
        integer :: directional !! 1: the hourglass stiffness has axes
        real(rk) :: h, alpha, beta !! smoothing length [m], artificial viscosity
        real(rk) :: stiffness !! of the hourglass force, without axes [Pa]
        real(rk) :: zeta_viscous, artificial_strength
    end type row_rules_t

contains

    !> The rules of a body.
    pure function rules_of(body, material) result(rules)
        type(body_t), intent(in) :: body
        type(material_t), intent(in) :: material
        type(row_rules_t) :: rules

        rules%formulation = body%formulation
        rules%limiter = body%limiter
        rules%artificial = body%artificial
        rules%directional = merge(1, 0, body%directional)
        rules%h = body%h
        rules%alpha = body%alpha
        rules%beta = body%beta
        rules%stiffness = body%zeta*material%shear
        rules%zeta_viscous = body%zeta_viscous
        rules%artificial_strength = body%artificial_strength
    end function rules_of

    !> The row of a particle but for its stress and its tilt, which is there. Where a body has axes,
    !> the affine slots hold dx/dX alone, and stiffen_along must follow.
    !@cuf attributes(host,device) &
    pure subroutine fill_row(rules, h, a, rho, c_bulk, volume, mass, stress, strength, &
    unsupported, row)
        type(row_rules_t), intent(in) :: rules
        real(rk), intent(in) :: h(3, 3) !! velocity gradient [1/s]
        real(rk), intent(in) :: a(3, 3) !! 'bending': dX/dx; 'total_lagrangian': dx/dX
        real(rk), intent(in) :: rho, c_bulk !! [kg/m3], sound speed in the viscosity [m/s]
        real(rk), intent(in) :: volume, mass !! [m3]; what an artificial stress keeps in its slot
        real(rk), intent(in) :: stress(6), strength !! [Pa]; share that is left
        integer, intent(inout) :: unsupported !! 1: no stiff hourglass force any more
        real(rk), intent(inout) :: row(n_pair)
        real(rk) :: q(3, 3), z
        integer :: c, j

        z = shear_limiter(rules%limiter, h, c_bulk/rules%h)
        row(pair_volume) = volume
        row(pair_linear) = z*rules%alpha*rho*c_bulk/2
        row(pair_quadratic) = z*rules%beta*rho/2
        row(pair_keep) = strength
        z = 0
        call copy_matrix(h, q)
        if (rules%formulation == form_bending .or. rules%formulation == form_total) then
            call copy_matrix(a, q)
            if (rules%formulation == form_bending) call deformation(a, unsupported, q)
            z = rules%stiffness
            row(pair_keep) = strength*(1 - unsupported)
            if (rules%directional == 0) then
                do j = 1, 3
                    do c = 1, 3
                        q(c, j) = z*q(c, j)
                    end do
                end do
            end if
        else if (rules%formulation == form_corrected_hourglass) then
            ! a tilted gradient would exert a torque
            if (.not. abs(row(pair_tilt)) > 0) z = rules%zeta_viscous*rules%h*rho*c_bulk
        else if (rules%artificial /= artificial_none) then
            call artificial_stress(rules%artificial, rules%artificial_strength, rho, stress, q)
            z = mass
        end if
        row(pair_zeta) = z
        call copy_matrix(q, row(pair_affine + 1))
    end subroutine fill_row

    !> Deformation dx/dX from dX/dx of a particle that is control to the unloaded body, else
    !> nothing. Debris with a single neighbour at the edge of its support has a dX/dx near zero,
    !> whose inverse, squared, is no number in real32.
    !@cuf attributes(host,device) &
    pure subroutine deformation(a, unsupported, q)
        real(rk), intent(in) :: a(3, 3)
        integer, intent(inout) :: unsupported !! 1: not control, or not any more
        real(rk), intent(inout) :: q(3, 3)
        logical :: ok
        integer :: c, j

        call inverse3(a, q, ok)
        do j = 1, 3
            do c = 1, 3
                if (.not. abs(q(c, j)) < most_stretch) ok = .false.
            end do
        end do
        if (.not. ok) unsupported = 1
        if (unsupported == 0) return
        do j = 1, 3
            do c = 1, 3
                q(c, j) = 0
            end do
        end do
    end subroutine deformation

    !> Stiffness of the hourglass force along axes times the deformation dx/dX in the row. Where a
    !> metal has yielded it is a share of that of the axes: what keeps a layer from bending about
    !> its own middle bears no more than the metal.
    !@cuf attributes(host,device) &
    pure subroutine stiffen_along(axes, share, k_axes, row)
        real(rk), intent(in) :: axes(3, 4) !! of the ply; the last column: stiffness along each [Pa]
        real(rk), intent(in) :: share !! secant_share of brz_material
        real(real32), intent(inout) :: k_axes(6) !! [Pa]
        real(rk), intent(inout) :: row(n_pair)
        real(rk) :: along(6), f(3, 3), g(3, 3), k(3, 3)
        integer :: c

        call copy_matrix(row(pair_affine + 1), f)
        call axial_stiffness(axes(1, 4), axes, f, along)
        do c = 1, 6
            k_axes(c) = real(share*along(c), real32)
            along(c) = k_axes(c) ! as the pairs see it: no torque
        end do
        call to_matrix(along, k)
        call multiply3(k, f, g)
        call copy_matrix(g, row(pair_affine + 1))
    end subroutine stiffen_along

    !> The tensile control of a particle whose F is in its slots: nothing where it was not in
    !> tension or has lost its support, where `trace` is 0.
    !@cuf attributes(host,device) &
    pure subroutine fill_control(tensile_control, stress, mu, q, trace, volume, unsupported, &
    control)
        real(rk), intent(in) :: tensile_control, stress(6) !! [-], [Pa]
        real(rk), intent(in) :: mu !! compression, 0 of a material of springs
        real(rk), intent(in) :: q, trace !! see deviation of brz_tensile_control
        real(rk), intent(in) :: volume !! [m3]
        integer, intent(in) :: unsupported
        real(rk), intent(inout) :: control(n_control)
        real(rk) :: k
        integer :: c

        k = 0
        if (trace > 0) k = stiffness_of_control(tensile_control, stress, mu, q/trace)
        control(control_stiffness) = k
        do c = 1, 9
            control(control_affine + c) = k*control(control_affine + c)
        end do
        control(control_energy) = volume*k*q/2
        control(control_whole) = 1 - unsupported
    end subroutine fill_control

    !> Take out of the energy what the stress does on the faces of a single layer.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine free_face(p, first, rows, step_v, time, row, grad, stress, volume, mass, energy)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: rows, step_v !! of columns; distance of volumes
        real(rk), intent(in) :: time !! [s]
        real(rk), intent(in) :: row(n_pair, *), grad(rows, 9), stress(rows, 6), volume(*), mass(*)
        real(rk), intent(inout) :: energy(*)
        real(rk) :: b(3, 3), h(3, 3), s(6)
        integer :: c, i, j

        i = first - 1 + p
        call copy_matrix(row(pair_stress + 1, i), b)
        do j = 1, 3
            do c = 1, 3
                h(c, j) = grad(i, c + 3*(j - 1))
            end do
        end do
        do c = 1, 6
            s(c) = stress(i, c)
        end do
        energy(i) = energy(i) - time*face_power(b, h, s)*volume(1 + (i - 1)*step_v)/mass(i)
    end subroutine free_face

    !> Strain the half layer at the face of a particle that may touch others.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine move_face(p, first, rows, step_v, total, tilted, dt, density, reach, count, &
                              unsupported, row, grad, mu, volume, mass, face, press)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: rows, step_v !! of columns; distance of volumes
        integer, intent(in) :: total, tilted !! 1: total-Lagrangian; with gradients by tilted arms
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        real(rk), intent(in) :: density !! unloaded [kg/m3]
        real(rk), intent(in) :: reach !! of the face, see strain_face [m]
        integer(int32), intent(in) :: count(*), unsupported(*)
        real(rk), intent(in) :: row(n_pair, *), grad(rows, *), mu(*), volume(*), mass(*)
        real(real32), intent(inout) :: face(rows, *) !! see brz_contact_face
        real(rk), intent(inout) :: press(n_press, *) !! see links_t
        real(rk) :: b(3, 3), h(3, 3), f(3, 3), s(3, 3), along(3, 3), normal(3), rho
        integer :: c, i, j

        i = first - 1 + p
        if (count(i) == 0) return
        rho = density*(1 + mu(i))
        do c = 1, 3
            normal(c) = face(i, face_normal + c)
        end do
        call copy_matrix(row(pair_stress + 1, i), b)
        call copy_matrix(row(pair_affine + 1, i), f)
        do j = 1, 3
            do c = 1, 3
                h(c, j) = grad(i, c + 3*(j - 1))
                s(c, j) = normal(c)*normal(j)
                if (tilted == 1) f(c, j) = grad(i, 9 + c + 3*(j - 1))
            end do
        end do
        if (total == 1) then
            call piola(f, s)
        else
            do j = 1, 3
                do c = 1, 3
                    s(c, j) = s(c, j)*(mass(i)/(rho*volume(1 + (i - 1)*step_v)))
                end do
            end do
        end if
        call multiply3(s, b, along)
        call strain_face(dt, h, normal, along, merge(reach, 0.0_rk, unsupported(i) == 0), &
                         mass(i)/rho, face(i, face_strain), face(i, face_past), press(6, i))
    end subroutine move_face
end module brz_row_loop_bodies
