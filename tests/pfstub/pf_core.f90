! SPDX-License-Identifier: MIT
!> What a test throws, what a suite holds, and the comparisons behind the assertions.
module pf_core
    use, intrinsic :: iso_fortran_env, only: int64, real64
    use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
    implicit none
    private
    public :: SourceLocation, TestSuite, test_t, test_i, MpiTestMethod
    public :: anyExceptions, throw, thrown_text, forget_exceptions
    public :: compare_reals, compare_integers
    public :: op_equal, op_not_equal, op_less, op_less_equal, op_greater, &
              op_greater_equal, op_relative

    integer, parameter :: op_equal = 1, op_not_equal = 2, op_less = 3, op_less_equal = 4, &
                          op_greater = 5, op_greater_equal = 6, op_relative = 7
    character(2), parameter :: sign_of(7) = ['==', '/=', '< ', '<=', '> ', '>=', '==']

    type :: SourceLocation
        character(256) :: file = ''
        integer :: line = 0
    end type SourceLocation

    !> What a test on several processes is given.
    type :: MpiTestMethod
        integer :: process = 0, processes = 1, communicator = 0
    contains
        procedure :: getProcessRank, getNumProcesses, getMpiCommunicator
    end type MpiTestMethod

    abstract interface
        subroutine test_i()
        end subroutine test_i
        subroutine mpi_test_i(this)
            import :: MpiTestMethod
            class(MpiTestMethod), intent(inout) :: this
        end subroutine mpi_test_i
    end interface

    type :: test_t
        character(:), allocatable :: suite, name
        procedure(test_i), pointer, nopass :: run => null(), before => null(), after => null()
        procedure(mpi_test_i), pointer, nopass :: run_mpi => null()
        integer :: npes = 0 !! processes; 0: a test without MPI
        logical :: disabled = .false.
    end type test_t

    type :: TestSuite
        character(:), allocatable :: name
        procedure(test_i), pointer, nopass :: before => null(), after => null()
        type(test_t), allocatable :: tests(:)
    contains
        procedure :: begin, set_before, set_after, addTest, addMpiTest
    end type TestSuite

    character(:), allocatable :: thrown !! messages of the running test

