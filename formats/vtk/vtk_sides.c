/* Opens the files that a VTK file lists, one at a time, and checks their names. */
#define _GNU_SOURCE /* fstat */
#include "formats/vtk/vtk_sides.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

cw_status cwi_vtk_sides_name(cwi_names *names, const char *tag, const char *name,
                             cwi_attributes a, cw_error *err)
{
    const char *file = cwi_attribute(a, name);
    if (!file || !*file)
        return cwi_fail(err, CW_ERR_FORMAT, "a %s has no '%s', the file that holds it", tag,
                        name);
    return cwi_names_add(names, file, err);
}

void cwi_vtk_sides_close(cwi_vtk_sides *s)
{
    if (s->opened)
        close(s->now.fd);
    s->opened = 0;
}

cw_status cwi_vtk_sides_open(cwi_vtk_sides *s, size_t n, const cwi_input **in, cw_error *err)
{
    const char *name = s->names->items[n];
    *in = &s->now;
    if (s->opened == n + 1)
        return CW_OK;
    cwi_vtk_sides_close(s);
    s->now = *s->list;
    s->now.path = name;
    cw_status st = cwi_input_open_side(s->list, name, &s->now.fd, &s->now.size, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, name);
    s->opened = n + 1;
    return CW_OK;
}

/* A file as the system knows it, whatever its name. */
typedef struct identity {
    dev_t device;
    ino_t number;
    size_t name; /* among the names; their count: the list itself */
} identity;

static int compare_identities(const void *a, const void *b)
{
    const identity *s = a, *t = b;
    if (s->device != t->device)
        return s->device < t->device ? -1 : 1;
    if (s->number != t->number)
        return s->number < t->number ? -1 : 1;
    return (s->name > t->name) - (s->name < t->name);
}

static cw_status identify(int fd, size_t name, identity *id, cw_error *err)
{
    struct stat facts;
    if (fstat(fd, &facts) != 0)
        return cwi_fail(err, CW_ERR_IO, "the system does not tell which file it is");
    *id = (identity){facts.st_dev, facts.st_ino, name};
    return CW_OK;
}

static cw_status check_identities(const cwi_vtk_sides *s, identity *ids, cw_error *err)
{
    const size_t count = s->names->count;
    qsort(ids, count + 1, sizeof *ids, compare_identities);
    for (size_t n = 1; n <= count; n++) {
        if (ids[n].device != ids[n - 1].device || ids[n].number != ids[n - 1].number)
            continue;
        const char *first = s->names->items[ids[n - 1].name];
        return ids[n].name == count
                   ? cwi_fail(err, CW_ERR_FORMAT, "'%.100s' is the list itself", first)
                   : cwi_fail(err, CW_ERR_FORMAT,
                              "'%.100s' and '%.100s' are one file, listed twice", first,
                              s->names->items[ids[n].name]);
    }
    return CW_OK;
}

cw_status cwi_vtk_sides_check(cwi_vtk_sides *s, uint64_t *bytes, cw_error *err)
{
    const size_t count = s->names->count;
    const cwi_input *in;
    identity *ids = cwi_alloc_array(count + 1, sizeof *ids);
    cw_status st = ids ? identify(s->list->fd, count, &ids[count], err) : cwi_fail_memory(err);
    *bytes = 0;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        st = cwi_vtk_sides_open(s, n, &in, err);
        if (st == CW_OK)
            st = identify(in->fd, n, &ids[n], err);
        *bytes += st == CW_OK ? in->size : 0;
    }
    if (st == CW_OK)
        st = check_identities(s, ids, err);
    cwi_free(ids);
    return st;
}
