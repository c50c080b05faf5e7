/* Reads VTKHDF files: volumes by the readers of VTK's XML images and grids, surfaces by that of its
 * PolyData, from a file in memory with the same elements. */
#define _GNU_SOURCE /* memmem */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/volume/named_arrays.h"
#include "formats/volume/slice_visit.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/vti.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtp.h"
#include "formats/vtkhdf/vtkhdf_file.h"
#include "formats/vtkhdf/vtkhdf_format.h"

#include <string.h>

/* --- content ------------------------------------------------------------------------------ */

bool cwi_vtkhdf_sniff(const unsigned char *head, size_t size)
{
    return size >= 8 && memcmp(head, "\x89HDF\r\n\x1a\n", 8) == 0;
}

bool cwi_vtkhdf_mesh_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return cwi_vtkhdf_sniff(head, size);
}

static bool has_word(const cwi_input *in, uint64_t from, unsigned char *bytes, size_t capacity)
{
    static const char word[] = "VTKHDF";
    size_t size = 0;
    return cwi_input_read_at(in->fd, from, bytes, capacity, &size, NULL) == CW_OK &&
           memmem(bytes, size, word, sizeof word - 1);
}

bool cwi_vtkhdf_is_other(const cwi_input *in, const unsigned char *head, size_t size)
{
    const size_t END_BYTES = 1 << 20;
    if (!cwi_vtkhdf_sniff(head, size) || cwi_has_extension(in->path, ".vtkhdf"))
        return false;
    unsigned char *bytes = cwi_alloc_array(END_BYTES, 1);
    const bool has =
        bytes &&
        (has_word(in, 0, bytes, END_BYTES) ||
         (in->size > END_BYTES && has_word(in, in->size - END_BYTES, bytes, END_BYTES)));
    cwi_free(bytes);
    return bytes && !has;
}

/* --- messages ----------------------------------------------------------------------------- */

/* Says why an array that was asked for, or the first one where all are, cannot be read. */
static cw_status refuse_arrays(const cwi_vtkhdf *h, cw_error *err)
{
    const cwi_vtkhdf_array *first = NULL;
    for (uint32_t n = 0; n < h->facts.array_count; n++) {
        const cwi_vtkhdf_array *a = &h->facts.arrays[n];
        for (int of_cells = 0; of_cells < 2; of_cells++) {
            const char *name = cwi_vtkhdf_value_name(a, of_cells);
            if (name && !*a->refusal && !h->in->array)
                return CW_OK;
            if (name && (!h->in->array || strcmp(name, h->in->array) == 0) && !first)
                first = a;
        }
    }
    return first && *first->refusal
               ? cwi_fail(err, CW_ERR_FORMAT, "the array '%s' cannot be read: %s", first->name,
                          first->refusal)
               : CW_OK;
}

static void tell_refused(const cwi_vtkhdf *h)
{
    for (uint32_t n = 0; n < h->facts.array_count; n++) {
        const cwi_vtkhdf_array *a = &h->facts.arrays[n];
        if (*a->refusal && (cwi_vtkhdf_value_name(a, false) || cwi_vtkhdf_value_name(a, true)))
            cwi_note(h->desc, "the array '%s' is left out: %s", a->name, a->refusal);
    }
}

static void tell_steps(const cwi_vtkhdf *h)
{
    if (h->facts.has_steps && h->facts.steps > 1)
        cwi_note(h->desc, "it has %lld time steps: the first is read",
                 (long long)h->facts.steps);
}

/* --- images ------------------------------------------------------------------------------- */

/* Finds the item whose numbers start at a place of the file in memory. */
static cwi_vtkhdf_item *find_item(const cwi_vtkhdf *h, uint64_t at)
{
    size_t n = 0;
    while (h->items[n].at != at)
        n++;
    return &h->items[n];
}

/* Slices of numbers that are filled as they are asked for. */
typedef struct filled_slices {
    cwi_vtkhdf *h;
    cwi_vtkhdf_item *item;
    uint64_t slice_bytes;
    const cw_slice_source *source;
} filled_slices;

static cw_status fill_slices(filled_slices *s, size_t first, size_t count, cw_error *err)
{
    return cwi_vtkhdf_fill_range(s->h, s->item, first * s->slice_bytes,
                                 (first + count) * s->slice_bytes, err);
}

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    filled_slices *s = user;
    const cw_read_desc *d = s->h->desc;
    const cw_volume *v = &s->source->shape;
    const size_t start = d->region ? d->region->first[2] : 0,
                 step = d->every[2] ? d->every[2] : 1;
    const size_t packed = v->dim[0] * v->dim[1] * cw_type_size(v->type),
                 bytes = v->stride[2] ? (size_t)v->stride[2] : packed;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        st = fill_slices(s, start + (first + n) * step, 1, err);
        if (st == CW_OK)
            st = s->source->read(s->source->user, first + n, 1, (char *)to + n * bytes, err);
    }
    return st;
}

