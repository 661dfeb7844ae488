! SPDX-License-Identifier: MIT
!> What all dumps share: VTKHDF files for one time each, which ParaView and pyvista open.
!>
!> Format: VTKHDF 2.0 (docs.vtk.org), without a `Steps` group: an ImageData with a single step
!> cannot be read. The time stands in FieldData and in the series file.
module brz_vtkhdf
    use brz_errors, only: error_t
    use brz_hdf5_array, only: h5_write
    use brz_hdf5_attribute, only: h5_put
    use brz_hdf5_file, only: h5_t, h5_close, h5_create, h5_group, h5_packed
    use brz_kinds, only: int8, int32, real32, real64
    use brz_meta, only: meta_t, write_meta
    implicit none
    private
    public :: begin_dump, end_dump, write_field, root

    character(*), parameter :: root = 'VTKHDF'

    !> Write one field of the points or cells with its unit.
    interface write_field
        module procedure write_field_real64, write_field_real32, write_field_int32, write_field_int8
    end interface write_field

contains

    !> Start a dump.
    subroutine begin_dump(file, path, type, err)
        type(h5_t), intent(inout) :: file
        character(*), intent(in) :: path
        character(*), intent(in) :: type !! 'ImageData' or 'PolyData'
        type(error_t), intent(inout) :: err

        call h5_create(file, path, h5_packed, err)
        call h5_group(file, root, err)
        call h5_put(file, root, 'Version', [2, 0], err)
        call h5_put(file, root, 'Type', type, err)
    end subroutine begin_dump

    !> Add the time and the origin, and give the file its name.
    subroutine end_dump(file, meta, err)
        type(h5_t), intent(inout) :: file
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err

        call h5_write(file, root//'/FieldData/time', [meta%time], err)
        call h5_write(file, root//'/FieldData/cycle', [meta%cycle], err)
        call write_meta(file, meta, err)
        call h5_close(file, err)
    end subroutine end_dump

    subroutine write_field_real64(file, name, unit, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name !! with its group, e.g. 'CellData/pressure'
        character(*), intent(in) :: unit
        real(real64), intent(in), contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call h5_write(file, root//'/'//name, a, err)
        call h5_put(file, root//'/'//name, 'units', unit, err)
    end subroutine write_field_real64

    subroutine write_field_real32(file, name, unit, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name, unit
        real(real32), intent(in), contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call h5_write(file, root//'/'//name, a, err)
        call h5_put(file, root//'/'//name, 'units', unit, err)
    end subroutine write_field_real32

    subroutine write_field_int32(file, name, unit, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name, unit
        integer(int32), intent(in), contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call h5_write(file, root//'/'//name, a, err)
        call h5_put(file, root//'/'//name, 'units', unit, err)
    end subroutine write_field_int32

    subroutine write_field_int8(file, name, unit, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name, unit
        integer(int8), intent(in), contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call h5_write(file, root//'/'//name, a, err)
        call h5_put(file, root//'/'//name, 'units', unit, err)
    end subroutine write_field_int8
end module brz_vtkhdf
