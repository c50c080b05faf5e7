/* Writes files through a hidden temporary beside the target, which a rename puts in place once
 * it is complete. */
#define _GNU_SOURCE /* renameat2 */
#include "core/files/atomic_file.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/atomic_folder.h"
#include "core/files/temporary_name.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { BUFFER_BYTES = 256 * 1024, SLOT_COUNT = 64, NAME_TRIES = 100 };

struct cwi_outfile {
    int fd, folder;
    char name[CWI_FILE_NAME_BYTES]; /* in the folder, after links are followed */
    char temporary
        [CWI_FILE_NAME_BYTES]; /* in the same folder; "" before it exists and after it is removed */
    bool no_clobber;
    bool joined;  /* the temporary is another process's, or has no name */
    bool unnamed; /* it has no name, and needs no flush to the disk */
    bool counts;  /* its bytes are memory: counted of them */
    size_t counted;
    int failure;   /* errno of the first write that failed */
    int slot;      /* in the registry; -1 for none */
    uint64_t size; /* number of bytes so far, including those in the buffer */
    size_t used;
    unsigned char *buffer;
};

/* Temporaries in progress. A signal handler reads them, so they are copies in static memory
 * that is never freed, each guarded by its own state. */
static struct {
    atomic_int state;
    int folder;
    char name[CWI_FILE_NAME_BYTES];
} slots[SLOT_COUNT];

enum { SLOT_FREE, SLOT_CHANGING, SLOT_LIVE };

static int slot_take(int folder, const char *name)
{
    for (int i = 0; i < SLOT_COUNT; i++) {
        int expected = SLOT_FREE;
        if (atomic_compare_exchange_strong(&slots[i].state, &expected, SLOT_CHANGING)) {
            slots[i].folder = folder;
            strcpy(slots[i].name, name);
            atomic_store(&slots[i].state, SLOT_LIVE);
            return i;
        }
    }
    return -1;
}

static void slot_drop(int *slot)
{
    if (*slot >= 0)
        atomic_store(&slots[*slot].state, SLOT_FREE);
    *slot = -1;
}

void cwi_outfile_remove_all(void)
{
    const int before = errno;
    for (int i = 0; i < SLOT_COUNT; i++)
        if (atomic_load(&slots[i].state) == SLOT_LIVE)
            unlinkat(slots[i].folder, slots[i].name, 0);
    cwi_outfolder_remove_all();
    errno = before;
}

static atomic_bool ends;

/* Others fill a slot before they look at `ends`, so that one side sees what the other did. */
void cwi_outfile_end_all(void)
{
    atomic_store(&ends, true);
    cwi_outfile_remove_all();
}

static cw_status fail_system(cw_error *err, const char *what, int number)
{
    return cwi_fail(err, CW_ERR_OUTPUT, "%s: %s", what, strerror(number));
}

/* Decides by the target that exists: nothing (exists false), a regular file, or an error. */
static cw_status inspect_target(const char *path, bool no_clobber, bool *exists, mode_t *mode,
                                cw_error *err)
{
    struct stat link, info;
    *exists = lstat(path, &link) == 0;
    if (!*exists)
        return CW_OK; /* a missing folder is reported when it is opened */
    if (no_clobber)
        return cwi_fail(err, CW_ERR_OUTPUT, "it exists, and is not to be replaced");
    if (stat(path, &info) != 0)
        return cwi_fail(err, CW_ERR_OUTPUT, "it is a link that leads nowhere");
    if (S_ISDIR(info.st_mode))
        return cwi_fail(err, CW_ERR_OUTPUT, "it is a folder");
    if (!S_ISREG(info.st_mode))
        return cwi_fail(err, CW_ERR_OUTPUT, "it is a device, pipe or socket, not a file");
    *mode = info.st_mode & 0777;
    return CW_OK;
}

/* Creates the temporary. The kernel applies the umask to a new file's 0666. The mode of a
 * replaced file is narrowed at creation, so no one can open the temporary who could not open
 * the old file. */
static cw_status make_temporary(cwi_outfile *f, bool replaces, mode_t mode, cw_error *err)
{
    for (int i = 0; i < NAME_TRIES; i++) {
        cwi_name_temporary(f->name, f->temporary);
        f->fd = openat(f->folder, f->temporary,
                       O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW,
                       replaces ? mode : 0666);
        if (f->fd >= 0 || errno != EEXIST)
            break;
    }
    if (f->fd < 0) {
        f->temporary[0] = '\0';
        return fail_system(err, "no file can be made in its folder", errno);
    }
    f->slot = slot_take(f->folder, f->temporary);
    if (atomic_load(&ends)) {
        unlinkat(f->folder, f->temporary, 0);
        for (;;)
            pause();
    }
    if (replaces && fchmod(f->fd, mode) != 0 && errno != EPERM && errno != ENOTSUP)
        return fail_system(err, "its permissions cannot be kept", errno);
    return CW_OK;
}

