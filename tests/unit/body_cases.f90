! SPDX-License-Identifier: MIT
!> Cases of the tests of bodies.
module body_cases
    use brz_case, only: case_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: one_body

contains

    !> A case with one body of density 1000 in a unit box, four layers each way.
    subroutine one_body(case)
        type(case_t), intent(out) :: case

        allocate (case%materials(1), case%bodies(1))
        case%solid%present = .true.
        case%materials(1)%model = 'linear_elastic'
        case%materials(1)%n = 5
        case%materials(1)%key = [character(24) :: 'density', 'youngs_modulus', 'poisson_ratio', &
                                 'bulk_modulus', 'shear_modulus']
        case%materials(1)%value = [1000.0_dp, 1e6_dp, 0.3_dp, 0.0_dp, 0.0_dp]
        case%materials(1)%word = [character(32) :: '', '', '', '', '']
        case%materials(1)%given = [.true., .true., .true., .false., .false.]
        case%bodies(1)%id = 'b'
        case%bodies(1)%material_index = 1
        case%bodies(1)%hi = 1
        case%bodies(1)%spacing = 0.25_dp
    end subroutine one_body
end module body_cases
