// SPDX-License-Identifier: MIT
// A CUDA driver without a GPU: memory is host memory, and a launch runs the kernel for every
// thread in turn, block by block. The kernels are those of cuda/*.CUF, translated by
// scripts/gpu_emulate.py, which also writes the table of kernels.
//
// BRISANCE_EMULATOR_FAIL=NAME[:N] makes the N-th call (default: the first) of a function fail.
// BRISANCE_EMULATOR_MEMORY=BYTES is the memory of the device (default: 8 GiB).
// BRISANCE_EMULATOR_DEVICES=N devices are there (default: 1), all the same host.
// BRISANCE_EMULATOR_COUNT=1 has it say at the end what has crossed the bus.
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "emulator.h"

enum { success = 0, invalid = 1, out_of_memory = 2, no_device = 100, not_found = 500,
       already_pinned = 712, not_pinned = 713, failed = 719 };

static size_t in_use = 0;
static size_t to_device = 0, to_host = 0, launches = 0;

static void say_counts(void) {
    fprintf(stderr, "bus: %zu bytes to the device, %zu to the host, %zu launches\n", to_device,
            to_host, launches);
}

static int fails(const char *name) {
    static int calls = 0;
    const char *wanted = getenv("BRISANCE_EMULATOR_FAIL");
    size_t n = strlen(name);
    if (!wanted || strncmp(wanted, name, n) || (wanted[n] && wanted[n] != ':')) return 0;
    return ++calls == (wanted[n] ? atoi(wanted + n + 1) : 1);
}

static size_t memory(void) {
    const char *given = getenv("BRISANCE_EMULATOR_MEMORY");
    return given ? strtoull(given, 0, 10) : (size_t)8 << 30;
}

int cuInit(unsigned flags) {
    if (getenv("BRISANCE_EMULATOR_COUNT")) atexit(say_counts);
    return fails("cuInit") ? no_device : success + 0 * (int)flags;
}

int cuDriverGetVersion(int *v) { *v = 13000; return success; }
int cuDeviceGetCount(int *n) {
    const char *given = getenv("BRISANCE_EMULATOR_DEVICES");
    *n = fails("cuDeviceGetCount") ? 0 : given ? atoi(given) : 1;
    return success;
}

int cuDeviceGet(int *d, int i) { *d = i; return success; }
int cuDeviceGetName(char *s, int n, int d) { snprintf(s, n, d ? "Emulated GPU %d" : "Emulated GPU", d); return success; }
int cuDeviceGetAttribute(int *v, int which, int d) { *v = (which == 75 ? 9 : 0) + 0 * d; return success; }
int cuDevicePrimaryCtxRetain(void **c, int d) { *c = (void *)1; return 0 * d; }
int cuCtxSetCurrent(void *c) { return c ? success : invalid; }
int cuEventCreate(void **event, unsigned flags) { *event = (void *)3; return flags == 2 ? success : invalid; }
int cuEventRecord(void *event, void *stream) { return event && !stream ? success : invalid; }
int cuEventSynchronize(void *event) { return event && !fails("cuEventSynchronize") ? success : failed; }
int cuCtxSynchronize(void) { return fails("cuCtxSynchronize") ? failed : success; }

int cuMemGetInfo_v2(size_t *left, size_t *total) {
    *total = memory();
    *left = *total - in_use;
    return success;
}

int cuModuleLoadDataEx(void **m, const void *image, unsigned n, int *options, void **values) {
    (void)n, (void)options, (void)values;
    *m = (void *)2;
    return image && !fails("cuModuleLoadDataEx") ? success : invalid;
}

int cuModuleGetFunction(void **f, void *m, const char *name) {
    if (!m) return invalid;
    for (const struct kernel *k = kernels; k->name; k++)
        if (!strcmp(k->name, name)) {
            *f = (void *)k;
            return success;
        }
    return not_found;
}

// A block of device memory begins with its size and, where another process may see it, the file
// that it lies in: whole blocks of 2 MiB, as the true driver shares no less.
// Before and behind the others a guard lies: who writes beyond its block is named when it has.
struct block { size_t n; int file; struct block *last, *next; };
enum { before = 4096, shared_block = 2 << 20, guard = 64 };

static struct block first; // of the ring of blocks that are guarded
static char untouched[guard];

static struct block *block_of(size_t p) { return (struct block *)(p - before); }

static void look_at_guards(const char *name) {
    for (struct block *b = first.next; b && b != &first; b = b->next) {
        const char *start = (char *)b + before;
        if (!memcmp(start - guard, untouched, guard) && !memcmp(start + b->n, untouched, guard)) continue;
        fprintf(stderr, "emulated GPU: %s wrote beyond a block of %zu bytes\n", name, b->n);
        abort();
    }
}

static void link_block(struct block *b) {
    if (!first.next) {
        first.next = first.last = &first;
        memset(untouched, 0xa5, guard);
    }
    b->next = &first;
    b->last = first.last;
    b->last->next = first.last = b;
}

static void unlink_block(struct block *b) {
    b->last->next = b->next;
    b->next->last = b->last;
}

