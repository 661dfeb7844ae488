! SPDX-License-Identifier: MIT
!> Particles at the same place: a deck that lays them is refused.
module brz_solid_doubles
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp, int64
    use brz_solid_lanes, only: group_of
    use brz_solid_links, only: first_link, last_link, link_mask, link_partner
    use brz_solid_mirror, only: signs
    use brz_solid_state, only: solid_t
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
        integer(int64) :: k
        integer :: b, g, i

        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                g = group_of(solid%bodies(b), i)
                do k = solid%first(g), solid%first(g + 1) - 1
                    if (solid%list(k) /= i) call look(b, i, solid%list(k), 0)
                end do
                if (.not. solid%links%present) cycle
                do k = first_link(solid%links, i), last_link(solid%links, i)
                    call look(b, i, link_partner(solid%links, k), link_mask(solid%links, k))
                end do
                if (failed(err)) return
            end do
        end do

    contains

        subroutine look(b, i, j, m)
            integer, intent(in) :: b, i, j, m
            real(dp) :: d(3)

            d = solid%x(:, i) - signs(m)*solid%x(:, j)
            if (dot_product(d, d) > (same_place*solid%bodies(b)%spacing)**2) return
            call raise(err, exit_deck, "&body id='"//trim(solid%bodies(b)%id)// &
                       "': particles "//to_text(solid%id(i))//' and '//to_text(solid%id(j))// &
                       ' are at the same place, x = '//to_text(solid%x(1, i))//', y = '// &
                       to_text(solid%x(2, i))//', z = '//to_text(solid%x(3, i))//' m')
        end subroutine look
    end subroutine refuse_doubles
end module brz_solid_doubles
