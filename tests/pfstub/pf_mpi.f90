! SPDX-License-Identifier: MIT
!> Tests on several processes: the executable starts itself under mpirun for one test, and every
!> process writes what it throws into a file of its own. MPI is opened at run time, never linked.
module pf_mpi
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
        c_null_char, c_null_ptr, c_ptr
    use pf_core, only: anyExceptions, MpiTestMethod, SourceLocation, test_t, throw, thrown_text
    implicit none
    private
    public :: there_is_mpirun, run_on_processes, run_as_process

    integer, parameter :: time_limit = 600 !! of one test [s]
    integer(c_int), parameter :: bind_now = 2, for_all = 256 !! flags of dlopen in Linux

    abstract interface
        integer(c_int) function init_i(argc, argv) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: argc, argv
        end function init_i
        integer(c_int) function number_i(comm, number) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: comm
            integer(c_int), intent(out) :: number
        end function number_i
        integer(c_int) function to_fortran_i(comm) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: comm
        end function to_fortran_i
        integer(c_int) function finalize_i() bind(c)
            import :: c_int
        end function finalize_i
    end interface

    interface
        type(c_ptr) function dlopen(file, mode) bind(c)
            import :: c_char, c_int, c_ptr
            character(kind=c_char), intent(in) :: file(*)
            integer(c_int), value :: mode
        end function dlopen
        type(c_ptr) function find_object(library, name) bind(c, name='dlsym')
            import :: c_char, c_ptr
            type(c_ptr), value :: library
            character(kind=c_char), intent(in) :: name(*)
        end function find_object
        type(c_funptr) function find_function(library, name) bind(c, name='dlsym')
            import :: c_char, c_funptr, c_ptr
            type(c_ptr), value :: library
            character(kind=c_char), intent(in) :: name(*)
        end function find_function
        integer(c_int) function sleep(seconds) bind(c)
            import :: c_int
            integer(c_int), value :: seconds
        end function sleep
        subroutine quick_exit(status) bind(c, name='_exit')
            import :: c_int
            integer(c_int), value :: status
        end subroutine quick_exit
    end interface

contains

    logical function there_is_mpirun()
        integer :: code

        call execute_command_line('command -v mpirun >/dev/null 2>&1 || exit 1', exitstat=code)
        there_is_mpirun = code == 0
    end function there_is_mpirun

    !> Start a test on its processes, and throw what they have thrown.
    subroutine run_on_processes(test, record)
        type(test_t), intent(in) :: test
        character(*), intent(in) :: record !! begin of names of files
        character(4096) :: program
        character(12) :: number, limit
        integer :: code

        call get_command_argument(0, program)
        write (number, '(i0)') test%npes
        write (limit, '(i0)') time_limit
        call execute_command_line('OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 '// &
            'OMP_NUM_THREADS=1 timeout -k 10 '//trim(limit)//' mpirun -q --oversubscribe '// &
            '--mca mpi_yield_when_idle 1 --mca btl self,vader --mca pml ob1 -n '//trim(number)// &
            " '"//trim(program)//"' --process '"//test%suite//'.'//test%name//"' "//record// &
            ' </dev/null || exit $(($? > 126 ? 126 : $?))', exitstat=code)
        call gather(test%npes, record)
        if (code == 0 .or. anyExceptions()) return
        write (number, '(i0)') code
        call throw('mpirun ended with code '//trim(number)//trim(merge(' (time limit)', &
                   '             ', code == 124)), location=SourceLocation(test%name, 0))
    end subroutine run_on_processes

    !> Throw what the processes have thrown, and remove their files.
    subroutine gather(n, record)
        integer, intent(in) :: n
        character(*), intent(in) :: record
        character(2048) :: line
        character(24) :: place
        integer :: rank, unit, io

        do rank = 0, n - 1
            write (place, '(a, i0)') '.', rank
            open (newunit=unit, file=record//trim(place), action='read', status='old', iostat=io)
            if (io /= 0) cycle
            do
                read (unit, '(a)', iostat=io) line
                if (io /= 0) exit
                call throw(trim(line), location=SourceLocation('process '//trim(place(2:)), n))
            end do
            close (unit, status='delete')
        end do
    end subroutine gather

    !> The part of one process: run the test and write what it throws. One that fails ends the
    !> others, which may wait for it.
    subroutine run_as_process(test, record)
        type(test_t), intent(in) :: test
        character(*), intent(in) :: record
        procedure(finalize_i), pointer :: finalize
        type(MpiTestMethod) :: this
        type(c_ptr) :: library
        character(24) :: place
        integer(c_int) :: status
        integer :: unit

        library = dlopen('libmpi.so.40'//c_null_char, bind_now + for_all)
        if (.not. c_associated(library)) error stop 'libmpi.so.40 was not found'
        call begin(library, this)
        call test%run_mpi(this)
        if (anyExceptions()) then
            write (place, '(a, i0)') '.', this%process
            open (newunit=unit, file=record//trim(place), action='write', status='replace')
            write (unit, '(a)') thrown_text()
            close (unit)
            status = sleep(1_c_int) ! others may have something to say as well
            call quick_exit(1_c_int)
        end if
        call c_f_procpointer(find_function(library, 'MPI_Finalize'//c_null_char), finalize)
        status = finalize()
    end subroutine run_as_process

    !> Begin MPI and ask it who this is.
    subroutine begin(library, this)
        type(c_ptr), intent(in) :: library
        type(MpiTestMethod), intent(inout) :: this
        procedure(init_i), pointer :: init
        procedure(number_i), pointer :: rank, size
        procedure(to_fortran_i), pointer :: to_fortran
        type(c_ptr) :: world
        integer(c_int) :: status, number

        world = find_object(library, 'ompi_mpi_comm_world'//c_null_char)
        call c_f_procpointer(find_function(library, 'MPI_Init'//c_null_char), init)
        call c_f_procpointer(find_function(library, 'MPI_Comm_rank'//c_null_char), rank)
        call c_f_procpointer(find_function(library, 'MPI_Comm_size'//c_null_char), size)
        call c_f_procpointer(find_function(library, 'MPI_Comm_c2f'//c_null_char), to_fortran)
        status = init(c_null_ptr, c_null_ptr)
        status = rank(world, number)
        this%process = number
        status = size(world, number)
        this%processes = number
        this%communicator = to_fortran(world)
    end subroutine begin
end module pf_mpi
