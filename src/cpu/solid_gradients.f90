! SPDX-License-Identifier: MIT
!> Pass 1: gradients of every particle, and its material over the step just made.
!>
!> Reads the neighbours' positions, velocities and volumes; writes the particle's own state and,
!> for pass 2, its row of `pair`.
module brz_solid_gradients
    use brz_algebra, only: copy_matrix, inverse3, multiply3, to_matrix
    use brz_body, only: body_t
    use brz_contact_face, only: strain_face
    use brz_face_layout, only: face_normal, face_past, face_strain
    use brz_face_stress, only: face_work
    use brz_formulation_names, only: form_bending, form_rigid, form_total, form_uncorrected
    use brz_gradient, only: correction, midstep_gradient, piola, stable_step, total_gradient
    use brz_hold_layout, only: control_affine, control_stiffness
    use brz_intact_share, only: intact_share
    use brz_kinds, only: dp, int64, int8, rk
    use brz_membrane, only: close_layer, face_power, lie_in_layer, open_faces, stay_in_layer, &
                              turn_layer
    use brz_material, only: class_elastic, point_t, secant_share, strength_left
    use brz_materials, only: unloaded_speed, update_material
    use brz_moment_layout, only: at_f, at_g, at_s, at_x, at_y, n_terms => n_sums
    use brz_motion_loop_bodies, only: fill_rigid_row
    use brz_pair_layout, only: pair_stress, pair_tilt
    use brz_particle_groups, only: lanes
    use brz_particle_marks, only: is_gone
    use brz_ply_axes, only: axes_matrix
    use brz_rigid_pose, only: pose_t, resting_pose
    use brz_row_loop_bodies, only: fill_control, fill_row, row_rules_t, rules_of, stiffen_along
    use brz_solid_bonds, only: add_bonded_gradients
    use brz_solid_gradient_sums, only: add_neighbours
    use brz_solid_arrays, only: group_of
    use brz_solid_diagnostics, only: record_material
    use brz_solid_lanes, only: lane_group_t, images_t, in_turn, most_images, place_body, &
                               place_group, place_images
    use brz_listed_bodies, only: listed_bodies_t
    use brz_tensile_control, only: deviation, kappa_of, may_be_in_tension
    use brz_threads, only: worth_threads
    use brz_one_sided_arm, only: tilted_correction
    implicit none
    private
    public :: gradient_pass

