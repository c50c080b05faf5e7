/* Cuts a mesh by a plane: triangles are clipped, the section's edges linked to loops, and the loops
 * filled. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "simplify/cut/cut_state.h"

#include <string.h>

/* A vertex nearer to the plane than this fraction of the largest coordinate is in it: about four
 * steps of single precision. */
static const double NEARNESS = 4e-7;

/* The step by which vertices of the section move apart, as a fraction of the largest coordinate: one to
 * two units of its last digit. */
static const double STEP = 0x1p-23;

static cw_status check_input(const cw_mesh *mesh, const cw_cut_desc *d, cw_error *err)
{
    for (int a = 0; a < 3; a++) {
        if (!isfinite(d->normal[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "normal[%d] is %g; it must be finite", a,
                            d->normal[a]);
        if (!isfinite(d->point[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "point[%d] is %g; it must be finite", a,
                            d->point[a]);
    }
    if (d->normal[0] == 0 && d->normal[1] == 0 && d->normal[2] == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "normal is 0, 0, 0; it must have a length");
    return cwi_mesh_check_size(mesh, "cut", err);
}

/* Turns percentages of the mesh's box into a world point. */
static void place_point(cwi_cut *c)
{
    cw_cut_desc *d = &c->desc;
    double low[3], high[3];
    cw_mesh_bounds(c->mesh, low, high);
    for (int a = 0; a < 3; a++)
        if (d->point_is_percent && d->normal[a] != 0)
            d->point[a] = low[a] + (high[a] - low[a]) * d->point[a] / 100;
}

/* Sets the plane in the coordinates of the mesh's positions. Returns the largest of these. */
static double set_plane(cwi_cut *c)
{
    double largest = 0;
    place_point(c);
    memcpy(c->normal, c->desc.normal, sizeof c->normal);
    cwi_normalise(c->normal);
    c->axis = cwi_longest_axis(c->normal);
    for (int a = 0; a < 3; a++)
        c->offset += c->normal[a] * (c->desc.point[a] - c->mesh->origin[a]);
    for (size_t n = 0; n < 3 * c->mesh->vertex_count; n++)
        largest = cwi_greater(largest, fabs((double)c->mesh->positions[n]));
    c->tolerance = NEARNESS * largest;
    c->step = STEP * largest;
    return largest;
}

/* --- the result --------------------------------------------------------------------------- */

/* Sets a vertex' normal: at a filled section halfway to the normal of the section. */
static void set_normal(const cwi_cut *c, const cwi_cut_source *s, bool halfway, float *normal)
{
    double sum[3];
    for (size_t a = 0; a < 3; a++)
        sum[a] = (double)c->mesh->normals[3 * (size_t)s->a + a] * (1 - s->t) +
                 (double)c->mesh->normals[3 * (size_t)s->b + a] * s->t;
    cwi_normalise(sum);
    for (int a = 0; a < 3 && halfway; a++)
        sum[a] -= c->normal[a];
    if (!cwi_normalise(sum))
        memcpy(sum, c->normal, sizeof sum);
    for (int a = 0; a < 3; a++)
        normal[a] = (float)sum[a];
}

static void set_attributes(const cwi_cut *c, size_t n, cw_mesh *out)
{
    const cwi_cut_source *s = c->sources + n;
    if (s->a == s->b)
        cwi_attributes_put(c->mesh, s->a, out, n);
    else
        cwi_attributes_mix(c->mesh, (const uint32_t[2]){s->a, s->b},
                           (const double[2]){1 - s->t, s->t}, 2, out, n);
    if (c->mesh->normals && (s->a != s->b || c->is_section[n]))
        set_normal(c, s, !c->desc.leave_open, out->normals + 3 * n);
}

/* Gives the triangles of the section the colours of triangles beside them, by common vertices.
 * near: room for a triangle of each vertex; UINT32_MAX: none */
static void color_section(const cwi_cut *c, const cw_attribute *row, uint32_t *near,
                          cw_mesh *out)
{
    const size_t size = cwi_attribute_bytes(row);
    char *colors = row->data;
    memset(near, 0xff, out->vertex_count * sizeof *near);
    for (size_t i = 0; i < 3 * out->triangle_count; i++)
        if (c->parents[i / 3] != UINT32_MAX)
            near[out->triangles[i]] = (uint32_t)(i / 3);
    for (size_t i = 0; i < 3 * out->triangle_count; i++) {
        const uint32_t beside = near[out->triangles[i]];
        if (c->parents[i / 3] == UINT32_MAX && beside != UINT32_MAX)
            memcpy(colors + i / 3 * size, colors + beside * size, size);
    }
}

static cw_status color_sections(const cwi_cut *c, cw_mesh *out, cw_error *err)
{
    uint32_t *near = NULL;
    for (size_t n = 0; n < out->attribute_count; n++) {
        const cw_attribute *row = &out->attributes[n];
        if (row->on != CW_ON_TRIANGLES || row->interpolation != CW_INTERPOLATE_COLOR)
            continue;
        if (!near && !(near = cwi_alloc_array(out->vertex_count, sizeof *near)))
            return cwi_fail_memory(err);
        color_section(c, row, near, out);
    }
    cwi_free(near);
    return CW_OK;
}

/* Gives triangles the attributes of those that they are parts of; those of the section keep 0, but for
 * colours. */
static void set_triangle_attributes(const cwi_cut *c, cw_mesh *out)
{
    for (size_t t = 0; t < out->triangle_count; t++) {
        uint32_t same[3];
        for (size_t k = 0; k < 3; k++) {
            const cwi_cut_source *s = c->sources + out->triangles[3 * t + k];
            same[k] = s->a == s->b ? s->a : UINT32_MAX;
        }
        if (c->parents[t] != UINT32_MAX)
            cwi_attributes_put_triangle(c->mesh, c->parents[t], same, out, t);
    }
}

static cw_status make_result(const cwi_cut *c, cw_mesh *out, cw_error *err)
{
    cw_status st = cwi_mesh_alloc(out, c->vertex_count, c->triangle_count, false, err);
    if (st == CW_OK)
        st = cwi_attributes_alloc(c->mesh, out, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, c->mesh->origin, sizeof out->origin);
    memcpy(out->affine, c->mesh->affine, sizeof out->affine);
    memcpy(out->positions, c->positions, 3 * c->vertex_count * sizeof *c->positions);
    memcpy(out->triangles, c->triangles, 3 * c->triangle_count * sizeof *c->triangles);
    for (size_t n = 0; n < c->vertex_count; n++)
        if (c->sources[n].a != UINT32_MAX)
            set_attributes(c, n, out);
    set_triangle_attributes(c, out);
    st = color_sections(c, out, err);
    if (st != CW_OK || !c->has_unused)
        return st;
    bool *marked = cwi_alloc_zeroed(out->triangle_count, sizeof *marked);
    st = marked ? cwi_mesh_drop_marked(out, marked, err) : cwi_fail_memory(err);
    cwi_free(marked);
    return st;
}

static cw_status cut_mesh(cwi_cut *c, cw_mesh *out, cw_error *err)
{
    bool has[3] = {false, false, false};
    cw_status st = cwi_progress(&c->desc.progress, "cut", 0, err);
    const double largest = set_plane(c);
    if (st == CW_OK && !cwi_cut_find_sides(c, largest, has))
        st = cwi_fail_memory(err);
    if (st == CW_OK && !has[CWI_CUT_ABOVE + 1])
        st = cwi_fail(err, CW_ERR_EMPTY,
                      "nothing is left: no triangle is above the plane of the cut");
    if (st == CW_OK && !has[CWI_CUT_BELOW + 1])
        return c->nearness && has[CWI_CUT_ON + 1]
                   ? cwi_fail(err, CW_ERR_CHECK,
                              "vertices may be below that are near the plane")
                   : cwi_mesh_copy(c->mesh, out, err);
    if (st == CW_OK)
        st = cwi_cut_clip(c, err);
    if (st == CW_OK)
        st = cwi_cut_merge_equal(c, err);
    if (st == CW_OK)
        st = cwi_cut_link(c, err);
    if (st == CW_OK)
        st = cwi_cut_fill_apart(c, err);
    if (st == CW_OK && c->nearness && (c->crossings || !cwi_cut_keeps_volume(c)))
        return cwi_fail(err, CW_ERR_CHECK, "vertices near the plane moved too far");
    return st == CW_OK ? make_result(c, out, err) : st;
}

static void free_cut(cwi_cut *c)
{
    cwi_free(c->side);
    cwi_free(c->near);
    cwi_free(c->sources);
    cwi_free(c->positions);
    cwi_free(c->is_section);
    cwi_free(c->triangles);
    cwi_free(c->parents);
    cwi_free(c->edges);
    cwi_free(c->loop_vertices);
    cwi_free(c->loop_ends);
}

cw_status cw_mesh_cut(const cw_mesh *mesh, const cw_cut_desc *desc, cw_mesh *out,
                      cw_cut_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    static const double nearness[] = {1, 1.0 / 16, 0};
    *out = (cw_mesh){0};
    cw_status st = check_input(mesh, desc, err);
    const bool is_valid = st == CW_OK;
    for (size_t n = 0; n < 3 && is_valid; n++) {
        cwi_cut c = {.mesh = mesh, .desc = *desc, .nearness = nearness[n]};
        st = cut_mesh(&c, out, err);
        if (facts)
            *facts = st == CW_OK ? c.facts : (cw_cut_facts){0};
        free_cut(&c);
        if (st != CW_ERR_CHECK && st != CW_ERR_EMPTY)
            break;
    }
    if (st != CW_OK)
        cw_mesh_free(out);
    return st;
}
