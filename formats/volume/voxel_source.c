/* Reads voxels from files as a source describes them: checks sizes first, then decodes all or a
 * region. */
#include "formats/volume/voxel_source.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/affine.h"
#include "core/volume/label_ids.h"
#include "core/volume/volume.h"
#include "formats/volume/slice_visit.h"
#include "formats/volume/voxel_parts.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { MAX_COMPONENTS = 16 };

cw_status cwi_fail_type(cw_error *err, const char *field, const char *name)
{
#define NAME(constant, ctype, text) " " text
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s' is %.60s; the types that are read are" CW_TYPE_TABLE(
                        NAME) ", integers of 64 bits that fit 32, and floats of 16 bits",
                    field, name);
#undef NAME
}

void cwi_source_set_stored(cwi_source *src, cwi_stored stored)
{
    src->stored = stored;
    src->shape.type = cwi_stored_type(stored);
}

cw_status cwi_source_keep_wide(cwi_source *src, cw_error *err)
{
    cwi_axis axes[CWI_ROLE_COUNT];
    if ((src->stored != CWI_STORED_I64 && src->stored != CWI_STORED_U64) ||
        src->encoding == CWI_ASCII)
        return CW_OK;
    src->shape.type = (cw_type)(src->stored == CWI_STORED_I64 ? CWI_I64 : CWI_U64);
    src->stored = CWI_STORED_PLAIN;
    memcpy(axes, src->axes, sizeof axes);
    return cwi_source_set_axes(src, axes, src->axis_count, err);
}

void cwi_source_note(cwi_source *src, const char *format, ...)
{
    const size_t used = strlen(src->note);
    const size_t start = used && used + 3 < sizeof src->note ? used + 2 : used;
    va_list arguments;
    if (start > used)
        memcpy(src->note + used, "; ", 2);
    va_start(arguments, format);
    vsnprintf(src->note + start, sizeof src->note - start, format, arguments);
    va_end(arguments);
}

void cwi_flip_ras(double affine[3][4])
{
    for (int r = 0; r < 2; r++)
        for (int c = 0; c < 4; c++)
            affine[r][c] = 0.0 - affine[r][c]; /* no negative zeros */
}

static bool is_zero_column(double affine[3][4], int c)
{
    return affine[0][c] == 0 && affine[1][c] == 0 && affine[2][c] == 0;
}

void cwi_fill_columns(double affine[3][4])
{
    for (int c = 0; c < 3; c++) {
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        if (!is_zero_column(affine, c))
            continue;
        double normal[3];
        for (int r = 0; r < 3; r++)
            normal[r] = affine[(r + 1) % 3][a] * affine[(r + 2) % 3][b] -
                        affine[(r + 2) % 3][a] * affine[(r + 1) % 3][b];
        const double length = hypot(hypot(normal[0], normal[1]), normal[2]);
        for (int r = 0; r < 3 && length > 0; r++)
            affine[r][c] = normal[r] / length;
    }
}

void cwi_source_free(cwi_source *src)
{
    cwi_names_free(&src->files);
    cwi_free(src->shape.owned_grid);
    *src = (cwi_source){0};
}

