! SPDX-License-Identifier: MIT
!> Cohesive interfaces beside bodies of a single layer, which are seen in their middle: what lies
!> between that and the interface is part of its spring.
module brz_cohesive_layers
    use brz_body, only: body_t
    use brz_cohesive_law, only: slide_range
    use brz_kinds, only: dp, real32
    use brz_material, only: material_t
    use brz_ply_stress, only: p_g13, p_g23
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: add_layers, keep_energy

    real(dp), parameter :: most_held = 0.9_dp !! energy held at the strength over that of the mode

contains

    !> Stretch the openings of interface k by what its layers give, with the stiffness of the
    !> material. The usual stiffness has no part in it then.
    !>
    !> The shear stress falls to zero towards a face that is free, on a straight line: a layer that
    !> is glued on one side gives in shear as a third of it would.
    subroutine add_layers(solid, k, usual)
        class(interacting_bodies_t), intent(inout) :: solid
        integer, intent(in) :: k
        logical, intent(in) :: usual !! the deck gives no stiffness
        real(dp) :: across, along(3), share, mean, half, least, most
        integer :: b, s

        across = 0
        along = 0
        do s = 1, 2
            b = solid%cohesive%body(s, k)
            if (solid%bodies(b)%layer == 0) cycle
            associate (body => solid%bodies(b), m => solid%materials(solid%bodies(b)%material))
                share = 0.5_dp
                across = across + share*body%spacing/body%layer_stiffness(3)
                if (count(solid%cohesive%body == b) == 1) share = 1/3.0_dp
                along = along + share*body%spacing*shear_give(m, body, int(solid%ply(body%first)), &
                                                              solid%cohesive%facing(k))
            end associate
        end do
        if (.not. across > 0) return
        mean = (along(1) + along(2))/2
        half = norm2([(along(1) - along(2))/2, along(3)])
        associate (law => solid%cohesive%law(k))
            law%stretch(1) = stretch(across)
            least = stretch(mean + half)
            most = stretch(mean - half)
            law%stretch(2) = (least + most)/2
            if (half > 1e-9_dp*mean) law%skew = (least - most)/2*[(along(1) - along(2))/2, &
                                                                  along(3)]/half
        end associate

    contains

        !> Of an opening across what gives so much [m/Pa].
        pure real(dp) function stretch(give)
            real(dp), intent(in) :: give

            associate (stiffness => solid%cohesive%law(k)%stiffness)
                stretch = 1/sqrt(1 + stiffness*give)
                if (usual) stretch = min(1/sqrt(stiffness*give), 1.0_dp)
            end associate
        end function stretch
    end subroutine add_layers

    !> What a layer gives in shear across it, as a tensor in the tangents of a face: 11, 22, 12. A
    !> ply gives 1/G13 along its fibres and 1/G23 across them [1/Pa].
    pure function shear_give(m, body, ply, facing) result(give)
        type(material_t), intent(in) :: m
        type(body_t), intent(in) :: body
        integer, intent(in) :: ply !! of the layer
        integer, intent(in) :: facing !! normal of the faces, 0: not all the same
        real(dp) :: give(3)
        real(dp) :: f(2), along, across

        give = [1, 1, 0]/real(m%shear, dp)
        if (.not. body%directional) return
        along = 1/real(m%par(p_g13), dp)
        across = 1/real(m%par(p_g23), dp)
        give = [1, 1, 0]*(along + across)/2
        if (abs(facing) /= body%layer) return
        f(1) = body%axes(modulo(body%layer, 3) + 1, 1, ply)
        f(2) = body%axes(modulo(body%layer + 1, 3) + 1, 1, ply)*sign(1, facing)
        give = [1, 1, 0]*across + (along - across)*[f(1)*f(1), f(2)*f(2), f(1)*f(2)]
    end function shear_give

    !> Layers so thick that they hold more at the strength than the interface spends: they keep its
    !> energy, with a lower strength (Bazant and Oh 1983).
    subroutine keep_energy(solid, k)
        class(interacting_bodies_t), intent(inout) :: solid
        integer, intent(in) :: k
        character(7), parameter :: modes(2) = [character(7) :: 'opening', 'sliding']
        real(dp) :: most, least(2)
        integer :: m

        associate (law => solid%cohesive%law(k), b => solid%cohesive%body(:, k))
            if (all(solid%bodies(b)%layer == 0)) return
            least(1) = law%stretch(1)
            least(2) = minval(slide_range(law))
            do m = 1, 2
                most = least(m)*sqrt(2*most_held*law%stiffness*law%energy(m))
                if (law%strength(m) <= most) cycle
                solid%notes = solid%notes//"warning: between '"//trim(solid%bodies(b(1))%id)// &
                    "' and '"//trim(solid%bodies(b(2))%id)//"' the strength in "// &
                    trim(modes(m))//' is lowered from '//to_text(real(law%strength(m), real32))// &
                    ' to '//to_text(real(most, real32))//' Pa, or the layers would hold more '// &
                    'energy than the interface spends; it takes layers of at most '// &
                    to_text(real(solid%bodies(b(1))%spacing*(most/law%strength(m))**2, real32))// &
                    ' m'//new_line('a')
                law%strength(m) = most
            end do
        end associate
    end subroutine keep_energy
end module brz_cohesive_layers
