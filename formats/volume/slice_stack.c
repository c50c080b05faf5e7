/* Reads the planes of a stack from files, and turns their pixels into the voxels of a
 * volume. */
#include "formats/volume/slice_stack.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "formats/volume/damaged_files.h"
#include "formats/volume/slice_visit.h"
#include "formats/volume/voxel_source.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

void cwi_stack_free(cwi_stack *stack)
{
    cwi_names_free(&stack->files);
    cwi_free(stack->planes);
    cwi_free(stack->slots);
    *stack = (cwi_stack){0};
}

cw_status cwi_stack_reserve(cwi_stack *stack, size_t planes, size_t slots, cw_error *err)
{
    stack->planes = cwi_alloc_zeroed(planes, sizeof *stack->planes);
    stack->slots = cwi_alloc_zeroed(slots, sizeof *stack->slots);
    stack->plane_count = planes;
    stack->slot_count = slots;
    return stack->planes && stack->slots ? CW_OK : cwi_fail_memory(err);
}

/* The reading of a stack. */
typedef struct reading {
    const cwi_stack *stack;
    cwi_stack_reader reader;
    cwi_planes *planes;
    cw_box box;                /* the wanted region */
    size_t every;              /* every n-th of its slices */
    size_t only;               /* of the stacks of slices, steps and components, that are one
                                  after another: this one; SIZE_MAX: all */
    size_t pixels;             /* number of wanted samples in a plane */
    unsigned char *low, *high; /* planes as the module returns them */
    char *voxels;
} reading;

/* --- from pixels to voxels ---------------------------------------------------------------- */

/* Returns the type of a plane's pixels, as the module returns them. */
static cw_type type_of(const cwi_stack *s, const cwi_plane *plane)
{
    return s->mixed ? plane->type : s->type;
}

static bool is_padding(const cwi_stack *s, const cwi_plane *plane, double pixel)
{
    const double *padding = s->mixed ? plane->padding : s->padding;
    return s->has_padding && pixel >= padding[0] && pixel <= padding[1];
}

/* Returns the value of a plane's pixel in the result; sets *nodata where it is padding. */
static double value_of(const reading *r, const cwi_plane *plane, const unsigned char *pixels,
                       size_t i, bool *nodata)
{
    const cwi_stack *s = r->stack;
    const cw_type type = type_of(s, plane);
    const double pixel = cwi_voxel_at(type, pixels + i * cw_type_size(type));
    *nodata = is_padding(s, plane, pixel);
    return s->scaled ? plane->slope * pixel + plane->intercept : pixel;
}

static void put_values(const reading *r, const cwi_slot *slot, char *to)
{
    const cwi_stack *s = r->stack;
    const cw_type type = s->shape.type;
    const size_t size = cw_type_size(type);
    const cwi_plane *low = &s->planes[slot->low], *high = &s->planes[slot->high];
    const double nodata = s->shape.has_nodata ? s->shape.nodata : NAN;
    bool lost[2] = {false, false};
    for (size_t i = 0; i < r->pixels; i++) {
        double value = value_of(r, low, r->low, i, &lost[0]);
        if (slot->t > 0)
            value = (1 - slot->t) * value + slot->t * value_of(r, high, r->high, i, &lost[1]);
        cwi_voxel_put(type, to + i * size, lost[0] || lost[1] ? nodata : value);
    }
}

static void put_label(const reading *r, const cwi_slot *slot, char *to)
{
    const cwi_stack *s = r->stack;
    const size_t in = cw_type_size(s->type), out = cw_type_size(s->shape.type);
    for (size_t i = 0; i < r->pixels; i++)
        if (cwi_voxel_at(s->type, r->low + i * in) != 0)
            cwi_voxel_put(s->shape.type, to + i * out, slot->label);
}

/* --- from files to pixels ----------------------------------------------------------------- */

