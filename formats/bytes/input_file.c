/* Opens untrusted files and the side files that they name, without leaving the folder, and
 * expands name patterns. */
#define _GNU_SOURCE /* O_PATH, strerrordesc_np */
#include "formats/bytes/input_file.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/stored_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_NAMES = 65536, LONGEST_NAME = 1023 };

/* Reports the system's last error, and leaves it in errno. */
static cw_status fail_system(cw_error *err, const char *what)
{
    const int number = errno;
    const char *why = strerrordesc_np(number);
    cwi_fail(err, CW_ERR_IO, "%s: %s", what, why ? why : "unknown error");
    errno = number;
    return CW_ERR_IO;
}

static const char *kind_of_file(mode_t mode)
{
    return S_ISDIR(mode)    ? "a folder"
           : S_ISFIFO(mode) ? "a named pipe"
           : S_ISSOCK(mode) ? "a socket"
                            : "a device";
}

/* Opens a regular file. O_NONBLOCK prevents waiting for a pipe or a tape before fstat has
 * reported the type. */
static cw_status open_regular(int folder, const char *name, int flags, int *fd, uint64_t *size,
                              cw_error *err)
{
    struct stat info;
    *fd = openat(folder, name, O_RDONLY | O_NONBLOCK | O_CLOEXEC | flags);
    if (*fd < 0 && errno == ELOOP && flags & O_NOFOLLOW)
        return cwi_fail(err, CW_ERR_UNSAFE, "a symbolic link, which a data file must not be");
    if (*fd < 0)
        return fail_system(err, "cannot be opened");
    cw_status st = CW_OK;
    if (fstat(*fd, &info) != 0)
        st = fail_system(err, "cannot be looked at");
    else if (!S_ISREG(info.st_mode))
        st = cwi_fail(err, CW_ERR_IO, "%s, not a file", kind_of_file(info.st_mode));
    else if (info.st_size == 0)
        st = cwi_fail(err, CW_ERR_IO, "the file is empty");
    else if (fcntl(*fd, F_SETFL, 0) != 0)
        st = fail_system(err, "cannot be set to blocking");
    if (st == CW_OK) {
        *size = (uint64_t)info.st_size;
        return CW_OK;
    }
    close(*fd);
    *fd = -1;
    return st;
}

static int open_folder(const char *path, size_t length)
{
    char name[4096];
    if (length >= sizeof name) {
        errno = ENAMETOOLONG;
        return -1;
    }
    memcpy(name, path, length);
    name[length] = '\0';
    return open(length ? name : ".", O_PATH | O_DIRECTORY | O_CLOEXEC);
}

cw_status cwi_input_open(cwi_input *in, const char *path, cw_error *err)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    *in = (cwi_input){.path = path, .fd = -1};
    in->folder = open_folder(path, (size_t)(base - path));
    if (in->folder < 0)
        return fail_system(err, "cannot be opened");
    cw_status st =
        open_regular(in->folder, *base || !slash ? base : ".", 0, &in->fd, &in->size, err);
    if (st != CW_OK)
        cwi_input_close(in);
    return st;
}

cw_status cwi_input_open_stored(cwi_input *in, const cw_stored_file *file, cw_error *err)
{
    *in = (cwi_input){.path = file->name, .folder = -1, .fd = -1, .size = file->size};
    return cwi_stored_file_reopen(file, &in->fd, err);
}

bool cwi_input_is_stored(const cwi_input *in)
{
    return in->path && in->folder < 0 && in->fd >= 0;
}

const char *cwi_input_name(const char *path, const cw_stored_file *file)
{
    return file ? file->name : path;
}

cw_status cwi_input_open_folder(cwi_input *in, const char *path, cw_error *err)
{
    *in = (cwi_input){.path = path, .fd = -1, .folder = open_folder(path, strlen(path))};
    return in->folder < 0 ? fail_system(err, "cannot be opened") : CW_OK;
}

void cwi_input_close(cwi_input *in)
{
    if (in->path && in->folder >= 0)
        close(in->folder);
    if (in->path && in->fd >= 0)
        close(in->fd);
    *in = (cwi_input){.folder = -1, .fd = -1};
}

