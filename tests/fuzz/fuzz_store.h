/* Fuzzing of the readers of volumes that are folders: an input is a list of files. */
#ifndef TESTS_FUZZ_STORE_H
#define TESTS_FUZZ_STORE_H

#include "fuzz_reader.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void make_path(char path[128], const char *folder, const char *name)
{
    snprintf(path, 128, "%s/%s", folder, name);
}

/* Writes a file, and makes the folders that it needs. */
static void write_file(const char *folder, const char *name, const uint8_t *bytes, size_t size)
{
    char path[128];
    make_path(path, folder, name);
    for (char *at = path + strlen(folder) + 1; (at = strchr(at, '/')); at++) {
        *at = '\0';
        mkdir(path, 0700);
        *at = '/';
    }
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd >= 0 && write(fd, bytes, size) != (ssize_t)size)
        abort();
    if (fd >= 0)
        close(fd);
}

/* Removes the files that an input may have, and the folders above them that are empty then. */
static void remove_files(const char *folder, const char *const *names, size_t count)
{
    char path[128];
    for (size_t n = 0; n < count; n++) {
        make_path(path, folder, names[n]);
        unlink(path);
    }
    for (size_t n = 0; n < count; n++) {
        make_path(path, folder, names[n]);
        for (char *slash; (slash = strrchr(path, '/')) > path + strlen(folder);) {
            *slash = '\0';
            rmdir(path);
        }
    }
    rmdir(folder);
}

/* Reads a store of the files that an input has. A record is the index of a name, the size of the
 * file in two bytes, the low one first, and its content. */
static void read_store(const uint8_t *bytes, size_t size, const char *const *names,
                       size_t count)
{
    char folder[] = "/tmp/fuzz-store-XXXXXX";
    cw_label_table labels = {0};
    const cw_read_desc desc = {.max_bytes = (uint64_t)1 << 16, .labels = &labels};
    cw_volume volume;
    if (!mkdtemp(folder))
        return;
    for (size_t at = 0; at + 3 <= size;) {
        const size_t stated = bytes[at + 1] | (size_t)bytes[at + 2] << 8, left = size - at - 3;
        const size_t length = stated < left ? stated : left;
        write_file(folder, names[bytes[at] % count], bytes + at + 3, length);
        at += 3 + length;
    }
    if (cw_volume_read(folder, &desc, &volume, NULL, NULL) == CW_OK) {
        volatile double sum = touch_voxels(&volume);
        (void)sum;
        read_middle(folder, &desc, &volume);
        cw_volume_free(&volume);
    }
    cw_label_table_free(&labels);
    remove_files(folder, names, count);
}

#endif