cw_status cwi_source_set_axes(cwi_source *src, const cwi_axis *axes, size_t count,
                              cw_error *err)
{
    const size_t voxel = cw_type_size(src->shape.type);
    size_t sizes[CWI_ROLE_COUNT] = {1, 1, 1, 1, 1}, strides[CWI_ROLE_COUNT] = {0};
    size_t bytes = voxel;
    assert(count <= CWI_ROLE_COUNT);
    src->axis_count = count;
    for (size_t i = 0; i < count; i++) {
        src->axes[i] = axes[i];
        sizes[axes[i].role] = axes[i].size;
        strides[axes[i].role] = bytes;
        if (!cwi_size_mul(bytes, axes[i].size, &bytes) || bytes > PTRDIFF_MAX)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "'%s' asks for more %s than an address space holds",
                            src->size_field, cwi_source_noun(src));
    }
    if (sizes[CWI_AXIS_COMPONENT] > MAX_COMPONENTS)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' asks for %zu values per voxel; at most %d are read",
                        src->size_field, sizes[CWI_AXIS_COMPONENT], MAX_COMPONENTS);
    for (int r = 0; r < CWI_ROLE_COUNT; r++) /* never used as a step, but as in packed data */
        if (strides[r] == 0)
            strides[r] = r == CWI_AXIS_COMPONENT ? voxel : bytes;
    cw_volume *v = &src->shape;
    for (int a = 0; a < 3; a++) {
        v->dim[a] = sizes[a];
        v->stride[a] = (ptrdiff_t)strides[a];
    }
    v->components = sizes[CWI_AXIS_COMPONENT];
    v->component_stride = (ptrdiff_t)strides[CWI_AXIS_COMPONENT];
    v->steps = sizes[CWI_AXIS_STEP];
    v->step_stride = (ptrdiff_t)strides[CWI_AXIS_STEP];
    src->bytes = bytes;
    return CW_OK;
}

/* Limits lengths: vertices are written as 32-bit floats in places, and products of three
 * lengths are taken. */
static bool is_moderate(double x)
{
    return fabs(x) < 1e30;
}

cw_status cwi_check_frame(const cw_volume *v, const char *field, cw_error *err)
{
    double unit[3][4] = {{0}};
    for (int c = 0; c < 4; c++) {
        const double length = hypot(hypot(v->affine[0][c], v->affine[1][c]), v->affine[2][c]);
        if (!is_moderate(length * (c < 3 ? (double)v->dim[c] : 1.0)))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' has numbers that are not finite or too large", field);
        if (c < 3 && !(length > 1e-30))
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' gives axis %d no length", field, c);
        for (int r = 0; r < 3; r++)
            unit[r][c] = v->affine[r][c] / length;
    }
    const double volume = cwi_affine_determinant(unit[0]);
    if (!(fabs(volume) > 1e-6))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' gives directions that lie in one plane (determinant %g)", field,
                        volume);
    return CW_OK;
}

static cw_status read_part(cwi_part_reading *r, const cwi_part_file *p, size_t index,
                           cw_error *err)
{
    const uint64_t part_bytes = cwi_source_part_bytes(r->src);
    r->at = index * part_bytes;
    r->numbers = (cwi_numbers){.stream = &r->stream, .noun = cwi_source_noun(r->src)};
    cw_status st = cwi_part_open_stream(r->src, p, &r->stream, &r->blocks, err);
    if (st == CW_OK)
        st = cwi_part_read_runs(r, r->at + part_bytes, err);
    if (st == CW_OK)
        st = cwi_part_check_packed(r, p->start, err);
    cwi_blocks_close(&r->blocks);
    cwi_stream_close(&r->stream);
    return st;
}

static bool has_selected(const cwi_part_reading *r, size_t index)
{
    return r->runs.left > 0 && r->runs.next / cwi_source_part_bytes(r->src) == index;
}

/* Opens every part and checks it, or opens the parts with wanted voxels, and reads them. *left is set
 * to the bytes behind the voxels. A
 * header may name more files than a program may keep open. So they are opened again for
 * reading, and checked again. */
static cw_status walk_parts(const cwi_source *src, const cwi_input *in, cwi_part_reading *r,
                            uint64_t *left, cw_error *err)
{
    const size_t count = src->files.count ? src->files.count : 1;
    cw_status st = CW_OK;
    *left = 0;
    for (size_t i = 0; st == CW_OK && i < count; i++) {
        cwi_part_file p;
        if (r && !has_selected(r, i))
            continue;
        st = cwi_part_open(src, in, i, &p, err);
        *left += p.left;
        if (st == CW_OK && r)
            st = read_part(r, &p, i, err);
        cwi_part_close(&p);
        if (st != CW_OK && cwi_part_name(src, i) && st != CW_ERR_CANCELLED)
            cwi_fail_in(err, st, cwi_part_name(src, i));
    }
    return st;
}

