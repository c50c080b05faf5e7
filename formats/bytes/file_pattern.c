/* Lists the files of a folder or a pattern in natural order, and finds the number in which
 * names differ. */
#define _GNU_SOURCE /* O_PATH, fdopendir */
#include "formats/bytes/file_pattern.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { DEEPEST = 16 };

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Compares numbers of any length: after leading zeros the longer one is larger. */
static int compare_numbers(const char **a, const char **b)
{
    *a += strspn(*a, "0");
    *b += strspn(*b, "0");
    const size_t m = strspn(*a, "0123456789"), n = strspn(*b, "0123456789");
    const int order = m != n ? (m < n ? -1 : 1) : strncmp(*a, *b, m);
    *a += m;
    *b += n;
    return order;
}

/* Returns true at a minus that is the sign of the number behind it: a blank, an underscore or the like is
 * in front. With `any`, only a digit may not be there. */
static bool is_sign(const char *start, const char *s, bool any)
{
    if (*s != '-' || !is_digit(s[1]))
        return false;
    return s == start || strchr("_ (=,[/", s[-1]) || (any && !is_digit(s[-1]));
}

static bool is_number(const char *start, const char *s, bool any)
{
    return is_digit(*s) || is_sign(start, s, any);
}

/* A place in a name. */
typedef struct place {
    const char *start, *at;
} place;

/* Compares numbers with their signs, and moves behind both. */
static int compare_signed(place *a, place *b, bool any)
{
    const bool is_minus[2] = {is_sign(a->start, a->at, any), is_sign(b->start, b->at, any)};
    a->at += is_minus[0];
    b->at += is_minus[1];
    const int order = compare_numbers(&a->at, &b->at);
    if (is_minus[0] != is_minus[1])
        return is_minus[0] ? -1 : 1;
    return is_minus[0] ? -order : order;
}

static bool are_numbers(const place *a, const place *b, bool any)
{
    return is_number(a->start, a->at, any) && is_number(b->start, b->at, any);
}

int cwi_natural_order(const char *a, const char *b)
{
    place s = {a, a}, t = {b, b};
    while (*s.at && *t.at) {
        const int order = are_numbers(&s, &t, false)
                              ? compare_signed(&s, &t, false)
                              : (unsigned char)*s.at++ - (unsigned char)*t.at++;
        if (order)
            return order;
    }
    return *s.at || *t.at ? (*s.at ? 1 : -1) : strcmp(a, b); /* 1 and 01 also differ */
}

static int compare_names(const void *a, const void *b)
{
    return cwi_natural_order(*(char *const *)a, *(char *const *)b);
}

bool cwi_files_is_pattern(const char *path)
{
    return strpbrk(path, "*?[") && access(path, F_OK) != 0;
}

bool cwi_is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* --- numbers in names --------------------------------------------------------------------- */

enum { UNLIKE = -2, SAME = -1 };

/* Finds the only number in which two names differ, counted from 0. Returns SAME where they
 * differ by leading zeros at most. any: as for is_sign() */
static int differing_number(const char *a, const char *b, bool any)
{
    place s = {a, a}, t = {b, b};
    int found = SAME, number = 0;
    while (*s.at && *t.at) {
        if (are_numbers(&s, &t, any)) {
            if (compare_signed(&s, &t, any) != 0) {
                if (found != SAME)
                    return UNLIKE;
                found = number;
            }
            number++;
        } else if (*s.at++ != *t.at++) {
            return UNLIKE;
        }
    }
    return *s.at || *t.at ? UNLIKE : found;
}

static bool number_at(const char *name, int which, bool any, double *number)
{
    for (const char *s = name; *s; which--) {
        while (*s && !is_number(name, s, any))
            s++;
        const double sign = *s == '-' ? -1 : 1;
        s += *s == '-';
        const size_t length = strspn(s, "0123456789");
        *number = 0;
        for (size_t i = 0; i < length; i++)
            *number = 10 * *number + (s[i] - '0');
        *number *= sign;
        if (which == 0)
            return length > 0 && length <= 15;
        s += length;
    }
    return false;
}

