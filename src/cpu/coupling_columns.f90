! SPDX-License-Identifier: MIT
!> Columns of solid cells behind wall faces: which particles a face loads, and by how much.
!>
!> A face loads the particles of its column from the outermost one inwards, and no farther than the
!> next gas cell, in proportion to mass and load_weight of their depth. All of this follows from
!> positions, which do not change while the air takes its step.
module brz_coupling_columns
    use brz_air_state, only: air_t
    use brz_cell_shells, only: neighbour
    use brz_column_rules, only: height_of
    use brz_coupling_state, only: coupling_t, side_of
    use brz_kinds, only: dp, rk
    use brz_load_rules, only: load_weight
    use brz_solid_state, only: solid_t, worth_threads
    implicit none
    private
    public :: weigh_columns, face_above, weight_of, area

contains

    !> Surface of the column behind each face, and the sum of the weights in it.
    subroutine weigh_columns(air, solid, coupling)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: f

        !$omp parallel do if(solid%n >= worth_threads) schedule(dynamic, 64)
        do f = 1, coupling%wall%n_faces
            call weigh_column(air, solid, coupling, f)
        end do
    end subroutine weigh_columns

    subroutine weigh_column(air, solid, coupling, f)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: f !! wall face
        real(dp) :: top
        real(rk) :: total
        integer :: c, d, i, m, s
        logical :: more

        d = coupling%wall%face(4, f)
        s = coupling%wall%face(5, f)
        c = coupling%wall%face_cell(f)
        top = huge(top)
        do i = coupling%first(c), coupling%first(c + 1) - 1
            top = min(top, height(air, coupling, f, solid%x(d, coupling%binned(i))))
        end do
        coupling%surface(f) = top
        total = 0
        do m = 0, ceiling(coupling%spread)
            do i = coupling%first(c), coupling%first(c + 1) - 1
                total = total + weight_of(air, solid, coupling, f, coupling%binned(i))
            end do
            call next_solid(air, coupling, d, s, c, more)
            if (.not. more) exit
        end do
        coupling%weight(f) = total
    end subroutine weigh_column

    !> Weight of a particle in the load of a face whose column it belongs to [kg].
    pure real(rk) function weight_of(air, solid, coupling, f, p)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: f, p !! face, particle
        real(dp) :: depth
        integer :: d

        d = coupling%wall%face(4, f)
        depth = height(air, coupling, f, solid%x(d, p)) - coupling%surface(f)
        weight_of = solid%mass(p)*load_weight(real(depth, rk), real(coupling%spread*air%dx(d), rk))
    end function weight_of

    !> Face that begins the column of cell c and is near enough to load it, or 0.
    pure integer function face_above(air, coupling, d, s, c) result(f)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: d, s !! direction and side of the face
        integer, intent(in) :: c !! place in the wall list
        integer :: m, at
        logical :: more

        at = c
        f = 0
        do m = 0, ceiling(coupling%spread)
            f = coupling%face_of(side_of(d, s), at)
            if (f > 0) return
            call next_solid(air, coupling, d, -s, at, more)
            if (.not. more) return
        end do
    end function face_above

    !> Step from a solid cell to the next one along an axis; `more` is false at gas or at the box.
    pure subroutine next_solid(air, coupling, d, s, c, more)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: d, s !! direction, and +1 or -1
        integer, intent(inout) :: c !! place in the wall list
        logical, intent(out) :: more
        integer :: offset(3), to(3)

        offset = 0
        offset(d) = s
        call neighbour(air%n, coupling%wraps, coupling%wall%cell(:, c), offset, to, more)
        if (.not. more) return
        more = coupling%wall%solid(to(1), to(2), to(3)) == 1
        if (more) c = coupling%wall%index(to(1), to(2), to(3))
    end subroutine next_solid

    !> Distance of a coordinate from the middle of a face's gas cell, towards the solid [m].
    pure real(dp) function height(air, coupling, f, x)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: f
        real(dp), intent(in) :: x !! along the direction of the face
        integer :: d

        d = coupling%wall%face(4, f)
        height = height_of(x, air%lo(d), air%dx(d), air%n(d), coupling%wraps(d), &
                           coupling%wall%face(d, f), coupling%wall%face(5, f))
    end function height

    !> Area of a face normal to direction d [m2].
    pure real(dp) function area(air, d)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d

        area = product(air%dx)/air%dx(d)
    end function area
end module brz_coupling_columns