contains

    subroutine begin(self, name)
        class(TestSuite), intent(inout) :: self
        character(*), intent(in) :: name

        self%name = name
        allocate (self%tests(0))
    end subroutine begin

    subroutine set_before(self, before)
        class(TestSuite), intent(inout) :: self
        procedure(test_i) :: before

        self%before => before
    end subroutine set_before

    subroutine set_after(self, after)
        class(TestSuite), intent(inout) :: self
        procedure(test_i) :: after

        self%after => after
    end subroutine set_after

    subroutine addTest(self, name, run, disabled)
        class(TestSuite), intent(inout) :: self
        character(*), intent(in) :: name
        procedure(test_i) :: run
        logical, intent(in), optional :: disabled
        type(test_t) :: test

        test%suite = self%name
        test%name = name
        test%run => run
        test%before => self%before
        test%after => self%after
        if (present(disabled)) test%disabled = disabled
        self%tests = [self%tests, test]
    end subroutine addTest

    !> A test on several processes, once for each number of them.
    subroutine addMpiTest(self, name, run, npes, disabled)
        class(TestSuite), intent(inout) :: self
        character(*), intent(in) :: name
        procedure(mpi_test_i) :: run
        integer, intent(in) :: npes(:)
        logical, intent(in), optional :: disabled
        type(test_t) :: test
        character(12) :: number
        integer :: i

        test%suite = self%name
        test%run_mpi => run
        if (present(disabled)) test%disabled = disabled
        do i = 1, size(npes)
            write (number, '(i0)') npes(i)
            test%name = name//'[npes='//trim(number)//']'
            test%npes = npes(i)
            self%tests = [self%tests, test]
        end do
    end subroutine addMpiTest

    integer function getProcessRank(this)
        class(MpiTestMethod), intent(in) :: this

        getProcessRank = this%process
    end function getProcessRank

    integer function getNumProcesses(this)
        class(MpiTestMethod), intent(in) :: this

        getNumProcesses = this%processes
    end function getNumProcesses

    integer function getMpiCommunicator(this)
        class(MpiTestMethod), intent(in) :: this

        getMpiCommunicator = this%communicator
    end function getMpiCommunicator

    logical function anyExceptions()
        anyExceptions = allocated(thrown)
    end function anyExceptions

    subroutine forget_exceptions()
        if (allocated(thrown)) deallocate (thrown)
    end subroutine forget_exceptions

    function thrown_text() result(text)
        character(:), allocatable :: text

        text = ''
        if (allocated(thrown)) text = thrown
    end function thrown_text

    !> Let the running test fail. Messages of one test are kept together.
    subroutine throw(text, message, location)
        character(*), intent(in) :: text
        character(*), intent(in), optional :: message
        type(SourceLocation), intent(in) :: location
        character(12) :: line
        character(:), allocatable :: whole

        write (line, '(i0)') location%line
        whole = '['//trim(location%file)//':'//trim(line)//'] '
        if (present(message)) whole = whole//message//' '
        whole = whole//text
        if (allocated(thrown)) then
            thrown = thrown//new_line('a')//whole
        else
            thrown = whole
        end if
    end subroutine throw

    !> Compare element by element. A scalar `expected` (empty shape) stands for all elements.
    subroutine compare_reals(op, expected, e_shape, actual, a_shape, tolerance, message, location)
        integer, intent(in) :: op
        real(real64), intent(in) :: expected(:), actual(:) !! flattened
        integer, intent(in) :: e_shape(:), a_shape(:)
        real(real64), intent(in), optional :: tolerance
        character(*), intent(in), optional :: message
        type(SourceLocation), intent(in) :: location
        real(real64) :: bound, e, gap, worst
        integer :: i, at

        if (.not. shapes_agree(e_shape, a_shape, message, location)) return
        bound = 0
        if (present(tolerance)) bound = tolerance
        at = 0
        worst = -1
        do i = 1, size(actual)
            e = expected(min(i, size(expected)))
            if (holds(op, e, actual(i), bound)) cycle
            gap = abs(actual(i) - e)
            if (ieee_is_nan(gap)) gap = huge(gap)
            if (gap <= worst) cycle
            worst = gap
            at = i
        end do
        if (at == 0) return
        e = expected(min(at, size(expected)))
        call throw('expected '//number(e)//' '//sign_of(op)//' '//number(actual(at)) &
                   //difference(op, e, actual(at), bound)//place(at, a_shape), message, location)
    end subroutine compare_reals

    !> The same for integers.
    subroutine compare_integers(op, expected, e_shape, actual, a_shape, message, location)
        integer, intent(in) :: op
        integer(int64), intent(in) :: expected(:), actual(:) !! flattened
        integer, intent(in) :: e_shape(:), a_shape(:)
        character(*), intent(in), optional :: message
        type(SourceLocation), intent(in) :: location
        character(24) :: first, second
        integer(int64) :: e
        integer :: i

        if (.not. shapes_agree(e_shape, a_shape, message, location)) return
        do i = 1, size(actual)
            e = expected(min(i, size(expected)))
            if (whole_holds(op, e, actual(i))) cycle
            write (first, '(i0)') e
            write (second, '(i0)') actual(i)
            call throw('expected '//trim(first)//' '//sign_of(op)//' '//trim(second) &
                       //place(i, a_shape), message, location)
            return
        end do
    end subroutine compare_integers

    logical function shapes_agree(e_shape, a_shape, message, location)
        integer, intent(in) :: e_shape(:), a_shape(:)
        character(*), intent(in), optional :: message
        type(SourceLocation), intent(in) :: location
        character(80) :: text

        shapes_agree = .true.
        if (size(e_shape) == 0) return
        shapes_agree = all(e_shape == a_shape)
        if (shapes_agree) return
        write (text, '(*(i0, :, " "))') e_shape, a_shape
        call throw('the shapes differ, expected then actual: '//trim(text), message, location)
    end function shapes_agree

    pure logical function holds(op, e, a, bound)
        integer, intent(in) :: op
        real(real64), intent(in) :: e, a, bound

        select case (op)
        case (op_equal)
            holds = abs(a - e) <= bound .or. a == e
        case (op_relative)
            holds = abs(a - e) <= bound*abs(e) .and. abs(e) > 0
        case (op_not_equal)
            holds = e /= a
        case (op_less)
            holds = e < a
        case (op_less_equal)
            holds = e <= a
        case (op_greater)
            holds = e > a
        case default
            holds = e >= a
        end select
    end function holds

    pure logical function whole_holds(op, e, a)
        integer, intent(in) :: op
        integer(int64), intent(in) :: e, a

        select case (op)
        case (op_equal)
            whole_holds = e == a
        case (op_not_equal)
            whole_holds = e /= a
        case (op_less)
            whole_holds = e < a
        case (op_less_equal)
            whole_holds = e <= a
        case (op_greater)
            whole_holds = e > a
        case default
            whole_holds = e >= a
        end select
    end function whole_holds

    pure function number(x) result(text)
        real(real64), intent(in) :: x
        character(:), allocatable :: text
        character(32) :: buffer

        write (buffer, '(es24.16e3)') x
        text = trim(adjustl(buffer))
    end function number

    pure function difference(op, e, a, bound) result(text)
        integer, intent(in) :: op
        real(real64), intent(in) :: e, a, bound
        character(:), allocatable :: text

        text = ''
        if (op == op_equal) text = '; difference '//number(a - e)//', tolerance '//number(bound)
        if (op == op_relative) text = '; relative difference '//number((a - e)/e)// &
                                      ', tolerance '//number(bound)
    end function difference

    !> Where element `at` of the flattened array lies.
    pure function place(at, dims) result(text)
        integer, intent(in) :: at, dims(:)
        character(:), allocatable :: text
        character(40) :: buffer

        buffer = ''
        if (size(dims) == 1) write (buffer, '("; worst at [", i0, "]")') at
        if (size(dims) == 2) write (buffer, '("; worst at [", i0, ", ", i0, "]")') &
            mod(at - 1, dims(1)) + 1, (at - 1)/dims(1) + 1
        text = trim(buffer)
    end function place
end module pf_core
