! SPDX-License-Identifier: MIT
!> The gas of a dump of the air: conserved variables of its cells.
module brz_gas_box
    use brz_case, only: gas_case_t, label
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_hdf5_array, only: h5_read
    use brz_hdf5_attribute, only: h5_get
    use brz_hdf5_file, only: h5_close, h5_has, h5_open, h5_t
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: gas_box_t, read_gas_box, second_gamma

    character(*), parameter :: cells = 'VTKHDF/CellData/', gas = 'VTKHDF/FieldData/'
    real(dp), parameter :: alike = 1e-6_dp !! relative: the same ratio of specific heats

    type :: gas_box_t
        integer :: n(3) = 1 !! cells
        real(dp) :: lo(3) = 0, dx(3) = 1 !! low corner, cell sides [m]
        real(dp), allocatable :: u(:, :, :, :)
        !! (6, n1, n2, n3) density, momentum, total energy, products, per volume
    end type gas_box_t

contains

    !> Read a dump of the air of a box.
    subroutine read_gas_box(path, gamma, two_gases, active, box, err)
        character(*), intent(in) :: path
        real(dp), intent(in) :: gamma !! ratio of specific heats of the air of this scene [-]
        logical, intent(in) :: two_gases !! it carries products
        logical, intent(in) :: active(3) !! directions that are modelled
        type(gas_box_t), intent(out) :: box
        type(error_t), intent(inout) :: err !! exit_deck with a remedy
        type(error_t) :: bad
        type(h5_t) :: file
        real(dp) :: own(1)
        integer :: a, extent(6)

        call open_dump(path, file, err)
        if (failed(err)) return
        call h5_get(file, 'VTKHDF', 'WholeExtent', extent, bad)
        call h5_get(file, 'VTKHDF', 'Origin', box%lo, bad)
        call h5_get(file, 'VTKHDF', 'Spacing', box%dx, bad)
        call h5_read(file, gas//'gamma', own, bad)
        if (.not. failed(bad)) then
            box%n = extent(2::2)
            if (abs(own(1)/gamma - 1) > alike) call raise(bad, exit_deck, path//': its air has '// &
                'gamma = '//to_text(own(1))//'; give &air the same')
            do a = 1, 3
                if (box%n(a) > 1 .and. .not. active(a)) call raise(bad, exit_deck, path// &
                    ': has several cells along '//'xyz' (a:a)//', where &air has one; give it '// &
                    'several too')
            end do
        end if
        call read_cells(file, path, gamma, two_gases, box, bad)
        call finish(file, bad, err)
    end subroutine read_gas_box

    !> Fields of the cells.
    subroutine read_cells(file, path, gamma, two_gases, box, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: path
        real(dp), intent(in) :: gamma
        logical, intent(in) :: two_gases
        type(gas_box_t), intent(inout) :: box
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: p(:, :, :), rho(:, :, :), v(:, :, :, :), y(:, :, :)
        real(dp) :: heat, other(1)
        integer :: i, j, k

        if (failed(err)) return
        associate (n => box%n)
            allocate (box%u(6, n(1), n(2), n(3)), rho(n(1), n(2), n(3)), p(n(1), n(2), n(3)), &
                      v(3, n(1), n(2), n(3)), y(n(1), n(2), n(3)))
        end associate
        call h5_read(file, cells//'density', rho, err)
        call h5_read(file, cells//'pressure', p, err)
        call h5_read(file, cells//'velocity', v, err)
        y = 0
        other = gamma
        if (two_gases) then
            if (h5_has(file, cells//'products')) then
                call h5_read(file, cells//'products', y, err)
                call h5_read(file, gas//'gamma_products', other, err)
            end if
        end if
        if (failed(err)) return
        if (.not. (all(rho > 0) .and. all(p > 0))) then
            call raise(err, exit_deck, path//': a density or pressure is not positive')
            return
        end if
        do k = 1, box%n(3)
            do j = 1, box%n(2)
                do i = 1, box%n(1)
                    heat = (1 - y(i, j, k))/(gamma - 1) + y(i, j, k)/(other(1) - 1)
                    box%u(1, i, j, k) = rho(i, j, k)
                    box%u(2:4, i, j, k) = rho(i, j, k)*v(:, i, j, k)
                    box%u(5, i, j, k) = p(i, j, k)*heat + rho(i, j, k)/2*sum(v(:, i, j, k)**2)
                    box%u(6, i, j, k) = rho(i, j, k)*y(i, j, k)
                end do
            end do
        end do
    end subroutine read_cells

    !> Ratio of specific heats of the products in the file of a box of gas; 0: it has none.
    real(dp) function second_gamma(input, err) result(gamma)
        type(gas_case_t), intent(in) :: input
        type(error_t), intent(inout) :: err
        type(error_t) :: bad, told
        type(h5_t) :: file
        real(dp) :: own(1)

        gamma = 0
        if (failed(err) .or. input%file == '' .or. index(input%file, '.csv') > 0) return
        call open_dump(trim(input%file), file, bad)
        if (.not. failed(bad)) then
            if (h5_has(file, cells//'products')) then
                call h5_read(file, gas//'gamma_products', own, bad)
                gamma = own(1)
            end if
            call finish(file, bad, told)
        else
            told = bad
        end if
        if (failed(told)) call raise(err, exit_deck, label('gas', input%id, input%place)//told%text)
    end function second_gamma

    !> Open a dump of a box, or say why it is none.
    subroutine open_dump(path, file, err)
        character(*), intent(in) :: path
        type(h5_t), intent(out) :: file
        type(error_t), intent(inout) :: err
        type(error_t) :: bad
        character(:), allocatable :: type, deck

        call h5_open(file, path, bad)
        if (failed(bad)) then
            call raise(err, exit_deck, bad%text//'; name a dump air_*.vtkhdf of a run, or a '// &
                       'table of comma-separated numbers that ends in .csv')
            return
        end if
        call h5_get(file, 'VTKHDF', 'Type', type, bad)
        if (.not. failed(bad) .and. type /= 'ImageData') call raise(bad, exit_deck, path// &
            ': is no dump of the air, but of '//type//'; name an air_*.vtkhdf')
        call h5_get(file, 'brisance', 'deck', deck, bad)
        if (.not. failed(bad)) then
            if (index(deck, "geometry = 'axial'") > 0) call raise(bad, exit_deck, path// &
                ": is of the plane through an axis, which no box takes from a file; use "// &
                "start='2d' of &charge")
        end if
        if (failed(bad)) call finish(file, bad, err)
    end subroutine open_dump

    !> Close a file and hand its error on.
    subroutine finish(file, bad, err)
        type(h5_t), intent(inout) :: file
        type(error_t), intent(in) :: bad
        type(error_t), intent(inout) :: err
        type(error_t) :: closing

        call h5_close(file, closing)
        if (failed(bad) .and. .not. failed(err)) call raise(err, exit_deck, bad%text)
    end subroutine finish
end module brz_gas_box
