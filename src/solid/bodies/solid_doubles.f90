! SPDX-License-Identifier: MIT
!> Particles at the same place: a deck that lays them is refused.
module brz_solid_doubles
    use brz_body, only: body_t
    use brz_errors, only: error_t, exit_deck, raise
    use brz_kinds, only: dp, int64
    use brz_solid_arrays, only: group_of
    use brz_link_rows, only: first_link, last_link, link_mask, link_partner
    use brz_solid_mirror, only: signs
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_text, only: to_text
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: refuse_doubles

    real(dp), parameter :: same_place = 1e-3_dp !! in spacings

contains

    !> Look through the lists of neighbours and links once.
    subroutine refuse_doubles(solid, err)
        class(listed_bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer :: i, k, worst

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
        associate (body => solid%bodies(owner(solid, worst)))
            call raise(err, exit_deck, body%place//text_of(solid, worst, &
                                                           double_of(solid, body, worst)))
        end associate
    end subroutine refuse_doubles

    !> The body of a particle.
    pure integer function owner(solid, i)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: i

        owner = findloc(solid%bodies%rim >= i, .true., dim=1)
    end function owner

    !> What is wrong with particles i and j, and what helps.
    pure function text_of(solid, i, j) result(text)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: i, j
        character(:), allocatable :: text
        integer :: first

        associate (body => solid%bodies(owner(solid, i)), other => solid%bodies(owner(solid, j)), &
                   x => solid%x(:, i))
            text = 'particles '//to_text(solid%id(i))//' and '//to_text(solid%id(j))
            if (other%id /= body%id) text = text//" of '"//trim(other%id)//"'"
            text = text//' are at the same place, x = '//to_text(x(1))//', y = '// &
                to_text(x(2))//', z = '//to_text(x(3))//' m'
            first = body%number(1)
            if (other%id /= body%id) then
                text = text//'; move one of the bodies'
            else if (allocated(body%line)) then
                if (size(body%line) > 0) text = text//': lines '// &
                    to_text(body%line(solid%id(i) - first + 1))//' and '// &
                    to_text(body%line(solid%id(j) - first + 1))//' of '//body%file
                text = text//'; leave one of them out'
            end if
        end associate
    end function text_of

    !> The first particle in the lists of i that is at its place; 0: none.
    pure integer function double_of(solid, body, i) result(j)
        class(listed_bodies_t), intent(in) :: solid
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
