/* Fuzzes the reader of PVD lists, and checks the order of their times. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz_reader.h"

#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

/* The list lives in memory only. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    char path[32];
    cw_pvd_entry *entries;
    size_t count;
    cw_error err;
    const int fd = memfd_create("fuzz", MFD_CLOEXEC);
    if (fd < 0 || write(fd, bytes, size) != (ssize_t)size)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    if (cw_pvd_read(path, &(cw_read_desc){.allow_external = true}, &entries, &count, &err) ==
        CW_OK) {
        for (size_t n = 0; n < count; n++)
            if (!entries[n].path[0] || (n && !(entries[n - 1].time < entries[n].time)))
                __builtin_trap();
        cw_pvd_free(entries, count);
    }
    close(fd);
    return 0;
}
