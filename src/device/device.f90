! SPDX-License-Identifier: MIT
!> The GPU: open it, load the kernels, hold memory, launch.
!>
!> Every procedure reports through `error_t` with exit_device and does nothing once an error is
!> recorded. All work goes through the default stream, in order, but for what may run side by side.
module brz_device
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_intptr_t, &
        c_loc, c_null_char, c_null_ptr, c_ptr, c_signed_char, c_size_t
    use brz_buffers, only: arguments_t, buffer_t, most_arguments
    use brz_cuda_driver, only: cu_allocate, cu_context_retain, cu_context_set, cu_copy, &
        cu_device, cu_device_attribute, cu_device_count, cu_device_name, cu_driver_version, &
        cu_fill_bytes, &
        cu_free, cu_host_register, cu_host_unregister, cu_init, cu_launch, cu_memory_info, &
        cu_module_function, cu_module_load, cu_stream_create, cu_synchronize, cu_to_device, &
        driver_message, load_driver
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_host_calls, only: record_call, to_copy, to_launch, to_read, to_reserve, to_wait
    use brz_host_room, only: read_memory
    use brz_kernel_profile, only: record_launch, profiling
    use brz_kinds, only: dp, int64, int8
    use brz_present_table, only: detach_all
    use brz_text, only: to_text
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: threads_per_block
    public :: device_t, buffer_t, kernel_t, arguments_t, open_device, measure_memory, load_kernels
    public :: find_kernel, find_once, launch, side_by_side, wait_for_device, check
    public :: allocate_buffer, put_buffer, reserve_buffer, free_buffer, free_all
    public :: copy_in, copy_out, copy_within, clear_buffer, pin, sessions

    integer, parameter :: threads_per_block = 128 !! all along x
    integer, parameter :: most_streams = 8 !! in which kernels run side by side
    type(c_ptr), save :: streams(most_streams) = c_null_ptr
    type(c_ptr), save :: stream = c_null_ptr !! of the launches to come; null: the default stream
    type(c_ptr), save :: loaded = c_null_ptr !! the kernels

    integer(c_intptr_t), allocatable, save :: held(:) !! all memory that is reserved
    type(c_ptr), allocatable, save :: pinned(:) !! memory of the host, see `pin`

    integer, protected, save :: sessions = 0 !! how often all memory was given back

    type :: device_t
        logical :: open = .false.
        integer :: count = 0 !! devices that this process sees
        character(:), allocatable :: name !! with memory and driver, for messages
        integer(c_size_t) :: free_bytes = 0 !! when it was opened or measured last
    end type device_t

    type :: kernel_t
        type(c_ptr) :: handle = c_null_ptr
        character(32) :: name = ''
    end type kernel_t

