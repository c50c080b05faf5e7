/* Reads ParaView's list of the files of a time series (.pvd). */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/text/xml.h"
#include "formats/vtk/pvd.h"
#include "formats/vtk/vtk_xml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_FILES = 65536 };

typedef struct parsing {
    const cwi_input *in;
    cw_pvd_entry *entries;
    size_t count, capacity;
} parsing;

bool cwi_pvd_sniff(const unsigned char *head, size_t size)
{
    return cwi_vtk_xml_sniff(head, size, "Collection");
}

static cw_status start_file(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    const char *type = cwi_attribute(a, "type");
    (void)user, (void)x;
    if (type && strcmp(type, "Collection") == 0)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "the VTK file is '%.40s'; a list of files (pvd) is a "
                    "Collection",
                    type ? type : "");
}

/* Makes a path for this program from a name in the file, which is relative to the list's
 * folder. */
static char *path_of(const cwi_input *in, const char *name)
{
    const char *slash = strrchr(in->path, '/');
    const size_t folder = slash && name[0] != '/' ? (size_t)(slash + 1 - in->path) : 0;
    char *path = cwi_alloc_array(folder + strlen(name) + 1, 1);
    if (!path)
        return NULL;
    memcpy(path, in->path, folder);
    strcpy(path + folder, name);
    return path;
}

static cw_status add_entry(parsing *p, const char *name, double time, cw_error *err)
{
    if (p->count == MAX_FILES)
        return cwi_fail(err, CW_ERR_LIMIT, "more than %d files are listed", MAX_FILES);
    void *grown = cwi_grow_array(p->entries, p->count, &p->capacity, sizeof *p->entries);
    if (!grown)
        return cwi_fail_memory(err);
    p->entries = grown;
    char *path = path_of(p->in, name);
    if (!path)
        return cwi_fail_memory(err);
    p->entries[p->count++] = (cw_pvd_entry){path, time};
    return CW_OK;
}

static cw_status start_entry(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    const char *name = cwi_attribute(a, "file"), *step = cwi_attribute(a, "timestep");
    double time = 0;
    uint64_t size;
    int fd;
    if (!name || !*name)
        return cwi_fail(err, CW_ERR_FORMAT, "line %lu: the DataSet names no 'file'",
                        cwi_xml_line(x));
    if (step &&
        (!cwi_parse_double(&step, &time) || step[strspn(step, " \t")] || !isfinite(time)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %lu: 'timestep' is '%.40s'; a number was expected",
                        cwi_xml_line(x), cwi_attribute(a, "timestep"));
    cw_status st = cwi_input_open_side(p->in, name, &fd, &size, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, name);
    close(fd);
    return add_entry(p, name, time, err);
}

enum { FILE_ROW, COLLECTION, DATA_SET, ELEMENT_COUNT };

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [FILE_ROW] = {"VTKFile", CWI_XML_ROOT, start_file, NULL},
    [COLLECTION] = {"Collection", FILE_ROW, NULL, NULL},
    [DATA_SET] = {"DataSet", COLLECTION, start_entry, NULL},
};

static const cwi_xml_rules rules = {
    .elements = elements, .element_count = ELEMENT_COUNT, .max_elements = 4 * MAX_FILES};

static int compare_times(const void *a, const void *b)
{
    const cw_pvd_entry *s = a, *t = b;
    return (s->time > t->time) - (s->time < t->time);
}

/* Refuses several files of one time: they are the parts of a run on several processors. */
static cw_status check_entries(parsing *p, cw_error *err)
{
    if (p->count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the list names no file");
    qsort(p->entries, p->count, sizeof *p->entries, compare_times);
    for (size_t n = 1; n < p->count; n++)
        if (p->entries[n].time == p->entries[n - 1].time)
            return cwi_fail(err, CW_ERR_UNSUPPORTED,
                            "'%s' and '%s' are both of time %.6g: one file a time step is read",
                            p->entries[n - 1].path, p->entries[n].path, p->entries[n].time);
    return CW_OK;
}

cw_status cw_pvd_read(const char *path, const cw_read_desc *desc, cw_pvd_entry **entries,
                      size_t *count, cw_error *err)
{
    CWI_REQUIRE(err, path, entries, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_input in = {0};
    parsing p = {.in = &in};
    cw_status st = cwi_input_open(&in, path, err);
    in.allow_external = desc && desc->allow_external;
    if (st == CW_OK)
        st = cwi_xml_read_file(&rules, &p, &in, err);
    if (st == CW_OK)
        st = check_entries(&p, err);
    cwi_input_close(&in);
    *entries = p.entries;
    *count = p.count;
    if (st == CW_OK)
        return CW_OK;
    cw_pvd_free(p.entries, p.count);
    *entries = NULL;
    *count = 0;
    return cwi_fail_in(err, st, path);
}

void cw_pvd_free(cw_pvd_entry *entries, size_t count)
{
    if (!entries)
        return;
    for (size_t n = 0; n < count; n++)
        cwi_free((void *)(uintptr_t)entries[n].path);
    cwi_free(entries);
}

bool cw_pvd_is(const char *path)
{
    if (!path)
        return false;
    unsigned char head[512];
    cwi_input in = {0};
    size_t size = 0;
    const bool opened = cwi_input_open(&in, path, NULL) == CW_OK;
    const bool is = opened &&
                    cwi_input_read_at(in.fd, 0, head, sizeof head, &size, NULL) == CW_OK &&
                    cwi_pvd_sniff(head, size);
    if (opened)
        cwi_input_close(&in);
    return is;
}
