/* Gives slices to a visitor, and picks one component of voxels that have several. */
#include "formats/volume/slice_visit.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

/* Slices with several components, of which one is wanted. */
typedef struct component_slices {
    cw_slice_source all;
    size_t offset; /* of the component in a voxel */
    unsigned char *slice;
} component_slices;

static cw_status read_component(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    component_slices *c = user;
    const cw_volume *s = &c->all.shape;
    const size_t size = cw_type_size(s->type), row = s->dim[0] * size;
    unsigned char *out = to;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        st = c->all.read(c->all.user, first + n, 1, c->slice, err);
        for (size_t j = 0; j < s->dim[1] && st == CW_OK; j++, out += row)
            for (size_t i = 0; i < s->dim[0]; i++)
                memcpy(out + i * size,
                       c->slice + (ptrdiff_t)j * s->stride[1] + (ptrdiff_t)i * s->stride[0] +
                           c->offset,
                       size);
    }
    return st;
}

static cw_status visit_component(cwi_slice_visit *v, const cw_slice_source *all, cw_error *err)
{
    component_slices c = {
        .all = *all,
        .offset = v->component * (size_t)all->shape.component_stride,
        .slice = cwi_alloc_array((size_t)all->shape.stride[2], 1),
    };
    cw_slice_source one = {.shape = all->shape, .read = read_component, .user = &c};
    if (!c.slice)
        return cwi_fail_memory(err);
    one.shape.components = 1;
    one.shape.component_stride = 0;
    memset(one.shape.stride, 0, sizeof one.shape.stride);
    cw_status st = v->visit(v->user, &one, err);
    cwi_free(c.slice);
    return st;
}

cw_status cwi_visit_slices(cwi_slice_visit *v, const cw_volume *shape,
                           cw_status (*read)(void *user, size_t first, size_t count, void *to,
                                             cw_error *err),
                           void *user, cw_error *err)
{
    cw_slice_source source = {.shape = *shape, .read = read, .user = user};
    cw_volume *s = &source.shape;
    const size_t components = s->components ? s->components : 1;
    const ptrdiff_t slice = s->stride[2];
    if ((s->dim[0] > 1 && s->stride[0] >= slice) || (s->dim[1] > 1 && s->stride[1] >= slice) ||
        (components > 1 && s->component_stride >= slice))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "the slices of this file are not contiguous: its fastest axis is z, or "
                        "components are apart; it is only read as a whole");
    v->called = true;
    s->data = NULL;
    s->owned = s->owned_grid = NULL;
    s->steps = 1;
    s->step_stride = 0;
    return components > 1 ? visit_component(v, &source, err) : v->visit(v->user, &source, err);
}
