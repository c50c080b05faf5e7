/* Prepares parts for a writer: names, arrays, origins, digits and times. */
#include "formats/mesh/place_parts.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/mesh/mesh_attributes.h"
#include "core/texture/split_seams.h"

#include <math.h>
#include <stdio.h>

/* --- names ------------------------------------------------------------------------------- */

/* Returns the bytes of the character at text, if a name may keep it; otherwise 0. */
static size_t kept_length(const char *text)
{
    const unsigned char first = (unsigned char)text[0];
    const bool printable = first >= 0x20 && first != 0x7f && first != '\\';
    return printable ? cwi_utf8_length(text) : 0;
}

void cwi_clean_name(const char *text, size_t size, char name[CWI_NAME_BYTES])
{
    size_t used = 0;
    for (size_t i = 0; i < size;) {
        const size_t length = kept_length(text + i);
        const size_t step = length ? length : 1;
        if (used + step >= CWI_NAME_BYTES || i + step > size)
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

void cwi_choose_name(const char *path, const cw_part *parts, size_t count,
                     const cw_write_desc *desc, char name[CWI_NAME_BYTES])
{
    const char *requested = desc->name ? desc->name : count == 1 ? parts->name : NULL;
    const char *stem = requested ? requested : path, *end = stem + strlen(stem);
    while (!requested && end > path + 1 && end[-1] == '/') /* of a folder */
        end--;
    for (const char *c = path; !requested && c < end; c++)
        stem = *c == '/' && c + 1 < end ? c + 1 : stem;
    for (const char *c = end; !requested && c > stem + 1; c--)
        if (c[-1] == '.') {
            end = c - 1;
            break;
        }
    cwi_clean_name(stem, (size_t)(end - stem), name);
}

/* Names a part. Without a name of its own it has that of all, and a number if there are
 * several. */
static void name_part(cwi_part *part, const char *given, const char *all, size_t number,
                      size_t count)
{
    if (given && count > 1)
        cwi_clean_name(given, strlen(given), part->name);
    else if (count > 1)
        snprintf(part->name, sizeof part->name, "%.200s %zu", all, number);
    else
        snprintf(part->name, sizeof part->name, "%s", all);
}

/* --- placing ----------------------------------------------------------------------------- */

static cw_status check_parts(const cw_part *parts, size_t count, cw_error *err)
{
    bool empty = true;
    for (size_t i = 0; i < count; i++) {
        cw_status st = parts[i].spool ? CW_OK : cw_mesh_check(parts[i].mesh, err);
        if (st != CW_OK)
            return st;
        empty = empty && parts[i].mesh->triangle_count == 0;
    }
    return empty ? cwi_fail(err, CW_ERR_ARGUMENT, "the mesh is empty") : CW_OK;
}

static const uint8_t *find_face_colors(const cw_mesh *mesh)
{
    const cw_attribute *row = cw_mesh_attribute_find(mesh, CW_FACE_COLORS);
    return row && row->on == CW_ON_TRIANGLES && row->type == CW_U8 && row->components == 4
               ? row->data
               : NULL;
}

unsigned cwi_arrays_of(const cw_mesh *mesh)
{
    const size_t known = (size_t)(find_face_colors(mesh) != NULL) +
                         (size_t)(cwi_texture_of(mesh) != NULL) +
                         (size_t)(cwi_corner_normals_of(mesh) != NULL);
    unsigned has =
        (mesh->normals ? CW_KEEPS_NORMALS : 0u) | (mesh->colors ? CW_KEEPS_COLORS : 0u) |
        (mesh->scalars ? CW_KEEPS_SCALARS : 0u) | (mesh->labels ? CW_KEEPS_LABELS : 0u) |
        (find_face_colors(mesh) ? CW_KEEPS_FACE_COLORS : 0u) |
        (cwi_texture_of(mesh) ? CW_KEEPS_TEXTURE : 0u) |
        (cwi_corner_normals_of(mesh) ? CW_KEEPS_CREASES : 0u) |
        (mesh->attribute_count > known ? CW_KEEPS_ATTRIBUTES : 0u);
    for (int i = 0; i < 12; i++)
        has |= mesh->affine[i / 4][i % 4] != 0 ? CW_KEEPS_AFFINE : 0u;
    return has;
}

static void keep_arrays(cw_mesh *m, unsigned keeps)
{
    m->normals = keeps & CW_KEEPS_NORMALS ? m->normals : NULL;
    m->colors = keeps & CW_KEEPS_COLORS ? m->colors : NULL;
    m->scalars = keeps & CW_KEEPS_SCALARS ? m->scalars : NULL;
    m->labels = keeps & CW_KEEPS_LABELS ? m->labels : NULL;
}

/* Returns the arrays that a label stands for where all parts are one mesh. */
static unsigned arrays_of_label(const cw_label *label)
{
    return !label             ? 0u
           : label->has_color ? CW_KEEPS_LABELS | CW_KEEPS_COLORS
                              : (unsigned)CW_KEEPS_LABELS;
}

/* Finds the one colour of a part: that of its label, unless its vertices have colours; else the colour of
 * all its vertices. White of vertices stays theirs, since a white material is no colour to readers. */
static void choose_color(cwi_part *part)
{
    static const uint8_t white[4] = {255, 255, 255, 255};
    const cw_label *label = part->label;
    if (cwi_mesh_one_color(&part->mesh, part->color) &&
        memcmp(part->color, white, sizeof white) != 0) {
        part->has_color = true;
        part->mesh.colors = NULL;
    } else if (!part->mesh.colors && label && label->has_color) {
        part->has_color = true;
        memcpy(part->color, label->color, sizeof part->color);
    }
}

/* Drops arrays that one part lacks, for formats where all parts share the arrays. */
static void choose_arrays(cwi_parts *parts, unsigned keeps)
{
    unsigned shared = keeps;
    uint64_t normals = 0;
    for (size_t i = 0; i < parts->count; i++) {
        cwi_part *part = &parts->items[i];
        part->arrays = part->spool ? cwi_spool_arrays(part->spool) : cwi_arrays_of(&part->mesh);
        part->arrays |= keeps & CW_KEEPS_PARTS ? 0u : arrays_of_label(part->label);
        shared &= part->arrays;
    }
    for (size_t i = 0; i < parts->count; i++) {
        cwi_part *part = &parts->items[i];
        part->arrays &= keeps & CW_KEEPS_PARTS ? keeps : shared;
        part->face_colors =
            part->arrays & CW_KEEPS_FACE_COLORS ? find_face_colors(&part->mesh) : NULL;
        part->texture = part->arrays & CW_KEEPS_TEXTURE ? cwi_texture_of(&part->mesh) : NULL;
        part->corner_normals =
            part->arrays & CW_KEEPS_CREASES ? cwi_corner_normals_of(&part->mesh) : NULL;
        part->textures = keeps & CW_KEEPS_PICTURES && part->texture ? part->textures : NULL;
        keep_arrays(&part->mesh, part->arrays);
        if (keeps & CW_KEEPS_PARTS && keeps & CW_KEEPS_COLORS)
            choose_color(part);
        part->first_normal = normals;
        normals += part->arrays & CW_KEEPS_NORMALS ? part->mesh.vertex_count : 0;
    }
}

/* Finds the box of a spool with the part's origin, to the bit that of the same mesh. */
static void bound_spool(const cwi_part *part, double min[3], double max[3])
{
    double low[3], high[3];
    cwi_spool_range(part->spool, low, high);
    for (int a = 0; a < 3; a++) {
        min[a] = part->mesh.origin[a] + low[a];
        max[a] = part->mesh.origin[a] + high[a];
    }
}

void cwi_part_bounds(const cwi_part *part, double low[3], double high[3])
{
    double min[3], max[3], p[3], q[3];
    if (part->spool)
        bound_spool(part, min, max);
    else
        cw_mesh_bounds(&part->mesh, min, max);
    cwi_turn_point(&part->turn, min, p);
    cwi_turn_point(&part->turn, max, q);
    for (int a = 0; a < 3; a++) {
        low[a] = fmin(p[a], q[a]);
        high[a] = fmax(p[a], q[a]);
    }
}

/* Returns the number of digits for coordinates. Nine give a float back to the bit, the tenth is
 * for the origin. Where the mesh is more than ten times its own size from zero, 17 give a
 * double. */
static int digits_of(const cwi_part *part)
{
    double low[3], high[3], distance = 0, size = 0;
    cwi_part_bounds(part, low, high);
    for (int a = 0; a < 3; a++) {
        distance = fmax(distance, fmax(fabs(low[a]), fabs(high[a])));
        size = fmax(size, high[a] - low[a]);
    }
    return distance > 10 * size ? 17 : 10;
}

static void add_part(cwi_parts *parts, const cw_part *given, const double origin[3],
                     const cw_axes *axes)
{
    const cw_mesh *mesh = given->mesh;
    cwi_part *part = &parts->items[parts->count++];
    part->level = given->level;
    part->max_error_mm = given->max_error_mm;
    part->rms_error_mm = given->rms_error_mm;
    part->time_s = given->time_s;
    part->label = given->label;
    part->textures = given->textures;
    part->mesh = *mesh;
    part->spool = given->spool;
    part->turn = cwi_turn_to(axes);
    part->first = parts->vertices;
    part->first_triangle = parts->triangles;
    for (int a = 0; a < 3; a++)
        part->mesh.origin[a] -= origin[a];
    part->digits = digits_of(part);
    parts->vertices += mesh->vertex_count;
    parts->triangles += mesh->triangle_count;
}

/* Returns the time when a part comes into sight, or the end of all, counted from the start. */
static double begin_s(const cw_part *parts, size_t count, size_t i)
{
    const double last = parts[count - 1].time_s - parts[0].time_s;
    return i < count ? parts[i].time_s - parts[0].time_s
                     : last + (parts[count - 1].time_s - parts[count - 2].time_s);
}

static void set_sight(cwi_part *placed, const cw_part *parts, size_t count, size_t i)
{
    placed->from_s = begin_s(parts, count, i);
    placed->until_s = begin_s(parts, count, i + 1);
}

static cw_status check_times(const cw_part *parts, size_t count, cw_error *err)
{
    if (count < 2)
        return cwi_fail(err, CW_ERR_ARGUMENT, "an animation of %zu part; it has at least two",
                        count);
    for (size_t i = 0; i < count; i++) {
        if (parts[i].level > 0)
            return cwi_fail(err, CW_ERR_ARGUMENT, "an animation of levels of detail");
        const float here = (float)begin_s(parts, count, i);
        const float next = (float)begin_s(parts, count, i + 1);
        if (!isfinite(next) || !(next > here))
            return cwi_fail(
                err, CW_ERR_ARGUMENT,
                "part %zu of an animation stands at %g s and the next at %g s after "
                "the first; times must ascend",
                i, (double)here, (double)next);
    }
    return CW_OK;
}

cw_status cwi_parts_place(const cw_part *parts, size_t count, const cw_write_desc *desc,
                          unsigned keeps, const char *name, cwi_parts *placed, double origin[3],
                          cw_error *err)
{
    static const double zero[3] = {0};
    cw_status st = check_parts(parts, count, err);
    if (st == CW_OK && desc->animated)
        st = check_times(parts, count, err);
    if (st != CW_OK)
        return st;
    placed->items = cwi_alloc_zeroed(count, sizeof *placed->items);
    if (!placed->items)
        return cwi_fail_memory(err);
    const double *from = desc->local ? parts->mesh->origin : zero;
    for (size_t i = 0; i < count; i++)
        if (parts[i].mesh->triangle_count) {
            add_part(placed, &parts[i], from, &desc->axes);
            name_part(&placed->items[placed->count - 1], parts[i].name, name, i + 1, count);
            placed->items[placed->count - 1].sides = desc->sides;
            placed->items[placed->count - 1].side_labels = desc->sides ? desc->labels : NULL;
            if (desc->animated)
                set_sight(&placed->items[placed->count - 1], parts, count, i);
        }
    placed->end_s = desc->animated ? begin_s(parts, count, count) : 0;
    choose_arrays(placed, keeps);
    cwi_turn_point(&placed->items->turn, from, origin);
    return CW_OK;
}

void cwi_parts_free(cwi_parts *parts)
{
    cwi_free(parts->items);
    *parts = (cwi_parts){0};
}
