! SPDX-License-Identifier: MIT
!> Sums over the coupling, for its diagnostics: work and impulses that cross wall faces, and what
!> deferred sources hold.
module brz_coupling_sum_loop_bodies
    use brz_column_rules, only: direction_of, sign_of
    use brz_coupling_box, only: box_t, is_own
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: record_face, total_deferred_source

contains

    !> The diagnostics of work and impulse, as the air sees them.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine record_face(f, box, dt, gas, rows, owner, impulse, v, work, given, taken)
        integer, intent(in) :: f !! wall faces
        type(box_t), intent(in) :: box
        real(dp), intent(in) :: dt !! step of the air [s]
        integer(int32), intent(in) :: gas(*), rows(*), owner(*)
        real(rk), intent(in) :: impulse(*), v(3, *)
        real(dp), intent(inout) :: work(2) !@sum of all pressure, of the reference pressure [J]
        real(dp), intent(inout) :: given(3) !@sum of impulses given to the solid [N s]
        real(dp), intent(inout) :: taken(3) !@sum of what was taken off [N s]
        real(dp) :: push, reference, speed
        integer :: d, s

        if (.not. is_own(box, gas(f))) return
        s = sign_of(rows(f))
        push = s*real(impulse(f), dp)
        reference = s*box%reference*box%area(direction_of(rows(f)))*dt
        speed = v(direction_of(rows(f)), owner(f))
        work(1) = work(1) + push*speed
        work(2) = work(2) + reference*speed
        do d = 1, 3
            if (d /= direction_of(rows(f))) cycle
            given(d) = given(d) + (push - reference)
            taken(d) = taken(d) + reference
        end do
    end subroutine record_face

    !> Sum of the deferred sources of this process.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine total_deferred_source(e, box, n_var, cell, deferred, total)
        integer, intent(in) :: e !! deferred sources
        type(box_t), intent(in) :: box
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(in) :: deferred(n_var, *)
        real(dp), intent(inout) :: total(6) !@exact per cell volume
        integer :: k

        if (.not. is_own(box, cell(e))) return
        do k = 1, 6
            if (k <= n_var) total(k) = total(k) + deferred(k, e)
        end do
    end subroutine total_deferred_source
end module brz_coupling_sum_loop_bodies
