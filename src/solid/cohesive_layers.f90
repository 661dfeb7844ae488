! SPDX-License-Identifier: MIT
!> Cohesive interfaces beside bodies of a single layer, which are seen in their middle: what lies
!> between that and the interface is part of its spring.
module brz_cohesive_layers
    use brz_kinds, only: dp, real32
    use brz_material, only: material_t
    use brz_ply_stress, only: p_g13, p_g23
    use brz_solid_state, only: body_t, solid_t
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
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: k
        logical, intent(in) :: usual !! the deck gives no stiffness
        real(dp) :: give(2), share(2) !! [m/Pa]
        integer :: b, s

        give = 0
        do s = 1, 2
            b = solid%cohesive%body(s, k)
            if (solid%bodies(b)%layer == 0) cycle
            share = 0.5_dp
            if (count(solid%cohesive%body == b) == 1) share(2) = 1/3.0_dp
            give = give + share*solid%bodies(b)%spacing/stiffness_of( &
                solid%materials(solid%bodies(b)%material), solid%bodies(b))
        end do
        if (.not. any(give > 0)) return
        associate (law => solid%cohesive%law(k))
            law%stretch = 1/sqrt(1 + law%stiffness*give)
            if (usual) law%stretch = min(1/sqrt(law%stiffness*give), 1.0_dp)
        end associate
    end subroutine add_layers

    !> Stiffness of a layer across it, and in shear: of a ply the mean of both directions, which is
    !> that of plies that cross [Pa].
    pure function stiffness_of(m, body) result(stiffness)
        type(material_t), intent(in) :: m
        type(body_t), intent(in) :: body
        real(dp) :: stiffness(2)

        stiffness = [body%across_layer, m%shear]
        if (body%directional) stiffness(2) = 2/(1/real(m%par(p_g13), dp) + 1/real(m%par(p_g23), dp))
    end function stiffness_of

    !> Layers so thick that they hold more at the strength than the interface spends: they keep its
    !> energy, with a lower strength (Bazant and Oh 1983).
    subroutine keep_energy(solid, k)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: k
        character(7), parameter :: modes(2) = [character(7) :: 'opening', 'sliding']
        real(dp) :: most
        integer :: m

        associate (law => solid%cohesive%law(k), b => solid%cohesive%body(:, k))
            if (all(solid%bodies(b)%layer == 0)) return
            do m = 1, 2
                most = law%stretch(m)*sqrt(2*most_held*law%stiffness*law%energy(m))
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
