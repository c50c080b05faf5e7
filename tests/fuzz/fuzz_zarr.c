/* Fuzzes the volume reader of Zarr stores: an input is a list of files in a folder. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz_reader.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The files that an input may have. A record is the index of one, its size in two bytes, the low
 * one first, and its content. */
static const char *const names[] = {"zarr.json",   ".zarray",   ".zgroup", ".zattrs",
                                    "0/zarr.json", "0/.zarray", "c/0/0/0", "c/0/0/1",
                                    "0.0.0",       "0.0.1",     "0/0.0.0", "0/c/0/0/0"};
enum { NAMES = sizeof names / sizeof *names };

static void make_path(char path[128], const char *folder, const char *name)
{
    snprintf(path, 128, "%s/%s", folder, name);
}

static void make_folders(const char *folder)
{
    static const char *const folders[] = {"",        "0", "0/c", "0/c/0",
                                          "0/c/0/0", "c", "c/0", "c/0/0"};
    char path[128];
    for (size_t n = 0; n < sizeof folders / sizeof *folders; n++) {
        make_path(path, folder, folders[n]);
        mkdir(path, 0700);
    }
}

static void write_file(const char *folder, const char *name, const uint8_t *bytes, size_t size)
{
    char path[128];
    make_path(path, folder, name);
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd >= 0 && write(fd, bytes, size) != (ssize_t)size)
        abort();
    if (fd >= 0)
        close(fd);
}

static void remove_files(const char *folder)
{
    char path[128];
    for (size_t n = 0; n < NAMES; n++) {
        make_path(path, folder, names[n]);
        unlink(path);
    }
}

static void remove_folder(const char *folder)
{
    static const char *const folders[] = {"0/c/0/0", "0/c/0", "0/c", "0",
                                          "c/0/0",   "c/0",   "c",   ""};
    char path[128];
    for (size_t n = 0; n < sizeof folders / sizeof *folders; n++) {
        make_path(path, folder, folders[n]);
        rmdir(path);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    char folder[] = "/tmp/fuzz-zarr-XXXXXX";
    cw_label_table labels = {0};
    const cw_read_desc desc = {.max_bytes = (uint64_t)1 << 16, .labels = &labels};
    cw_volume volume;
    if (!mkdtemp(folder))
        return 0;
    make_folders(folder);
    for (size_t at = 0; at + 3 <= size;) {
        const size_t stated = bytes[at + 1] | (size_t)bytes[at + 2] << 8, left = size - at - 3;
        const size_t length = stated < left ? stated : left;
        write_file(folder, names[bytes[at] % NAMES], bytes + at + 3, length);
        at += 3 + length;
    }
    if (cw_volume_read(folder, &desc, &volume, NULL, NULL) == CW_OK) {
        volatile double sum = touch_voxels(&volume);
        (void)sum;
        read_middle(folder, &desc, &volume);
        cw_volume_free(&volume);
    }
    cw_label_table_free(&labels);
    remove_files(folder);
    remove_folder(folder);
    return 0;
}
