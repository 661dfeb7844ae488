! SPDX-License-Identifier: MIT
!> The CUDA driver API, opened at run time: one executable for machines with and without a GPU.
!>
!> The procedure pointers have the names and arguments of the API; `load_driver` sets them all, or
!> says what is missing. Every function returns 0 for success.
module brz_cuda_driver
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_f_procpointer, c_float, c_int, &
        c_int64_t, c_intptr_t, c_ptr, c_signed_char, c_size_t
    use brz_shared_library, only: library_t
    implicit none
    private
    public :: load_driver, driver_message
    public :: cu_init, cu_driver_version, cu_device_count, cu_device, cu_device_name
    public :: cu_device_attribute, cu_context_retain, cu_context_set, cu_memory_info
    public :: cu_module_load, cu_module_function, cu_allocate, cu_free, cu_to_device, cu_to_host
    public :: cu_copy, cu_fill_bytes, cu_launch, cu_synchronize, cu_event_create, cu_event_record
    public :: cu_event_synchronize, cu_event_elapsed, cu_host_register, cu_host_unregister
    public :: ipc_handle_t, ipc_lazily, cu_ipc_export, cu_ipc_open, cu_ipc_close

    !> What another process needs to see memory of this one, CUipcMemHandle.
    type, bind(c) :: ipc_handle_t
        integer(c_int64_t) :: word(8) = 0
    end type ipc_handle_t
    integer(c_int), parameter :: ipc_lazily = 1 !! CU_IPC_MEM_LAZY_ENABLE_PEER_ACCESS

    abstract interface
        integer(c_int) function no_argument_i() bind(c)
            import :: c_int
        end function no_argument_i
        integer(c_int) function flags_i(flags) bind(c)
            import :: c_int
            integer(c_int), value :: flags
        end function flags_i
        integer(c_int) function number_i(number) bind(c)
            import :: c_int
            integer(c_int), intent(out) :: number
        end function number_i
        integer(c_int) function device_i(device, ordinal) bind(c)
            import :: c_int
            integer(c_int), intent(out) :: device
            integer(c_int), value :: ordinal
        end function device_i
        integer(c_int) function name_i(name, length, device) bind(c)
            import :: c_char, c_int
            character(kind=c_char), intent(out) :: name(*)
            integer(c_int), value :: length, device
        end function name_i
        integer(c_int) function attribute_i(number, attribute, device) bind(c)
            import :: c_int
            integer(c_int), intent(out) :: number
            integer(c_int), value :: attribute, device
        end function attribute_i
        integer(c_int) function create_i(handle, number) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), intent(out) :: handle
            integer(c_int), value :: number
        end function create_i
        integer(c_int) function handle_i(handle) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: handle
        end function handle_i
        integer(c_int) function memory_i(free, total) bind(c)
            import :: c_int, c_size_t
            integer(c_size_t), intent(out) :: free, total
        end function memory_i
        integer(c_int) function load_i(module, image, n, options, values) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), intent(out) :: module
            type(c_ptr), value :: image
            integer(c_int), value :: n
            integer(c_int), intent(in) :: options(*)
            type(c_ptr), intent(inout) :: values(*)
        end function load_i
        integer(c_int) function function_i(kernel, module, name) bind(c)
            import :: c_char, c_int, c_ptr
            type(c_ptr), intent(out) :: kernel
            type(c_ptr), value :: module
            character(kind=c_char), intent(in) :: name(*)
        end function function_i
        integer(c_int) function allocate_i(address, bytes) bind(c)
            import :: c_int, c_intptr_t, c_size_t
            integer(c_intptr_t), intent(out) :: address
            integer(c_size_t), value :: bytes
        end function allocate_i
        integer(c_int) function free_i(address) bind(c)
            import :: c_int, c_intptr_t
            integer(c_intptr_t), value :: address
        end function free_i
        integer(c_int) function register_i(host, bytes, flags) bind(c)
            import :: c_int, c_ptr, c_size_t
            type(c_ptr), value :: host
            integer(c_size_t), value :: bytes
            integer(c_int), value :: flags
        end function register_i
        integer(c_int) function ipc_export_i(handle, address) bind(c)
            import :: c_int, c_intptr_t, ipc_handle_t
            type(ipc_handle_t), intent(out) :: handle
            integer(c_intptr_t), value :: address
        end function ipc_export_i
        integer(c_int) function ipc_open_i(address, handle, flags) bind(c)
            import :: c_int, c_intptr_t, ipc_handle_t
            integer(c_intptr_t), intent(out) :: address
            type(ipc_handle_t), value :: handle
            integer(c_int), value :: flags
        end function ipc_open_i
        integer(c_int) function to_device_i(address, host, bytes) bind(c)
            import :: c_int, c_intptr_t, c_ptr, c_size_t
            integer(c_intptr_t), value :: address
            type(c_ptr), value :: host
            integer(c_size_t), value :: bytes
        end function to_device_i
        integer(c_int) function to_host_i(host, address, bytes) bind(c)
            import :: c_int, c_intptr_t, c_ptr, c_size_t
            type(c_ptr), value :: host
            integer(c_intptr_t), value :: address
            integer(c_size_t), value :: bytes
        end function to_host_i
        integer(c_int) function copy_i(to, from, bytes) bind(c)
            import :: c_int, c_intptr_t, c_size_t
            integer(c_intptr_t), value :: to, from
            integer(c_size_t), value :: bytes
        end function copy_i
        integer(c_int) function fill_i(address, byte, n) bind(c)
            import :: c_int, c_intptr_t, c_signed_char, c_size_t
            integer(c_intptr_t), value :: address
            integer(c_signed_char), value :: byte
            integer(c_size_t), value :: n
        end function fill_i
        integer(c_int) function launch_i(kernel, gx, gy, gz, bx, by, bz, shared, stream, &
            arguments, extra) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: kernel, stream, extra
            integer(c_int), value :: gx, gy, gz, bx, by, bz, shared
            type(c_ptr), intent(in) :: arguments(*)
        end function launch_i
        integer(c_int) function record_i(event, stream) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: event, stream
        end function record_i
        integer(c_int) function elapsed_i(milliseconds, start, end) bind(c)
            import :: c_float, c_int, c_ptr
            real(c_float), intent(out) :: milliseconds
            type(c_ptr), value :: start, end
        end function elapsed_i
        integer(c_int) function message_i(error, text) bind(c)
            import :: c_int, c_ptr
            integer(c_int), value :: error
            type(c_ptr), intent(out) :: text
        end function message_i
    end interface

    interface
        integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
            import :: c_ptr, c_size_t
            type(c_ptr), value :: text
        end function c_strlen
    end interface

    type(library_t), save :: library
    procedure(flags_i), pointer, protected, save :: cu_init => null()
    procedure(number_i), pointer, protected, save :: cu_driver_version => null(), &
        cu_device_count => null()
    procedure(device_i), pointer, protected, save :: cu_device => null()
    procedure(name_i), pointer, protected, save :: cu_device_name => null()
    procedure(attribute_i), pointer, protected, save :: cu_device_attribute => null()
    procedure(create_i), pointer, protected, save :: cu_context_retain => null(), &
        cu_event_create => null()
    procedure(handle_i), pointer, protected, save :: cu_context_set => null(), &
        cu_event_synchronize => null(), cu_host_unregister => null()
    procedure(memory_i), pointer, protected, save :: cu_memory_info => null()
    procedure(load_i), pointer, protected, save :: cu_module_load => null()
    procedure(function_i), pointer, protected, save :: cu_module_function => null()
    procedure(allocate_i), pointer, protected, save :: cu_allocate => null()
    procedure(free_i), pointer, protected, save :: cu_free => null(), cu_ipc_close => null()
    procedure(ipc_export_i), pointer, protected, save :: cu_ipc_export => null()
    procedure(ipc_open_i), pointer, protected, save :: cu_ipc_open => null()
    procedure(register_i), pointer, protected, save :: cu_host_register => null()
    procedure(to_device_i), pointer, protected, save :: cu_to_device => null()
    procedure(to_host_i), pointer, protected, save :: cu_to_host => null()
    procedure(copy_i), pointer, protected, save :: cu_copy => null()
    procedure(fill_i), pointer, protected, save :: cu_fill_bytes => null()
    procedure(launch_i), pointer, protected, save :: cu_launch => null()
    procedure(no_argument_i), pointer, protected, save :: cu_synchronize => null()
    procedure(record_i), pointer, protected, save :: cu_event_record => null()
    procedure(elapsed_i), pointer, protected, save :: cu_event_elapsed => null()
    procedure(message_i), pointer, save :: cu_message => null()

