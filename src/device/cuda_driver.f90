! SPDX-License-Identifier: MIT
!> The CUDA driver API, opened at run time: one executable for machines with and without a GPU.
!>
!> scripts/foreign.py writes a procedure pointer for each function below; `load_driver` sets them
!> all, or says what is missing. Every function returns 0 for success.
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

    !@foreign cuInit cu_init(int flags)
    !@foreign cuDriverGetVersion cu_driver_version(out int version)
    !@foreign cuDeviceGetCount cu_device_count(out int count)
    !@foreign cuDeviceGet cu_device(out int device, int ordinal)
    !@foreign cuDeviceGetName cu_device_name(inout text name, int length, int device)
    !@foreign cuDeviceGetAttribute cu_device_attribute(out int number, int attribute, int device)
    !@foreign cuDevicePrimaryCtxRetain cu_context_retain(out pointer context, int device)
    !@foreign cuCtxSetCurrent cu_context_set(pointer context)
    !@foreign cuMemGetInfo_v2 cu_memory_info(out size free, out size total)
    !@foreign cuModuleLoadDataEx cu_module_load(out pointer module, pointer image, int n, &
    !@      in int options, inout pointer values)
    !@foreign cuModuleGetFunction cu_module_function(out pointer kernel, pointer module, &
    !@      in text name)
    !@foreign cuMemAlloc_v2 cu_allocate(out address memory, size bytes)
    !@foreign cuMemFree_v2 cu_free(address memory)
    !@foreign cuMemAllocHost_v2 cu_host_allocate(out pointer host, size bytes)
    !@foreign cuMemHostRegister_v2 cu_host_register(pointer host, size bytes, int flags)
    !@foreign cuMemHostUnregister cu_host_unregister(pointer host)
    !@foreign cuIpcGetMemHandle cu_ipc_export(out handle shared, address memory)
    !@foreign cuIpcOpenMemHandle_v2 cu_ipc_open(out address memory, handle shared, int flags)
    !@foreign cuIpcCloseMemHandle cu_ipc_close(address memory)
    !@foreign cuMemcpyHtoD_v2 cu_to_device(address memory, pointer host, size bytes)
    !@foreign cuMemcpyDtoH_v2 cu_to_host(pointer host, address memory, size bytes)
    !@foreign cuMemcpyDtoD_v2 cu_copy(address to, address from, size bytes)
    !@foreign cuMemsetD8_v2 cu_fill_bytes(address memory, byte value, size n)
    !@foreign cuLaunchKernel cu_launch(pointer kernel, int gx, int gy, int gz, int bx, int by, &
    !@      int bz, int shared, pointer stream, in pointer arguments, pointer extra)
    !@foreign cuStreamCreate cu_stream_create(out pointer stream, int flags)
    !@foreign cuEventCreate cu_event_create(out pointer event, int flags)
    !@foreign cuEventRecord cu_event_record(pointer event, pointer stream)
    !@foreign cuEventSynchronize cu_event_synchronize(pointer event)
    !@foreign cuCtxSynchronize cu_synchronize()
    !@foreign cuGetErrorString cu_message(int error, out pointer text)

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
        call find_functions(library)
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
