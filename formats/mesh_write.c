/* Writes meshes: finds the writer, checks what is asked of it, and says what a file loses. */
#include <cubewright/formats.h>

#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/bytes/file_pattern.h"
#include "formats/format_registry.h"
#include "formats/mesh/place_parts.h"

#include <stdio.h>
#include <stdlib.h>

static bool is_wanted(const cw_format *format, const char *path, const char *name)
{
    if (!format->writes_mesh)
        return false;
    return name ? strcmp(format->name, name) == 0 : cwi_has_extension(path, format->extensions);
}

const cw_format *cw_mesh_format(const char *path, const char *name)
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

/* glTF may be asked for what it is in any case. */
static cw_status check_axes(const cwi_format_driver *f, const cw_axes *axes, cw_error *err)
{
    const bool metres = axes->unit == CW_UNIT_MM || axes->unit == CW_UNIT_M;
    if (axes->unit >= CW_UNIT_COUNT)
        return cw_fail(err, CW_ERR_ARGUMENT, "%d is not a unit", (int)axes->unit);
    if (f->write.own_axes && (!metres || axes->ras))
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "%s is in metres, +Y up and facing +Z: it has no other unit or frame",
                       f->name);
    return CW_OK;
}

static cw_status check_text(const cwi_format_driver *f, const cw_write_desc *d, cw_error *err)
{
    char list[128] = "";
    size_t used = 0;
    if (!d->text || f->write.text)
        return CW_OK;
    for (size_t n = 0; cwi_format_at(n); n++)
        if (cwi_format_at(n)->write.text && used < sizeof list)
            used += (size_t)snprintf(list + used, sizeof list - used, " %s",
                                     cwi_format_at(n)->name);
    return cw_fail(err, CW_ERR_ARGUMENT, "%s has no form as text; those that have are%s",
                   f->name, list);
}

static cw_status check_compression(const cwi_format_driver *f, const cw_write_desc *d,
                                   cw_error *err)
{
    cw_write_desc as_written = *d;
    if (f->write.only && d->compression && d->compression != f->write.only)
        return cw_fail(err, CW_ERR_ARGUMENT, "%s has one form only, Draco's", f->name);
    if (f->write.only)
        as_written.compression = f->write.only;
    if (as_written.compression == CW_COMPRESS_NONE)
        return CW_OK;
    if (f->write.compresses || f->write.only)
        return cwi_gltf_prepare_codec(&as_written, err);
    return cw_fail(err, CW_ERR_ARGUMENT, "%s has no compressed form; glTF (.glb, .gltf) has",
                   f->name);
}

static cw_status check_animation(const cwi_format_driver *f, const cw_write_desc *d,
                                 cw_error *err)
{
    return !d->animated || f->write.animates
               ? CW_OK
               : cw_fail(err, CW_ERR_ARGUMENT, "%s has no animation; glTF (.glb, .gltf) has",
                         f->name);
}

/* How a file will be written. */
typedef struct target {
    const cw_format *format;
    const cwi_format_driver *driver;
} target;

/* The format and writer of a path, with what it needs loaded; it can do what is asked for. */
static cw_status find_writer(const char *path, const cw_write_desc *d, target *t, cw_error *err)
{
    *t = (target){.format = cw_mesh_format(path, d->format)};
    if (!t->format)
        return fail_unknown(d->format, err);
    t->driver = cwi_find_format(t->format->name);
    cw_status st = check_axes(t->driver, &d->axes, err);
    if (st == CW_OK)
        st = check_text(t->driver, d, err);
    if (st == CW_OK)
        st = check_animation(t->driver, d, err);
    if (st == CW_OK)
        st = check_compression(t->driver, d, err);
    return st == CW_OK && t->driver->write.prepare ? t->driver->write.prepare(err) : st;
}

static cw_status check_levels(const cwi_format_driver *f, const cw_part *parts, size_t count,
                              cw_error *err)
{
    for (size_t i = 0; i < count; i++) {
        const size_t level = parts[i].level;
        if (level == 0)
            continue;
        if (!f->write.levels)
            return cw_fail(err, CW_ERR_ARGUMENT,
                           "%s has no levels of detail; glTF (.glb, .gltf) has", f->name);
        if (i == 0 || parts[i - 1].level != level - 1)
            return cw_fail(err, CW_ERR_ARGUMENT,
                           "part %zu is of level %zu: one of level %zu must be "
                           "in front of it",
                           i, level, level - 1);
        if (!parts[i].mesh->triangle_count || !parts[i - 1].mesh->triangle_count)
            return cw_fail(err, CW_ERR_ARGUMENT, "a level of detail has no triangles");
    }
    return CW_OK;
}

