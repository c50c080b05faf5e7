/* Fuzzes the readers of names and colours of labels, and checks the order of the table. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz_reader.h"

#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

/* The file lives in memory only. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    char path[32];
    cw_label_table table = {0};
    cw_error err;
    const int fd = memfd_create("fuzz", MFD_CLOEXEC);
    if (fd < 0 || write(fd, bytes, size) != (ssize_t)size)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    if (cw_label_table_read(path, &table, NULL, &err) != CW_OK && table.labels)
        __builtin_trap();
    for (size_t n = 0; n < table.count; n++) {
        const cw_label *label = &table.labels[n];
        if ((n && table.labels[n - 1].value >= label->value) || label->layer ||
            (label->name && !*label->name))
            __builtin_trap();
    }
    cw_label_table_free(&table);
    close(fd);
    return 0;
}
