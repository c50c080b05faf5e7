#include <cubewright/formats.h>

#include "core/status.h"
#include "core/text.h"
#include "formats/mesh_writers.h"
#include "formats/table.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct writer {
    const char *format;
    cwi_mesh_writer *write;
    cw_status (*prepare)(cw_error *err); /* loads what it needs; NULL: nothing */
    bool world;                          /* coordinates hold the origin, unless local */
} writer;

static const writer writers[] = {
    {"glb", cwi_glb_write, cwi_gltf_prepare, false},
    {"gltf", cwi_gltf_write, cwi_gltf_prepare, false},
    {"stl", cwi_stl_write, NULL, true},
    {"ply", cwi_ply_write, NULL, true},
    {"obj", cwi_obj_write, NULL, true},
};

enum { NAME_BYTES = 256, PROGRESS_STEP = 65536 };

cw_status cwi_write_records(const cw_mesh *mesh, cwi_mesh_output *out,
                            cwi_record_encoder *encode, size_t count, cw_error *err)
{
    unsigned char record[CWI_RECORD_BYTES];
    cw_status st = CW_OK;
    for (size_t i = 0; i < count && st == CW_OK; i++) {
        const unsigned char *end = encode(mesh, i, record);
        st = cwi_outfile_write(out->file, record, (size_t)(end - record), err);
        if (st == CW_OK && out->done++ % PROGRESS_STEP == 0)
            st = cwi_progress(out->progress, "writing", (double)out->done / (double)out->total,
                              err);
    }
    return st;
}

cw_status cwi_check_single(const cw_mesh *mesh, cw_error *err)
{
    double low[3], high[3];
    cw_mesh_bounds(mesh, low, high);
    for (int a = 0; a < 3; a++)
        if (low[a] < -(double)FLT_MAX || high[a] > (double)FLT_MAX)
            return cw_fail(err, CW_ERR_LIMIT,
                           "the mesh stands at %g mm, which the format's single "
                           "precision cannot say",
                           high[a]);
    return CW_OK;
}