static cw_status check_files(const cwi_source *src, const cwi_input *in,
                             const cw_read_desc *desc, cw_error *err)
{
    uint64_t left;
    const size_t count = src->files.count;
    if (count &&
        (src->bytes % count || cwi_source_part_bytes(src) % cw_type_size(src->shape.type)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' asks for %zu bytes, which %zu files cannot share",
                        src->size_field, src->bytes, count);
    cw_status st = walk_parts(src, in, NULL, &left, err);
    if (st == CW_OK)
        cwi_part_note_left(src, left, desc);
    return st;
}

cw_status cwi_check_limits(const cw_volume *v, size_t bytes, const char *field,
                           const cw_read_desc *desc, cw_error *err)
{
    const uint64_t max = desc->max_voxels ? desc->max_voxels : (uint64_t)1 << 40;
    const uint64_t voxels = bytes / cw_type_size(v->type) / v->components;
    if (voxels > max)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'%s' asks for %llu voxels; the limit is %llu (desc->max_voxels)",
                        field, (unsigned long long)voxels, (unsigned long long)max);
    if (desc->max_bytes && bytes > desc->max_bytes) {
        char requested[CWI_MEMORY_TEXT], limit[CWI_MEMORY_TEXT];
        cwi_print_memory(bytes, requested);
        cwi_print_memory(desc->max_bytes, limit);
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'%s' asks for %s of voxels; the limit is %s (desc->max_bytes)", field,
                        requested, limit);
    }
    return CW_OK;
}

/* Replaces sizes, place, strides and bytes by those of a region. */
static cw_status narrow_to_region(const cwi_source *src, const cw_box *region, cwi_source *out,
                                  cw_error *err)
{
    cwi_axis axes[CWI_ROLE_COUNT];
    cw_status st = cwi_volume_shrink(&out->shape, region, err);
    for (size_t a = 0; a < src->axis_count; a++) {
        axes[a] = src->axes[a];
        if (axes[a].role <= CWI_AXIS_Z)
            axes[a].size = region->count[axes[a].role];
    }
    out->size_field = "region";
    return st == CW_OK ? cwi_source_set_axes(out, axes, src->axis_count, err) : st;
}

/* Chooses the distances of the voxels that are read. Along the fastest of x, y and z they are
 * neighbours, since these are contiguous in the file. */
static void choose_steps(const cwi_source *src, const cw_read_desc *desc, size_t step[3],
                         int *fastest)
{
    *fastest = -1;
    for (int a = 0; a < 3; a++)
        step[a] = desc->every[a] ? desc->every[a] : 1;
    for (size_t a = 0; a < src->axis_count && *fastest < 0; a++)
        if (src->axes[a].role <= CWI_AXIS_Z)
            *fastest = (int)src->axes[a].role;
    if (*fastest >= 0)
        step[*fastest] = 1;
}

/* Replaces shape and bytes by those of every n-th voxel. */
static cw_status thin_source(const cw_read_desc *desc, cwi_source *out, cw_error *err)
{
    size_t every[3], step[3];
    cwi_axis axes[CWI_ROLE_COUNT];
    int fastest;
    cw_volume *v = &out->shape;
    choose_steps(out, desc, step, &fastest);
    for (int a = 0; a < 3; a++)
        every[a] = desc->every[a] ? desc->every[a] : 1;
    memcpy(axes, out->axes, sizeof axes);
    for (size_t a = 0; a < out->axis_count; a++)
        if (axes[a].role <= CWI_AXIS_Z)
            axes[a].size = (axes[a].size - 1) / step[axes[a].role] + 1;
    cw_status st = cwi_volume_thin(v, every, err);
    const size_t dim[3] = {v->dim[0], v->dim[1], v->dim[2]};
    if (st == CW_OK)
        st = cwi_source_set_axes(out, axes, out->axis_count, err);
    memcpy(v->dim, dim, sizeof dim);
    if (fastest >= 0) /* skipped in memory */
        v->stride[fastest] *= (ptrdiff_t)every[fastest];
    return st;
}