/* Returns the name of a file; NULL: the open file. */
static const char *file_name(const cwi_stack *s, size_t file)
{
    return s->files.count ? s->files.items[file] : NULL;
}

static cw_status hand_over(cwi_stack_reader *r, size_t file, cw_error *err)
{
    const char *name = file_name(r->stack, file);
    const void *facts;
    uint64_t size = r->in->size;
    int fd = r->in->fd;
    if (file == r->file)
        return CW_OK;
    cw_status st = name ? cwi_input_open_side(r->in, name, &fd, &size, err) : CW_OK;
    if (st == CW_OK) {
        st = cwi_planes_facts(r->planes, fd, size, &facts, err);
        if (name)
            close(fd);
    }
    r->file = st == CW_OK ? file : SIZE_MAX;
    return st;
}

/* Reads rows of a plane. */
static cw_status read_rows(cwi_stack_reader *r, size_t index, size_t first, size_t count,
                           void *to, cw_error *err)
{
    const cwi_stack *s = r->stack;
    const cwi_plane *plane = &s->planes[index];
    cw_status st = hand_over(r, plane->file, err);
    if (st == CW_OK)
        st = cwi_planes_read(r->planes, plane->number, first, count,
                             s->shape.dim[0] * s->samples * cw_type_size(type_of(s, plane)), to,
                             err);
    const char *name = file_name(s, plane->file);
    if (st == CW_OK || st == CW_ERR_CANCELLED || !name)
        return st;
    return cwi_is_damage(st) && s->files.count > 1 ? cwi_fail_in_damaged(err, st, name)
                                                   : cwi_fail_in(err, st, name);
}

cw_status cwi_stack_read_plane(cwi_stack_reader *r, size_t index, void *to, cw_error *err)
{
    return read_rows(r, index, 0, r->stack->shape.dim[1], to, err);
}

/* Keeps the wanted columns of rows, one row after another. */
static void keep_columns(const reading *r, size_t plane, char *rows)
{
    const cwi_stack *s = r->stack;
    const size_t pixel = s->samples * cw_type_size(type_of(s, &s->planes[plane]));
    const size_t row = s->shape.dim[0] * pixel, kept = r->box.count[0] * pixel;
    for (size_t j = 0; kept < row && j < r->box.count[1]; j++)
        memmove(rows + j * kept, rows + j * row + r->box.first[0] * pixel, kept);
}

/* Reads the wanted rows of a plane; there must be room for whole rows. */
static cw_status read_plane(reading *r, size_t index, void *to, cw_error *err)
{
    cw_status st = read_rows(&r->reader, index, r->box.first[1], r->box.count[1], to, err);
    if (st == CW_OK)
        keep_columns(r, index, to);
    return st;
}

/* Returns true if voxels are the module's pixels without any conversion. */
static bool is_plain(const cwi_stack *s, const cwi_slot *slot)
{
    const bool ranged = s->has_padding && !s->mixed &&
                        (s->padding[0] != s->padding[1] || s->padding[0] != s->shape.nodata);
    return !s->scaled && !slot->label && slot->t == 0 && !ranged &&
           s->shape.type == type_of(s, &s->planes[slot->low]);
}

static cw_status read_slot(reading *r, const cwi_slot *slot, cw_error *err)
{
    const cwi_stack *s = r->stack;
    const size_t slices = s->shape.dim[2], z = slot->slice % slices - r->box.first[2];
    const size_t kept = (r->box.count[2] - 1) / r->every + 1;
    const size_t bytes = r->pixels * cw_type_size(s->shape.type);
    const bool plain = is_plain(s, slot);
    const size_t in = slot->slice / slices;
    if (z >= r->box.count[2] || z % r->every || /* also for slices before it */
        (r->only != SIZE_MAX && r->only != in))
        return CW_OK;
    char *to = r->voxels + ((r->only == SIZE_MAX ? in * kept : 0) + z / r->every) * bytes;
    if (plain && r->box.count[0] == s->shape.dim[0])
        return read_plane(r, slot->low, to, err);
    cw_status st = read_plane(r, slot->low, r->low, err);
    if (st == CW_OK && slot->t > 0)
        st = read_plane(r, slot->high, r->high, err);
    if (st == CW_OK && plain)
        memcpy(to, r->low, bytes);
    else if (st == CW_OK && slot->label)
        put_label(r, slot, to);
    else if (st == CW_OK)
        put_values(r, slot, to);
    return st;
}

