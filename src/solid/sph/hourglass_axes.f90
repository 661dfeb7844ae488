! SPDX-License-Identifier: MIT
!> Hourglass control in a laminate: axes and stiffness of the stiff hourglass force.
!>
!> The hourglass energy of a bent plate, u = -k x z, w = k x^2/2, is (K_x + 3/4 K_z) m k^2/2 per
!> volume, with m = 4/15 h^2 the fourth moment of the weights. It makes good what the sums over
!> layers miss of the bending energy: the second moment of each layer about its own middle,
!> E_ply dz^2/12 k^2/2. So K_x + 3/4 K_z = E_ply dz^2/(12 m). K_z = G/2 is what a body needs to stay
!> whole: it bears a tension of 0.8 K. (In two dimensions a laminate that lies in the plane bends
!> edgewise and has no tilted gradients: there the force also makes good what its outermost
!> particles lose, which see the strain of a place deeper; this goes with the modulus of the outer
!> plies.)
!>
!> Source: docs/theory/plates.md
module brz_hourglass_axes
    use brz_kernel, only: kernel_scale, kernel_slope
    use brz_kinds, only: rk
    use brz_material, only: material_t
    implicit none
    private
    public :: fourth_moment, lay_axes, lay_layer_axes

    real(rk), parameter :: moment = 4.0_rk/15 !! m/h^2
    real(rk), parameter :: edge = 1.25_rk !! own share and that of the outermost particles together
    real(rk), parameter :: least = 0.5_rk, least_edge = 2 !! K_z/G

