! SPDX-License-Identifier: MIT
!> Particles at the same place: a deck that lays them is refused.
module brz_solid_doubles
    use brz_errors, only: error_t, exit_deck, raise
    use brz_kinds, only: dp, int64
    use brz_solid_arrays, only: group_of
    use brz_link_rows, only: first_link, last_link, link_mask, link_partner
    use brz_solid_mirror, only: signs
    use brz_solid_state, only: body_t, solid_t, worth_threads
    use brz_text, only: to_text
    implicit none
    private
    public :: refuse_doubles

    real(dp), parameter :: same_place = 1e-3_dp !! in spacings

contains

    !> Look through the lists of neighbours and links once.
    subroutine refuse_doubles(solid, err)
        type(solid_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer :: b, i, k, worst

        worst = solid%n + 1 ! the first particle that has a double
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i) &
        !$omp reduction(min: worst)
        do k = 1, size(solid%block, 2)
            do i = solid%block(2, k), solid%block(3, k)
                if (i >= worst) exit
                if (double_of(solid, solid%bodies(solid%block(1, k)), i) > 0) worst = i
            end do
        end do
        if (worst > solid%n) return
        b = findloc(solid%bodies%last >= worst, .true., dim=1)
        associate (body => solid%bodies(b), x => solid%x(:, worst))
            call raise(err, exit_deck, "&body id='"//trim(body%id)//"': particles "// &
                       to_text(solid%id(worst))//' and '// &
                       to_text(solid%id(double_of(solid, body, worst)))// &
                       ' are at the same place, x = '//to_text(x(1))//', y = '//to_text(x(2))// &
                       ', z = '//to_text(x(3))//' m')
        end associate
    end subroutine refuse_doubles

    !> The first particle in the lists of i that is at its place; 0: none.
    pure integer function double_of(solid, body, i) result(j)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body !! of i
        integer, intent(in) :: i
        real(dp) :: d(3), near2
        integer(int64) :: k
        integer :: g

        near2 = (same_place*body%spacing)**2
        g = group_of(body, i)
        do k = solid%first(g), solid%first(g + 1) - 1
            j = solid%list(k)
            d = solid%x(:, i) - solid%x(:, j)
            if (j /= i .and. dot_product(d, d) <= near2) return
        end do
        if (solid%links%present) then
            do k = first_link(solid%links, i), last_link(solid%links, i)
                j = link_partner(solid%links, k)
                d = solid%x(:, i) - signs(link_mask(solid%links, k))*solid%x(:, j)
                if (dot_product(d, d) <= near2) return
            end do
        end if
        j = 0
    end function double_of
end module brz_solid_doubles