int cuMemAlloc_v2(size_t *p, size_t n) {
    if (fails("cuMemAlloc_v2") || in_use + n > memory()) return out_of_memory;
    int file = n % shared_block ? -1 : memfd_create("device", 0);
    if (file >= 0 && ftruncate(file, n + before)) return out_of_memory;
    char *start = file < 0 ? malloc(n + before + guard)
                           : mmap(0, n + before, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (!start || start == MAP_FAILED) return out_of_memory;
    memset(start, 0xa5, n + before + (file < 0 ? guard : 0)); // what is not cleared is no zero
    *p = (size_t)start + before;
    block_of(*p)->n = n;
    block_of(*p)->file = file;
    if (file < 0) link_block(block_of(*p));
    in_use += n;
    return success;
}

int cuMemFree_v2(size_t p) {
    struct block *block = block_of(p);
    in_use -= block->n;
    if (block->file < 0) {
        unlink_block(block);
        free(block);
    } else {
        close(block->file);
        memset((void *)p, 0xa5, block->n); // who still sees it must not read it
        munmap(block, block->n + before);
    }
    return success;
}

struct handle { long process, file, n, unused[5]; };

int cuIpcGetMemHandle(struct handle *handle, size_t p) {
    const struct handle found = {getpid(), block_of(p)->file, block_of(p)->n, {0}};
    *handle = found;
    return found.file < 0 || fails("cuIpcGetMemHandle") ? invalid : success;
}

int cuIpcOpenMemHandle_v2(size_t *p, struct handle handle, unsigned flags) {
    char name[64];
    if (handle.process == getpid() || flags != 1 || fails("cuIpcOpenMemHandle_v2")) return invalid;
    snprintf(name, sizeof name, "/proc/%ld/fd/%ld", handle.process, handle.file);
    const int file = open(name, O_RDWR);
    if (file < 0) return invalid;
    char *start = mmap(0, handle.n + before, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (start == MAP_FAILED) return invalid;
    *p = (size_t)start + before;
    return success;
}

int cuIpcCloseMemHandle(size_t p) {
    return munmap(block_of(p), block_of(p)->n + before) ? invalid : success;
}

// Memory of the host that the device reads without a detour. As the true driver does, a copy is
// refused whose host side lies in such a range only in part: its memory was given back while pinned.
enum { most_pinned = 1000 };
static struct { const char *start; size_t n; } pinned[most_pinned];

static int half_pinned(const void *h, size_t n) {
    const char *from = h;
    for (int i = 0; i < most_pinned; i++) {
        const char *start = pinned[i].start, *end = start + pinned[i].n;
        if (start && from < end && from + n > start && (from < start || from + n > end)) return 1;
    }
    return 0;
}

int cuMemAllocHost_v2(void **h, size_t n) {
    *h = fails("cuMemAllocHost_v2") ? 0 : malloc(n);
    return *h ? success : out_of_memory;
}

int cuMemHostRegister_v2(void *h, size_t n, unsigned flags) {
    if (!h || !n || flags || fails("cuMemHostRegister_v2")) return invalid;
    for (int i = 0; i < most_pinned; i++) {
        const char *start = pinned[i].start;
        if (start && start < (char *)h + n && start + pinned[i].n > (char *)h) return already_pinned;
    }
    for (int i = 0; i < most_pinned; i++)
        if (!pinned[i].start) {
            pinned[i].start = h;
            pinned[i].n = n;
            return success;
        }
    return out_of_memory;
}

int cuMemHostUnregister(void *h) {
    for (int i = 0; i < most_pinned; i++)
        if (h && pinned[i].start == h) {
            pinned[i].start = 0;
            return success;
        }
    return not_pinned;
}

int cuMemcpyHtoD_v2(size_t d, const void *h, size_t n) {
    if (half_pinned(h, n)) return invalid;
    memcpy((void *)d, h, n);
    look_at_guards("cuMemcpyHtoD_v2");
    to_device += n;
    return fails("cuMemcpyHtoD_v2") ? failed : success;
}

int cuMemcpyDtoH_v2(void *h, size_t d, size_t n) {
    if (half_pinned(h, n)) return invalid;
    if (fails("cuMemcpyDtoH_v2")) return failed;
    memcpy(h, (void *)d, n);
    to_host += n;
    return success;
}

int cuMemcpyDtoD_v2(size_t to, size_t from, size_t n) {
    memcpy((void *)to, (void *)from, n);
    look_at_guards("cuMemcpyDtoD_v2");
    return success;
}

int cuMemsetD8_v2(size_t d, unsigned char value, size_t n) {
    memset((void *)d, value, n);
    look_at_guards("cuMemsetD8_v2");
    return success;
}

static char streams[1];
int cuStreamCreate(void **stream, unsigned flags) { *stream = streams; return flags; }

int cuLaunchKernel(void *f, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by,
                   unsigned bz, unsigned shared, void *stream, void **arguments, void **extra) {
    const struct kernel *k = f;
    const int block[3] = {bx, by, bz};
    const int n = gx * gy * gz;
    void *p[40] = {0};
    launches++;
    if (fails("cuLaunchKernel")) return failed;
    if (bx * by * bz > 1024 || gx < 1 || gy < 1 || gz < 1 || gy > 65535 || gz > 65535) return invalid;
    if (shared || extra || (stream && stream != streams)) return invalid;
    for (int i = 0; k->arguments[i]; i++)
        p[i] = k->arguments[i] == 'a' ? *(void **)arguments[i] : arguments[i];
#pragma omp parallel for if (n > 8)
    for (int i = 0; i < n; i++) {
        const struct dim3 grid = {gx, gy, gz}, threads = {bx, by, bz};
        const struct dim3 place = {i % gx + 1, i / gx % gy + 1, i / (gx * gy) + 1};
        emulated_grid = grid;
        emulated_threads = threads;
        emulated_block = place;
        k->run_block(p, block);
    }
    look_at_guards(k->name);
    return success;
}

int cuGetErrorString(int code, const char **text) {
    *text = code == out_of_memory ? "out of memory" : code == not_found ? "named symbol not found"
                                                                        : "emulated failure";
    return success;
}