contains

    !> Open the driver and find its functions. `why` is unallocated where all is well.
    subroutine load_driver(why)
        character(:), allocatable, intent(out) :: why

        if (library%is_open()) return
        library = library_t()
        call library%open('libcuda.so.1', shared=.false.)
        if (.not. library%is_open()) then
            why = 'there is no CUDA driver on this machine (libcuda.so.1 was not found)'
            return
        end if
        call c_f_procpointer(library%function('cuInit'), cu_init)
        call c_f_procpointer(library%function('cuDriverGetVersion'), cu_driver_version)
        call c_f_procpointer(library%function('cuDeviceGetCount'), cu_device_count)
        call c_f_procpointer(library%function('cuDeviceGet'), cu_device)
        call c_f_procpointer(library%function('cuDeviceGetName'), cu_device_name)
        call c_f_procpointer(library%function('cuDeviceGetAttribute'), cu_device_attribute)
        call c_f_procpointer(library%function('cuDevicePrimaryCtxRetain'), cu_context_retain)
        call c_f_procpointer(library%function('cuCtxSetCurrent'), cu_context_set)
        call c_f_procpointer(library%function('cuMemGetInfo_v2'), cu_memory_info)
        call c_f_procpointer(library%function('cuModuleLoadDataEx'), cu_module_load)
        call c_f_procpointer(library%function('cuModuleGetFunction'), cu_module_function)
        call c_f_procpointer(library%function('cuMemAlloc_v2'), cu_allocate)
        call c_f_procpointer(library%function('cuMemFree_v2'), cu_free)
        call c_f_procpointer(library%function('cuMemHostRegister_v2'), cu_host_register)
        call c_f_procpointer(library%function('cuMemHostUnregister'), cu_host_unregister)
        call c_f_procpointer(library%function('cuIpcGetMemHandle'), cu_ipc_export)
        call c_f_procpointer(library%function('cuIpcOpenMemHandle_v2'), cu_ipc_open)
        call c_f_procpointer(library%function('cuIpcCloseMemHandle'), cu_ipc_close)
        call c_f_procpointer(library%function('cuMemcpyHtoD_v2'), cu_to_device)
        call c_f_procpointer(library%function('cuMemcpyDtoH_v2'), cu_to_host)
        call c_f_procpointer(library%function('cuMemcpyDtoD_v2'), cu_copy)
        call c_f_procpointer(library%function('cuMemsetD8_v2'), cu_fill_bytes)
        call c_f_procpointer(library%function('cuLaunchKernel'), cu_launch)
        call c_f_procpointer(library%function('cuCtxSynchronize'), cu_synchronize)
        call c_f_procpointer(library%function('cuEventCreate'), cu_event_create)
        call c_f_procpointer(library%function('cuEventRecord'), cu_event_record)
        call c_f_procpointer(library%function('cuEventSynchronize'), cu_event_synchronize)
        call c_f_procpointer(library%function('cuEventElapsedTime'), cu_event_elapsed)
        call c_f_procpointer(library%function('cuGetErrorString'), cu_message)
        if (allocated(library%missing)) why = 'the CUDA driver of this machine has no '// &
            library%missing//': it is too old'
    end subroutine load_driver

    !> What the driver says of an error.
    function driver_message(error) result(text)
        integer(c_int), intent(in) :: error
        character(:), allocatable :: text
        character(kind=c_char), pointer :: letters(:)
        type(c_ptr) :: found
        integer :: i

        text = 'unknown error'
        if (cu_message(error, found) /= 0) return
        call c_f_pointer(found, letters, [c_strlen(found)])
        text = repeat(' ', size(letters))
        do i = 1, size(letters)
            text(i:i) = letters(i)
        end do
    end function driver_message
end module brz_cuda_driver