static cw_status write_parts(const char *path, const cwi_parts *parts, const target *t,
                             const cw_write_desc *d, cwi_mesh_output *out, cw_error *err)
{
    cw_status st = cwi_outfile_open(&out->file, path, d->no_clobber, err);
    if (st == CW_OK)
        st = t->driver->write.write(parts, out, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&out->file, err);
    cwi_outfile_abort(&out->file);
    return st;
}

cw_status cw_parts_write(const char *path, const cw_part *parts, size_t count,
                         const cw_write_desc *desc, cw_error *err)
{
    cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    target t;
    char name[CWI_NAME_BYTES];
    double origin[3];
    cwi_parts placed = {0};
    cwi_choose_name(path, parts, count, &d, name);
    cwi_mesh_output out = {.name = name,
                           .local_origin = d.local ? origin : NULL,
                           .desc = &d,
                           .axes = &d.axes,
                           .text = d.text,
                           .progress = &d.progress};
    cw_status st = find_writer(path, &d, &t, err);
    if (st == CW_OK)
        st = check_levels(t.driver, parts, count, err);
    if (st == CW_OK && t.driver->write.own_axes)
        d.axes = (cw_axes){0};
    if (st == CW_OK && t.driver->write.only)
        d.compression = t.driver->write.only;
    if (st == CW_OK)
        st = cwi_parts_place(parts, count, &d, t.format->keeps, name, &placed, origin, err);
    if (st == CW_OK)
        st = write_parts(path, &placed, &t, &d, &out, err);
    cwi_parts_free(&placed);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_mesh_write(const char *path, const cw_mesh *mesh, const cw_write_desc *desc,
                        cw_error *err)
{
    return cw_parts_write(path, &(cw_part){.mesh = mesh}, 1, desc, err);
}

/* A local file of one part holds its positions as they are. */
static bool is_exact(const cwi_part *part, const cw_write_desc *d)
{
    const double *origin = part->mesh.origin;
    return d->local && origin[0] == 0 && origin[1] == 0 && origin[2] == 0;
}

static unsigned find_dropped(const cw_part *parts, size_t count, const cwi_parts *placed,
                             unsigned keeps, const cw_write_loss *loss)
{
    unsigned had = CW_KEEPS_SHARING | (placed->count > 1 ? CW_KEEPS_PARTS : 0u);
    unsigned has = keeps & (CW_KEEPS_SHARING | CW_KEEPS_PARTS | CW_KEEPS_AFFINE);
    for (size_t i = 0; i < count; i++)
        had |= cwi_arrays_of(parts[i].mesh);
    for (size_t i = 0; i < placed->count; i++)
        has |= cwi_arrays_of(&placed->items[i].mesh) & ~(unsigned)CW_KEEPS_AFFINE;
    if (loss->merged_vertices || loss->flat_triangles)
        had |= CW_KEEPS_PLACES;
    return had & ~has;
}

cw_status cw_parts_write_loss(const char *path, const cw_part *parts, size_t count,
                              const cw_write_desc *desc, cw_write_loss *loss, cw_error *err)
{
    const cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    target t;
    double origin[3];
    cwi_parts placed = {0};
    memset(loss, 0, sizeof *loss);
    cw_status st = find_writer(path, &d, &t, err);
    if (st == CW_OK)
        st = cwi_parts_place(parts, count, &d, t.format->keeps, "", &placed, origin, err);
    for (size_t i = 0; i < placed.count && st == CW_OK; i++)
        if (!(t.format->keeps & CW_KEEPS_PLACES) && !is_exact(&placed.items[i], &d))
            st = cwi_measure_loss(&placed.items[i], loss, err);
    if (st == CW_OK)
        loss->dropped = find_dropped(parts, count, &placed, t.format->keeps, loss);
    cwi_parts_free(&placed);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_mesh_write_loss(const char *path, const cw_mesh *mesh, const cw_write_desc *desc,
                             cw_write_loss *loss, cw_error *err)
{
    return cw_parts_write_loss(path, &(cw_part){.mesh = mesh}, 1, desc, loss, err);
}

cw_status cw_mesh_write_check(const char *path, const cw_write_desc *desc, cw_error *err)
{
    const cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    cwi_outfile *file = NULL;
    target t;
    cw_status st = find_writer(path, &d, &t, err);
    if (st == CW_OK) /* to make a file and drop it is the only sure way to know */
        st = cwi_outfile_open(&file, path, d.no_clobber, err);
    cwi_outfile_abort(&file);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