contains

    !> One pass over all particles that are active; with dt = 0 over all, nothing is updated and
    !> only `pair` is written.
    subroutine gradient_pass(solid, dt)
        class(listed_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        integer :: k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static)
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                solid%search%limit(k) = body%dt_limit
                solid%search%sums(:, k) = 0
                solid%search%bad(k) = 0
                if (body%inactive .and. dt > 0) cycle
                solid%search%limit(k) = huge(dt)
                solid%search%in_tension(k) = .false.
                call gradient_block(solid, body, dt, k)
            end associate
        end do
        solid%bodies%dt_limit = huge(dt)
        solid%bodies%in_tension = .false.
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                body%dt_limit = min(body%dt_limit, solid%search%limit(k))
                body%in_tension = body%in_tension .or. solid%search%in_tension(k)
            end associate
        end do
        solid%dt_limit = minval(solid%bodies%dt_limit)
        if (dt > 0) call record_material(solid)
    end subroutine gradient_pass

    subroutine gradient_block(solid, body, dt, k)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: dt
        integer, intent(in) :: k !! block
        type(lane_group_t) :: p
        type(row_rules_t) :: rules
        real(rk) :: group(lanes, n_terms), sums(n_terms)
        type(pose_t) :: pose
        integer :: i, first

        if (body%formulation == form_rigid) then
            pose = resting_pose(body%rigid)
            do i = solid%block(2, k), solid%block(3, k) ! contact and bonds read these rows
                call fill_rigid_row(1, i, 1, pose, solid%volume, solid%pair)
            end do
            return ! its time step: rigid_step of brz_rigid_motion
        end if
        call place_body(solid, body, p)
        rules = rules_of(body, solid%materials(body%material))
        do first = solid%block(2, k), solid%block(3, k), lanes
            if (solid%fixed(first) == is_gone) exit ! and so are all that follow
            call place_group(solid, body, first, p)
            call tilt_group(solid, body, p)
            call find_tension(solid, body, p)
            call sum_group(solid, body, p, group)
            do i = first, p%last
                if (solid%fixed(i) == is_gone) cycle
                sums = group(i - first + 1, :)
                solid%pair(pair_tilt, i) = p%tilt(i - first + 1)
                if (solid%links%bonds) call add_bonded_gradients(solid, i, sums)
                call advance(solid, body, rules, dt, i, k, p%in_tension(i - first + 1), sums)
            end do
        end do
    end subroutine gradient_block

    !> Tilts of a group: none once a particle has lost its support or its strength.
    pure subroutine tilt_group(solid, body, p)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(lane_group_t), intent(inout) :: p
        integer :: fails, i, l

        p%tilt = 0
        if (.not. any(body%normal > 0)) return
        fails = solid%materials(body%material)%fails
        do l = 1, lanes
            i = min(p%i + l - 1, p%last)
            if (solid%unsupported(i) /= 0 .or. strength_left(fails, solid%damage(i)) <= &
                intact_share) cycle
            p%tilt(l) = solid%tilt(i)
        end do
    end subroutine tilt_group

    !> Which of a group may need the tensile control: what was in tension before the step.
    pure subroutine find_tension(solid, body, p)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(lane_group_t), intent(inout) :: p
        integer :: l

        p%in_tension = .false.
        if (.not. body%tensile_control > 0) return
        do l = 1, p%last - p%i + 1
            p%in_tension(l) = may_be_in_tension(solid%stress(:, p%i + l - 1))
        end do
    end subroutine find_tension

    !> Sums over the neighbours of a group and over their images, one after the other.
    subroutine sum_group(solid, body, p, sums)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(lane_group_t), intent(inout) :: p
        real(rk), intent(out) :: sums(lanes, n_terms)
        type(images_t) :: images
        integer(int64) :: k, last
        integer :: g

        sums = 0
        call add_neighbours(p, solid%x, solid%v, solid%x_ref, solid%volume, solid%h, &
                            solid%list(p%list), sums)
        if (.not. any(solid%mirror)) return
        g = group_of(body, p%i)
        do k = solid%image_first(g), solid%image_first(g + 1) - 1, most_images
            last = min(k + most_images, solid%image_first(g + 1)) - 1
            call place_images(solid, k, last, images)
            p%count = int(last - k) + 1
            call add_neighbours(p, images%x, images%v, images%x_ref, images%volume, images%h, &
                                in_turn, sums)
        end do
    end subroutine sum_group

    !> From the sums to the new state of particle i and its row of `pair`.
    subroutine advance(solid, body, rules, dt, i, k, in_tension, sums)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        type(row_rules_t), intent(in) :: rules !! of the body
        real(dp), intent(in) :: dt
        integer, intent(in) :: i, k !! particle and its block
        logical, intent(in) :: in_tension !! it was in tension
        real(rk), intent(inout) :: sums(n_terms)
        real(rk) :: a(3, 3), b(3, 3), h(3, 3), l(3, 3), s(3, 3), f(3, 3), c_wave, c_bulk, rho
        real(rk) :: shrink, size, normal(3)
        integer :: weak, weaker, c, unsupported
        logical :: tilted !! a gradient with arms of their own

        do c = solid%dimension + 1, 3
            sums(c) = 1
            sums(at_x + 4*c - 3) = 1
            sums(at_s + c) = 1
            sums(at_y + 4*c - 3) = 1
            sums(at_f + 4*c - 3) = 1
        end do
        if (body%layer > 0) call close_layer(body%layer, sums, sums(at_x + 1), normal)
        if (body%formulation == form_uncorrected) then
            weak = 0
            b = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
        else
            call correction(solid%dimension, sums, b, weak)
        end if
        call multiply3(sums(at_x + 1), b, a)
        f = a
        tilted = abs(solid%pair(pair_tilt, i)) > 0
        if (tilted) then
            call tilted_correction(solid%dimension, sums(at_y + 1), b, weaker)
            weak = max(weak, weaker)
            call multiply3(sums(at_f + 1), b, f)
        end if
        call multiply3(sums(at_g + 1), b, h)
        if (body%layer > 0) then
            call lie_in_layer(normal, b)
            call turn_faces(solid, body, i, dt, normal, h)
        end if
        shrink = 1
        if (body%formulation == form_total) call total_gradient(body%at_rest, f, h, shrink)
        c_wave = solid%materials(body%material)%c_wave
        c_bulk = unloaded_speed(solid%materials(body%material))
        if (dt > 0) then
            call midstep_gradient(h, real(dt, rk), l)
            if (body%layer > 0) call free_faces(solid, i, real(dt/2, rk), b, h)
            call update_particle(solid, body, real(dt, rk), l, i, k, c_wave, c_bulk)
            if (body%layer > 0) call free_faces(solid, i, real(dt/2, rk), b, h)
        end if
        size = body%h
        if (body%variable) size = solid%h(i)
        solid%search%limit(k) = min(solid%search%limit(k), &
                                    real(stable_step(body%cfl, size, shrink*c_wave, shrink*c_bulk, &
                                                     body%alpha, body%beta, h), dp))
        rho = solid%materials(body%material)%density*(1 + solid%mu(i))
        if (allocated(solid%face_stress)) call record_face(solid, body, dt, i, k, rho, h)
        call working_stress(solid, body, i, dt > 0, rho, f, s)
        if (tilted) b = transpose(b)
        call multiply3(s, b, solid%pair(pair_stress + 1, i))
        if (body%layer > 0) call stay_in_layer(b, solid%pair(pair_stress + 1, i))
        if (solid%links%faces) &
            call move_face(solid, body, i, real(dt, rk), rho, f, b, h)
        if (weak /= 0 .and. (body%formulation == form_bending .or. body%tensile_control > 0 .or. &
                             body%formulation == form_total)) solid%unsupported(i) = 1
        unsupported = solid%unsupported(i)
        call fill_row(rules, h, a, rho, c_bulk, solid%volume(i), 0.0_rk, solid%stress(:, i), &
                      strength_left(solid%materials(body%material)%fails, solid%damage(i)), &
                      unsupported, solid%pair(:, i))
        solid%unsupported(i) = int(unsupported, int8)
        if (body%directional) call stiffen_along(body%axes(:, :, solid%ply(i)), left_of( &
            solid, body, i), solid%k_axes(:, i), solid%pair(:, i))
        if (.not. body%tensile_control > 0) return
        call hold_particle(solid, body, i, in_tension, a, sums(at_s + 1:at_y), &
                           sum(sums(:solid%dimension)))
        if (solid%control(control_stiffness, i) > 0) solid%search%in_tension(k) = .true.
    end subroutine advance

    !> Record the work of the stress that a load brings to faces: it is work of the load. The air
    !> pays that on the velocity of its surface cells, which lies as deep as its load, and no more:
    !> the rest is taken out of the energy of the layer above.
    pure subroutine record_face(solid, body, dt, i, k, rho, h)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: dt
        integer, intent(in) :: i, k !! particle and its block
        real(rk), intent(in) :: rho, h(3, 3) !! [kg/m3], velocity gradient [1/s]
        real(dp) :: work !! of its mass [J/kg]

        work = dt*body%face_share*face_work(solid%face_stress(:, i), h)/rho
        if (allocated(solid%loads%of)) then
            solid%search%sums(4, k) = solid%search%sums(4, k) + work*solid%mass(i)
        else
            solid%energy(i) = real(solid%energy(i) - work, rk)
        end if
    end subroutine record_face

    !> The stress that acts along the arms of the pairs, less what the load brings by the faces.
    pure subroutine working_stress(solid, body, i, loaded, rho, f, s)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        logical, intent(in) :: loaded !! after a step; before the first one no load has acted
        real(rk), intent(in) :: rho, f(3, 3) !! [kg/m3], dx/dX of a total-Lagrangian body
        real(rk), intent(out) :: s(3, 3) !! [Pa]

        if (loaded .and. allocated(solid%face_stress)) then
            call to_matrix(solid%stress(:, i) - body%face_share*solid%face_stress(:, i), s)
        else
            call to_matrix(solid%stress(:, i), s)
        end if
        call put_to_work(solid, body, i, rho, f, s)
    end subroutine working_stress

    !> From Cauchy's stress to that which acts along the arms of the pairs: Piola's; else it works
    !> on the present volume, while the weights of the pairs have the last one.
    pure subroutine put_to_work(solid, body, i, rho, f, s)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        real(rk), intent(in) :: rho, f(3, 3) !! see working_stress
        real(rk), intent(inout) :: s(3, 3) !! [Pa]

        if (body%formulation == form_total) then
            call piola(f, s)
        else
            s = s*(solid%mass(i)/(rho*solid%volume(i)))
        end if
    end subroutine put_to_work

    !> Strain the half layer at the face of a particle that may touch others.
    subroutine move_face(solid, body, i, dt, rho, f, b, h)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        real(rk), intent(in) :: dt, rho !! [s], [kg/m3]
        real(rk), intent(in) :: f(3, 3), b(3, 3), h(3, 3) !! see working_stress, correction
        real(rk) :: normal(3), s(3, 3), along(3, 3), reach
        integer :: a

        associate (row => solid%links%row(i), face => solid%links%face(:, i))
            if (row == 0) return
            normal = face(face_normal + 1:face_normal + 3)
            do a = 1, 3
                s(:, a) = normal*normal(a)
            end do
            call put_to_work(solid, body, i, rho, f, s)
            call multiply3(s, b, along)
            reach = 0
            if (solid%unsupported(i) == 0) reach = body%face_share*real(body%spacing, rk)
            call strain_face(dt, h, normal, along, reach, solid%mass(i)/rho, face(face_strain), &
                             face(face_past), solid%links%press(6:8, row))
        end associate
    end subroutine move_face

    !> Share of the stiffness of the hourglass force along axes that plastic strain leaves.
    pure real(rk) function left_of(solid, body, i) result(share)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i

        share = 1
        associate (yields => solid%materials(body%material)%yields)
            if (yields > 0) share = secant_share(yields, solid%hist(1, i))
        end associate
    end function left_of

    !> The tensile control of particle i: nothing where it was not in tension or has lost its
    !> support.
    subroutine hold_particle(solid, body, i, in_tension, a, s, trace)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        logical, intent(in) :: in_tension
        real(rk), intent(in) :: a(3, 3) !! dX/dx
        real(rk), intent(in) :: s(6), trace !! see deviation
        real(rk) :: f(3, 3), q, mu, there
        logical :: ok

        q = 0
        f = 0
        there = 0
        if (in_tension .and. solid%unsupported(i) == 0) then
            call inverse3(a, f, ok)
            if (.not. ok) solid%unsupported(i) = 1
        end if
        if (in_tension .and. solid%unsupported(i) == 0) then
            q = deviation(solid%dimension, f, s, trace)
            there = trace
        end if
        mu = solid%mu(i)
        if (solid%materials(body%material)%class == class_elastic) mu = 0
        call copy_matrix(f, solid%control(control_affine + 1, i))
        call fill_control(kappa_of(body%tensile_control, body%lift, solid%pair(pair_tilt, i)), &
                       solid%stress(:, i), mu, q, there, solid%volume(i), &
                       int(solid%unsupported(i)), solid%control(:, i))
    end subroutine hold_particle

    !> The velocity gradient across a layer: its faces are free of stress at the end of the step.
    pure subroutine turn_faces(solid, body, i, dt, normal, h)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        real(dp), intent(in) :: dt !! [s]
        real(rk), intent(in) :: normal(3)
        real(rk), intent(inout) :: h(3, 3)
        real(rk) :: axes(3, 3), turned(3), gap(3)

        turned = 0 ! no turn
        if (body%layer_of_ply) turned = solid%hist(:3, i)
        call axes_matrix(turned, axes)
        call open_faces(body%layer_stiffness, axes, normal, solid%stress(:, i), gap)
        call turn_layer(body%contraction, normal, gap, &
                        real(merge(1/max(dt, tiny(dt)), 0.0_dp, dt > 0), rk), h)
    end subroutine turn_faces

    !> Take out of the energy what the stress does on the faces of a layer.
    pure subroutine free_faces(solid, i, time, b, h)
        type(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: i
        real(rk), intent(in) :: time, b(3, 3), h(3, 3) !! [s]; see face_power

        solid%energy(i) = solid%energy(i) - time*face_power(b, h, solid%stress(:, i)) &
                          *solid%volume(i)/solid%mass(i)
    end subroutine free_faces

    !> Material update of particle i; its work goes to the sums of the block.
    subroutine update_particle(solid, body, dt, l, i, k, c_wave, c_bulk)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(rk), intent(in) :: dt, l(3, 3)
        integer, intent(in) :: i, k
        real(rk), intent(inout) :: c_wave, c_bulk !! fastest wave, sound speed [m/s]
        type(point_t) :: point
        integer :: status

        point%mu = solid%mu(i)
        point%energy = solid%energy(i)
        point%stress = solid%stress(:, i)
        point%damage = solid%damage(i)
        point%c_wave = c_wave
        point%c_bulk = c_bulk
        point%work = 0
        point%hist(:solid%n_hist) = solid%hist(:, i)
        call update_material(solid%materials(body%material), dt, body%crack, l, point, status)
        if (status > 0 .and. solid%search%bad(k) == 0) solid%search%bad(k) = i
        if (status < 0) solid%search%sums(3, k) = solid%search%sums(3, k) + 1
        solid%mu(i) = point%mu
        solid%energy(i) = point%energy
        solid%stress(:, i) = point%stress
        solid%damage(i) = point%damage
        c_wave = point%c_wave
        c_bulk = point%c_bulk
        solid%hist(:, i) = point%hist(:solid%n_hist)
        solid%search%sums(1, k) = solid%search%sums(1, k) + point%work(1)*solid%mass(i)
        solid%search%sums(2, k) = solid%search%sums(2, k) + point%work(2)*solid%mass(i)
    end subroutine update_particle
end module brz_solid_gradients
