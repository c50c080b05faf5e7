/* Writes folders through a hidden one beside the target, which takes the target's place once it
 * is complete. */
#define _GNU_SOURCE /* renameat2, SYS_getdents64 */
#include "core/files/atomic_folder.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/temporary_name.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { SLOT_COUNT = 8, NAME_TRIES = 100, MAX_PASSES = 64, LIST_BYTES = 8192 };

struct cwi_outfolder {
    int parent, folder, fd;              /* -1: not open; fd is the file that was begun */
    char name[CWI_FILE_NAME_BYTES];      /* in the parent, after links are followed */
    char temporary[CWI_FILE_NAME_BYTES]; /* in the parent; "": none */
    char *path;                          /* without slashes at its end */
    bool no_clobber;
    cwi_folder_check *check;
    int slot; /* in the registry; -1: none */
    uint64_t size;
};

/* Hidden folders in progress, for a signal handler: copies in static memory. */
static struct {
    atomic_int state;
    int parent;
    char name[CWI_FILE_NAME_BYTES];
} slots[SLOT_COUNT];

enum { SLOT_FREE, SLOT_CHANGING, SLOT_LIVE };

static int take_slot(int parent, const char *name)
{
    for (int i = 0; i < SLOT_COUNT; i++) {
        int expected = SLOT_FREE;
        if (atomic_compare_exchange_strong(&slots[i].state, &expected, SLOT_CHANGING)) {
            slots[i].parent = parent;
            strcpy(slots[i].name, name);
            atomic_store(&slots[i].state, SLOT_LIVE);
            return i;
        }
    }
    return -1;
}

/* --- removing ---------------------------------------------------------------------------- */

/* An entry of a folder as the kernel lists it; readdir() is not async-signal-safe. */
typedef struct listed_entry {
    uint64_t inode;
    int64_t offset;
    unsigned short length;
    unsigned char type;
    char name[];
} listed_entry;

static bool is_dots(const char *name)
{
    return name[0] == '.' && (!name[1] || (name[1] == '.' && !name[2]));
}

/* Removes a folder with its files, and with folders of files in it down to `depth`. A folder
 * that loses entries while it is listed is listed again. */
