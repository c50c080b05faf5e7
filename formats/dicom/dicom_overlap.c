/* Finds layers for segments that overlap: one after the other, each goes into the first layer in
 * which none of its pixels is taken. */
#include "formats/dicom/dicom_overlap.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

typedef struct layering {
    cwi_stack *stack;
    uint8_t *layer_of;
    uint16_t *taken;    /* of each voxel, a bit a layer */
    unsigned char *own; /* of each voxel: it is in the segment at hand */
    size_t plane;       /* pixels */
    size_t layers;
} layering;

/* Returns true if two slots have the same place: slots of a segment follow each other. */
static bool shares_slices(const cwi_stack *stack, uint8_t *seen)
{
    for (size_t n = 0; n < stack->slot_count; n++) {
        if (seen[stack->slots[n].slice])
            return true;
        seen[stack->slots[n].slice] = 1;
    }
    return false;
}

/* Marks the pixels of a plane, and finds the layers in which one of them is taken. */
static void mark_plane(layering *l, size_t slice, const unsigned char *pixels,
                       uint16_t *conflicts)
{
    const uint16_t *taken = l->taken + slice * l->plane;
    unsigned char *own = l->own + slice * l->plane;
    for (size_t i = 0; i < l->plane; i++)
        if (pixels[i]) {
            own[i] = 1;
            *conflicts |= taken[i];
        }
}

/* Takes the pixels of the segment's planes, slots first to end, in a layer. */
static void take_layer(layering *l, size_t first, size_t end, size_t layer)
{
    for (size_t n = first; n < end; n++) {
        cwi_slot *slot = &l->stack->slots[n];
        uint16_t *taken = l->taken + slot->slice * l->plane;
        unsigned char *own = l->own + slot->slice * l->plane;
        for (size_t i = 0; i < l->plane; i++)
            taken[i] = (uint16_t)(taken[i] | own[i] << layer);
        memset(own, 0, l->plane);
        slot->slice += layer * l->stack->shape.dim[2];
    }
}

/* Reads the planes of one segment, and chooses its layer. */
static cw_status place_segment(layering *l, cwi_stack_reader *reader, size_t first, size_t end,
                               unsigned char *pixels, cw_error *err)
{
    const uint32_t label = l->stack->slots[first].label;
    uint16_t conflicts = 0;
    size_t layer = 0;
    cw_status st = CW_OK;
    for (size_t n = first; n < end && st == CW_OK; n++) {
        const cwi_slot *slot = &l->stack->slots[n];
        st = cwi_stack_read_plane(reader, slot->low, pixels, err);
        if (st == CW_OK)
            mark_plane(l, slot->slice, pixels, &conflicts);
    }
    while (conflicts >> layer & 1)
        layer++;
    if (st == CW_OK && layer == CWI_DICOM_MAX_LAYERS)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "segment %u overlaps others in all of %d layers, as many as are read",
                        label, CWI_DICOM_MAX_LAYERS);
    if (st != CW_OK)
        return st;
    l->layer_of[label] = (uint8_t)layer;
    l->layers = layer + 1 > l->layers ? layer + 1 : l->layers;
    take_layer(l, first, end, layer);
    return CW_OK;
}

static cw_status place_segments(layering *l, const cwi_input *in, cwi_planes *planes,
                                const cw_read_desc *desc, cw_error *err)
{
    const cwi_stack *s = l->stack;
    cwi_stack_reader reader = {.stack = s, .in = in, .planes = planes, .file = SIZE_MAX};
    unsigned char *pixels = cwi_alloc_array(l->plane, 1);
    cw_status st = pixels ? CW_OK : cwi_fail_memory(err);
    for (size_t first = 0, end; first < s->slot_count && st == CW_OK; first = end) {
        for (end = first + 1;
             end < s->slot_count && s->slots[end].label == s->slots[first].label;)
            end++;
        st = cwi_progress(&desc->progress, "finding overlaps",
                          (double)first / (double)s->slot_count, err);
        if (st == CW_OK)
            st = place_segment(l, &reader, first, end, pixels, err);
    }
    cwi_free(pixels);
    return st;
}

cw_status cwi_dicom_find_layers(cwi_stack *stack, const cwi_input *in, cwi_planes *planes,
                                const cw_read_desc *desc, uint8_t *layer_of, cw_error *err)
{
    cw_volume *v = &stack->shape;
    size_t voxels;
    layering l = {
        .stack = stack, .layer_of = layer_of, .plane = v->dim[0] * v->dim[1], .layers = 1};
    uint8_t *seen = cwi_alloc_zeroed(v->dim[2], 1);
    if (!seen)
        return cwi_fail_memory(err);
    const bool may_overlap = shares_slices(stack, seen);
    cwi_free(seen);
    if (!may_overlap)
        return CW_OK;
    if (!cwi_size_mul(l.plane, v->dim[2], &voxels))
        return cwi_fail(err, CW_ERR_LIMIT, "more voxels than an address space holds");
    l.taken = cwi_alloc_zeroed(voxels, sizeof *l.taken);
    l.own = cwi_alloc_zeroed(voxels, 1);
    cw_status st =
        l.taken && l.own ? place_segments(&l, in, planes, desc, err) : cwi_fail_memory(err);
    cwi_free(l.taken);
    cwi_free(l.own);
    v->components = l.layers;
    v->component_stride = v->stride[2] * (ptrdiff_t)v->dim[2];
    return st;
}
