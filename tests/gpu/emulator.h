// SPDX-License-Identifier: MIT
// What the emulated driver and the table of kernels, written by scripts/gpu_emulate.py, share.
struct kernel {
    const char *name;
    void (*run_block)(void **arguments, const int *threads);
    const char *arguments; // one letter each: a = array, s = scalar
};
extern const struct kernel kernels[];

// The CUDA variables of emulated_cuda.f90.
struct dim3 { int x, y, z; };
extern __thread struct dim3 emulated_thread, emulated_block, emulated_threads, emulated_grid;

#define EACH_THREAD(b)                                                       \
    for (emulated_thread.z = 1; emulated_thread.z <= b[2]; emulated_thread.z++)     \
        for (emulated_thread.y = 1; emulated_thread.y <= b[1]; emulated_thread.y++) \
            for (emulated_thread.x = 1; emulated_thread.x <= b[0]; emulated_thread.x++)