contains

    !> Axes (columns 1 to 3) and the stiffness along each (column 4) of plies 0.., 0 being a body
    !> without plies.
    pure subroutine lay_axes(zeta, material, axis, angles, layer, tilted, axes)
        real(rk), intent(in) :: zeta !! over 2: factor of it all
        type(material_t), intent(in) :: material
        character(1), intent(in) :: axis !! stacking axis 'x', 'y', 'z'
        real(rk), intent(in) :: angles(:) !! of the fibres of each ply, right-handed about it [rad]
        real(rk), intent(in) :: layer !! spacing over smoothing length
        logical, intent(in) :: tilted !! gradients are right in the outermost layers
        real(rk), intent(out) :: axes(3, 4, 0:size(angles)) !! column 4 [Pa]
        real(rk) :: outer(3), own, lost, normal
        integer :: p

        own = layer**2/(12*moment)
        lost = merge(0.0_rk, max(edge - own, 0.0_rk), tilted)
        normal = merge(least, least_edge, tilted)*zeta/2*material%across
        outer = in_plane(material, 0.0_rk)
        call lay_ply(zeta/2*(own + lost)*outer, normal, axis, axes(:, :, 0))
        if (size(angles) == 0) return
        outer = (in_plane(material, angles(1)) + in_plane(material, angles(size(angles))))/2
        do p = 1, size(angles)
            call lay_ply(zeta/2*(own*in_plane(material, angles(p)) + lost*outer), normal, axis, &
                         axes(:, :, p))
        end do
    end subroutine lay_axes

    !> The same of a body of a single layer, for which K_z alone bends it: K_z m_4 k^2/8 per volume,
    !> m_4 the sum of w x^4 in the layer. It makes good the bending energy of the layer about its
    !> own middle, with the mean of the moduli in its plane: exact in the sum of plies that cross.
    pure subroutine lay_layer_axes(zeta, material, axis, angles, dimension, spacing, h, axes)
        real(rk), intent(in) :: zeta !! over 2: factor of it all
        type(material_t), intent(in) :: material
        character(1), intent(in) :: axis !! stacking axis 'x', 'y', 'z'
        real(rk), intent(in) :: angles(:) !! see lay_axes
        integer, intent(in) :: dimension
        real(rk), intent(in) :: spacing, h !! [m]
        real(rk), intent(out) :: axes(3, 4, 0:size(angles)) !! column 4 [Pa]
        real(rk) :: e(3), angle, own, turns(1 + size(angles))
        integer :: p

        own = spacing**2/(3*fourth_moment(dimension, spacing, h))
        turns = [0.0_rk, angles]
        do p = 1, size(turns)
            angle = turns(p)
            e = in_plane(material, angle)
            e(3) = (e(1) + e(2))/2
            if (dimension == 2) e(3) = e(merge(1, 2, axis == 'x')) ! along the layer
            call lay_ply([0.0_rk, 0.0_rk, 0.0_rk], zeta/2*max(least*material%across, own*e(3)), &
                         axis, axes(:, :, p - 1))
            axes(:, 1:2, p - 1) = fibre_axes(axis, angle)
        end do
    end subroutine lay_layer_axes

    !> Directions along and across the fibres.
    pure function fibre_axes(axis, angle) result(e)
        character(1), intent(in) :: axis !! stacking axis 'x', 'y', 'z'
        real(rk), intent(in) :: angle !! of the fibres, right-handed about it [rad]
        real(rk) :: e(3, 2)
        integer :: s

        s = max(1, index('xyz', axis))
        e = 0
        e(1 + mod(s, 3), :) = [cos(angle), -sin(angle)]
        e(1 + mod(s + 1, 3), :) = [sin(angle), cos(angle)]
    end function fibre_axes

    !> Sum of w x^4 over the layer of a particle [m2].
    pure real(rk) function fourth_moment(dimension, spacing, h) result(m)
        integer, intent(in) :: dimension
        real(rk), intent(in) :: spacing, h !! [m]
        integer :: i, j, across

        across = merge(3, 0, dimension == 3)
        m = 0
        do j = -across, across
            do i = -3, 3
                m = m + kernel_slope(kernel_scale(h, dimension), 1/(2*h), &
                                     spacing*sqrt(real(i*i + j*j, rk)))*(i*spacing)**4
            end do
        end do
        m = m*spacing**dimension
    end function fourth_moment

    !> Moduli of a ply as a tensor in its plane: 11, 22, 12 of E1 n1 (x) n1 + E2 n2 (x) n2.
    pure function in_plane(material, angle) result(e)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: angle !! [rad]
        real(rk) :: e(3) !! [Pa]
        real(rk) :: c, s

        c = cos(angle)
        s = sin(angle)
        e(1) = material%axial(1)*c*c + material%axial(2)*s*s
        e(2) = material%axial(1)*s*s + material%axial(2)*c*c
        e(3) = (material%axial(1) - material%axial(2))*c*s
    end function in_plane

    !> Principal axes of K_x + 3/4 K_z, and the stiffness along them and along the normal.
    pure subroutine lay_ply(e, normal, axis, axes)
        real(rk), intent(in) :: e(3) !! tensor in the plane, see in_plane [Pa]
        real(rk), intent(in) :: normal !! K_z [Pa]
        character(1), intent(in) :: axis
        real(rk), intent(out) :: axes(3, 4)
        real(rk) :: turn, mean, half
        integer :: s, a, b

        s = max(1, index('xyz', axis))
        a = 1 + mod(s, 3)
        b = 1 + mod(s + 1, 3)
        mean = (e(1) + e(2))/2
        half = sqrt(((e(1) - e(2))/2)**2 + e(3)**2)
        turn = 0
        if (half > 0) turn = atan2(2*e(3), e(1) - e(2))/2
        axes = 0
        axes(a, 1) = cos(turn)
        axes(b, 1) = sin(turn)
        axes(a, 2) = -sin(turn)
        axes(b, 2) = cos(turn)
        axes(s, 3) = 1
        axes(1, 4) = max(mean + half - 0.75_rk*normal, normal)
        axes(2, 4) = max(mean - half - 0.75_rk*normal, normal)
        axes(3, 4) = normal
    end subroutine lay_ply
end module brz_hourglass_axes
