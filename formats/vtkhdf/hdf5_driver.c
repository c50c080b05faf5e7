/* A file driver for libhdf5 that reads one open file by its descriptor, and nothing else. */
#define _GNU_SOURCE /* pread */
#include "core/base/status.h"
#include "formats/vtkhdf/hdf5_file.h"

#include <errno.h>
#include <stdio.h>
#include <unistd.h>

/* The name is the address of the bytes. A file is not written, and no other is opened. */
static H5FD_t *open_bytes(const char *name, unsigned flags, hid_t list, haddr_t max)
{
    void *bytes = NULL;
    (void)list, (void)max;
    if (flags != H5F_ACC_RDONLY || sscanf(name, "%p", &bytes) != 1)
        return NULL;
    return &((cwi_hdf5_bytes *)bytes)->base;
}

/* Leaves the file open: its owner closes it. */
static herr_t close_bytes(H5FD_t *file)
{
    (void)file;
    return 0;
}

static int compare_files(const H5FD_t *a, const H5FD_t *b)
{
    const int x = ((const cwi_hdf5_bytes *)a)->fd, y = ((const cwi_hdf5_bytes *)b)->fd;
    return (x > y) - (x < y);
}

static herr_t tell_flags(const H5FD_t *file, unsigned long *flags)
{
    (void)file;
    *flags = 0;
    return 0;
}

static haddr_t get_allocated(const H5FD_t *file, H5FD_mem_t type)
{
    (void)type;
    return ((const cwi_hdf5_bytes *)file)->allocated;
}

static herr_t set_allocated(H5FD_t *file, H5FD_mem_t type, haddr_t end)
{
    (void)type;
    ((cwi_hdf5_bytes *)file)->allocated = end;
    return 0;
}

static haddr_t get_end(const H5FD_t *file, H5FD_mem_t type)
{
    (void)type;
    return ((const cwi_hdf5_bytes *)file)->end;
}

/* Reads bytes. Those behind the end are an error: damaged files ask for them. */
static herr_t read_bytes(H5FD_t *file, H5FD_mem_t type, hid_t list, haddr_t at, size_t size,
                         void *to)
{
    const cwi_hdf5_bytes *o = (const cwi_hdf5_bytes *)file;
    char *left = to;
    (void)type, (void)list;
    if (at > o->end || size > o->end - at)
        return -1;
    while (size) {
        const ssize_t n = pread(o->fd, left, size, (off_t)at);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return -1;
        left += n;
        at += (haddr_t)n;
        size -= (size_t)n;
    }
    return 0;
}

static herr_t refuse_write(H5FD_t *file, H5FD_mem_t type, hid_t list, haddr_t at, size_t size,
                           const void *from)
{
    (void)file, (void)type, (void)list, (void)at, (void)size, (void)from;
    return -1;
}

static const H5FD_class_t driver = {
#ifdef H5FD_CLASS_VERSION
    .version = H5FD_CLASS_VERSION,
    .value = 511, /* one of those that are free for all */
#endif
    .name = "cubewright",
    .maxaddr = INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .open = open_bytes,
    .close = close_bytes,
    .cmp = compare_files,
    .query = tell_flags,
    .get_eoa = get_allocated,
    .set_eoa = set_allocated,
    .get_eof = get_end,
    .read = read_bytes,
    .write = refuse_write,
    .fl_map = H5FD_FLMAP_SINGLE,
};

hid_t cwi_hdf5_open(cwi_hdf5_bytes *bytes)
{
    char name[40];
    const hid_t id = H5FDregister(&driver), list = H5Pcreate(H5P_FILE_ACCESS);
    hid_t file = -1;
    bytes->allocated = 0;
    snprintf(name, sizeof name, "%p", (void *)bytes);
    if (id >= 0 && list >= 0 && H5Pset_driver(list, id, NULL) >= 0)
        file = H5Fopen(name, H5F_ACC_RDONLY, list);
    if (list >= 0)
        H5Pclose(list);
    if (id >= 0)
        H5FDunregister(id);
    return file;
}

static herr_t keep_first(unsigned n, const H5E_error2_t *error, void *text)
{
    if (n == 0)
        snprintf(text, 120, "%s", error->desc ? error->desc : "");
    return 0;
}

cw_status cwi_hdf5_fail(const char *subject, cw_error *err)
{
    char text[120] = "";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, text);
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "%s cannot be read, as the file is damaged%s%s: 'h5dump' shows how far it can be",
        subject, *text ? "; HDF5 says: " : "", text);
}