static bool has_parent_step(const char *name)
{
    for (const char *s = strstr(name, ".."); s; s = strstr(s + 1, ".."))
        if ((s == name || s[-1] == '/') && (s[2] == '/' || s[2] == '\0'))
            return true;
    return false;
}

/* Returns true for a path such as "C:/scans/a.raw". */
static bool is_windows_path(const char *name)
{
    const char letter = (char)(name[0] | 0x20);
    return letter >= 'a' && letter <= 'z' && name[1] == ':' && name[2] == '/';
}

static cw_status check_name(const char *name, cw_error *err)
{
    const char *why = name[0] == '/'                ? "an absolute path"
                      : has_parent_step(name)       ? "a path with '..'"
                      : strstr(name, "://")         ? "an address"
                      : is_windows_path(name)       ? "an absolute path of Windows"
                      : strchr(name, '%')           ? "a name with '%'"
                      : strlen(name) > LONGEST_NAME ? "a name of more than 1023 bytes"
                                                    : NULL;
    if (why)
        return cwi_fail(err, CW_ERR_UNSAFE,
                        "%s; a data file must lie in its header's folder, unless "
                        "desc->allow_external is set",
                        why);
    return CW_OK;
}

/* Walks down folder by folder, so that no link on the way can lead out. */
static cw_status open_below(int folder, const char *name, int *fd, uint64_t *size,
                            cw_error *err)
{
    const char *slash = strchr(name, '/');
    if (!slash)
        return open_regular(folder, name, O_NOFOLLOW, fd, size, err);
    char step[LONGEST_NAME + 1];
    const size_t length = (size_t)(slash - name);
    memcpy(step, name, length);
    step[length] = '\0';
    const int next =
        openat(folder, length ? step : ".", O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (next < 0)
        return fail_system(err, "its folder cannot be opened or is a link");
    cw_status st = open_below(next, slash + 1, fd, size, err);
    const int number = errno;
    close(next);
    errno = number;
    return st;
}

bool cwi_input_is_named(const cwi_input *in, const char *name)
{
    if (!in->path || in->fd < 0)
        return false;
    const char *slash = strrchr(in->path, '/');
    return strcmp(slash ? slash + 1 : in->path, name) == 0;
}

/* Turns the backslashes of a name that was written on Windows. Longer names are left alone, as they are
 * refused. */
static const char *with_slashes(const char *name, char text[LONGEST_NAME + 2])
{
    if (!strchr(name, '\\') || strlen(name) > LONGEST_NAME)
        return name;
    strcpy(text, name);
    for (char *c = text; (c = strchr(c, '\\'));)
        *c = '/';
    return text;
}

static cw_status open_named(const cwi_input *in, const char *name, int *fd, uint64_t *size,
                            cw_error *err)
{
    if (cwi_input_is_stored(in))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "this file is missing: data without a path have no files beside them");
    if (in->allow_external)
        return open_regular(in->folder, name, 0, fd, size, err);
    cw_status st = check_name(name, err);
    return st == CW_OK ? open_below(in->folder, name, fd, size, err) : st;
}

cw_status cwi_input_open_side(const cwi_input *in, const char *name, int *fd, uint64_t *size,
                              cw_error *err)
{
    if (cwi_input_is_named(in, name)) {
        *fd = fcntl(in->fd, F_DUPFD_CLOEXEC, 0);
        *size = in->size;
        return *fd < 0 ? fail_system(err, "cannot be opened") : CW_OK;
    }
    char slashes[LONGEST_NAME + 2];
    cw_status st = open_named(in, with_slashes(name, slashes), fd, size, err);
    if (in->allow_external && st == CW_ERR_IO && errno == ENOENT && strchr(name, '\\'))
        st = open_named(in, name, fd, size, err); /* a backslash may be a part of the name */
    return st;
}

cw_status cwi_input_find_side(const cwi_input *in, const char *name, int *fd, uint64_t *size,
                              cw_error *err)
{
    cw_error why = {0};
    *fd = -1;
    if (cwi_input_is_stored(in) && !cwi_input_is_named(in, name))
        return CW_OK;
    errno = 0;
    cw_status st = cwi_input_open_side(in, name, fd, size, &why);
    if (st == CW_ERR_IO && errno == ENOENT) {
        *fd = -1;
        return CW_OK;
    }
    return st == CW_OK ? CW_OK : cwi_fail(err, st, "%s", why.message);
}