/* Reads the wanted voxels to memory. Integers of 64 bits are read again where some of them are too
 * large for the type, and fit the one without a sign. */
static cw_status fill_voxels(const cwi_source *src, const cwi_input *in,
                             const cw_read_desc *desc, cw_volume *v, cw_error *err)
{
    cwi_source typed = *src; /* its files are borrowed */
    cw_error why = {0};
    size_t step[3];
    int fastest;
    uint64_t left;
    choose_steps(src, desc, step, &fastest);
    cwi_part_reading r = {.src = &typed, .progress = &desc->progress, .to = v->owned};
    cwi_runs_plan(&r.runs, src, desc->region, step);
    cw_status st = walk_parts(&typed, in, &r, &left, &why);
    if (st != CW_OK && r.needs_u32 && src->may_widen) {
        typed.shape.type = v->type = CW_U32;
        r = (cwi_part_reading){.src = &typed, .progress = &desc->progress, .to = v->owned};
        cwi_runs_plan(&r.runs, src, desc->region, step);
        st = walk_parts(&typed, in, &r, &left, &why);
    }
    if (st != CW_OK)
        return cwi_fail(err, st, "%s", why.message);
    cwi_part_note_left(&typed, r.left, desc);
    return CW_OK;
}

/* Loads the voxels. `selected` is the source or, narrowed and thinned, a part of it. */
static cw_status load_voxels(const cwi_source *src, const cwi_source *selected,
                             const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                             cw_error *err)
{
    cw_volume v = selected->shape;
    v.owned = cwi_alloc_large(selected->bytes, 1);
    if (!v.owned)
        return cwi_fail_memory(err);
    v.data = v.owned;
    cw_status st = cwi_volume_own_coordinates(&v, err);
    if (st == CW_OK)
        st = fill_voxels(src, in, desc, &v, err);
    if (st == CW_OK)
        st = cwi_progress(&desc->progress, "reading", 1, err);
    if (st == CW_OK)
        *volume = v;
    else
        cw_volume_free(&v);
    return st;
}

/* --- slices --------------------------------------------------------------------------------- */

/* The slices of a region, read in rising order. A part of the files stays open between them, so
 * that compressed data are inflated once. */
typedef struct slice_reading {
    const cwi_input *in;
    cw_box box; /* all wanted voxels */
    size_t step[3];
    uint64_t offset; /* bytes of the time steps before the wanted one */
    cwi_part_reading reading;
    cwi_part_file part;
    size_t index; /* of the open cwi_part_file */
    bool open;
} slice_reading;

static void close_reading(slice_reading *s)
{
    cwi_blocks_close(&s->reading.blocks);
    cwi_stream_close(&s->reading.stream);
    if (s->open)
        cwi_part_close(&s->part);
    s->open = false;
}

