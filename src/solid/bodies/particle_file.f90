! SPDX-License-Identifier: MIT
!> Particles from a file: a table with the columns x, y, z and perhaps volume, or an HDF5 file with
!> VTKHDF/Points, as dumps have it, and perhaps VTKHDF/PointData/volume.
module brz_particle_file
    use brz_csv_table, only: read_columns
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_hdf5_array, only: h5_read, h5_shape
    use brz_hdf5_file, only: h5_close, h5_open, h5_t
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: read_particles, read_triples

contains

    !> Read places and volumes; `volume` has no elements where the file has none, `line` where it is
    !> no table.
    subroutine read_particles(path, x, volume, line, err)
        character(*), intent(in) :: path !! ends in .csv, .h5 or .vtkhdf
        real(dp), allocatable, intent(out) :: x(:, :) !! (3, n)
        real(dp), allocatable, intent(out) :: volume(:) !! (n) or (0) [m3]
        integer, allocatable, intent(out) :: line(:) !! (n) or (0) of the file
        type(error_t), intent(inout) :: err

        if (path(max(1, len(path) - 3):) == '.csv') then
            call from_table(path, x, volume, line, err)
        else
            allocate (line(0))
            call from_hdf5(path, x, volume, err)
        end if
        if (failed(err)) return
        if (size(x, 2) == 0) call raise(err, exit_deck, path//': holds no particle')
        if (.not. all(abs(x) < 1e30_dp)) call raise(err, exit_deck, path// &
            ': a coordinate is no finite number')
        if (.not. all(volume > 0)) call raise(err, exit_deck, path//': a volume is not positive')
    end subroutine read_particles

    subroutine from_hdf5(path, x, volume, err)
        character(*), intent(in) :: path
        real(dp), allocatable, intent(inout) :: x(:, :), volume(:)
        type(error_t), intent(inout) :: err
        type(error_t) :: absent
        type(h5_t) :: file
        integer(int64), allocatable :: dims(:)

        call h5_open(file, path, err)
        call read_triples(file, 'VTKHDF/Points', x, err)
        if (failed(err)) return
        call h5_shape(file, 'VTKHDF/PointData/volume', dims, absent)
        allocate (volume(merge(size(x, 2), 0, .not. failed(absent))))
        if (size(volume) > 0) call h5_read(file, 'VTKHDF/PointData/volume', volume, err)
        call h5_close(file, err)
    end subroutine from_hdf5

    !> A table of three numbers for each point: (3, points).
    subroutine read_triples(file, name, x, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        real(dp), allocatable, intent(inout) :: x(:, :)
        type(error_t), intent(inout) :: err !! exit_deck where it is another table
        integer(int64), allocatable :: dims(:)

        call h5_shape(file, name, dims, err)
        if (failed(err)) return
        if (size(dims) /= 2 .or. dims(1) /= 3) then
            call raise(err, exit_deck, file%path//': '//name//' is no table of three columns')
            return
        end if
        allocate (x(3, dims(2)))
        call h5_read(file, name, x, err)
    end subroutine read_triples

    !> Comma-separated text.
    subroutine from_table(path, x, volume, line, err)
        character(*), intent(in) :: path
        real(dp), allocatable, intent(inout) :: x(:, :), volume(:)
        integer, allocatable, intent(inout) :: line(:)
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: values(:, :)
        logical :: found(4)

        call read_columns(path, [character(6) :: 'x', 'y', 'z', 'volume'], values, found, err, &
                          line)
        if (failed(err)) return
        if (.not. all(found(:3))) then
            call raise(err, exit_deck, path//": its first row must name the columns x, y and z")
            return
        end if
        x = values(:3, :)
        volume = pack(values(4, :), spread(found(4), 1, size(values, 2)))
    end subroutine from_table
end module brz_particle_file