static void remove_folder(int parent, const char *name, int depth)
{
    const int folder = openat(parent, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    bool again = folder >= 0;
    for (int pass = 0; again && pass < MAX_PASSES; pass++) {
        _Alignas(listed_entry) char list[LIST_BYTES];
        long got;
        again = false;
        lseek(folder, 0, SEEK_SET);
        while ((got = syscall(SYS_getdents64, folder, list, sizeof list)) > 0)
            for (long at = 0; at < got;) {
                const listed_entry *e = (const listed_entry *)(list + at);
                at += e->length;
                if (is_dots(e->name))
                    continue;
                again |= unlinkat(folder, e->name, 0) == 0;
                if (depth > 0)
                    remove_folder(folder, e->name, depth - 1);
            }
    }
    if (folder >= 0)
        close(folder);
    unlinkat(parent, name, AT_REMOVEDIR);
}

enum { DEPTH = 1 };

void cwi_outfolder_remove_all(void)
{
    for (int i = 0; i < SLOT_COUNT; i++)
        if (atomic_load(&slots[i].state) == SLOT_LIVE)
            remove_folder(slots[i].parent, slots[i].name, DEPTH);
}

static void close_and_free(cwi_outfolder **out)
{
    cwi_outfolder *f = *out;
    if (f->fd >= 0)
        close(f->fd);
    if (f->folder >= 0)
        close(f->folder);
    if (f->temporary[0])
        remove_folder(f->parent, f->temporary, DEPTH);
    if (f->slot >= 0)
        atomic_store(&slots[f->slot].state, SLOT_FREE);
    if (f->parent >= 0)
        close(f->parent);
    cwi_free(f->path);
    cwi_free(f);
    *out = NULL;
}

void cwi_outfolder_abort(cwi_outfolder **f)
{
    if (*f)
        close_and_free(f);
}

/* --- opening ----------------------------------------------------------------------------- */

static cw_status fail_system(cw_error *err, const char *what, int number)
{
    return cwi_fail(err, CW_ERR_OUTPUT, "%s: %s", what, strerror(number));
}

static bool is_empty(int folder)
{
    const int copy = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *dir = copy >= 0 ? fdopendir(copy) : NULL;
    bool empty = dir != NULL;
    for (struct dirent *e; empty && (e = readdir(dir));)
        empty = is_dots(e->d_name);
    if (dir)
        closedir(dir);
    else if (copy >= 0)
        close(copy);
    return empty;
}

/* Decides by the target that exists: nothing (exists false), a folder to replace, or an
 * error. */
static cw_status inspect_target(const cwi_outfolder *f, bool *exists, cw_error *err)
{
    struct stat link;
    *exists = lstat(f->path, &link) == 0;
    if (!*exists)
        return CW_OK;
    if (f->no_clobber)
        return cwi_fail(err, CW_ERR_OUTPUT, "it exists, and is not to be replaced");
    const int folder = open(f->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0 && errno == ENOTDIR)
        return cwi_fail(err, CW_ERR_OUTPUT, "it is a file, not a folder");
    if (folder < 0)
        return fail_system(err, "the folder cannot be opened", errno);
    cw_status st = is_empty(folder) ? CW_OK : f->check(folder, err);
    close(folder);
    return st;
}

static cw_status make_temporary(cwi_outfolder *f, cw_error *err)
{
    int made = -1;
    for (int i = 0; i < NAME_TRIES && made != 0; i++) {
        cwi_name_temporary(f->name, f->temporary);
        made = mkdirat(f->parent, f->temporary, 0777);
        if (made != 0 && errno != EEXIST)
            break;
    }
    if (made != 0) {
        f->temporary[0] = '\0';
        return fail_system(err, "no folder can be made beside it", errno);
    }
    f->slot = take_slot(f->parent, f->temporary);
    f->folder =
        openat(f->parent, f->temporary, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    return f->folder >= 0 ? CW_OK : fail_system(err, "its folder cannot be opened", errno);
}

static cw_status open_beside(cwi_outfolder *f, cw_error *err)
{
    bool exists;
    cw_status st = inspect_target(f, &exists, err);
    if (st != CW_OK)
        return st;
    char *real = exists ? realpath(f->path, NULL) : NULL;
    st = cwi_open_parent(real ? real : f->path, &f->parent, f->name, err);
    free(real);
    return st == CW_OK ? make_temporary(f, err) : st;
}

cw_status cwi_outfolder_open(cwi_outfolder **out, const char *path, bool no_clobber,
                             cwi_folder_check *check, cw_error *err)
{
    cwi_outfolder *f = cwi_alloc_zeroed(1, sizeof *f);
    *out = NULL;
    if (!f)
        return cwi_fail_memory(err);
    f->parent = f->folder = f->fd = f->slot = -1;
    f->no_clobber = no_clobber;
    f->check = check;
    f->path = cwi_strdup(path);
    for (size_t n = f->path ? strlen(f->path) : 0; n > 1 && f->path[n - 1] == '/'; n--)
        f->path[n - 1] = '\0';
    cw_status st = f->path ? open_beside(f, err) : cwi_fail_memory(err);
    if (st != CW_OK)
        close_and_free(&f);
    *out = f;
    return st;
}

/* --- files ------------------------------------------------------------------------------- */

cw_status cwi_outfolder_begin(cwi_outfolder *f, const char *name, cw_error *err)
{
    const char *slash = strchr(name, '/');
    if (slash) {
        char inner[CWI_FILE_NAME_BYTES];
        snprintf(inner, sizeof inner, "%.*s", (int)(slash - name), name);
        if (mkdirat(f->folder, inner, 0777) != 0 && errno != EEXIST)
            return fail_system(err, "a folder in it cannot be made", errno);
    }
    f->fd = openat(f->folder, name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    return f->fd >= 0 ? CW_OK : fail_system(err, "a file in it cannot be made", errno);
}

cw_status cwi_outfolder_write(cwi_outfolder *f, const void *bytes, size_t size, cw_error *err)
{
    const unsigned char *at = bytes;
    f->size += size;
    while (size) {
        const ssize_t n = write(f->fd, at, size);
        if (n == 0 || (n < 0 && errno != EINTR))
            return fail_system(err, "a file in it cannot be written", n ? errno : ENOSPC);
        at += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return CW_OK;
}

cw_status cwi_outfolder_end(cwi_outfolder *f, cw_error *err)
{
    int synced;
    do
        synced = fsync(f->fd);
    while (synced != 0 && errno == EINTR);
    if (synced != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
        return fail_system(err, "a file in it cannot be flushed to the disk", errno);
    const int closed = close(f->fd);
    f->fd = -1;
    return closed == 0 || errno == EINTR
               ? CW_OK
               : fail_system(err, "a file in it cannot be closed", errno);
}

cw_status cwi_outfolder_save(cwi_outfolder *f, const char *name, const void *bytes, size_t size,
                             cw_error *err)
{
    cw_status st = cwi_outfolder_begin(f, name, err);
    if (st == CW_OK)
        st = cwi_outfolder_write(f, bytes, size, err);
    return st == CW_OK ? cwi_outfolder_end(f, err) : st;
}

uint64_t cwi_outfolder_size(const cwi_outfolder *f)
{
    return f->size;
}

/* --- commit ------------------------------------------------------------------------------ */

/* Puts the hidden folder where nothing stands. */
static cw_status rename_new(cwi_outfolder *f, cw_error *err)
{
    int done = renameat2(f->parent, f->temporary, f->parent, f->name, RENAME_NOREPLACE);
    if (done != 0 && (errno == EINVAL || errno == ENOSYS || errno == ENOTSUP))
        done = renameat(f->parent, f->temporary, f->parent, f->name);
    if (done != 0 && (errno == EEXIST || errno == ENOTEMPTY))
        return cwi_fail(err, CW_ERR_OUTPUT, "it was made by another program in the meantime");
    if (done != 0)
        return fail_system(err, "it cannot be put in its place", errno);
    f->temporary[0] = '\0';
    return CW_OK;
}

/* Exchanges the hidden folder and the old one, which is then the hidden one, to be removed.
 * Where the file system has no such exchange, the old one is moved aside first. */
static cw_status replace_old(cwi_outfolder *f, cw_error *err)
{
    char aside[CWI_FILE_NAME_BYTES];
    if (renameat2(f->parent, f->temporary, f->parent, f->name, RENAME_EXCHANGE) == 0)
        return CW_OK;
    cwi_name_temporary(f->name, aside);
    if (renameat(f->parent, f->name, f->parent, aside) != 0)
        return fail_system(err, "the old folder cannot be replaced", errno);
    if (renameat(f->parent, f->temporary, f->parent, f->name) != 0) {
        const int number = errno;
        if (renameat(f->parent, aside, f->parent, f->name) != 0)
            return cwi_fail(err, CW_ERR_OUTPUT, "the old folder is now '%s'", aside);
        return fail_system(err, "it cannot be put in its place", number);
    }
    strcpy(f->temporary, aside);
    return CW_OK;
}

cw_status cwi_outfolder_commit(cwi_outfolder **out, cw_error *err)
{
    cwi_outfolder *f = *out;
    bool exists;
    fsync(f->folder); /* best effort: the files are already on the disk */
    cw_status st = inspect_target(f, &exists, err);
    if (st == CW_OK)
        st = exists ? replace_old(f, err) : rename_new(f, err);
    if (st == CW_OK)
        fsync(f->parent);
    close_and_free(out);
    return st;
}