/* Opens the part with the next wanted byte, unless it is open and not yet beyond that byte. */
static cw_status open_next_part(slice_reading *s, cw_error *err)
{
    cwi_part_reading *r = &s->reading;
    const uint64_t part_bytes = cwi_source_part_bytes(r->src);
    const size_t index = (size_t)(r->runs.next / part_bytes);
    if (s->open && s->index == index && r->at <= r->runs.next)
        return CW_OK;
    close_reading(s);
    cw_status st = cwi_part_open(r->src, s->in, index, &s->part, err);
    if (st != CW_OK)
        return st;
    s->open = true;
    s->index = index;
    r->at = index * part_bytes;
    r->numbers = (cwi_numbers){.stream = &r->stream, .noun = cwi_source_noun(r->src)};
    return cwi_part_open_stream(r->src, &s->part, &r->stream, &r->blocks, err);
}

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    slice_reading *s = user;
    cwi_part_reading *r = &s->reading;
    const cwi_source *src = r->src;
    const uint64_t part_bytes = cwi_source_part_bytes(src);
    cw_box box = s->box;
    box.first[2] += first * s->step[2];
    box.count[2] = (count - 1) * s->step[2] + 1;
    cwi_source one_step = *src; /* its files are borrowed */
    for (size_t a = 0; a < src->axis_count; a++)
        if (src->axes[a].role == CWI_AXIS_STEP)
            one_step.axes[a].size = 1;
    cwi_runs_plan(&r->runs, &one_step, &box, s->step);
    r->runs.next += s->offset;
    r->runs.end += s->offset;
    r->to = to;
    cw_status st = CW_OK;
    while (st == CW_OK && r->runs.left > 0) {
        st = open_next_part(s, err);
        if (st == CW_OK)
            st = cwi_part_read_runs(r, (s->index + 1) * part_bytes, err);
        if (st == CW_OK && r->at == (s->index + 1) * part_bytes)
            st = cwi_part_check_packed(r, s->part.start, err);
        if (st != CW_OK && cwi_part_name(src, s->index) && st != CW_ERR_CANCELLED)
            cwi_fail_in(err, st, cwi_part_name(src, s->index));
    }
    return st;
}

/* Gives slices to the input's visitor. `selected`: as in load_voxels() */
static cw_status visit_slices(const cwi_source *src, const cwi_source *selected,
                              const cwi_input *in, const cw_read_desc *desc, cw_error *err)
{
    static const cw_progress quiet = {0};
    const cw_volume *all = &src->shape;
    slice_reading s = {.in = in, .reading = {.src = src, .progress = &quiet}};
    int fastest;
    for (int a = 0; a < 3; a++)
        s.box.count[a] = all->dim[a];
    if (desc->region)
        s.box = *desc->region;
    choose_steps(src, desc, s.step, &fastest);
    s.offset = in->visit->step * (uint64_t)all->step_stride;
    for (size_t a = 0; a + 1 < src->axis_count; a++)
        if (src->axes[a].role == CWI_AXIS_STEP && src->axes[a].size > 1)
            return cwi_fail(err, CW_ERR_UNSUPPORTED,
                            "time steps are not the slowest axis of this file; it is only read "
                            "as a whole");
    cw_status st = cwi_visit_slices(in->visit, &selected->shape, read_slices, &s, err);
    close_reading(&s);
    return st;
}

/* Checks the files, and makes the source of the wanted voxels: a region, every n-th of them. */
static cw_status want_part(const cwi_source *src, const cwi_input *in, const cw_read_desc *desc,
                           cwi_source *selected, cw_error *err)
{
    *selected = *src; /* its files are borrowed */
    cw_status st = check_files(src, in, desc, err);
    if (st == CW_OK && desc->region)
        st = narrow_to_region(src, desc->region, selected, err);
    if (st == CW_OK)
        st = thin_source(desc, selected, err);
    return st == CW_OK ? cwi_check_limits(&selected->shape, selected->bytes,
                                          selected->size_field, desc, err)
                       : st;
}

cw_status cwi_source_load(const cwi_source *src, const cwi_input *in, const cw_read_desc *desc,
                          cw_volume *volume, cw_error *err)
{
    cwi_source selected;
    cw_status st = want_part(src, in, desc, &selected, err);
    if (st != CW_OK || !desc->header_only)
        return st == CW_OK ? load_voxels(src, &selected, in, desc, volume, err) : st;
    st = cwi_volume_own_coordinates(&selected.shape, err);
    if (st == CW_OK)
        *volume = selected.shape;
    return st;
}

cw_status cwi_source_visit(const cwi_source *src, const cwi_input *in, const cw_read_desc *desc,
                           cw_error *err)
{
    cw_read_desc limits = *desc;
    cwi_source selected;
    limits.max_bytes = 0; /* voxels are not read at once */
    cw_status st = want_part(src, in, &limits, &selected, err);
    return st == CW_OK ? visit_slices(src, &selected, in, desc, err) : st;
}