static cw_status read_slots(reading *r, const cw_progress *progress, cw_error *err)
{
    const cwi_stack *s = r->stack;
    cw_status st = CW_OK;
    for (size_t i = 0; st == CW_OK && i < s->slot_count; i++) {
        r->planes->box.done = (double)i / (double)s->slot_count;
        st = cwi_progress(progress, "reading", r->planes->box.done, err);
        if (st == CW_OK)
            st = read_slot(r, &s->slots[i], err);
    }
    return st == CW_OK ? cwi_progress(progress, "reading", 1, err) : st;
}

/* Computes the bytes of the sizes; returns false when they exceed the address space. */
static bool count_bytes(const cw_volume *v, const size_t held[3], size_t *bytes)
{
    return cwi_size_mul(held[0], held[1], bytes) && cwi_size_mul(*bytes, held[2], bytes) &&
           cwi_size_mul(*bytes, v->steps, bytes) &&
           cwi_size_mul(*bytes, v->components, bytes) &&
           cwi_size_mul(*bytes, cw_type_size(v->type), bytes) && *bytes <= PTRDIFF_MAX;
}

/* Fills the voxels that no slot covers. */
static void fill_voxels(const cwi_stack *s, char *voxels, size_t bytes)
{
    const size_t size = cw_type_size(s->shape.type);
    memset(voxels, 0, bytes);
    for (size_t i = 0; s->shape.has_nodata && i < bytes; i += size)
        cwi_voxel_put(s->shape.type, voxels + i, s->shape.nodata);
}

/* Allocates two planes of pixels as the module returns them. */
static cw_status alloc_planes(reading *r, cw_error *err)
{
    const cwi_stack *s = r->stack;
    const size_t size = s->mixed ? sizeof(double) : cw_type_size(s->type);
    const size_t row = s->shape.dim[0] * s->samples * size;
    r->pixels = r->box.count[0] * r->box.count[1] * s->samples;
    r->low = cwi_alloc_array(r->box.count[1], row);
    r->high = cwi_alloc_array(r->box.count[1], row);
    return r->low && r->high ? CW_OK : cwi_fail_memory(err);
}

/* Loads the voxels; `v` is the shape of the wanted part. */
static cw_status load_voxels(cw_volume v, size_t bytes, reading *r, const cw_read_desc *desc,
                             cw_volume *volume, cw_error *err)
{
    const cwi_stack *s = r->stack;
    cw_status st = alloc_planes(r, err);
    v.owned = cwi_alloc_large(bytes, 1);
    r->voxels = v.owned;
    if (st == CW_OK && !v.owned)
        st = cwi_fail_memory(err);
    else if (st == CW_OK && s->sparse)
        fill_voxels(s, r->voxels, bytes);
    if (st == CW_OK)
        st = read_slots(r, &desc->progress, err);
    cwi_free(r->low);
    cwi_free(r->high);
    v.data = v.owned;
    if (st == CW_OK)
        *volume = v;
    else
        cw_volume_free(&v);
    return st;
}

/* Sets the strides of `count` columns, rows and slices in memory, in place of those of all
 * slices. */
static void pack_strides(cw_volume *v, size_t slices, const size_t count[3])
{
    const ptrdiff_t plane = v->stride[2], all = plane * (ptrdiff_t)slices;
    v->stride[1] = v->stride[0] * (ptrdiff_t)count[0];
    v->stride[2] = v->stride[1] * (ptrdiff_t)count[1];
    const ptrdiff_t packed = v->stride[2] * (ptrdiff_t)count[2];
    v->step_stride = v->step_stride / all * packed;
    if (v->component_stride >= plane) /* components in separate planes */
        v->component_stride = v->component_stride / all * packed;
}

