! SPDX-License-Identifier: MIT
!> The processes (MPI ranks) of a run: how they start, vote (an all-reduce of errors), add up, and
!> end together.
!>
!> A run that mpirun has not started is one process and never touches MPI. Every procedure here but
!> `start_ranks` and `end_ranks` does nothing for one process.
module brz_ranks
    use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_null_char, c_null_ptr, c_ptr
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_descriptor, only: c_close, c_open
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_kinds, only: dp, int64
    use brz_mpi_library, only: mpi_allreduce, mpi_bcast, mpi_bor, mpi_char, &
        mpi_comm_f2c, mpi_comm_rank, mpi_comm_size, mpi_comm_world, mpi_double, mpi_finalize, &
        mpi_in_place, mpi_init, mpi_int64, mpi_max, mpi_min, mpi_sum, open_mpi
    use brz_text, only: to_text
    use brz_timer, only: lap, wall_seconds
    implicit none
    private
    public :: ranks_t, start_ranks, end_ranks, join_ranks, several
    public :: traffic_t, traffic
    public :: reduce_errors, least_of_all, most_of_all, sum_of_all, bits_of_all, share_text

    type :: ranks_t
        integer :: n = 1 !! processes
        integer :: rank = 0 !! this one, from 0
        integer :: here = 1 !! processes on this machine
        integer :: place = 0 !! number of this one among them, from 0
        type(c_ptr) :: comm = c_null_ptr !! communicator of MPI
    end type ranks_t

    !> What this process has said to others so far, and how long that took.
    type :: traffic_t
        integer(int64) :: reductions = 0 !! numbers reduced over all processes, messages of it
        integer(int64) :: fetches = 0 !! fields fetched
        real(dp) :: seconds = 0 !! in both, most of them waiting
    end type traffic_t

    interface
        integer(c_int) function c_dup2(from, to) bind(c, name='dup2')
            import :: c_int
            integer(c_int), value :: from, to
        end function c_dup2
        integer(c_int) function c_sleep(seconds) bind(c, name='sleep')
            import :: c_int
            integer(c_int), value :: seconds
        end function c_sleep
    end interface

    integer(c_int), parameter :: standard_output = 1, standard_error = 2, to_write = 1
    logical, save :: begun = .false. !! MPI is
    type(traffic_t), save :: traffic

