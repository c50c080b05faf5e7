/* Opens, writes and reads temporary files that have no name. */
#define _GNU_SOURCE /* O_TMPFILE, memfd_create */
#include "core/base/unnamed_file.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

char *cwi_folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        return cwi_strdup(".");
    char *folder = cwi_strdup(path);
    if (folder)
        folder[slash == path ? 1 : slash - path] = '\0';
    return folder;
}

cw_status cwi_unnamed_open(const char *folder, int *file, cw_error *err)
{
    static const char name[] = "/.cubewright-XXXXXX"; /* a file system without such files */
    *file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (*file < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
        char *path = cwi_alloc_array(strlen(folder) + sizeof name, 1);
        if (!path)
            return cwi_fail_memory(err);
        strcpy(path, folder);
        strcat(path, name);
        *file = mkostemp(path, O_CLOEXEC);
        if (*file >= 0)
            unlink(path);
        cwi_free(path);
    }
    return *file >= 0 ? CW_OK
                      : cwi_fail(err, CW_ERR_OUTPUT, "no temporary file in '%s': %s", folder,
                                 strerror(errno));
}

cw_status cwi_unnamed_open_memory(int *file, cw_error *err)
{
    *file = memfd_create("cubewright", MFD_CLOEXEC);
    return *file >= 0 ? CW_OK
                      : cwi_fail(err, CW_ERR_OUTPUT, "no temporary file in memory: %s",
                                 strerror(errno));
}

cw_status cwi_unnamed_write(const char *folder, int file, size_t at, const void *from,
                            size_t bytes, cw_error *err)
{
    const char *left = from;
    while (bytes) {
        const ssize_t n = pwrite(file, left, bytes, (off_t)at);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return cwi_fail(err, CW_ERR_OUTPUT,
                            "a temporary file in '%s' cannot be written: %s", folder,
                            strerror(n < 0 ? errno : ENOSPC));
        left += n;
        at += (size_t)n;
        bytes -= (size_t)n;
    }
    return CW_OK;
}

cw_status cwi_unnamed_read(int file, size_t at, void *to, size_t bytes, cw_error *err)
{
    char *left = to;
    while (bytes) {
        const ssize_t n = pread(file, left, bytes, (off_t)at);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return cwi_fail(err, CW_ERR_IO, "a temporary file cannot be read: %s",
                            n < 0 ? strerror(errno) : "it ends early");
        left += n;
        at += (size_t)n;
        bytes -= (size_t)n;
    }
    return CW_OK;
}
