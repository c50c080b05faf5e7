/* What the fuzz targets of the volume readers share. */
#ifndef TESTS_FUZZ_READER_H
#define TESTS_FUZZ_READER_H

#include <cubewright/formats.h>

#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Adds up what a reader made of the bytes, so that none of it is left unlooked at. */
static inline double touch_voxels(const cw_volume *v)
{
    cw_volume one;
    double sum = 0;
    for (size_t c = 0; c < v->components; c++)
        for (size_t t = 0; t < v->steps && t < 4; t++) {
            if (cw_volume_select(v, c, t, &one, NULL) != CW_OK)
                __builtin_trap(); /* what was read must be usable */
            sum += cw_volume_value(&one, 0, 0, 0) +
                   cw_volume_value(&one, one.dim[0] - 1, one.dim[1] - 1, one.dim[2] - 1);
        }
    return sum;
}

/* Reads the bytes as a file that lives in memory only. The path has no extension: the reader is
 * named, so that every input reaches it. */
static inline int fuzz_with(const cw_read_desc *desc, const uint8_t *bytes, size_t size)
{
    char path[32];
    cw_volume volume;
    cw_error err;
    const int fd = memfd_create("fuzz", MFD_CLOEXEC);
    if (fd < 0 || write(fd, bytes, size) != (ssize_t)size)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    if (cw_volume_read(path, desc, &volume, NULL, &err) == CW_OK) {
        volatile double sum = touch_voxels(&volume);
        (void)sum;
        cw_volume_free(&volume);
    }
    close(fd);
    return 0;
}

static inline int fuzz_reader(const char *reader, const uint8_t *bytes, size_t size)
{
    const cw_read_desc desc = {.reader = reader, .max_bytes = (uint64_t)64 << 20};
    return fuzz_with(&desc, bytes, size);
}

#endif