/* Computes the shape of every n-th voxel of a box. `held` voxels are in memory: all columns and
 * rows, and every n-th slice. */
static cw_status narrow_to_region(const cw_read_desc *desc, reading *r, size_t held[3],
                                  cw_volume *v, cw_error *err)
{
    const size_t slices = v->dim[2];
    size_t every[3];
    cw_status st = desc->region ? cwi_volume_shrink(v, desc->region, err) : CW_OK;
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++) {
        every[a] = desc->every[a] ? desc->every[a] : 1;
        held[a] = r->box.count[a] = v->dim[a];
    }
    r->every = every[2];
    held[2] = (held[2] - 1) / every[2] + 1;
    pack_strides(v, slices, held);
    st = cwi_volume_thin(v, every, err);
    v->stride[0] *= (ptrdiff_t)every[0];
    v->stride[1] *= (ptrdiff_t)every[1];
    return st;
}

/* --- slices --------------------------------------------------------------------------------- */

/* The slices of a region. */
typedef struct slice_reading {
    reading reading;
    cw_box box;
    size_t every, slice_bytes;
} slice_reading;

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    static const cw_progress quiet = {0};
    slice_reading *s = user;
    reading *r = &s->reading;
    r->box.first[2] = s->box.first[2] + first * s->every;
    r->box.count[2] = (count - 1) * s->every + 1;
    r->voxels = to;
    if (r->stack->sparse)
        fill_voxels(r->stack, to, count * s->slice_bytes);
    return read_slots(r, &quiet, err);
}

/* Gives slices to the input's visitor; `v` is the shape of the wanted part. */
static cw_status visit_slices(const cw_volume *v, const reading *from, cw_error *err)
{
    slice_reading s = {.reading = *from,
                       .box = from->box,
                       .every = from->every,
                       .slice_bytes = (size_t)v->stride[2]};
    cwi_slice_visit *visit = from->reader.in->visit;
    reading *r = &s.reading;
    cw_volume shape = *v;
    const size_t planar = v->component_stride >= v->stride[2] ? v->components : 1;
    r->only = planar > 1 ? visit->component + visit->step * planar : visit->step;
    if (planar > 1) { /* a component is a stack of its own */
        shape.components = 1;
        shape.component_stride = 0;
    }
    cw_status st = alloc_planes(r, err);
    if (st == CW_OK)
        st = cwi_visit_slices(visit, &shape, read_slices, &s, err);
    cwi_free(r->low);
    cwi_free(r->high);
    return st;
}

cw_status cwi_stack_load(const cwi_stack *stack, const cwi_input *in, cwi_planes *planes,
                         const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    size_t bytes, held[3];
    cw_volume v = stack->shape;
    reading r = {.stack = stack,
                 .reader = {.stack = stack, .in = in, .planes = planes, .file = SIZE_MAX},
                 .planes = planes,
                 .only = SIZE_MAX};
    if (desc->region)
        r.box = *desc->region;
    cw_status st = narrow_to_region(desc, &r, held, &v, err);
    if (st != CW_OK)
        return st;
    if (!count_bytes(&v, held, &bytes))
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'%s' asks for more voxels than an address space holds",
                        stack->size_field);
    cw_read_desc limits = *desc;
    if (in->visit)
        limits.max_bytes = 0; /* voxels are not read at once */
    st = cwi_check_limits(&v, bytes, desc->region ? "region" : stack->size_field, &limits, err);
    if (st == CW_OK && in->visit)
        st = visit_slices(&v, &r, err);
    else if (st == CW_OK && desc->header_only)
        *volume = v;
    else if (st == CW_OK)
        st = load_voxels(v, bytes, &r, desc, volume, err);
    return st;
}
