! SPDX-License-Identifier: MIT
!> One-sided gradient correction at free faces: the outermost layers of a laminate have neighbours
!> on one side only.
!>
!> A gradient there sees the strain of a place a quarter of a spacing deeper. So where M and G of
!> brz_gradient have x_ij in their second place, such a particle has the arm
!>     y_ij = X_ij + c (n.X_ij) (X_ij - n (n.X_ij)),      H = (sum w v_ij (x) y_ij) M^-1,
!> with M = sum w x_ij (x) y_ij, n the normal of the plies in the unloaded body, and the tilt c
!> that makes sum w t^2 z (1 + c z) = 0 there, t along the layer, z across it. H is exact for linear
!> fields on any arrangement, for u = t z also, and blind to a rigid rotation. The force of the
!> stress is its adjoint, -w (T_i y^i_ij + T_j y^j_ij) with T = stress M^-T. Point physics.
!>
!> What bends has w = -k t^2/2 across it, too, which to neighbours on one side looks like a strain
!> across. So plates and walls have besides the lift s c t^2 n, with s that makes
!> sum w t^2 (z + s c t^2) = 0 there: of a regular lattice a number of its own (`face_lift`), 0 in
!> updated laminates, whose stiffness along the fibres goes with their hourglass force.
!>
!> A bar along e has free faces in both directions across it. There the tilt is a vector C,
!>     y_ij = X_ij + (C.X_ij) (e.X_ij) e,
!> without lift, and n holds, in place of a normal, the unit of C twice, in the directions across;
!> both parts of C lie in one number, as whole multiples of that unit.
!>
!> In a wall round an axis n is radial at each particle.
!>
!> Source: docs/theory/plates.md
module brz_one_sided_arm
    use brz_gradient, only: invert_supported
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, rk
    use brz_pair_force, only: most_bent, overstretched
    implicit none
    private
    public :: face_lift, curved_arm, mirrored_tilt, pack_tilt, ply_arm, radial_normal, &
              one_sided_arm, tilted_correction, tilted_force, wall_arm

    real(rk), parameter :: shift = 4096 !! of the first part of a packed tilt
    !> Added and taken away again it leaves the nearest whole number, in vector code too.
    real(rk), parameter :: to_whole = 1.5_rk/epsilon(1.0_rk)
    integer, parameter :: largest = 2000 !! of a part