static void close_and_free(cwi_outfile **f)
{
    if ((*f)->fd >= 0)
        close((*f)->fd);
    if ((*f)->temporary[0])
        unlinkat((*f)->folder, (*f)->temporary, 0);
    slot_drop(&(*f)->slot);
    cwi_memory_give((*f)->counted);
    if ((*f)->folder >= 0)
        close((*f)->folder);
    cwi_free((*f)->buffer);
    cwi_free(*f);
    *f = NULL;
}

/* Opens the folder of a path, or of the file that a link there leads to. */
static cw_status open_real_parent(cwi_outfile *f, const char *path, cw_error *err)
{
    char *real = realpath(path, NULL); /* NULL: there is no file yet */
    cw_status st = cwi_open_parent(real ? real : path, &f->folder, f->name, err);
    free(real);
    return st;
}

static cw_status open_beside(cwi_outfile *f, const char *path, cw_error *err)
{
    bool exists;
    mode_t mode = 0;
    cw_status st = inspect_target(path, f->no_clobber, &exists, &mode, err);
    if (st != CW_OK)
        return st;
    st = open_real_parent(f, path, err);
    if (st == CW_OK)
        st = make_temporary(f, exists, mode, err);
    return st;
}

/* Allocates a file that is not open yet. */
static cw_status new_file(cwi_outfile **out, const char *path, cw_error *err)
{
    cwi_outfile *f = *out = cwi_alloc_zeroed(1, sizeof *f);
    if (f) {
        f->fd = f->folder = f->slot = -1;
        f->buffer = cwi_alloc_array(BUFFER_BYTES, 1);
    }
    if (f && f->buffer && path)
        return CW_OK;
    if (f)
        close_and_free(out);
    return cwi_fail_memory(err);
}

cw_status cwi_outfile_open(cwi_outfile **out, const char *path, bool no_clobber, cw_error *err)
{
    cw_status st = new_file(out, path, err);
    if (st != CW_OK)
        return st;
    (*out)->no_clobber = no_clobber;
    st = open_beside(*out, path, err);
    if (st != CW_OK)
        close_and_free(out);
    return st;
}