cw_status cwi_input_read_at(int fd, uint64_t offset, void *to, size_t size, size_t *got,
                            cw_error *err)
{
    *got = 0;
    while (*got < size) {
        if (offset + *got > INT64_MAX)
            return CW_OK;
        const ssize_t n = pread(fd, (char *)to + *got, size - *got, (off_t)(offset + *got));
        if (n < 0 && errno != EINTR)
            return fail_system(err, "cannot be read");
        if (n == 0)
            return CW_OK;
        *got += n > 0 ? (size_t)n : 0;
    }
    return CW_OK;
}

cw_status cwi_names_add(cwi_names *names, const char *name, cw_error *err)
{
    const size_t n = names->count;
    if (n >= MAX_NAMES)
        return cwi_fail(err, CW_ERR_LIMIT, "more than %d data files", MAX_NAMES);
    if ((n & (n - 1)) == 0) { /* the capacity is reached at every power of two */
        char **items = cwi_realloc_array(names->items, n ? 2 * n : 1, sizeof *items);
        if (!items)
            return cwi_fail_memory(err);
        names->items = items;
    }
    names->items[n] = cwi_strdup(name);
    if (!names->items[n])
        return cwi_fail_memory(err);
    names->count = n + 1;
    return CW_OK;
}

void cwi_names_free(cwi_names *names)
{
    for (size_t i = 0; i < names->count; i++)
        cwi_free(names->items[i]);
    cwi_free(names->items);
    *names = (cwi_names){0};
}

/* A file name that contains one number, split into parts. */
typedef struct pattern {
    int head; /* number of bytes before the number */
    int width;
    bool zeros;       /* pad with zeros, not blanks */
    const char *tail; /* text after the number */
    int tail_length;
} pattern;

/* Splits a pattern. It is never passed to printf, since a format string of an untrusted file
 * could do harm. */
static bool take_apart(const char *text, size_t length, pattern *p)
{
    const char *percent = memchr(text, '%', length);
    if (!percent || length > LONGEST_NAME - 20)
        return false;
    const char *s = percent + 1;
    p->head = (int)(percent - text);
    p->zeros = *s == '0';
    s += p->zeros;
    p->width = *s >= '1' && *s <= '9' ? *s++ - '0' : 0;
    p->tail = s + 1;
    p->tail_length = (int)(text + length - p->tail);
    return *s == 'd' && !memchr(p->tail, '%', (size_t)p->tail_length);
}

static cw_status add_number(cwi_names *names, const char *text, const pattern *p,
                            int64_t number, cw_error *err)
{
    char name[LONGEST_NAME + 1], digits[24];
    if (p->zeros)
        snprintf(digits, sizeof digits, "%0*lld", p->width, (long long)number);
    else
        snprintf(digits, sizeof digits, "%*lld", p->width, (long long)number);
    snprintf(name, sizeof name, "%.*s%s%.*s", p->head, text, digits, p->tail_length, p->tail);
    return cwi_names_add(names, name, err);
}

cw_status cwi_names_expand(cwi_names *names, const char *text, int64_t *depth, cw_error *err)
{
    pattern p;
    int64_t first, last, step;
    const char *s = text + strcspn(text, " \t");
    if (!take_apart(text, (size_t)(s - text), &p))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the pattern '%.64s' needs one %%d, with a width up to 9 and without blanks", text);
    if (!cwi_parse_int(&s, &first) || !cwi_parse_int(&s, &last) || !cwi_parse_int(&s, &step) ||
        (cwi_parse_int(&s, depth), *s))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the pattern '%.64s' needs three numbers behind it: first, last, step",
                        text);
    if (step == 0 || first < 0 || last < 0 || (step > 0 ? last < first : last > first))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the pattern counts from %lld to %lld by %lld; it must reach its end, and all "
            "numbers must be 0 or more",
            (long long)first, (long long)last, (long long)step);
    cw_status st = CW_OK;
    for (int64_t n = first; st == CW_OK; n += step) {
        st = add_number(names, text, &p, n, err);
        if (step > 0 ? step > last - n : step < last - n)
            break;
    }
    return st;
}
