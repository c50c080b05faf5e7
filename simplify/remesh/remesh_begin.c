/* Begins a remeshing: links triangles, lists curves, and builds the trees that distances need. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/triangle_boxes.h"
#include "simplify/remesh/remesh_state.h"

#include <string.h>

/* Fraction of the allowed distance that the work may use: it is checked at points alone, and the
 * rest is for the points between them. */
static const double WORK_FRACTION = 0.75;

/* --- links -------------------------------------------------------------------------------- */

static cw_status refuse_mesh(cw_error *err, const char *what, uint32_t vertex)
{
    return cwi_fail(err, CW_ERR_FORMAT,
                    "%s at vertex %u; remeshing needs an oriented manifold: repair it first",
                    what, (unsigned)vertex);
}

/* Joins the two sides along each edge. */
static cw_status pair_sides(cwi_remesh *r, const cwi_side *sides, size_t count, cw_error *err)
{
    for (size_t n = 0, along; n < count; n += along) {
        const uint32_t a = sides[n].corner, low = (uint32_t)(sides[n].key >> 32);
        along = cwi_sides_along(sides, count, n);
        if (along > 2)
            return refuse_mesh(err, "an edge has more than two triangles", low);
        if (along == 1)
            continue;
        if (r->triangles[a] == r->triangles[sides[n + 1].corner])
            return refuse_mesh(err, "neighbours wind in opposite ways", low);
        cwi_twins_join(r->twin, a, sides[n + 1].corner);
    }
    return CW_OK;
}

static cw_status link_triangles(cwi_remesh *r, cw_error *err)
{
    const size_t count = 3 * r->triangle_count;
    cw_status st = CW_OK;
    for (uint32_t c = 0; c < count && st == CW_OK; c++) {
        r->twin[c] = CWI_NONE;
        if (r->triangles[c] == r->triangles[cwi_corner_next(c)])
            st = refuse_mesh(err, "a triangle names a vertex twice", r->triangles[c]);
    }
    cwi_side *sides = st == CW_OK ? cwi_alloc_array(count, sizeof *sides) : NULL;
    if (st == CW_OK && !sides)
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        cwi_sides_list(r->triangles, count, sides);
        st = pair_sides(r, sides, count, err);
    }
    cwi_free(sides);
    return st;
}

/* Finds a corner of each vertex, and whether its triangles are one fan. */
static cw_status check_fans(cwi_remesh *r, cw_error *err)
{
    for (size_t v = 0; v < r->vertex_count; v++) {
        r->corner[v] = CWI_NONE;
        r->sizes[v] = 0; /* counts triangles here; exact below 2^24 */
    }
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++) {
        const uint32_t v = r->triangles[c];
        r->corner[v] = r->corner[v] == CWI_NONE ? c : r->corner[v];
        r->sizes[v] += 1;
    }
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        const uint32_t start = r->corner[v];
        uint32_t c = start, across;
        if (start == CWI_NONE)
            continue;
        float count = 1;
        while ((across = r->twin[cwi_corner_prev(c)]) != CWI_NONE && across != start) {
            c = across;
            count += 1;
        }
        for (c = start; across == CWI_NONE && r->twin[c] != CWI_NONE; count += 1)
            c = cwi_corner_next(r->twin[c]);
        if (count < r->sizes[v])
            return refuse_mesh(err, "several fans of triangles meet", v);
    }
    return CW_OK;
}

/* --- curves ------------------------------------------------------------------------------- */

