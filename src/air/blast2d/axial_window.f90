! SPDX-License-Identifier: MIT
!> How far a blast in the plane through an axis has come: the cells to compute, and a plane that
!> grows with it.
module brz_axial_window
    use brz_axial_products, only: gas_state
    use brz_axial_state, only: axial_t, find_lighting, margin_cells, v_energy, v_rho, w_energy, &
        w_p, w_rho, w_sound
    use brz_kinds, only: dp
    implicit none
    private
    public :: axial_window_t, find_front, follow_front

    real(dp), parameter :: changed = 1e-6_dp !! change of pressure that tells a front, relative
    integer, parameter :: few_cells = 20000 !! not worth waking the other threads
    integer, parameter :: ahead = 5 !! cells that a step can carry something into

    !> Rows and columns that a step computes.
    type :: axial_window_t
        integer :: columns = 0, low = 0, high = 0
        logical :: wide = .false. !! worth waking the other threads
    end type axial_window_t

contains

    !> Find the last cell of the front in each row.
    subroutine find_front(blast, window)
        type(axial_t), intent(inout) :: blast !! prepared
        type(axial_window_t), intent(in) :: window
        integer :: i, j

        blast%reach = 0
        blast%first = 1
        blast%last = 0
        blast%reached = 0
        do j = window%low, window%high
            do i = window%columns, 1, -1
                if (abs(blast%w(i, w_p, j) - blast%input%pressure) > &
                    changed*blast%input%pressure) exit
            end do
            blast%reached(j) = i
            if (i == 0) cycle
            if (blast%last < blast%first) blast%first = j
            blast%last = j
            blast%reach = max(blast%reach, i)
        end do
    end subroutine find_front

    !> The window of the next step; cells are made one where it nears the edge.
    subroutine follow_front(blast, window)
        type(axial_t), intent(inout) :: blast
        type(axial_window_t), intent(out) :: window

        if (blast%cycle == 0) call set_rest(blast)
        call place_window(blast, window)
        do while (too_near(blast, window))
            call make_one(blast)
            call set_rest(blast)
            call place_window(blast, window)
        end do
    end subroutine follow_front

    !> The states of undisturbed air everywhere: those in the window are derived at each stage.
    subroutine set_rest(blast)
        type(axial_t), intent(inout) :: blast
        real(dp) :: p, c

        call gas_state(blast%gas, blast%rest(v_rho), 0.0_dp, blast%rest(v_energy), 1.0_dp, &
            0.0_dp, p, c)
        blast%w = 0
        blast%w(:, w_rho, :) = blast%rest(v_rho)
        blast%w(:, w_p, :) = p
        blast%w(:, w_energy, :) = blast%rest(v_energy)
        blast%w(:, w_sound, :) = c
    end subroutine set_rest

    !> Make two by two cells one, from the centre outwards, with undisturbed air around them. Of an
    !> odd number of rows above a floor, two are made one from there on.
    subroutine make_one(blast)
        type(axial_t), intent(inout) :: blast
        integer :: j, low, odd

        low = blast%low
        odd = mod(max(blast%below, 0), 2)
        if (blast%below > 0) blast%below = blast%below/2
        blast%rise = blast%rise - odd*blast%dz
        if (blast%below >= 0) blast%low = max(1 - blast%below, 1 - blast%n)
        do j = 1, blast%n
            call make_row(blast, low, odd, j)
        end do
        do j = 0, blast%low, -1
            call make_row(blast, low, odd, j)
        end do
        blast%dr = 2*blast%dr
        blast%dz = 2*blast%dz
        blast%reach = (blast%reach + 1)/2
        blast%first = ceiling((blast%first + odd)/2.0_dp)
        blast%last = ceiling((blast%last + odd)/2.0_dp)
        blast%merged = blast%merged + 1
        call find_lighting(blast)
    end subroutine make_one

    !> One row of the coarser cells from two of the finer; their volumes grow as 1, 3, 5 ...
    subroutine make_row(blast, low, odd, j)
        type(axial_t), intent(inout) :: blast
        integer, intent(in) :: low !! first row of the finer cells
        integer, intent(in) :: odd !! rows that the finer cells are shifted by
        integer, intent(in) :: j
        integer :: c, i, below, above

        below = 2*j - 1 - odd
        above = 2*j - odd
        if (below < low .or. above > blast%n) then
            do c = 1, 5
                blast%u(:, c, j) = blast%rest(c)
            end do
            blast%reached(j) = 0
            return
        end if
        blast%reached(j) = (max(blast%reached(below), blast%reached(above)) + 1)/2
        do c = 1, 5
            do i = 1, blast%n/2
                associate (u => blast%u(2*i - 1:2*i, c, below:above))
                    blast%u(i, c, j) = ((4*i - 3)*(u(1, 1) + u(1, 2)) &
                        + (4*i - 1)*(u(2, 1) + u(2, 2)))/(16*i - 8)
                end associate
            end do
            blast%u(blast%n/2 + 1:, c, j) = blast%rest(c)
        end do
    end subroutine make_row

    !> Rows and columns around the front; while it burns, around the charge as well.
    pure subroutine place_window(blast, window)
        type(axial_t), intent(in) :: blast
        type(axial_window_t), intent(out) :: window
        integer :: charge(3)

        charge = [blast%reach, blast%first, blast%last]
        if (blast%burning .or. blast%cycle == 0) then
            charge(1) = max(charge(1), ceiling(blast%input%radius/blast%dr))
            charge(2) = min(charge(2), 1 - ceiling((blast%input%half + blast%rise)/blast%dz))
            charge(3) = max(charge(3), ceiling((blast%input%half - blast%rise)/blast%dz))
        end if
        window%columns = min(charge(1) + ahead, blast%n)
        window%low = max(charge(2) - ahead, blast%low)
        window%high = min(charge(3) + ahead, blast%n)
        window%wide = window%columns*(window%high - window%low + 1) > few_cells
    end subroutine place_window

    !> True where the plane must grow.
    pure logical function too_near(blast, window)
        type(axial_t), intent(in) :: blast
        type(axial_window_t), intent(in) :: window

        too_near = max(window%columns, window%high) > blast%n - margin_cells
        if (blast%below < 0 .or. blast%below > blast%n) &
            too_near = too_near .or. window%low < 1 - blast%n + margin_cells
    end function too_near
end module brz_axial_window
