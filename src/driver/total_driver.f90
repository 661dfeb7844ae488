! SPDX-License-Identifier: MIT
!> Sums over a body: mass, momentum, energy, all in real64. On the CPU they are exact and depend
!> neither on the order of the particles nor on threads and processes; on the GPU they are folded in
!> a fixed order, as exact sums there took 3 ms more for each row of the histories.
module brz_total_driver
    use brz_force_loops, only: for_each_sum_state
    use brz_errors, only: error_t
    use brz_kinds, only: dp, rk
    use brz_solid_backend, only: sum_states
    use brz_solid_sums, only: n_sum
    use brz_solid_state, only: solid_t
    use brz_errors, only: error_t
    implicit none
    private
    public :: sums_of_bodies

contains

    !> Sums over the particles of each body. All processes must call.
    subroutine sums_of_bodies(solid, sums, err)
        type(solid_t), intent(in) :: solid
        real(dp), intent(out) :: sums(n_sum, size(solid%bodies)) !! see sum_state
        type(error_t), intent(inout) :: err
        real(dp) :: one(n_sum)
        integer :: k

        if (solid%on_gpu) then
            call sum_states(solid%device, solid, sums, err)
            return
        end if
        do k = 1, size(solid%bodies)
            associate (there => solid%bodies(k))
                call for_each_sum_state(solid%on_gpu, there%last - there%first + 1, solid%ranks, &
                    there%first, solid%wide, solid%stride_d, solid%stride_p, &
                    real(solid%dt_last/2, rk), solid%region, solid%x, solid%v, solid%mass, &
                    solid%a, solid%energy, solid%damage, solid%fixed, one, err)
            end associate
            sums(:, k) = one
        end do
    end subroutine sums_of_bodies
end module brz_total_driver