/* Lists the sharp edges as triangles without area. */
static cw_status list_curves(cwi_remesh *r, cw_error *err)
{
    cw_mesh *m = &r->curves.mesh;
    size_t count = 0;
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++)
        count += cwi_is_sharp(r, c) && (r->twin[c] == CWI_NONE || r->twin[c] > c);
    m->positions = r->input->positions;
    m->vertex_count = r->input->vertex_count;
    m->triangles = cwi_alloc_array(count, 3 * sizeof *m->triangles);
    r->curves.limits = cwi_alloc_array(count, sizeof *r->curves.limits);
    if (!m->triangles || !r->curves.limits)
        return cwi_fail_memory(err);
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++) {
        if (!cwi_is_sharp(r, c) || (r->twin[c] != CWI_NONE && r->twin[c] < c))
            continue;
        uint32_t *v = m->triangles + 3 * m->triangle_count++;
        v[0] = r->triangles[c];
        v[1] = v[2] = r->triangles[cwi_corner_next(c)];
    }
    return cwi_closest_build(m, &r->curves.tree, err);
}

/* --- memory ------------------------------------------------------------------------------- */

static bool alloc_work(cwi_remesh *r)
{
    const size_t v = r->input->vertex_count, t = r->input->triangle_count;
    r->positions = cwi_alloc_array(v, 3 * sizeof *r->positions);
    r->sizes = cwi_alloc_array(v, sizeof *r->sizes);
    r->corner = cwi_alloc_array(v, sizeof *r->corner);
    r->freedom = cwi_alloc_array(v, sizeof *r->freedom);
    r->triangles = cwi_alloc_array(t, 3 * sizeof *r->triangles);
    r->twin = cwi_alloc_array(t, 3 * sizeof *r->twin);
    r->first_sample = cwi_alloc_array(t, sizeof *r->first_sample);
    r->bits = cwi_alloc_array(t, sizeof *r->bits);
    r->vertex_capacity = v;
    r->triangle_capacity = t;
    return r->positions && r->sizes && r->corner && r->freedom && r->triangles && r->twin &&
           r->first_sample && r->bits;
}

static bool alloc_input(cwi_remesh *r)
{
    const size_t v = r->input->vertex_count, t = r->input->triangle_count;
    r->surface.normals = cwi_alloc_array(t, 3 * sizeof *r->surface.normals);
    r->surface.limits = cwi_alloc_array(t, sizeof *r->surface.limits);
    r->input_freedom = cwi_alloc_array(v, sizeof *r->input_freedom);
    r->input_twin = cwi_alloc_array(t, 3 * sizeof *r->input_twin);
    r->input_bits = cwi_alloc_array(t, sizeof *r->input_bits);
    r->sample_limits = cwi_alloc_array(v, sizeof *r->sample_limits);
    r->next_sample = cwi_alloc_array(v, sizeof *r->next_sample);
    r->scratch = cwi_alloc_array(v, sizeof *r->scratch);
    r->scratch_ends = cwi_alloc_array(v, 2 * sizeof *r->scratch_ends);
    r->scratch_to = cwi_alloc_array(v, sizeof *r->scratch_to);
    return r->surface.normals && r->surface.limits && r->input_freedom && r->input_twin &&
           r->input_bits && r->sample_limits && r->next_sample && r->scratch &&
           r->scratch_ends && r->scratch_to;
}

void cwi_remesh_free(cwi_remesh *r)
{
    cwi_boxes_free(&r->surface.tree);
    cwi_boxes_free(&r->curves.tree);
    void *const arrays[] = {r->surface.normals,
                            r->surface.limits,
                            r->curves.limits,
                            r->curves.mesh.triangles,
                            r->target_sizes,
                            r->input_freedom,
                            r->input_twin,
                            r->input_bits,
                            r->sample_limits,
                            r->next_sample,
                            r->scratch,
                            r->scratch_ends,
                            r->scratch_to,
                            r->positions,
                            r->sizes,
                            r->corner,
                            r->freedom,
                            r->triangles,
                            r->twin,
                            r->first_sample,
                            r->bits};
    for (size_t n = 0; n < sizeof arrays / sizeof *arrays; n++)
        cwi_free(arrays[n]);
    *r = (cwi_remesh){.desc = r->desc, .input = r->input};
}

