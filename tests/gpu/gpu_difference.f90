! SPDX-License-Identifier: MIT
!> How far two states of the solids are apart.
module gpu_difference
    use brz_kinds, only: dp, rk
    use brz_solid_fields, only: fields_of, fields_t, is_integer, numbers_of
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: difference

contains

    !> Largest difference of two states, each field relative to its largest value; what is counted
    !> must be the same.
    real(dp) function difference(a, b)
        class(interacting_bodies_t), intent(inout), target :: a, b
        type(fields_t) :: ours, theirs
        real(dp), allocatable :: p(:, :), q(:, :)
        integer :: k

        difference = 0
        call fields_of(a, ours)
        call fields_of(b, theirs)
        do k = 1, ours%n
            associate (field => ours%of(k))
                ! what the tensile control owes is a small difference of energies
                if (.not. field%kept .or. field%rows == 0 .or. field%name == 'owed') cycle
                p = numbers_of(field, a%n)
                q = numbers_of(theirs%of(k), b%n)
                ! what has lost all strength may lose its support on one side alone
                if (field%kind >= is_integer) then
                    if (any(abs(p(1, :) - q(1, :)) > 0 .and. a%damage < 1)) &
                        difference = huge(difference)
                else
                    difference = max(difference, maxval(abs(p - q)) &
                        /(maxval(abs(p)) + tiny(1.0_rk)))
                end if
            end associate
        end do
        if (.not. a%cohesive%present) return
        associate (x => a%cohesive, y => b%cohesive)
            difference = max(difference, maxval(abs(x%damage - y%damage)), &
                maxval(abs(x%spent - y%spent))/(maxval(x%spent) + tiny(1.0_dp)), &
                maxval(abs(x%held - y%held))/(maxval(x%held) + tiny(1.0_dp)))
            if (any(x%place /= y%place)) difference = huge(difference)
        end associate
    end function difference
end module gpu_difference