static bool find_numbers(const cwi_names *names, bool any, double *numbers)
{
    int which = SAME;
    for (size_t i = 1; i < names->count; i++) {
        const int here = differing_number(names->items[0], names->items[i], any);
        if (here == UNLIKE || (which != SAME && here != SAME && here != which))
            return false;
        which = here == SAME ? which : here;
    }
    bool good = true;
    for (size_t i = 0; good && i < names->count; i++)
        good = number_at(names->items[i], which == SAME ? 0 : which, any, &numbers[i]);
    return good;
}

bool cwi_files_numbers(const cwi_names *names, double *numbers)
{
    return find_numbers(names, false, numbers) || find_numbers(names, true, numbers);
}

/* A name and its number. */
typedef struct numbered {
    double number;
    char *name;
} numbered;

static int compare_numbered(const void *x, const void *y)
{
    const numbered *a = x, *b = y;
    return a->number != b->number ? (a->number > b->number ? 1 : -1)
                                  : cwi_natural_order(a->name, b->name);
}

/* Sorts names such as s-1 and s1: they are alike only where the minus is a sign. */
static void sort_signed(cwi_names *names)
{
    double *numbers = cwi_alloc_array(names->count, sizeof *numbers);
    numbered *items = cwi_alloc_array(names->count, sizeof *items);
    const bool has_signs = numbers && items && !find_numbers(names, false, numbers) &&
                           find_numbers(names, true, numbers);
    for (size_t i = 0; has_signs && i < names->count; i++)
        items[i] = (numbered){numbers[i], names->items[i]};
    if (has_signs)
        qsort(items, names->count, sizeof *items, compare_numbered);
    for (size_t i = 0; has_signs && i < names->count; i++)
        names->items[i] = items[i].name;
    cwi_free(numbers);
    cwi_free(items);
}

void cwi_files_sort(cwi_names *names)
{
    if (names->count)
        qsort(names->items, names->count, sizeof *names->items, compare_names);
    if (names->count > 1)
        sort_signed(names);
}

/* --- a folder ---------------------------------------------------------------------------- */

typedef struct listing {
    const cwi_input *in;
    bool deep;
    cwi_names *names;
    size_t links;
} listing;

static cw_status list_folder(listing *l, const char *folder, int depth, cw_error *err);

/* Handles the entry of one name: leaves it out, lists it, or lists the folder. */
static cw_status take_entry(listing *l, int folder, const char *prefix, const char *name,
                            int depth, cw_error *err)
{
    char path[1024];
    struct stat info;
    const bool named = depth == 0 && cwi_input_is_named(l->in, name); /* named by the user */
    const int follow = l->in->allow_external || named ? 0 : AT_SYMLINK_NOFOLLOW;
    if ((name[0] == '.' && !named) || fstatat(folder, name, &info, follow) != 0)
        return CW_OK;
    l->links += S_ISLNK(info.st_mode);
    const int length = snprintf(path, sizeof path, "%s%s", prefix, name);
    if (length >= (int)sizeof path - 1)
        return cwi_fail(err, CW_ERR_LIMIT, "a path in it is longer than %zu bytes",
                        sizeof path - 2);
    if (S_ISREG(info.st_mode))
        return cwi_names_add(l->names, path, err);
    if (!S_ISDIR(info.st_mode) || !l->deep)
        return CW_OK;
    path[length] = '/';
    path[length + 1] = '\0';
    return list_folder(l, path, depth + 1, err);
}