static cw_status visit_filled(void *user, const cw_slice_source *source, cw_error *err)
{
    filled_slices *s = user;
    const cwi_slice_visit *visit = s->h->in->visit;
    const cw_slice_source filled = {.shape = source->shape, .read = read_slices, .user = s};
    s->source = source;
    return visit->visit(visit->user, &filled, err);
}

static cw_status load_filled(filled_slices *s, const cwi_source *src, cw_volume *volume,
                             cw_error *err)
{
    cwi_vtkhdf *h = s->h;
    const cw_box *box = h->desc->region;
    const size_t first = box ? box->first[2] : 0,
                 count = box ? box->count[2] : src->shape.dim[2];
    if (h->in->visit) {
        cwi_slice_visit visit = *h->in->visit;
        visit.visit = visit_filled;
        visit.user = s;
        h->made.visit = &visit;
        cw_status st = cwi_source_visit(src, &h->made, h->desc, err);
        h->in->visit->called = visit.called;
        return st;
    }
    if (!h->desc->header_only) { /* sizes first */
        cw_read_desc header = *h->desc;
        cw_volume shape;
        header.header_only = true;
        header.max_bytes = 0;
        cw_status st = cwi_source_load(src, &h->made, &header, &shape, err);
        if (st == CW_OK)
            st = fill_slices(s, first, count, err);
        if (st != CW_OK)
            return st;
    }
    return cwi_source_load(src, &h->made, h->desc, volume, err);
}

/* Reads from the file itself, where the numbers are in one piece; else from memory. */
static cw_status load_image(cwi_vtkhdf *h, cwi_vtkhdf_item *item, cwi_source *src,
                            cw_volume *volume, cw_error *err)
{
    const cwi_vtkhdf_array *a = item->array;
    filled_slices s = {.h = h, .item = item, .slice_bytes = item->bytes / src->shape.dim[2]};
    if (*src->note)
        cwi_note(h->desc, "%s", src->note);
    src->may_widen = true;
    cw_status st = cwi_check_frame(&src->shape, src->frame_field, err);
    if (st != CW_OK)
        return st;
    cwi_set_spacing(&src->shape, h->desc);
    if (a->offset == UINT64_MAX)
        return load_filled(&s, src, volume, err);
    src->offset = a->offset + item->first * cwi_vtkhdf_row_bytes(a);
    src->skip = 0;
    src->big_endian = a->big_endian;
    return h->in->visit ? cwi_source_visit(src, h->in, h->desc, err)
                        : cwi_source_load(src, h->in, h->desc, volume, err);
}

static cw_status read_image(cwi_vtkhdf *h, cw_volume *volume, cw_error *err)
{
    cwi_vti_file file = {.choice = {.expected = h->in->array, .list = h->in->arrays}};
    cwi_source src = {0};
    bool of_cells;
    cw_status st = cwi_vtkhdf_put_image(h, err);
    if (st == CW_OK)
        st = refuse_arrays(h, err);
    if (st == CW_OK)
        st = cwi_vtkhdf_make(h, err);
    if (st == CW_OK)
        st = cwi_vti_open(&h->made, &file, err);
    const cwi_vti *v = file.count ? &file.pieces[0] : &file.common;
    if (st == CW_OK)
        st = cwi_vti_describe(v, &file.choice, &h->made, &src, err);
    if (st == CW_OK) {
        const cwi_vti_array *chosen = cwi_vti_chosen(v, &of_cells);
        cwi_array_list_choose(h->in->arrays, chosen->data.name, of_cells);
        st = load_image(h, find_item(h, chosen->data.offset), &src, volume, err);
    }
    cwi_source_free(&src);
    cwi_vti_close(&file);
    return st;
}

/* --- grids -------------------------------------------------------------------------------- */

/* Reads the header alone, for the name of the array that is chosen, and fills that. */
static cw_status fill_chosen(cwi_vtkhdf *h, cw_error *err)
{
    cwi_array_list list = {0};
    cwi_input in = h->made;
    cw_read_desc desc = *h->desc;
    cw_volume shape = {0};
    bool is_grid;
    in.arrays = &list;
    in.visit = NULL;
    desc.header_only = true;
    desc.note = NULL;
    cw_status st = cwi_vtu_read(&in, &desc, &is_grid, &shape, err);
    cw_volume_free(&shape);
    const cw_array *chosen = NULL;
    for (size_t n = 0; n < list.count; n++)
        if (list.items[n].is_default)
            chosen = &list.items[n];
    for (size_t n = 0; n < h->item_count && st == CW_OK; n++) {
        const char *name =
            chosen ? cwi_vtkhdf_value_name(h->items[n].array, chosen->of_cells) : NULL;
        if (name && strncmp(name, chosen->name, sizeof chosen->name - 1) == 0)
            st = cwi_vtkhdf_fill(h, &h->items[n], err);
    }
    if (st == CW_OK && !chosen)
        st = cwi_fail_memory(err);
    cwi_array_list_free(&list);
    return st;
}