/* The fewest digits that read back the same. */
static int print_shortest(char *text, size_t size, double value)
{
    int length = 0;
    for (int digits = 15; digits <= 17; digits++) {
        length = snprintf(text, size, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    return length;
}

void cwi_print_origin(const cwi_mesh_output *out, const char *before, const char *after,
                      char text[CWI_ORIGIN_BYTES])
{
    void *locale = cwi_locale_c();
    size_t used = 0;
    text[0] = '\0';
    for (int a = 0; a < 3 && out->local_origin; a++) {
        used += (size_t)snprintf(text + used, CWI_ORIGIN_BYTES - used, "%s ", a ? "" : before);
        used +=
            (size_t)print_shortest(text + used, CWI_ORIGIN_BYTES - used, out->local_origin[a]);
    }
    snprintf(text + used, CWI_ORIGIN_BYTES - used, "%s", out->local_origin ? after : "");
    cwi_locale_restore(locale);
}

static bool is_wanted(const cw_format *format, const char *path, const char *name)
{
    if (!format->writes_mesh)
        return false;
    return name ? strcmp(format->name, name) == 0 : cwi_has_extension(path, format->extensions);
}

static const cw_format *find_format(const char *path, const char *name)
{
    size_t count;
    const cw_format *all = cw_formats(&count);
    for (size_t i = 0; i < count; i++)
        if (is_wanted(&all[i], path, name))
            return &all[i];
    return NULL;
}

static cw_status fail_unknown(const char *name, cw_error *err)
{
    char list[256] = "";
    size_t count, used = 0;
    const cw_format *all = cw_formats(&count);
    for (size_t i = 0; i < count; i++)
        if (all[i].writes_mesh && used < sizeof list)
            used += (size_t)snprintf(list + used, sizeof list - used, " %s",
                                     name ? all[i].name : all[i].extensions);
    if (name)
        return cw_fail(err, CW_ERR_ARGUMENT, "no mesh format is named '%s'; there are%s", name,
                       list);
    return cw_fail(err, CW_ERR_ARGUMENT, "its extension is of no mesh format; there are%s",
                   list);
}

/* The writer of a path, with what it needs loaded. */
static cw_status find_writer(const char *path, const char *name, const writer **out,
                             cw_error *err)
{
    const cw_format *format = find_format(path, name);
    if (!format)
        return fail_unknown(name, err);
    *out = writers;
    while (strcmp((*out)->format, format->name) != 0)
        (*out)++; /* every format that says it writes meshes has its row */
    return (*out)->prepare ? (*out)->prepare(err) : CW_OK;
}

/* Bytes of the character at text that a name may keep; 0 when it may not. */
static size_t kept_length(const char *text)
{
    const unsigned char first = (unsigned char)text[0];
    const bool printable = first >= 0x20 && first != 0x7f && first != '\\';
    return printable ? cwi_utf8_length(text) : 0;
}

/* Copies size bytes of text; what is not a printable character of UTF-8 becomes '_', so that no
 * name can break a line of OBJ or the JSON of glTF. */
static void clean_name(const char *text, size_t size, char name[NAME_BYTES])
{
    size_t used = 0;
    for (size_t i = 0; i < size;) {
        const size_t length = kept_length(text + i);
        const size_t step = length ? length : 1;
        if (used + step >= NAME_BYTES || i + step > size)
            break;
        if (length)
            memcpy(name + used, text + i, length);
        else
            name[used] = '_';
        used += step;
        i += step;
    }
    name[used] = '\0';
}

/* The name asked for, or the path's last part without its extension. */
static void choose_name(const char *path, const char *asked, char name[NAME_BYTES])
{
    const char *slash = strrchr(path, '/');
    const char *stem = asked ? asked : slash ? slash + 1 : path;
    const char *dot = asked ? NULL : strrchr(stem, '.');
    clean_name(stem, dot && dot != stem ? (size_t)(dot - stem) : strlen(stem), name);
}

static cw_status write_whole(const char *path, const cw_mesh *mesh, const cw_write_desc *d,
                             cwi_mesh_writer *write, cw_error *err)
{
    char name[NAME_BYTES];
    choose_name(path, d->name, name);
    cwi_mesh_output out = {
        .name = name, .local_origin = d->local ? mesh->origin : NULL, .progress = &d->progress};
    cw_mesh placed = *mesh; /* borrows the arrays */
    if (d->local)
        memset(placed.origin, 0, sizeof placed.origin);
    cw_status st = cwi_outfile_open(&out.file, path, d->no_clobber, err);
    if (st == CW_OK)
        st = write(&placed, &out, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&out.file, err);
    cwi_outfile_abort(&out.file);
    return st;
}

cw_status cw_mesh_write(const char *path, const cw_mesh *mesh, const cw_write_desc *desc,
                        cw_error *err)
{
    const cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    const writer *w;
    cw_status st = find_writer(path, d.format, &w, err);
    if (st == CW_OK)
        st = cw_mesh_check(mesh, err);
    if (st == CW_OK && mesh->triangle_count == 0)
        st = cw_fail(err, CW_ERR_ARGUMENT, "the mesh is empty");
    if (st == CW_OK)
        st = write_whole(path, mesh, &d, w->write, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_mesh_write_loss(const char *path, const cw_mesh *mesh, const cw_write_desc *desc,
                             cw_write_loss *loss, cw_error *err)
{
    const cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    const writer *w;
    memset(loss, 0, sizeof *loss);
    cw_status st = find_writer(path, d.format, &w, err);
    if (st == CW_OK)
        st = cw_mesh_check(mesh, err);
    if (st == CW_OK && w->world && !d.local)
        st = cwi_measure_loss(mesh, loss, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_mesh_write_check(const char *path, const cw_write_desc *desc, cw_error *err)
{
    const cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    cwi_outfile *file = NULL;
    const writer *w;
    cw_status st = find_writer(path, d.format, &w, err);
    if (st == CW_OK) /* to make a file and drop it is the only sure way to know */
        st = cwi_outfile_open(&file, path, d.no_clobber, err);
    cwi_outfile_abort(&file);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