/* Lists a folder; prefix is empty, or a folder with its slash. */
static cw_status list_folder(listing *l, const char *prefix, int depth, cw_error *err)
{
    const int flags = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
    if (depth > DEEPEST)
        return cwi_fail(err, CW_ERR_LIMIT, "its folders are nested deeper than %d", DEEPEST);
    const int fd = openat(l->in->folder, *prefix ? prefix : ".", flags);
    DIR *folder = fd >= 0 ? fdopendir(fd) : NULL;
    if (!folder) {
        const char *why = strerrordesc_np(errno);
        if (fd >= 0)
            close(fd);
        return cwi_fail(err, CW_ERR_IO, "the folder '%s' cannot be listed: %s",
                        *prefix ? prefix : ".", why ? why : "unknown error");
    }
    cw_status st = CW_OK;
    for (const struct dirent *e; st == CW_OK && (e = readdir(folder));)
        st = take_entry(l, fd, prefix, e->d_name, depth, err);
    closedir(folder);
    return st;
}

static cw_status list_all(listing *l, cw_error *err)
{
    cw_status st = list_folder(l, "", 0, err);
    cwi_files_sort(l->names);
    return st;
}

cw_status cwi_files_beside(const cwi_input *in, cwi_names *names, size_t *links, cw_error *err)
{
    const char *slash = strrchr(in->path, '/');
    *links = 0;
    if (cwi_input_is_stored(in))
        return cwi_names_add(names, slash ? slash + 1 : in->path, err);
    listing l = {.in = in, .names = names};
    cw_status st = list_all(&l, err);
    *links = l.links;
    return st;
}

/* --- a pattern --------------------------------------------------------------------------- */

/* Names the folders that match where no file does. */
static cw_status fail_match(const glob_t *found, size_t folders, cw_error *err)
{
    if (folders == 0)
        return cwi_fail(err, CW_ERR_IO, "no file matches");
    if (folders == 1)
        return cwi_fail(err, CW_ERR_IO, "no file matches, but a folder does: %.400s",
                        found->gl_pathv[0]);
    return cwi_fail(err, CW_ERR_IO,
                    "no file matches, but %zu folders do: %.200s to %.200s; cw_volume_read() "
                    "takes one of them",
                    folders, found->gl_pathv[0], found->gl_pathv[found->gl_pathc - 1]);
}

static cw_status match_names(const char *pattern, cwi_names *names, cw_error *err)
{
    glob_t found = {0};
    struct stat info;
    const int code = glob(pattern, 0, NULL, &found);
    cw_status st = CW_OK;
    size_t folders = 0;
    if (code == GLOB_NOSPACE)
        st = cwi_fail_memory(err);
    for (size_t i = 0; st == CW_OK && code == 0 && i < found.gl_pathc; i++) {
        const bool exists = stat(found.gl_pathv[i], &info) == 0;
        folders += exists && S_ISDIR(info.st_mode);
        if (exists && S_ISREG(info.st_mode))
            st = cwi_names_add(names, found.gl_pathv[i], err);
    }
    if (st == CW_OK && names->count == 0)
        st = fail_match(&found, folders, err);
    globfree(&found);
    cwi_files_sort(names);
    return st;
}

cw_status cwi_files_find(cwi_input *in, const char *path, bool deep, cwi_names *names,
                         size_t *links, cw_error *err)
{
    const bool pattern = cwi_files_is_pattern(path);
    const bool external = in->allow_external;
    cw_status st = cwi_input_open_folder(in, pattern ? "." : path, err);
    in->path = path;
    in->allow_external = external || pattern; /* named by the user */
    if (st != CW_OK || pattern)
        return st == CW_OK ? match_names(path, names, err) : st;
    listing l = {.in = in, .deep = deep, .names = names};
    st = list_all(&l, err);
    *links = l.links;
    return st;
}

static bool ends_in(const char *path, const char *extension, size_t length)
{
    const size_t path_length = strlen(path);
    return path_length > length &&
           strncasecmp(path + path_length - length, extension, length) == 0;
}

bool cwi_has_extension(const char *path, const char *extensions)
{
    while (*extensions) {
        const size_t length = strcspn(extensions, " ");
        if (length && ends_in(path, extensions, length))
            return true;
        extensions += length;
        extensions += strspn(extensions, " ");
    }
    return false;
}
