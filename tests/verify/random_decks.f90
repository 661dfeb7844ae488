! SPDX-License-Identifier: MIT
!> Random decks in the plane: a strong shock, and up to three bodies of real materials that fly,
!> turn, meet and break in it. The number of a deck alone decides what it is.
module random_decks
    use brz_kinds, only: dp
    use dice, only: dice_t
    implicit none
    private
    public :: write_random_deck

    character(*), parameter :: end_of_group = ' /'

contains

    !> Write a deck; `what` tells it in a line.
    subroutine write_random_deck(number, path, what)
        integer, intent(in) :: number
        character(*), intent(in) :: path
        character(*), intent(out) :: what
        character(12) :: symmetry, ends
        type(dice_t) :: random
        real(dp) :: m, ratio
        integer :: b, bodies, unit

        call random%seed(100000 + number)
        symmetry = merge("'y'    ", "       ", random%draw() < 0.4_dp)
        ends = merge('wall   ', 'outflow', random%draw() < 0.3_dp)
        ratio = 10**(3*random%draw())
        m = sqrt((ratio - 1)*6/7 + 1)
        bodies = random%pick([1, 2, 3])
        write (what, '(a, i0, 3a, f7.1, a, i0)') 'deck ', number, &
            ' planes '//trim(symmetry), ' ends '//trim(ends), ' ratio', ratio, ' bodies ', bodies
        open (newunit=unit, file=path, action='write', status='replace')
        write (unit, '(a)') '&run t_end = 1, dimension = 2'
        if (symmetry /= '') write (unit, '(a)') '    symmetry = '//symmetry
        write (unit, '(a)') end_of_group, &
            '&air box = -0.1, 0.1,  0, 0.14,  0, 1,  cells = 32, 22, 1', &
            "    bc = 'outflow', '"//trim(ends)//"', '"//trim(merge('symmetry', 'outflow ', &
            symmetry /= ''))//"', '"//trim(ends)//"', 'wall', 'wall'"
        write (unit, '(a)') end_of_group
        write (unit, '(a, 2(es13.6, a), es13.6, a)') &
            "&gas id = 'shock', box = -1, -0.0625, -1, 1, -1, 2, density = ", &
            1.225_dp*2.4_dp*m**2/(0.4_dp*m**2 + 2), ', pressure = ', ratio*101325, &
            ', velocity = ', 340.3_dp/1.2_dp*(m - 1/m), ', 0, 0 /'
        do b = 1, bodies
            call write_body(unit, b, random)
        end do
        close (unit)
    end subroutine write_random_deck

    !> A body and its material: each in a column of its own, so that they do not overlap.
    subroutine write_body(unit, b, random)
        integer, intent(in) :: unit, b
        type(dice_t), intent(inout) :: random
        character(*), parameter :: materials(4) = [character(80) :: "preset = 'al2024'", &
            "preset = 'hjc_48'", "preset = 'steel_paper'", "model = 'linear_elastic', "// &
            'density = 200, youngs_modulus = 1e6']
        real(dp) :: from(2), size(2)
        integer :: kind

        kind = random%pick([1, 2, 3, 4])
        write (unit, '(a, i0, 3a)') "&material id = 'm", b, "', ", trim(materials(kind)), &
            trim(merge(', poisson_ratio = 0.3 /', ' /                     ', kind == 4))
        from = [-0.055_dp + 0.05_dp*(b - 1), 0.05_dp*random%draw()]
        if (random%draw() < 0.3_dp) from(2) = 0
        size = [merge(0.004_dp, 0.03_dp, random%draw() < 0.4_dp), 0.01_dp + 0.06_dp*random%draw()]
        write (unit, '(a, i0, a, 4(f8.4, a), a, i0, a)') "&body id = 'b", b, "', box = ", from(1), &
            ', ', from(1) + size(1), ', ', from(2), ', ', from(2) + size(2), ', 0, 1, ', &
            "spacing = 4e-3, material = 'm", b, "'"
        write (unit, '(a, 2(f9.2, a))') '    velocity = ', 1500*(2*random%draw() - 1)**3, ', ', &
            merge(0.0_dp, 300*(2*random%draw() - 1), random%draw() < 0.3_dp), ', 0'
        if (random%draw() < 0.4_dp) write (unit, '(a)') "    formulation = 'rigid'"
        write (unit, '(a)') end_of_group
    end subroutine write_body
end module random_decks
