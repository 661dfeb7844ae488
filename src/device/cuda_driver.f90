! SPDX-License-Identifier: MIT
!> The CUDA driver API, opened at run time: one executable for machines with and without a GPU.
!>
!> There is a procedure pointer for each function that is called; `load_driver` sets them all, or
!> says what is missing. Every function returns 0 for success.
module brz_cuda_driver
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_f_procpointer, c_int, &
        c_int64_t, c_intptr_t, c_ptr, c_signed_char, c_size_t
    use brz_shared_library, only: library_t
    implicit none
    private
    public :: load_driver, driver_message, ipc_handle_t, ipc_lazily

    !> What another process needs to see memory of this one, CUipcMemHandle.
    type, bind(c) :: ipc_handle_t
        integer(c_int64_t) :: word(8) = 0
    end type ipc_handle_t
    integer(c_int), parameter :: ipc_lazily = 1 !! CU_IPC_MEM_LAZY_ENABLE_PEER_ACCESS

    abstract interface
        integer(c_int) function cu_init_i(flags) bind(c)
            import :: c_int
            integer(c_int), value :: flags
        end function cu_init_i

        integer(c_int) function cu_driver_version_i(version) bind(c)
            import :: c_int
            integer(c_int), intent(out) :: version
        end function cu_driver_version_i

        integer(c_int) function cu_device_count_i(count) bind(c)
            import :: c_int
            integer(c_int), intent(out) :: count
        end function cu_device_count_i

        integer(c_int) function cu_device_i(device, ordinal) bind(c)
            import :: c_int
            integer(c_int), intent(out) :: device
            integer(c_int), value :: ordinal
        end function cu_device_i

        integer(c_int) function cu_device_name_i(name, length, device) bind(c)
            import :: c_char, c_int
            character(kind=c_char), intent(inout) :: name(*)
            integer(c_int), value :: length, device
        end function cu_device_name_i

        integer(c_int) function cu_device_attribute_i(number, attribute, device) bind(c)
            import :: c_int
            integer(c_int), intent(out) :: number
            integer(c_int), value :: attribute, device
        end function cu_device_attribute_i

        integer(c_int) function cu_context_retain_i(context, device) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), intent(out) :: context
            integer(c_int), value :: device
        end function cu_context_retain_i

        integer(c_int) function cu_context_set_i(context) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: context
        end function cu_context_set_i

        integer(c_int) function cu_memory_info_i(free, total) bind(c)
            import :: c_int, c_size_t
            integer(c_size_t), intent(out) :: free, total
        end function cu_memory_info_i

        integer(c_int) function cu_module_load_i(module, image, n, options, values) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), intent(out) :: module
            type(c_ptr), value :: image
            integer(c_int), value :: n
            integer(c_int), intent(in) :: options(*)
            type(c_ptr), intent(inout) :: values(*)
        end function cu_module_load_i

        integer(c_int) function cu_module_function_i(kernel, module, name) bind(c)
            import :: c_char, c_int, c_ptr
            type(c_ptr), intent(out) :: kernel
            type(c_ptr), value :: module
            character(kind=c_char), intent(in) :: name(*)
        end function cu_module_function_i

        integer(c_int) function cu_allocate_i(memory, bytes) bind(c)
            import :: c_int, c_intptr_t, c_size_t
            integer(c_intptr_t), intent(out) :: memory
            integer(c_size_t), value :: bytes
        end function cu_allocate_i

        integer(c_int) function cu_free_i(memory) bind(c)
            import :: c_int, c_intptr_t
            integer(c_intptr_t), value :: memory
        end function cu_free_i

        integer(c_int) function cu_host_allocate_i(host, bytes) bind(c)
            import :: c_int, c_ptr, c_size_t
            type(c_ptr), intent(out) :: host
            integer(c_size_t), value :: bytes
        end function cu_host_allocate_i

        integer(c_int) function cu_host_register_i(host, bytes, flags) bind(c)
            import :: c_int, c_ptr, c_size_t
            type(c_ptr), value :: host
            integer(c_size_t), value :: bytes
            integer(c_int), value :: flags
        end function cu_host_register_i

        integer(c_int) function cu_host_unregister_i(host) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: host
        end function cu_host_unregister_i

        integer(c_int) function cu_ipc_export_i(shared, memory) bind(c)
            import :: c_int, c_intptr_t, ipc_handle_t
            type(ipc_handle_t), intent(out) :: shared
            integer(c_intptr_t), value :: memory
        end function cu_ipc_export_i

        integer(c_int) function cu_ipc_open_i(memory, shared, flags) bind(c)
            import :: c_int, c_intptr_t, ipc_handle_t
            integer(c_intptr_t), intent(out) :: memory
            type(ipc_handle_t), value :: shared
            integer(c_int), value :: flags
        end function cu_ipc_open_i

        integer(c_int) function cu_ipc_close_i(memory) bind(c)
            import :: c_int, c_intptr_t
            integer(c_intptr_t), value :: memory
        end function cu_ipc_close_i

        integer(c_int) function cu_to_device_i(memory, host, bytes) bind(c)
            import :: c_int, c_intptr_t, c_ptr, c_size_t
            integer(c_intptr_t), value :: memory
            type(c_ptr), value :: host
            integer(c_size_t), value :: bytes
        end function cu_to_device_i

        integer(c_int) function cu_to_host_i(host, memory, bytes) bind(c)
            import :: c_int, c_intptr_t, c_ptr, c_size_t
            type(c_ptr), value :: host
            integer(c_intptr_t), value :: memory
            integer(c_size_t), value :: bytes
        end function cu_to_host_i

        integer(c_int) function cu_copy_i(to, from, bytes) bind(c)
            import :: c_int, c_intptr_t, c_size_t
            integer(c_intptr_t), value :: to, from
            integer(c_size_t), value :: bytes
        end function cu_copy_i

        integer(c_int) function cu_fill_bytes_i(memory, value, n) bind(c)
            import :: c_int, c_intptr_t, c_signed_char, c_size_t
            integer(c_intptr_t), value :: memory
            integer(c_signed_char), value :: value
            integer(c_size_t), value :: n
        end function cu_fill_bytes_i

        integer(c_int) function cu_launch_i(kernel, gx, gy, gz, bx, by, bz, shared, stream, &
            arguments, extra) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: kernel
            integer(c_int), value :: gx, gy, gz, bx, by, bz, shared
            type(c_ptr), value :: stream
            type(c_ptr), intent(in) :: arguments(*)
            type(c_ptr), value :: extra
        end function cu_launch_i

        integer(c_int) function cu_stream_create_i(stream, flags) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), intent(out) :: stream
            integer(c_int), value :: flags
        end function cu_stream_create_i

        integer(c_int) function cu_event_create_i(event, flags) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), intent(out) :: event
            integer(c_int), value :: flags
        end function cu_event_create_i

        integer(c_int) function cu_event_record_i(event, stream) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: event, stream
        end function cu_event_record_i

        integer(c_int) function cu_event_synchronize_i(event) bind(c)
            import :: c_int, c_ptr
            type(c_ptr), value :: event
        end function cu_event_synchronize_i

        integer(c_int) function cu_synchronize_i() bind(c)
            import :: c_int
        end function cu_synchronize_i

        integer(c_int) function cu_message_i(error, text) bind(c)
            import :: c_int, c_ptr
            integer(c_int), value :: error
            type(c_ptr), intent(out) :: text
        end function cu_message_i
    end interface

    ! the functions, set by `load_driver`
    procedure(cu_init_i), pointer, protected, public, save :: cu_init => null()
    procedure(cu_driver_version_i), pointer, protected, public, save :: cu_driver_version => null()
    procedure(cu_device_count_i), pointer, protected, public, save :: cu_device_count => null()
    procedure(cu_device_i), pointer, protected, public, save :: cu_device => null()
    procedure(cu_device_name_i), pointer, protected, public, save :: cu_device_name => null()
    procedure(cu_device_attribute_i), pointer, protected, public, save :: &
        cu_device_attribute => null()
    procedure(cu_context_retain_i), pointer, protected, public, save :: cu_context_retain => null()
    procedure(cu_context_set_i), pointer, protected, public, save :: cu_context_set => null()
    procedure(cu_memory_info_i), pointer, protected, public, save :: cu_memory_info => null()
    procedure(cu_module_load_i), pointer, protected, public, save :: cu_module_load => null()
    procedure(cu_module_function_i), pointer, protected, public, save :: &
        cu_module_function => null()
    procedure(cu_allocate_i), pointer, protected, public, save :: cu_allocate => null()
    procedure(cu_free_i), pointer, protected, public, save :: cu_free => null()
    procedure(cu_host_allocate_i), pointer, protected, public, save :: cu_host_allocate => null()
    procedure(cu_host_register_i), pointer, protected, public, save :: cu_host_register => null()
    procedure(cu_host_unregister_i), pointer, protected, public, save :: &
        cu_host_unregister => null()
    procedure(cu_ipc_export_i), pointer, protected, public, save :: cu_ipc_export => null()
    procedure(cu_ipc_open_i), pointer, protected, public, save :: cu_ipc_open => null()
    procedure(cu_ipc_close_i), pointer, protected, public, save :: cu_ipc_close => null()
    procedure(cu_to_device_i), pointer, protected, public, save :: cu_to_device => null()
    procedure(cu_to_host_i), pointer, protected, public, save :: cu_to_host => null()
    procedure(cu_copy_i), pointer, protected, public, save :: cu_copy => null()
    procedure(cu_fill_bytes_i), pointer, protected, public, save :: cu_fill_bytes => null()
    procedure(cu_launch_i), pointer, protected, public, save :: cu_launch => null()
    procedure(cu_stream_create_i), pointer, protected, public, save :: cu_stream_create => null()
    procedure(cu_event_create_i), pointer, protected, public, save :: cu_event_create => null()
    procedure(cu_event_record_i), pointer, protected, public, save :: cu_event_record => null()
    procedure(cu_event_synchronize_i), pointer, protected, public, save :: &
        cu_event_synchronize => null()
    procedure(cu_synchronize_i), pointer, protected, public, save :: cu_synchronize => null()
    procedure(cu_message_i), pointer, protected, public, save :: cu_message => null()

    interface
        integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
            import :: c_ptr, c_size_t
            type(c_ptr), value :: text
        end function c_strlen
    end interface

    type(library_t), save :: library

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
        call find_functions()
        if (allocated(library%missing)) why = 'the CUDA driver of this machine has no '// &
            library%missing//': it is too old'
    end subroutine load_driver

    !> Point at the functions of the driver.
    subroutine find_functions()
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
        call c_f_procpointer(library%function('cuMemAllocHost_v2'), cu_host_allocate)
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
        call c_f_procpointer(library%function('cuStreamCreate'), cu_stream_create)
        call c_f_procpointer(library%function('cuEventCreate'), cu_event_create)
        call c_f_procpointer(library%function('cuEventRecord'), cu_event_record)
        call c_f_procpointer(library%function('cuEventSynchronize'), cu_event_synchronize)
        call c_f_procpointer(library%function('cuCtxSynchronize'), cu_synchronize)
        call c_f_procpointer(library%function('cuGetErrorString'), cu_message)
    end subroutine find_functions

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
