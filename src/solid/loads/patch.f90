! SPDX-License-Identifier: MIT
!> A loaded area of a face: which of its particles lie under a surface of triangles, seen along the
!> axis of the face, as the face itself is.
module brz_patch
    use brz_kinds, only: dp
    use brz_stl, only: mesh_t
    implicit none
    private
    public :: is_under

    real(dp), parameter :: edge = 1e-9_dp !! of a triangle: a point on it counts as inside

contains

    !> True where the line along an axis through a point crosses the surface within a reach.
    pure logical function is_under(mesh, x, axis, reach) result(yes)
        type(mesh_t), intent(in) :: mesh
        real(dp), intent(in) :: x(3), reach !! [m]
        integer, intent(in) :: axis
        real(dp) :: a(2), b(2), area, height, share(3)
        integer :: t, u, v

        u = mod(axis, 3) + 1
        v = mod(axis + 1, 3) + 1
        yes = .false.
        do t = 1, size(mesh%corner, 3)
            associate (c => mesh%corner(:, :, t))
                a = [c(u, 2) - c(u, 1), c(v, 2) - c(v, 1)]
                b = [c(u, 3) - c(u, 1), c(v, 3) - c(v, 1)]
                area = a(1)*b(2) - a(2)*b(1)
                if (.not. abs(area) > 0) cycle ! seen from its edge
                share(2) = ((x(u) - c(u, 1))*b(2) - (x(v) - c(v, 1))*b(1))/area
                share(3) = (a(1)*(x(v) - c(v, 1)) - a(2)*(x(u) - c(u, 1)))/area
                share(1) = 1 - share(2) - share(3)
                if (any(share < -edge)) cycle
                height = dot_product(share, c(axis, :))
                yes = abs(height - x(axis)) <= reach
                if (yes) return
            end associate
        end do
    end function is_under
end module brz_patch