contains

    !> Arm of a pair: x_ij without tilt; with it none where the pair left the stretches 1/1.6..1.6.
    !> Normals lie along an axis, so along the others each part of X_ij grows by the same factor.
    !@cuf attributes(host,device) &
    pure subroutine one_sided_arm(c, lift, n, x_ref, r, y)
        real(rk), intent(in) :: c !! tilt [1/m], of bars packed; of j as seen from i: the other sign
        real(rk), intent(in) :: lift !! s, see above; 0 of bars
        real(rk), intent(in) :: n(3) !! normal of the plies in the unloaded body; bars: see above
        real(rk), intent(in) :: x_ref(3), r(3) !! X_ij, x_ij [m]
        real(rk), intent(out) :: y(3) !! [m]
        real(rk) :: bar, first, z, z1, slope, along, across, rise
        integer :: t

        bar = two_of(n)
        first = (c*(bar/shift) + to_whole) - to_whole
        z = n(1)*x_ref(1) + n(2)*x_ref(2) + n(3)*x_ref(3)
        z1 = n(1)*x_ref(1)
        if (n(1) == 0) z1 = n(2)*x_ref(2)
        slope = (c - shift*first)*(z - bar*z1) + first*z1
        along = 1 + slope
        rise = lift*(x_ref(1)*x_ref(1) + x_ref(2)*x_ref(2) + x_ref(3)*x_ref(3) - z*z)*c
        if (overstretched(most_bent, x_ref, r)) then
            along = 0
            slope = 0
            rise = 0
        end if
        do t = 1, 3
            across = x_ref(t)
            if (n(t) == 0) across = 0
            y(t) = along*x_ref(t) - slope*across + rise*n(t)
            if (c == 0) y(t) = r(t)
        end do
    end subroutine one_sided_arm

    !> The same in laminates, which are no bars, and in curved walls: any normal.
    !@cuf attributes(host,device) &
    pure subroutine ply_arm(c, lift, n, x_ref, r, y)
        real(rk), intent(in) :: c, lift, n(3), x_ref(3), r(3)
        real(rk), intent(out) :: y(3)
        real(rk) :: z, along, across
        integer :: t

        z = n(1)*x_ref(1) + n(2)*x_ref(2) + n(3)*x_ref(3)
        along = 1 + c*z
        across = c*(z*z - lift*(x_ref(1)*x_ref(1) + x_ref(2)*x_ref(2) + x_ref(3)*x_ref(3) - z*z))
        if (overstretched(most_bent, x_ref, r)) then
            along = 0
            across = 0
        end if
        do t = 1, 3
            y(t) = along*x_ref(t) - across*n(t)
            if (c == 0) y(t) = r(t)
        end do
    end subroutine ply_arm

    !> The same in total-Lagrangian plates, in the unloaded body: no pair leaves it.
    !@cuf attributes(host,device) &
    pure subroutine curved_arm(c, lift, n, x_ref, y)
        real(rk), intent(in) :: c, lift, n(3) !! see one_sided_arm
        real(rk), intent(in) :: x_ref(3) !! X_ij [m]
        real(rk), intent(out) :: y(3) !! [m]
        real(rk) :: z, across

        z = n(1)*x_ref(1) + n(2)*x_ref(2) + n(3)*x_ref(3)
        across = c*(lift*(x_ref(1)*x_ref(1) + x_ref(2)*x_ref(2) + x_ref(3)*x_ref(3) - z*z) - z*z)
        y(1) = (1 + c*z)*x_ref(1) + across*n(1)
        y(2) = (1 + c*z)*x_ref(2) + across*n(2)
        y(3) = (1 + c*z)*x_ref(3) + across*n(3)
    end subroutine curved_arm

    !> Normal of a wall at a place of the unloaded body.
    !@cuf attributes(host,device) &
    pure subroutine radial_normal(across, middle, x, n)
        real(rk), intent(in) :: across(3) !! 1 in the directions across the axis, else 0
        real(dp), intent(in) :: middle(3), x(3) !! a point of the axis, the place [m]
        real(rk), intent(out) :: n(3)
        real(rk) :: r(3), length
        integer :: t

        do t = 1, 3
            r(t) = across(t)*real(x(t) - middle(t), rk)
        end do
        length = sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3))
        do t = 1, 3
            n(t) = r(t)/max(length, tiny(length))
        end do
    end subroutine radial_normal

    !> The same in a wall round an axis, at a particle there, or at its image in a plane through the
    !> axis.
    !@cuf attributes(host,device) &
    pure subroutine wall_arm(across, middle, x, c, lift, x_ref, r, y)
        real(rk), intent(in) :: across(3) !! see radial_normal
        real(dp), intent(in) :: middle(3), x(3) !! see radial_normal [m]
        real(rk), intent(in) :: c, lift, x_ref(3), r(3) !! see one_sided_arm
        real(rk), intent(out) :: y(3) !! [m]
        real(rk) :: n(3)

        call radial_normal(across, middle, x, n)
        call ply_arm(c, lift, n, x_ref, r, y)
    end subroutine wall_arm

    !> Lift of the faces of a regular lattice over their tilt: with it they see no strain across
    !> where w = t^2, and with the tilt that of u = t z at a place outside them.
    pure function face_lift(dimension, h, outside) result(lift)
        integer, intent(in) :: dimension !! 2 or 3
        real(rk), intent(in) :: h !! smoothing length over the spacing
        real(rk), intent(in) :: outside !! over the spacing
        real(rk) :: lift
        integer, parameter :: far = 4 !! layers and columns within reach, at least
        real(rk) :: sums(4), t2, w
        integer :: i, j, k

        sums = 0
        do k = 0, far
            do j = -far*(dimension - 2), far*(dimension - 2)
                do i = -far, far
                    t2 = real(i*i + j*j, rk)
                    w = t2*kernel_slope(1.0_rk, 1/(2*h), sqrt(real(i*i + j*j + k*k, rk)))
                    sums = sums + w*[1.0_rk, real(k, rk), real(k*k, rk), t2]
                end do
            end do
        end do
        lift = sums(2)*(sums(3) + outside*sums(2))/(sums(4)*(sums(2) + outside*sums(1)))
    end function face_lift

    !> 1 where two components of a vector are not zero, as of a bar; else 0.
    !@cuf attributes(host,device) &
    pure function two_of(n) result(two)
        real(rk), intent(in) :: n(3)
        real(rk) :: two

        two = 0
        if (merge(1, 0, n(1) /= 0) + merge(1, 0, n(2) /= 0) + merge(1, 0, n(3) /= 0) == 2) two = 1
    end function two_of

    !> Both parts of the tilt of a bar in one number.
    pure function pack_tilt(parts) result(c)
        real(rk), intent(in) :: parts(2) !! over their unit, in the order of the axes
        real(rk) :: c
        integer :: whole(2)

        whole = max(-largest, min(largest, nint(parts)))
        c = whole(1)*shift + whole(2)
    end function pack_tilt

    !> Tilt of an image: it changes sign where a plane turns its direction round.
    pure function mirrored_tilt(s, n, c) result(mirrored)
        real(rk), intent(in) :: s(3) !! -1 along the normal of a plane, else 1
        real(rk), intent(in) :: n(3), c !! see one_sided_arm
        real(rk) :: mirrored
        integer :: t

        mirrored = dot_product(s, n)*c
        if (.not. two_of(n) > 0) return
        t = merge(2, 1, n(1) == 0)
        mirrored = s(t)*shift*anint(c/shift) + s(merge(2, 3, n(3) == 0))*(c - shift*anint(c/shift))
    end function mirrored_tilt

    !> Inverse of M; where it is weak none, which for that step leaves the particle without stress
    !> and strain.
    !@cuf attributes(host,device) &
    pure subroutine tilted_correction(dimension, m, b, weak)
        integer, intent(in) :: dimension
        real(rk), intent(in) :: m(9) !! column by column
        real(rk), intent(out) :: b(3, 3)
        integer, intent(out) :: weak !! 1 where a direction is unsupported, else 0
        real(rk) :: a(3, 3)
        integer :: i, j

        do j = 1, 3
            do i = 1, 3
                a(i, j) = m(i + 3*(j - 1))
            end do
        end do
        call invert_supported(dimension, a, b, weak)
        if (weak == 0) return
        do j = 1, 3
            do i = 1, 3
                b(i, j) = 0
            end do
        end do
    end subroutine tilted_correction

    !> Force of the stress, -w (T_i y^i_ij + T_j y^j_ij).
    !@cuf attributes(host,device) &
    pure subroutine tilted_force(w, ti, tj, yi, yj, f)
        real(rk), intent(in) :: w
        real(rk), intent(in) :: ti(9), tj(9) !! T of the two particles [Pa]
        real(rk), intent(in) :: yi(3), yj(3) !! their arms [m]
        real(rk), intent(out) :: f(3) !! on i [N]

        f(1) = -w*((ti(1)*yi(1) + ti(4)*yi(2) + ti(7)*yi(3)) &
                   + (tj(1)*yj(1) + tj(4)*yj(2) + tj(7)*yj(3)))
        f(2) = -w*((ti(2)*yi(1) + ti(5)*yi(2) + ti(8)*yi(3)) &
                   + (tj(2)*yj(1) + tj(5)*yj(2) + tj(8)*yj(3)))
        f(3) = -w*((ti(3)*yi(1) + ti(6)*yi(2) + ti(9)*yi(3)) &
                   + (tj(3)*yj(1) + tj(6)*yj(2) + tj(9)*yj(3)))
    end subroutine tilted_force
end module brz_one_sided_arm
