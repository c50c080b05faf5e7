/* Drops one-sided components: a surface like a Moebius strip or a Klein bottle encloses nothing, however it is cut. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/repair/repair_state.h"

#include <math.h>

/* The square of the rim at a seam, as a fraction of the component's area, from which the surface itself is one-sided.
 * Below that a hole has a twist, such as where damage joined two edges the wrong way: it is cut open and filled. A narrow
 * strip has more than 100, a Klein bottle 2.2. */
static const double MIN_RIM = 1;

typedef struct sheets {
    uint32_t *part; /* of triangles: joined by twins */
    uint32_t *rim;  /* of vertices: joined by open edges */
    double *area;   /* of a part */
    double *length; /* of a rim */
    bool *is_one_sided, *marked;
} sheets;

static bool alloc_sheets(const cw_mesh *m, sheets *s)
{
    s->part = cwi_sets_alloc(m->triangle_count);
    s->rim = cwi_sets_alloc(m->vertex_count);
    s->area = cwi_alloc_zeroed(m->triangle_count, sizeof *s->area);
    s->length = cwi_alloc_zeroed(m->vertex_count, sizeof *s->length);
    s->is_one_sided = cwi_alloc_zeroed(m->triangle_count, sizeof *s->is_one_sided);
    s->marked = cwi_alloc_zeroed(m->triangle_count, sizeof *s->marked);
    return s->part && s->rim && s->area && s->length && s->is_one_sided && s->marked;
}

static void free_sheets(sheets *s)
{
    cwi_free(s->part);
    cwi_free(s->rim);
    cwi_free(s->area);
    cwi_free(s->length);
    cwi_free(s->is_one_sided);
    cwi_free(s->marked);
}

/* Sums the areas of parts and the lengths of rims. */
static void measure_sheets(const cwi_repair *r, sheets *s)
{
    const cw_mesh *m = &r->mesh;
    const size_t corners = 3 * m->triangle_count;
    for (uint32_t c = 0; c < corners; c++) {
        if (r->twin[c] == CWI_NO_CORNER)
            cwi_sets_join(s->rim, m->triangles[c], m->triangles[cwi_corner_next(c)]);
        else
            cwi_sets_join(s->part, c / 3, r->twin[c] / 3);
    }
    for (uint32_t c = 0; c < corners; c++) {
        const uint32_t a = m->triangles[c], b = m->triangles[cwi_corner_next(c)];
        if (r->twin[c] == CWI_NO_CORNER)
            s->length[cwi_sets_find(s->rim, a)] += sqrt(cwi_point_distance_sq(
                m->positions + 3 * (size_t)a, m->positions + 3 * (size_t)b));
        if (c % 3 == 0)
            s->area[cwi_sets_find(s->part, c / 3)] += cwi_mesh_area(m, c / 3);
    }
}

/* Marks the triangles to drop, here and in the input. */
static cw_status mark_triangles(cwi_repair *r, const sheets *s, cw_error *err)
{
    const uint32_t *source = r->mesh.attributes->data;
    r->unjudged = cwi_alloc_zeroed(r->input->triangle_count, sizeof *r->unjudged);
    if (!r->unjudged)
        return cwi_fail_memory(err);
    for (uint32_t t = 0; t < r->mesh.triangle_count; t++) {
        s->marked[t] = s->is_one_sided[cwi_sets_find(s->part, t)];
        if (s->marked[t] && source[t] != CWI_NEW)
            r->unjudged[source[t]] = CWI_NEW;
    }
    return CW_OK;
}

cw_status cwi_drop_one_sided(cwi_repair *r, cw_error *err)
{
    sheets s = {0};
    if (!r->seam_count)
        return CW_OK;
    cw_status st = alloc_sheets(&r->mesh, &s) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        measure_sheets(r, &s);
    for (size_t n = 0; n < r->seam_count && st == CW_OK; n++) {
        const uint32_t part = cwi_sets_find(s.part, r->seam[n].triangle);
        const double length = s.length[cwi_sets_find(s.rim, r->seam[n].vertex)];
        if (length * length > MIN_RIM * s.area[part] && !s.is_one_sided[part]) {
            s.is_one_sided[part] = true;
            r->facts.one_sided++;
        }
    }
    if (st == CW_OK && r->facts.one_sided)
        st = mark_triangles(r, &s, err);
    if (st == CW_OK && r->facts.one_sided)
        st = cwi_mesh_drop_marked(&r->mesh, s.marked, err);
    if (st == CW_OK && r->facts.one_sided)
        st = cwi_repair_link(r, false, err);
    free_sheets(&s);
    return st;
}