/* --- the beginning ------------------------------------------------------------------------ */

/* Allows the same distance everywhere. Positions in single precision need a little in any case. */
static void set_limits(cwi_remesh *r)
{
    double largest = 0;
    for (size_t n = 0; n < 3 * r->input->vertex_count; n++)
        largest = cwi_greater(largest, fabs((double)r->input->positions[n]));
    r->rounding_mm = largest * 0x1p-22;
    r->limit_mm = cwi_greater(WORK_FRACTION * r->desc.error_mm, r->rounding_mm);
    for (size_t t = 0; t < r->input->triangle_count; t++)
        r->surface.limits[t] = (float)r->limit_mm;
    for (size_t v = 0; v < r->input->vertex_count; v++)
        r->sample_limits[v] = (float)r->limit_mm;
    for (size_t e = 0; e < r->curves.mesh.triangle_count; e++)
        r->curves.limits[e] = (float)r->limit_mm;
}

/* Gives each sample a triangle at its vertex, and one with a sharp edge there if it has any. */
static void attach_samples(cwi_remesh *r)
{
    for (size_t v = 0; v < r->vertex_count; v++)
        r->scratch[v] = r->corner[v];
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++)
        if (cwi_is_sharp(r, c)) {
            r->scratch[r->triangles[c]] = c;
            r->scratch[r->triangles[cwi_corner_next(c)]] = c;
        }
    for (size_t t = 0; t < r->triangle_count; t++)
        r->first_sample[t] = CWI_NONE;
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        if (r->scratch[v] == CWI_NONE)
            continue;
        const uint32_t t = r->scratch[v] / 3;
        r->next_sample[v] = r->first_sample[t];
        r->first_sample[t] = v;
    }
}

/* Makes the mesh at work a copy of the input. */
static void copy_input(cwi_remesh *r)
{
    const cw_mesh *m = r->input;
    r->vertex_count = m->vertex_count;
    r->triangle_count = m->triangle_count;
    memcpy(r->positions, m->positions, 3 * m->vertex_count * sizeof *r->positions);
    memcpy(r->triangles, m->triangles, 3 * m->triangle_count * sizeof *r->triangles);
}

void cwi_remesh_restart(cwi_remesh *r)
{
    copy_input(r);
    memcpy(r->twin, r->input_twin, 3 * r->triangle_count * sizeof *r->twin);
    memcpy(r->bits, r->input_bits, r->triangle_count);
    memcpy(r->freedom, r->input_freedom, r->vertex_count);
    for (size_t v = 0; v < r->vertex_count; v++) {
        r->corner[v] = CWI_NONE;
        r->sizes[v] = r->target_sizes ? r->target_sizes[v] : (float)r->desc.edge_mm;
    }
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++)
        if (r->corner[r->triangles[c]] == CWI_NONE)
            r->corner[r->triangles[c]] = c;
    attach_samples(r);
}

cw_status cwi_remesh_begin(cwi_remesh *r, cw_error *err)
{
    if (!alloc_work(r) || !alloc_input(r))
        return cwi_fail_memory(err);
    copy_input(r);
    cw_status st = link_triangles(r, err);
    if (st == CW_OK)
        st = check_fans(r, err);
    if (st != CW_OK)
        return st;
    cwi_find_features(r);
    memcpy(r->input_twin, r->twin, 3 * r->triangle_count * sizeof *r->twin);
    memcpy(r->input_bits, r->bits, r->triangle_count);
    memcpy(r->input_freedom, r->freedom, r->vertex_count);
    r->surface.mesh = *r->input;
    st = list_curves(r, err);
    if (st == CW_OK)
        st = cwi_triangle_boxes_build(&r->surface.tree, r->input->positions,
                                      r->input->vertex_count, r->input->triangles,
                                      r->input->triangle_count, err);
    if (st == CW_OK)
        set_limits(r);
    return st;
}
