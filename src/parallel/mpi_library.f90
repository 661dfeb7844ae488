! SPDX-License-Identifier: MIT
!> Open MPI, opened at run time: one executable for machines with and without it.
!>
!> The procedure pointers have the names and arguments of the C interface of MPI 3.1; `open_mpi`
!> sets them all, or says what is missing. Communicators, types and operations of Open MPI are
!> addresses of its global objects, alike in versions 4 and 5 (both are libmpi.so.40). Every
!> function returns 0 for success, and by default an error of MPI ends all processes.
module brz_mpi_library
    use, intrinsic :: iso_c_binding, only: c_f_procpointer, c_int, c_intptr_t, c_null_ptr, c_ptr
    use brz_shared_library, only: library_t
    implicit none
    private
    public :: open_mpi, mpi_in_place
    public :: mpi_init, mpi_finalize, mpi_comm_rank, mpi_comm_size, mpi_comm_f2c
    public :: mpi_allreduce, mpi_alltoall, mpi_bcast, mpi_isend, mpi_irecv, mpi_waitall
    public :: mpi_comm_world, mpi_double, mpi_float, mpi_int64, mpi_char, mpi_min, mpi_max, &
              mpi_sum, mpi_bor

    abstract interface
        integer(c_int) function init_i(argc, argv, wanted, given) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: argc, argv
            integer(c_int), value :: wanted
            integer(c_int), intent(out) :: given
        end function init_i
        integer(c_int) function no_argument_i() bind(c)
            import :: c_int
        end function no_argument_i
        integer(c_int) function number_i(comm, number) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: comm
            integer(c_int), intent(out) :: number
        end function number_i
        type(c_ptr) function from_number_i(number) bind(c)
            import :: c_int, c_ptr
            integer(c_int), value :: number
        end function from_number_i
        integer(c_int) function allreduce_i(from, to, n, type, op, comm) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: from, to, type, op, comm
            integer(c_int), value :: n
        end function allreduce_i
        integer(c_int) function alltoall_i(from, n, type, to, n_to, type_to, comm) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: from, type, to, type_to, comm
            integer(c_int), value :: n, n_to
        end function alltoall_i
        integer(c_int) function bcast_i(data, n, type, root, comm) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: data, type, comm
            integer(c_int), value :: n, root
        end function bcast_i
        integer(c_int) function message_i(data, n, type, partner, tag, comm, request) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: data, type, comm
            integer(c_int), value :: n, partner, tag
            type(c_ptr), intent(out) :: request
        end function message_i
        integer(c_int) function waitall_i(n, requests, statuses) bind(c)
            import :: c_int, c_ptr
            integer(c_int), value :: n
            type(c_ptr), intent(inout) :: requests(*)
            type(c_ptr), value :: statuses
        end function waitall_i
    end interface

    integer(c_int), parameter :: one_thread_calls = 1 !! MPI_THREAD_FUNNELED
    character(*), parameter :: usual_name = 'libmpi.so.40'

    type(library_t), save :: library
    type(c_ptr), protected, save :: mpi_comm_world = c_null_ptr
    type(c_ptr), protected, save :: mpi_double = c_null_ptr, mpi_float = c_null_ptr, &
        mpi_int64 = c_null_ptr, mpi_char = c_null_ptr
    type(c_ptr), protected, save :: mpi_min = c_null_ptr, mpi_max = c_null_ptr, &
        mpi_sum = c_null_ptr, mpi_bor = c_null_ptr
    procedure(init_i), pointer, save :: init_thread => null()
    procedure(no_argument_i), pointer, protected, save :: mpi_finalize => null()
    procedure(number_i), pointer, protected, save :: mpi_comm_rank => null(), &
        mpi_comm_size => null()
    procedure(from_number_i), pointer, protected, save :: mpi_comm_f2c => null()
    procedure(allreduce_i), pointer, protected, save :: mpi_allreduce => null()
    procedure(alltoall_i), pointer, protected, save :: mpi_alltoall => null()
    procedure(bcast_i), pointer, protected, save :: mpi_bcast => null()
    procedure(message_i), pointer, protected, save :: mpi_isend => null(), mpi_irecv => null()
    procedure(waitall_i), pointer, protected, save :: mpi_waitall => null()

contains

    !> Open the library and find what is used of it. `why` is unallocated where all is well.
    subroutine open_mpi(why)
        character(:), allocatable, intent(out) :: why
        character(:), allocatable :: name

        if (library%is_open()) return
        name = library_name()
        library = library_t()
        call library%open(name, shared=.true.) ! the parts that Open MPI loads look for it
        if (.not. library%is_open()) then
            why = 'but the library '//name//' of Open MPI was not found'
            return
        end if
        mpi_comm_world = library%object('ompi_mpi_comm_world')
        mpi_double = library%object('ompi_mpi_double')
        mpi_float = library%object('ompi_mpi_float')
        mpi_int64 = library%object('ompi_mpi_int64_t')
        mpi_char = library%object('ompi_mpi_char')
        mpi_min = library%object('ompi_mpi_op_min')
        mpi_max = library%object('ompi_mpi_op_max')
        mpi_sum = library%object('ompi_mpi_op_sum')
        mpi_bor = library%object('ompi_mpi_op_bor')
        call c_f_procpointer(library%function('MPI_Init_thread'), init_thread)
        call c_f_procpointer(library%function('MPI_Finalize'), mpi_finalize)
        call c_f_procpointer(library%function('MPI_Comm_rank'), mpi_comm_rank)
        call c_f_procpointer(library%function('MPI_Comm_size'), mpi_comm_size)
        call c_f_procpointer(library%function('MPI_Comm_f2c'), mpi_comm_f2c)
        call c_f_procpointer(library%function('MPI_Allreduce'), mpi_allreduce)
        call c_f_procpointer(library%function('MPI_Alltoall'), mpi_alltoall)
        call c_f_procpointer(library%function('MPI_Bcast'), mpi_bcast)
        call c_f_procpointer(library%function('MPI_Isend'), mpi_isend)
        call c_f_procpointer(library%function('MPI_Irecv'), mpi_irecv)
        call c_f_procpointer(library%function('MPI_Waitall'), mpi_waitall)
        if (allocated(library%missing)) why = 'but the library '//name// &
            ' is not that of Open MPI: it has no '//library%missing
    end subroutine open_mpi

    !> File of the library: that of the variable BRISANCE_MPI, or what the loader finds.
    function library_name() result(name)
        character(:), allocatable :: name
        character(4096) :: given

        call get_environment_variable('BRISANCE_MPI', given)
        name = trim(given)
        if (name == '') name = usual_name
    end function library_name

    !> Begin MPI; only the first thread will call it.
    integer(c_int) function mpi_init() result(status)
        integer(c_int) :: given

        status = init_thread(c_null_ptr, c_null_ptr, one_thread_calls, given)
    end function mpi_init

    !> What stands for "the result goes where the numbers come from".
    type(c_ptr) function mpi_in_place() result(address)
        address = transfer(1_c_intptr_t, c_null_ptr)
    end function mpi_in_place
end module brz_mpi_library
