! SPDX-License-Identifier: MIT
!> Libraries that are opened at run time: one executable for machines with and without them.
module brz_shared_library
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_funptr, c_int, c_null_char, &
        c_null_ptr, c_ptr
    implicit none
    private
    public :: library_t

    type :: library_t
        type(c_ptr), private :: handle = c_null_ptr
        character(:), allocatable :: missing !! the first name that it does not have
    contains
        procedure :: open => open_library
        procedure :: is_open, object, function => function_of
    end type library_t

    interface
        type(c_ptr) function c_dlopen(file, mode) bind(c, name='dlopen')
            import :: c_char, c_int, c_ptr
            character(kind=c_char), intent(in) :: file(*)
            integer(c_int), value :: mode
        end function c_dlopen
        type(c_ptr) function c_dlsym_object(library, name) bind(c, name='dlsym')
            import :: c_char, c_ptr
            type(c_ptr), value :: library
            character(kind=c_char), intent(in) :: name(*)
        end function c_dlsym_object
        type(c_funptr) function c_dlsym_function(library, name) bind(c, name='dlsym')
            import :: c_char, c_funptr, c_ptr
            type(c_ptr), value :: library
            character(kind=c_char), intent(in) :: name(*)
        end function c_dlsym_function
    end interface

    integer(c_int), parameter :: bind_now = 2, for_all = 256 !! flags of dlopen in Linux

contains

    !> Open a library that the loader finds by its name; is_open tells whether it has.
    subroutine open_library(self, name, shared)
        class(library_t), intent(inout) :: self
        character(*), intent(in) :: name
        logical, intent(in) :: shared !! what it loads itself may look for its names

        self%handle = c_dlopen(name//c_null_char, merge(bind_now + for_all, bind_now, shared))
    end subroutine open_library

    !> True once it has been opened and no name has been found missing.
    pure logical function is_open(self)
        class(library_t), intent(in) :: self

        is_open = c_associated(self%handle) .and. .not. allocated(self%missing)
    end function is_open

    !> Address of a global object.
    type(c_ptr) function object(self, name)
        class(library_t), intent(inout) :: self
        character(*), intent(in) :: name

        object = c_dlsym_object(self%handle, name//c_null_char)
        if (.not. c_associated(object) .and. .not. allocated(self%missing)) self%missing = name
    end function object

    !> Address of a function.
    type(c_funptr) function function_of(self, name) result(address)
        class(library_t), intent(inout) :: self
        character(*), intent(in) :: name

        address = c_dlsym_function(self%handle, name//c_null_char)
        if (.not. c_associated(address) .and. .not. allocated(self%missing)) self%missing = name
    end function function_of
end module brz_shared_library
