! SPDX-License-Identifier: MIT
!> Forces between walls and particles: wall velocities for the air, loads for the solid.
module brz_coupling_load
    use brz_air_state, only: air_t
    use brz_cell_shells, only: neighbour
    use brz_coupling_state, only: coupling_t, side_of
    use brz_kinds, only: dp, rk
    use brz_load_rules, only: load_weight
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: spread_load, load_is_negligible

contains

    !> Turn the impulses of the wall faces, reference pressure taken off, into forces on particles.
    !>
    !> Each face loads the particles of its column of solid cells, from the outermost one inwards
    !> and no farther than the next gas cell, by load_weight times mass. The forces of a face add up
    !> to its impulse over dt.
    subroutine spread_load(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        integer :: c, f, p

        !$omp parallel
        !$omp do schedule(dynamic, 64)
        do f = 1, coupling%wall%n_faces
            call weigh_column(air, solid, coupling, dt, f)
        end do
        !$omp do schedule(static)
        do p = 1, solid%n
            if (coupling%cell_of(p) == 0) solid%load(:, p) = 0
        end do
        !$omp do schedule(dynamic, 64)
        do c = 1, coupling%wall%n_cells
            call load_cell(air, solid, coupling, c)
        end do
        !$omp end parallel
        call account(air, coupling, dt)
    end subroutine spread_load

    !> Surface of the column behind a face, and its force per unit of weight.
    subroutine weigh_column(air, solid, coupling, dt, f)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt
        integer, intent(in) :: f !! wall face
        real(dp) :: total, top
        real(rk) :: range
        integer :: c, d, i, m, p, s
        logical :: more

        d = coupling%wall%face(4, f)
        s = coupling%wall%face(5, f)
        range = real(coupling%spread*air%dx(d), rk)
        c = coupling%wall%face_cell(f)
        top = huge(top)
        do i = coupling%first(c), coupling%first(c + 1) - 1
            top = min(top, height(air, coupling, f, solid%x(d, coupling%binned(i))))
        end do
        coupling%surface(f) = top
        total = 0
        do m = 0, ceiling(coupling%spread)
            do i = coupling%first(c), coupling%first(c + 1) - 1
                p = coupling%binned(i)
                total = total + solid%mass(p)*load_weight( &
                        real(height(air, coupling, f, solid%x(d, p)) - top, rk), range)
            end do
            call next_solid(air, coupling, d, s, c, more)
            if (.not. more) exit
        end do
        coupling%force(f) = real(s*(coupling%wall%impulse(f)/dt &
                                    - coupling%reference_pressure*area(air, d))/total, rk)
    end subroutine weigh_column

    !> Loads of the particles of one solid cell, from all faces whose columns reach it.
    subroutine load_cell(air, solid, coupling, c)
        type(air_t), intent(in) :: air
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk) :: range
        integer :: d, f, i, p, s

        do i = coupling%first(c), coupling%first(c + 1) - 1
            solid%load(:, coupling%binned(i)) = 0
        end do
        do d = 1, 3
            if (air%n(d) == 1) cycle
            range = real(coupling%spread*air%dx(d), rk)
            do s = -1, 1, 2
                f = face_above(air, coupling, d, s, c)
                if (f == 0) cycle
                do i = coupling%first(c), coupling%first(c + 1) - 1
                    p = coupling%binned(i)
                    solid%load(d, p) = solid%load(d, p) + coupling%force(f)*solid%mass(p)* &
                        load_weight(real(height(air, coupling, f, solid%x(d, p)) &
                                         - coupling%surface(f), rk), range)
                end do
            end do
        end do
    end subroutine load_cell

    !> Face that begins the column of cell c and is near enough to load it, or 0.
    pure integer function face_above(air, coupling, d, s, c) result(f)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: d, s !! direction and side of the face
        integer, intent(in) :: c
        integer :: m, at
        logical :: more

        at = c
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
        real(dp) :: length

        d = coupling%wall%face(4, f)
        height = x - air%lo(d) - (coupling%wall%face(d, f) - 0.5_dp)*air%dx(d)
        if (coupling%wraps(d)) then
            length = air%n(d)*air%dx(d)
            height = height - length*anint(height/length)
        end if
        height = coupling%wall%face(5, f)*height
    end function height

    !> Area of a face normal to direction d [m2].
    pure real(dp) function area(air, d)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d

        area = product(air%dx)/air%dx(d)
    end function area

    !> Add the step to the sums of work and impulse, as the air sees them.
    subroutine account(air, coupling, dt)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt
        real(dp) :: push, reference, work(2), given(3), taken(3)
        integer :: d, f, s

        work = 0
        given = 0
        taken = 0
        do f = 1, coupling%wall%n_faces
            d = coupling%wall%face(4, f)
            s = coupling%wall%face(5, f)
            push = s*real(coupling%wall%impulse(f), dp)
            reference = s*coupling%reference_pressure*area(air, d)*dt
            work = work + [push, reference]*coupling%wall%v(d, coupling%wall%face_cell(f))
            given(d) = given(d) + (push - reference)
            taken(d) = taken(d) + reference
        end do
        coupling%work = coupling%work + work(1)
        coupling%work_reference = coupling%work_reference + work(2)
        coupling%impulse = coupling%impulse + given
        coupling%impulse_reference = coupling%impulse_reference + taken
    end subroutine account

    !> True when no wall face feels more than rounding above or below the reference pressure.
    pure logical function load_is_negligible(air, coupling, dt)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        real(dp), parameter :: negligible = 1e-9_dp !! of the reference pressure
        real(dp) :: reference
        integer :: f

        load_is_negligible = .false.
        do f = 1, coupling%wall%n_faces
            reference = coupling%reference_pressure*area(air, coupling%wall%face(4, f))*dt
            if (abs(coupling%wall%impulse(f) - reference) > negligible*reference) return
        end do
        load_is_negligible = .true.
    end function load_is_negligible
end module brz_coupling_load