static cw_status read_grid(cwi_vtkhdf *h, cw_volume *volume, cw_error *err)
{
    bool is_grid;
    cw_status st = cwi_vtkhdf_put_grid(h, err);
    if (st == CW_OK)
        st = refuse_arrays(h, err);
    if (st == CW_OK)
        st = cwi_vtkhdf_make(h, err);
    if (st == CW_OK)
        st = cwi_vtkhdf_fill_structure(h, err);
    if (st == CW_OK && !h->desc->header_only)
        st = fill_chosen(h, err);
    return st == CW_OK ? cwi_vtu_read(&h->made, h->desc, &is_grid, volume, err) : st;
}

cw_status cwi_vtkhdf_read_volume(const cwi_input *in, const cw_read_desc *desc, bool *is_grid,
                                 cw_volume *volume, cw_error *err)
{
    cwi_vtkhdf *h = cwi_alloc_zeroed(1, sizeof *h);
    *is_grid = true;
    if (!h)
        return cwi_fail_memory(err);
    cw_status st = cwi_vtkhdf_open(h, in, desc, err);
    if (st == CW_OK && cwi_vtkhdf_is(h, "PolyData"))
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "this is a mesh (vtkhdf), not a volume; use check, convert or simplify");
    if (st == CW_OK)
        st = cwi_vtkhdf_is(h, "ImageData") ? read_image(h, volume, err)
                                           : read_grid(h, volume, err);
    if (st == CW_OK) {
        tell_refused(h);
        tell_steps(h);
    }
    cwi_vtkhdf_close(h);
    cwi_free(h);
    return st;
}

/* --- surfaces ----------------------------------------------------------------------------- */

/* Fills what the reader of surfaces takes of the data of points and cells. */
static cw_status fill_attributes(cwi_vtkhdf *h, const cwi_vtp *v, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < v->count; n++)
        for (int role = 0; role < CWI_VTP_ROLE_COUNT && st == CW_OK; role++)
            if (v->pieces[n].has[role])
                st = cwi_vtkhdf_fill(h, find_item(h, v->pieces[n].arrays[role].offset), err);
    return st;
}

static cw_status read_surface(cwi_vtkhdf *h, cwi_mesh_input *in, cw_mesh *mesh,
                              cw_mesh_file *metadata, cw_error *err)
{
    const cwi_input file = in->file;
    cwi_vtp v = {0};
    cw_status st = cwi_vtkhdf_put_surface(h, err);
    if (st == CW_OK)
        st = cwi_vtkhdf_make(h, err);
    if (st == CW_OK)
        st = cwi_vtp_parse(&v, &h->made, 0, 0, err);
    if (st == CW_OK)
        st = fill_attributes(h, &v, err);
    in->file = h->made;
    if (st == CW_OK)
        st = cwi_vtp_load(&v, NULL, h->made.size, NULL, in, mesh, metadata, err);
    in->file = file;
    cwi_vtp_free(&v);
    return st;
}

cw_status cwi_vtkhdf_read_mesh(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                               cw_error *err)
{
    const cw_read_desc desc = {.max_bytes = in->desc.max_bytes,
                               .no_sandbox = in->desc.no_sandbox,
                               .timeout_s = in->desc.timeout_s,
                               .progress = in->desc.progress};
    cwi_vtkhdf *h = cwi_alloc_zeroed(1, sizeof *h);
    if (!h)
        return cwi_fail_memory(err);
    cw_status st = cwi_vtkhdf_open(h, &in->file, &desc, err);
    if (st == CW_OK && !cwi_vtkhdf_is(h, "PolyData"))
        st = cwi_fail(
            err, CW_ERR_FORMAT,
            "its 'Type' is %s, a volume (vtkhdf), not a mesh; 'extract' makes a mesh of it",
            h->facts.type);
    if (st == CW_OK)
        st = read_surface(h, in, mesh, metadata, err);
    if (st == CW_OK && h->facts.has_steps && h->facts.steps > 1)
        cwi_say_left_out(metadata, true, "time steps but the first");
    cwi_vtkhdf_close(h);
    cwi_free(h);
    return st;
}
