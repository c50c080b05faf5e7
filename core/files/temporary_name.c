/* Opens the folder of a path that is written, and names the hidden temporary in it. */
#define _GNU_SOURCE /* getrandom, O_PATH */
#include "core/files/temporary_name.h"

#include "core/base/status.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

cw_status cwi_open_parent(const char *path, int *folder, char name[CWI_FILE_NAME_BYTES],
                          cw_error *err)
{
    const char *slash = strrchr(path, '/');
    const char *last = slash ? slash + 1 : path;
    char parent[PATH_MAX] = ".";
    if (!*last)
        return cwi_fail(err, CW_ERR_OUTPUT, "it names no file");
    if (strlen(last) >= CWI_FILE_NAME_BYTES)
        return cwi_fail(err, CW_ERR_OUTPUT, "it cannot be made: %s", strerror(ENAMETOOLONG));
    strcpy(name, last);
    const int length = (int)(slash == path) + (slash ? (int)(slash - path) : 0);
    if (length >= PATH_MAX)
        return cwi_fail(err, CW_ERR_OUTPUT, "its folder cannot be opened: %s",
                        strerror(ENAMETOOLONG));
    if (slash) /* the root keeps its slash */
        snprintf(parent, sizeof parent, "%.*s", length, path);
    *folder = open(parent, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (*folder < 0 && errno == EACCES) /* a folder with write but no list permission */
        *folder = open(parent, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (*folder < 0 && errno == ENOENT)
        return cwi_fail(err, CW_ERR_OUTPUT, "the folder '%s' does not exist", parent);
    if (*folder < 0)
        return cwi_fail(err, CW_ERR_OUTPUT, "the folder '%s' cannot be opened: %s", parent,
                        strerror(errno));
    return CW_OK;
}

void cwi_name_temporary(const char *name, char temporary[CWI_FILE_NAME_BYTES])
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz012345";
    unsigned char random[6] = {0};
    char word[sizeof random + 1] = "";
    if (getrandom(random, sizeof random, GRND_NONBLOCK) != (ssize_t)sizeof random)
        for (size_t i = 0; i < sizeof random; i++) /* early in boot: O_EXCL still protects */
            random[i] = (unsigned char)rand();
    for (size_t i = 0; i < sizeof random; i++)
        word[i] = letters[random[i] % 32];
    const int capacity = CWI_FILE_NAME_BYTES - 1 - (int)(sizeof "..XXXXXX.part" - 1);
    snprintf(temporary, CWI_FILE_NAME_BYTES, ".%.*s.%s.part", capacity, name, word);
}