contains

    !> Record what the driver refused.
    subroutine check(code, what, err)
        integer(c_int), intent(in) :: code !! result of a driver call
        character(*), intent(in) :: what !! what was tried
        type(error_t), intent(inout) :: err

        if (code /= 0) call raise(err, exit_device, 'GPU: '//what//' failed: '// &
                                  driver_message(code)//' (CUDA error '//to_text(int(code))//')')
    end subroutine check

    !> Open a GPU: of those that the process sees the one with a number, from 0, counted round and
    !> round. Without one `err` says why.
    subroutine open_device(device, err, number)
        type(device_t), intent(out) :: device
        type(error_t), intent(inout) :: err
        integer, intent(in), optional :: number !! else the first
        character(:), allocatable :: why
        integer(c_int) :: n, handle, which
        type(c_ptr) :: context

        call load_driver(why)
        if (allocated(why)) then
            call raise(err, exit_device, 'no GPU: '//why)
            return
        end if
        n = 0
        if (cu_init(0_c_int) == 0) then
            if (cu_device_count(n) /= 0) n = 0
        end if
        if (n == 0) then
            call raise(err, exit_device, 'no GPU: the CUDA driver is there but shows no device')
            return
        end if
        device%count = n
        which = 0
        if (present(number)) which = mod(int(number, c_int), n)
        call check(cu_device(handle, which), 'opening device '//to_text(int(which)), err)
        call check(cu_context_retain(context, handle), 'making a context', err)
        if (failed(err)) return
        call check(cu_context_set(context), 'using the context', err)
        call describe(handle, device, err)
        device%open = .not. failed(err)
        if (.not. allocated(held)) allocate (held(0), pinned(0))
    end subroutine open_device

    !> Name, capability, memory and driver in one line.
    subroutine describe(handle, device, err)
        integer(c_int), intent(in) :: handle
        type(device_t), intent(inout) :: device
        type(error_t), intent(inout) :: err
        integer(c_int), parameter :: major_attribute = 75, minor_attribute = 76
        character(kind=c_char) :: letters(128)
        integer(c_size_t) :: total
        integer(c_int) :: major, minor, driver

        call check(cu_device_name(letters, size(letters, kind=c_int), handle), 'naming', err)
        call check(cu_device_attribute(major, major_attribute, handle), 'asking', err)
        call check(cu_device_attribute(minor, minor_attribute, handle), 'asking', err)
        call check(cu_memory_info(device%free_bytes, total), 'asking for memory', err)
        call check(cu_driver_version(driver), 'asking for the driver', err)
        if (failed(err)) return
        device%name = text_of(letters)//' (compute capability '//to_text(int(major))//'.'// &
                      to_text(int(minor))//', '//to_text(nint(total/2.0_dp**30))// &
                      ' GiB, CUDA '//to_text(int(driver)/1000)//'.'// &
                      to_text(mod(int(driver), 1000)/10)//')'
    end subroutine describe

    !> A text of C.
    pure function text_of(letters) result(text)
        character(kind=c_char), intent(in) :: letters(:)
        character(findloc(letters, c_null_char, 1) - 1) :: text

        text = transfer(letters(:len(text)), text)
    end function text_of

    !> Look how much memory is left.
    subroutine measure_memory(device, err)
        type(device_t), intent(inout) :: device
        type(error_t), intent(inout) :: err
        integer(c_size_t) :: total

        if (failed(err)) return
        call check(cu_memory_info(device%free_bytes, total), 'asking for memory', err)
    end subroutine measure_memory

    !> Load the kernels from a PTX file that was built from the same sources as this program.
    subroutine load_kernels(file, stamp, err)
        character(*), intent(in) :: file
        character(*), intent(in) :: stamp !! of the sources, first line of the file
        type(error_t), intent(inout) :: err
        integer(c_int), parameter :: log_option = 5, log_size_option = 6 ! CU_JIT_ERROR_LOG_BUFFER
        character(kind=c_char), allocatable, target :: image(:)
        character(kind=c_char), target :: log(4096)
        character(:), allocatable :: text
        type(c_ptr) :: values(2)
        integer(c_int) :: code

        call read_image(file, stamp, image, err)
        if (failed(err)) return
        log = c_null_char
        values = [c_loc(log), transfer(size(log, kind=c_intptr_t), c_null_ptr)]
        code = cu_module_load(loaded, c_loc(image), 2_c_int, [log_option, log_size_option], values)
        text = text_of(log)
        if (code /= 0 .and. text /= '') text = ': '//text
        call check(code, 'loading '//file//text, err)
    end subroutine load_kernels

    !> The PTX text with a null character at its end.
    subroutine read_image(file, stamp, image, err)
        character(*), intent(in) :: file, stamp
        character(kind=c_char), allocatable, intent(out) :: image(:)
        type(error_t), intent(inout) :: err
        integer :: unit, n, io

        open (newunit=unit, file=file, access='stream', form='unformatted', status='old', &
              action='read', iostat=io)
        if (io /= 0) then
            call raise(err, exit_device, 'the GPU code '//file// &
                       ' cannot be read: build it with make gpu, beside the program')
            return
        end if
        inquire (unit=unit, size=n)
        allocate (image(n + 1))
        read (unit, iostat=io) image(1:n)
        close (unit)
        image(n + 1) = c_null_char
        if (io == 0 .and. n > len(stamp) + 3) then
            if (all(image(4:3 + len(stamp)) == transfer(stamp, image))) return
        end if
        call raise(err, exit_device, file//' was not built from the sources of this program: '// &
                   'run make gpu again')
    end subroutine read_image

    !> Find a kernel by its name in the sources.
    subroutine find_kernel(name, kernel, err)
        character(*), intent(in) :: name
        type(kernel_t), intent(inout) :: kernel
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        kernel%name = name
        call check(cu_module_function(kernel%handle, loaded, name//c_null_char), &
                   'finding the kernel '//name, err)
    end subroutine find_kernel

    !> The same before its first launch.
    subroutine find_once(name, kernel, err)
        character(*), intent(in) :: name
        type(kernel_t), intent(inout) :: kernel
        type(error_t), intent(inout) :: err

        if (.not. c_associated(kernel%handle)) call find_kernel(name, kernel, err)
    end subroutine find_once

    !> Reserve memory on the GPU, all bytes zero.
    subroutine allocate_buffer(buffer, bytes, err)
        class(buffer_t), intent(out) :: buffer
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        real(dp) :: began

        if (failed(err)) return
        buffer%bytes = max(bytes, 8_int64)
        began = wall_seconds()
        call check(cu_allocate(buffer%address, buffer%bytes), 'reserving '//to_text(bytes)// &
                   ' bytes', err)
        call record_call(to_reserve, buffer%bytes, began)
        held = [held, buffer%address]
        call clear_buffer(buffer, err)
    end subroutine allocate_buffer

    !> Make room in a buffer that may hold some; what was there is lost where it grows.
    subroutine reserve_buffer(buffer, bytes, err)
        class(buffer_t), intent(inout) :: buffer
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err

        if (buffer%address /= 0 .and. buffer%bytes >= bytes) return
        call free_buffer(buffer)
        call allocate_buffer(buffer, bytes + bytes/8, err)
    end subroutine reserve_buffer

    !> Give memory back. Nothing happens to a buffer that holds none.
    subroutine free_buffer(buffer)
        class(buffer_t), intent(inout) :: buffer
        real(dp) :: began
        integer(c_int) :: code

        if (buffer%address == 0) return
        began = wall_seconds()
        code = cu_free(buffer%address)
        call record_call(to_reserve, 0_int64, began)
        held = pack(held, held /= buffer%address)
        buffer%address = 0
    end subroutine free_buffer

    !> Give all memory back, and let go of that of the host: no buffer holds any from now on.
    subroutine free_all()
        type(buffer_t) :: buffer
        integer(c_int) :: code
        integer :: k

        do k = size(held), 1, -1
            buffer%address = held(k)
            call free_buffer(buffer)
        end do
        do k = 1, size(pinned)
            code = cu_host_unregister(pinned(k))
        end do
        pinned = pinned(:0)
        call detach_all()
        sessions = sessions + 1
    end subroutine free_all

    !> Set a buffer, or its first bytes, to zero.
    subroutine clear_buffer(buffer, err, bytes)
        class(buffer_t), intent(in) :: buffer
        type(error_t), intent(inout) :: err
        integer(int64), intent(in), optional :: bytes
        integer(int64) :: n
        real(dp) :: began

        if (failed(err)) return
        n = buffer%bytes
        if (present(bytes)) n = bytes
        began = wall_seconds()
        call check(cu_fill_bytes(buffer%address, 0_c_signed_char, n), 'clearing', err)
        call record_call(to_copy, 0_int64, began)
    end subroutine clear_buffer

    !> Copy a contiguous array to the GPU.
    subroutine copy_in(x, buffer, bytes, err)
        type(*), intent(in), target, contiguous :: x(..)
        class(buffer_t), intent(in) :: buffer
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        real(dp) :: began

        if (failed(err) .or. bytes == 0) return
        began = wall_seconds()
        call check(cu_to_device(buffer%address, c_loc(x), int(bytes, c_size_t)), &
                   'copying to the GPU', err)
        call record_call(to_copy, bytes, began)
    end subroutine copy_in

    !> A new buffer that holds a contiguous array.
    subroutine put_buffer(x, buffer, bytes, err)
        type(*), intent(in), target, contiguous :: x(..)
        class(buffer_t), intent(out) :: buffer
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        call allocate_buffer(buffer, bytes, err)
        call copy_in(x, buffer, bytes, err)
    end subroutine put_buffer

    !> Copy from the GPU to a contiguous array; waits for all work before it.
    subroutine copy_out(buffer, x, bytes, err)
        class(buffer_t), intent(in) :: buffer
        type(*), intent(inout), target, contiguous :: x(..)
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        real(dp) :: began

        if (failed(err) .or. bytes == 0) return
        began = wall_seconds()
        call check(read_memory(c_loc(x), buffer%address, bytes), &
                   'copying from the GPU (or a kernel before it)', err)
        call record_call(to_read, bytes, began)
    end subroutine copy_out

    !> Let the GPU copy to and from memory of the host without a detour, until `free_all`. Memory
    !> given back before must not lie in what is copied later: the driver refuses that.
    subroutine pin(bytes)
        integer(int8), intent(in), target, contiguous :: bytes(:)
        integer(c_int) :: code

        if (size(bytes) == 0) return
        code = cu_host_register(c_loc(bytes), size(bytes, kind=int64), 0_c_int)
        if (code == 0) pinned = [pinned, c_loc(bytes)]
    end subroutine pin

    !> Copy from one place on the GPU to another, in turn with the kernels.
    subroutine copy_within(from, to, bytes, err)
        class(buffer_t), intent(in) :: from, to
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        real(dp) :: began

        if (failed(err) .or. bytes == 0) return
        began = wall_seconds()
        call check(cu_copy(to%address, from%address, bytes), 'copying on the GPU', err)
        call record_call(to_copy, bytes, began)
    end subroutine copy_within

    !> Launch a kernel with n threads, in x rounded up to whole blocks: the kernel must check its x.
    subroutine launch(kernel, n, arguments, err)
        type(kernel_t), intent(in) :: kernel
        integer, intent(in) :: n(3) !! threads in x, y, z; y and z up to 65535
        type(arguments_t), intent(in), target :: arguments
        type(error_t), intent(inout) :: err
        type(c_ptr) :: values(most_arguments)
        real(dp) :: start
        integer :: i

        if (failed(err)) return
        if (arguments%missing > 0) then
            call raise(err, exit_device, 'GPU: argument '//to_text(arguments%missing)//' of '// &
                       trim(kernel%name)//' is not on the GPU: this is an error of the program')
            return
        end if
        do i = 1, arguments%n
            values(i) = c_loc(arguments%value(arguments%first(i)))
        end do
        if (profiling) call wait_for_device(err)
        start = wall_seconds()
        call check(cu_launch(kernel%handle, (n(1) - 1)/threads_per_block + 1, n(2), n(3), &
                             threads_per_block, 1, 1, 0_c_int, stream, values, c_null_ptr), &
                   'launching '//trim(kernel%name), err)
        call record_call(to_launch, 0_int64, start)
        if (.not. profiling) return
        call wait_for_device(err)
        call record_launch(kernel%name, wall_seconds() - start)
    end subroutine launch

    !> From now on kernels of different `lane` may run side by side, with 0 again in order. What
    !> goes through the default stream waits for all lanes, and they for it.
    subroutine side_by_side(lane)
        integer, intent(in) :: lane !! from 1, or 0
        integer :: k

        stream = c_null_ptr
        if (lane == 0) return
        k = mod(lane - 1, most_streams) + 1
        if (.not. c_associated(streams(k))) then
            if (cu_stream_create(streams(k), 0_c_int) /= 0) streams(k) = c_null_ptr
        end if
        stream = streams(k)
    end subroutine side_by_side

    !> Wait until all work is done.
    subroutine wait_for_device(err)
        type(error_t), intent(inout) :: err
        real(dp) :: began

        if (failed(err)) return
        began = wall_seconds()
        call check(cu_synchronize(), 'the work of the kernels', err)
        call record_call(to_wait, 0_int64, began)
    end subroutine wait_for_device
end module brz_device