cw_status cwi_outfile_join(cwi_outfile **out, const char *path, const char *temporary,
                           cw_error *err)
{
    cw_status st = new_file(out, path, err);
    if (st != CW_OK)
        return st;
    cwi_outfile *f = *out;
    f->joined = true;
    st = open_real_parent(f, path, err);
    if (st == CW_OK) {
        f->fd = openat(f->folder, temporary, O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
        if (f->fd < 0)
            st = fail_system(err, "the file that another process made is not seen", errno);
    }
    if (st != CW_OK)
        close_and_free(out);
    return st;
}

cw_status cwi_outfile_open_at(cwi_outfile **out, int fd, bool in_memory, cw_error *err)
{
    cw_status st = new_file(out, "", err);
    if (st != CW_OK)
        return st;
    cwi_outfile *f = *out;
    f->joined = f->unnamed = true;
    f->counts = in_memory;
    f->fd = fcntl(fd, F_DUPFD_CLOEXEC, 0);
    if (f->fd >= 0)
        return CW_OK;
    st = fail_system(err, "its temporary file cannot be opened", errno);
    close_and_free(out);
    return st;
}

const char *cwi_outfile_temporary(const cwi_outfile *f)
{
    return f->temporary;
}

static cw_status fail_write(const cwi_outfile *f, cw_error *err)
{
    if (f->counts && f->failure == ENOMEM)
        return cwi_fail_memory(err);
    return fail_system(err, "it cannot be written", f->failure);
}

/* Counts bytes that are appended to a file in memory. */
static void count_bytes(cwi_outfile *f, size_t size)
{
    if (f->counts && !f->failure && cwi_memory_take(size))
        f->counted += size;
    else if (f->counts && !f->failure)
        f->failure = ENOMEM;
}

/* Writes at the end of the file or, if `at` is not negative, over the bytes there. */
static cw_status write_through(cwi_outfile *f, const unsigned char *bytes, size_t size,
                               off_t at, cw_error *err)
{
    if (at < 0)
        count_bytes(f, size);
    while (size && !f->failure) {
        const ssize_t n = at < 0 ? write(f->fd, bytes, size) : pwrite(f->fd, bytes, size, at);
        if (n > 0) {
            bytes += n;
            size -= (size_t)n;
            at += at < 0 ? 0 : n;
        } else if (n == 0) {
            f->failure = ENOSPC; /* a regular file accepts nothing only when the disk is full */
        } else if (errno != EINTR) {
            f->failure = errno;
        }
    }
    return f->failure ? fail_write(f, err) : CW_OK;
}

static cw_status flush_file(cwi_outfile *f, cw_error *err)
{
    const size_t size = f->used;
    f->used = 0;
    return write_through(f, f->buffer, size, -1, err);
}

cw_status cwi_outfile_write(cwi_outfile *f, const void *bytes, size_t size, cw_error *err)
{
    if (f->failure)
        return fail_write(f, err);
    f->size += size;
    if (size > BUFFER_BYTES - f->used) {
        cw_status st = flush_file(f, err);
        if (st != CW_OK || size >= BUFFER_BYTES)
            return st == CW_OK ? write_through(f, bytes, size, -1, err) : st;
    }
    if (size)
        memcpy(f->buffer + f->used, bytes, size);
    f->used += size;
    return CW_OK;
}

cw_status cwi_outfile_skip(cwi_outfile *f, uint64_t size, cw_error *err)
{
    cw_status st = f->failure ? fail_write(f, err) : flush_file(f, err);
    if (st == CW_OK && lseek(f->fd, (off_t)size, SEEK_CUR) < 0) {
        f->failure = errno;
        st = fail_write(f, err);
    }
    f->size += size;
    return st;
}

uint64_t cwi_outfile_size(const cwi_outfile *f)
{
    return f->size;
}

cw_status cwi_outfile_patch(cwi_outfile *f, uint64_t at, const void *bytes, size_t size,
                            cw_error *err)
{
    cw_status st = f->failure ? fail_write(f, err) : flush_file(f, err);
    return st == CW_OK ? write_through(f, bytes, size, (off_t)at, err) : st;
}

/* Formats into the buffer. Text that does not fit is formatted again into memory of its own. */
CW_PRINTF(3, 0)
static cw_status print_args(cwi_outfile *f, cw_error *err, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    const size_t left = BUFFER_BYTES - f->used;
    const int length = vsnprintf((char *)f->buffer + f->used, left, format, args);
    cw_status st = CW_OK;
    if (length < 0) {
        st = fail_system(err, "text cannot be formatted", errno);
    } else if ((size_t)length < left) {
        f->used += (size_t)length;
        f->size += (size_t)length;
    } else {
        char *text = cwi_alloc_array((size_t)length + 1, 1);
        if (text)
            vsnprintf(text, (size_t)length + 1, format, again);
        st = text ? cwi_outfile_write(f, text, (size_t)length, err) : cwi_fail_memory(err);
        cwi_free(text);
    }
    va_end(again);
    return st;
}

cw_status cwi_outfile_printf(cwi_outfile *f, cw_error *err, const char *format, ...)
{
    if (f->failure)
        return fail_write(f, err);
    va_list args;
    va_start(args, format);
    void *before = cwi_locale_c();
    cw_status st = print_args(f, err, format, args);
    cwi_locale_restore(before);
    va_end(args);
    return st;
}

/* Returns true for an error that only says fsync is not supported; a complete file is then
 * still accepted. */
static bool cannot_sync(int number)
{
    return number == EINVAL || number == ENOTSUP || number == EROFS;
}

cw_status cwi_outfile_finish(cwi_outfile *f, cw_error *err)
{
    if (f->fd < 0 && !f->failure)
        return CW_OK;
    cw_status st = f->failure ? fail_write(f, err) : flush_file(f, err);
    if (st != CW_OK)
        return st;
    int synced = 0;
    do
        synced = f->unnamed ? 0 : fsync(f->fd);
    while (synced != 0 && errno == EINTR);
    if (synced != 0 && !cannot_sync(errno))
        return fail_system(err, "it cannot be flushed to the disk", errno);
    const int closed = close(f->fd);
    f->fd = -1;
    if (closed != 0 && errno != EINTR) /* Linux has closed it even then */
        return fail_system(err, "it cannot be closed", errno);
    return CW_OK;
}

/* Renames without replacing. The kernel refuses the rename when the name is taken. A hard link
 * does the same where the file system lacks such a rename. */
static int rename_new(cwi_outfile *f)
{
    if (renameat2(f->folder, f->temporary, f->folder, f->name, RENAME_NOREPLACE) == 0)
        return 0;
    if (errno != EINVAL && errno != ENOSYS && errno != ENOTSUP)
        return -1;
    if (linkat(f->folder, f->temporary, f->folder, f->name, 0) != 0)
        return -1;
    return unlinkat(f->folder, f->temporary, 0);
}

static cw_status put_in_place(cwi_outfile *f, cw_error *err)
{
    const int renamed =
        f->no_clobber ? rename_new(f) : renameat(f->folder, f->temporary, f->folder, f->name);
    if (renamed != 0 && f->no_clobber && errno == EEXIST)
        return cwi_fail(err, CW_ERR_OUTPUT, "it exists, and is not to be replaced");
    if (renamed != 0)
        return fail_system(err, "it cannot be put in its place", errno);
    f->temporary[0] = '\0';
    fsync(f->folder); /* best effort: the file is already complete under its name */
    return CW_OK;
}

cw_status cwi_outfile_commit(cwi_outfile **f, cw_error *err)
{
    cw_status st = cwi_outfile_finish(*f, err);
    if (st == CW_OK && !(*f)->joined)
        st = put_in_place(*f, err);
    close_and_free(f);
    return st;
}

void cwi_outfile_abort(cwi_outfile **f)
{
    if (*f)
        close_and_free(f);
}

cw_status cwi_outfile_save(const char *path, const void *bytes, size_t size, cw_error *err)
{
    cwi_outfile *file = NULL;
    cw_status st = cwi_outfile_open(&file, path, false, err);
    if (st == CW_OK)
        st = cwi_outfile_write(file, bytes, size, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&file, err);
    cwi_outfile_abort(&file);
    return st == CW_OK ? st : cwi_fail_in(err, st, path);
}
