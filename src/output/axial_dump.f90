! SPDX-License-Identifier: MIT
!> Dump of a blast in the plane through its axis: a VTKHDF image one cell thick in the place of that
!> plane, with the fields of a dump of the air. Its cells grow with the blast.
module brz_axial_dump
    use brz_axial_start, only: frame_t
    use brz_axial_state, only: axial_t, top_of, w_p, w_part, w_r, w_rho, w_z
    use brz_errors, only: error_t
    use brz_gas_fields, only: gas_fields, gas_values_t, make_values, set_values, write_values
    use brz_hdf5_array, only: h5_write
    use brz_hdf5_attribute, only: h5_put
    use brz_hdf5_file, only: h5_t
    use brz_kinds, only: dp, int8
    use brz_meta, only: meta_t
    use brz_vtkhdf, only: begin_dump, end_dump, root
    implicit none
    private
    public :: write_axial_dump

contains

    !> Write the plane to `path`.
    subroutine write_axial_dump(path, blast, frame, meta, err)
        character(*), intent(in) :: path
        type(axial_t), intent(in) :: blast !! prepared
        type(frame_t), intent(in) :: frame
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        real(dp) :: low(3), side(3), rest(2)
        integer :: cells(3), extent(6)

        cells([frame%across, frame%axis]) = [blast%n, 1, blast%n - blast%low + 1]
        side([frame%across, frame%axis]) = [blast%dr, blast%dr, blast%dz]
        low = frame%centre
        low(frame%across(2)) = low(frame%across(2)) - blast%dr/2
        low(frame%axis) = low(frame%axis) + top_of(blast, blast%low - 1)
        extent = 0
        extent(2::2) = cells
        rest = [blast%input%density, blast%input%pressure]
        call begin_dump(file, path, 'ImageData', err)
        call h5_put(file, root, 'WholeExtent', extent, err)
        call h5_put(file, root, 'Origin', low, err)
        call h5_put(file, root, 'Spacing', side, err)
        call h5_put(file, root, 'Direction', [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, &
                                              0.0_dp, 0.0_dp, 1.0_dp], err)
        call h5_write(file, root//'/FieldData/gamma', [blast%input%gamma], err)
        call h5_write(file, root//'/FieldData/gamma_products', [1 + blast%input%eos%omega], err)
        call h5_write(file, root//'/FieldData/rest_density', rest(1:1), err)
        call h5_write(file, root//'/FieldData/rest_pressure', rest(2:2), err)
        call put_fields(file, blast, frame, cells, err)
        call end_dump(file, meta, err)
    end subroutine write_axial_dump

    !> The fields of the cells, in the order of the scene's axes.
    subroutine put_fields(file, blast, frame, cells, err)
        type(h5_t), intent(in) :: file
        type(axial_t), intent(in) :: blast
        type(frame_t), intent(in) :: frame
        integer, intent(in) :: cells(3)
        type(error_t), intent(inout) :: err
        type(gas_values_t) :: fields(size(gas_fields))
        integer :: i, j, at(3)
        real(dp) :: v(3)

        call make_values(cells, fields)
        v = 0
        do j = blast%low, blast%n
            do i = 1, blast%n
                at([frame%across, frame%axis]) = [i, 1, j - blast%low + 1]
                associate (w => blast%w(i, :, j))
                    v([frame%across(1), frame%axis]) = w([w_r, w_z])
                    call set_values(fields, at, [w(w_rho), v, w(w_p)], blast%input%pressure, &
                                    0_int8, w(w_part))
                end associate
            end do
        end do
        call write_values(file, fields, err)
    end subroutine put_fields
end module brz_axial_dump