contains

    !> Join the other processes if mpirun (or srun) has started this one. All but the first are
    !> silent from then on.
    subroutine start_ranks(ranks, err)
        type(ranks_t), intent(out) :: ranks
        type(error_t), intent(inout) :: err
        character(:), allocatable :: why
        integer(c_int) :: number, status
        logical :: by_open_mpi, by_pmix, by_another

        by_open_mpi = is_set('OMPI_COMM_WORLD_SIZE')
        by_pmix = is_set('PMIX_RANK') ! srun --mpi=pmix
        by_another = is_set('PMI_RANK')
        if (.not. (by_open_mpi .or. by_pmix)) then
            if (.not. by_another) return
            if (number_in('PMI_SIZE') == 1) return
            ranks%rank = number_in('PMI_RANK')
            why = 'by an MPI that is not Open MPI (PMI_RANK is set, '// &
                  'OMPI_COMM_WORLD_SIZE is not)'
        else
            ranks%rank = number_in('PMIX_RANK')
            if (by_open_mpi) ranks%rank = number_in('OMPI_COMM_WORLD_RANK')
            call open_mpi(why)
            if (.not. allocated(why)) then
                status = mpi_init()
                begun = status == 0
                if (.not. begun) why = 'but MPI_Init failed'
            end if
        end if
        if (allocated(why)) then
            ! mpirun ends all processes when the first has ended: let that one speak before
            if (ranks%rank > 0) status = c_sleep(2_c_int)
            call raise(err, exit_device, 'started as one of several processes, '//why// &
                       '; take the mpirun of Open MPI 4 or 5, name its library in '// &
                       'BRISANCE_MPI, or run one process without mpirun')
            if (ranks%rank > 0) call be_silent()
            return
        end if
        ranks%comm = mpi_comm_world
        status = mpi_comm_rank(ranks%comm, number)
        ranks%rank = number
        status = mpi_comm_size(ranks%comm, number)
        ranks%n = number
        ranks%here = number_in('OMPI_COMM_WORLD_LOCAL_SIZE')
        if (ranks%here < 1) ranks%here = ranks%n ! as srun starts them: as if all were here
        ranks%place = ranks%rank
        if (is_set('SLURM_LOCALID')) ranks%place = number_in('SLURM_LOCALID')
        if (is_set('OMPI_COMM_WORLD_LOCAL_RANK')) &
            ranks%place = number_in('OMPI_COMM_WORLD_LOCAL_RANK')
        if (ranks%rank > 0) call be_silent()
    end subroutine start_ranks

    !> Leave the others. All must come here, with the same error or none.
    subroutine end_ranks()
        integer(c_int) :: status

        if (.not. begun) return
        flush (output_unit)
        flush (error_unit)
        status = mpi_finalize()
    end subroutine end_ranks

    !> The company of a communicator that others have made, as Fortran numbers it. MPI has begun.
    subroutine join_ranks(communicator, ranks, err)
        integer, intent(in) :: communicator
        type(ranks_t), intent(out) :: ranks
        type(error_t), intent(inout) :: err
        character(:), allocatable :: why
        integer(c_int) :: number, status

        call open_mpi(why)
        if (allocated(why)) then
            call raise(err, exit_device, why)
            return
        end if
        ranks%comm = mpi_comm_f2c(int(communicator, c_int))
        status = mpi_comm_rank(ranks%comm, number)
        ranks%rank = number
        status = mpi_comm_size(ranks%comm, number)
        ranks%n = number
        ranks%here = number ! as if all were here
        ranks%place = ranks%rank
    end subroutine join_ranks

    !> True if there is anybody to talk to.
    pure logical function several(ranks)
        type(ranks_t), intent(in) :: ranks

        several = ranks%n > 1
    end function several

    !> An all-reduce of errors: if any process has an error, all get that of the lowest one that
    !> has. `least` becomes the least of all in the same message.
    subroutine reduce_errors(ranks, err, least)
        type(ranks_t), intent(in) :: ranks
        type(error_t), intent(inout) :: err
        real(dp), intent(inout), optional :: least(:)
        real(dp), allocatable :: reduction(:)
        integer :: n, speaker, how_many

        if (.not. several(ranks)) return
        n = 0
        if (present(least)) n = size(least)
        allocate (reduction(n + 1))
        reduction(1) = merge(ranks%rank, ranks%n, failed(err))
        if (n > 0) reduction(2:) = least
        call least_of_all(ranks, reduction)
        if (n > 0) least = reduction(2:)
        speaker = nint(reduction(1))
        if (speaker == ranks%n) return
        reduction(1) = merge(1, 0, failed(err))
        how_many = nint(total(ranks, reduction(1)))
        call share_error(ranks, speaker, how_many < ranks%n, err)
    end subroutine reduce_errors

    !> Give all processes the error of one.
    subroutine share_error(ranks, speaker, named, err)
        type(ranks_t), intent(in) :: ranks
        integer, intent(in) :: speaker
        logical, intent(in) :: named !! say whose error it is
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text
        integer(int64) :: code(1)

        code = 0
        text = ''
        if (ranks%rank == speaker) then
            code = err%code
            if (allocated(err%text)) text = err%text
            if (named) text = who(ranks)//text
        end if
        call sum_of_all(ranks, code)
        call share_text(ranks, speaker, text)
        err%code = int(code(1))
        err%text = text
    end subroutine share_error

    !> Give all processes a text of one.
    subroutine share_text(ranks, speaker, text)
        type(ranks_t), intent(in) :: ranks
        integer, intent(in) :: speaker
        character(:), allocatable, intent(inout) :: text
        integer(int64) :: length(1)
        integer(c_int) :: status

        if (.not. several(ranks)) return
        length = 0
        if (ranks%rank == speaker) length = len(text, int64)
        call sum_of_all(ranks, length)
        block
            character(int(length(1)) + 1), target :: letters

            letters = ''
            if (ranks%rank == speaker) letters = text
            status = mpi_bcast(c_loc(letters), int(len(letters), c_int), mpi_char, &
                               int(speaker, c_int), ranks%comm)
            text = letters(:len(letters) - 1)
        end block
    end subroutine share_text

    !> Replace every number by the least of it over all processes.
    subroutine least_of_all(ranks, x)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(inout), target, contiguous :: x(:)

        if (several(ranks) .and. size(x) > 0) &
            call reduce(ranks, c_loc(x), size(x, kind=c_int), mpi_double, mpi_min)
    end subroutine least_of_all

    !> Replace every whole number by the largest of it over all processes.
    subroutine most_of_all(ranks, x)
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(inout), target, contiguous :: x(:)

        if (several(ranks) .and. size(x) > 0) &
            call reduce(ranks, c_loc(x), size(x, kind=c_int), mpi_int64, mpi_max)
    end subroutine most_of_all

    !> Replace every whole number by its sum over all processes.
    subroutine sum_of_all(ranks, x)
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(inout), target, contiguous :: x(:)

        if (several(ranks) .and. size(x) > 0) &
            call reduce(ranks, c_loc(x), size(x, kind=c_int), mpi_int64, mpi_sum)
    end subroutine sum_of_all

    !> Gather numbers of which each is 0 to the bit in all processes but one.
    subroutine bits_of_all(ranks, x)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(inout), target, contiguous :: x(:)

        if (several(ranks) .and. size(x) > 0) &
            call reduce(ranks, c_loc(x), size(x, kind=c_int), mpi_int64, mpi_bor)
    end subroutine bits_of_all

    !> Reduce numbers over all processes, in place.
    subroutine reduce(ranks, numbers, n, type, operation)
        type(ranks_t), intent(in) :: ranks
        type(c_ptr), intent(in) :: numbers, type, operation
        integer(c_int), intent(in) :: n
        integer(c_int) :: status
        real(dp) :: mark

        mark = wall_seconds()
        status = mpi_allreduce(mpi_in_place(), numbers, n, type, operation, ranks%comm)
        traffic%reductions = traffic%reductions + 1
        call lap(mark, traffic%seconds)
    end subroutine reduce

    !> How this process is called in messages.
    pure function who(ranks) result(text)
        type(ranks_t), intent(in) :: ranks
        character(:), allocatable :: text

        text = 'process '//to_text(ranks%rank + 1)//' of '//to_text(ranks%n)//': '
    end function who

    !> Sum of a small whole number over all processes.
    real(dp) function total(ranks, x)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: x
        integer(int64) :: number(1)

        number = nint(x, int64)
        call sum_of_all(ranks, number)
        total = real(number(1), dp)
    end function total

    !> Print nothing from now on.
    subroutine be_silent()
        integer(c_int) :: nowhere, status

        flush (output_unit)
        flush (error_unit)
        nowhere = c_open('/dev/null'//c_null_char, to_write, 0_c_int)
        if (nowhere < 0) return
        status = c_dup2(nowhere, standard_output)
        status = c_dup2(nowhere, standard_error)
        status = c_close(nowhere)
    end subroutine be_silent

    !> True for an environment variable that is set.
    logical function is_set(name)
        character(*), intent(in) :: name
        integer :: length

        call get_environment_variable(name, length=length)
        is_set = length > 0
    end function is_set

    !> Number in an environment variable, 0 if there is none.
    integer function number_in(name) result(number)
        character(*), intent(in) :: name
        character(32) :: text
        integer :: io

        call get_environment_variable(name, text)
        read (text, *, iostat=io) number
        if (io /= 0) number = 0
    end function number_in
end module brz_ranks
