/* Vertices of facets that cross after rounding, moved onto vertices close by: two sheets of surface that are closer
 * than floats can tell apart become one there, and cancel out. */
#include "simplify/boolean/snapping.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* Marks the triangles that meet others. */
static void mark_hot(const cwi_meetings *meetings, const cwi_seams *seams, bool *hot)
{
    for (size_t n = 0; n < seams->count; n++)
        hot[seams->seams[n].triangle] = true;
    for (size_t n = 0; n < meetings->count; n++)
        if (meetings->pairs[n].overlap)
            hot[meetings->pairs[n].a] = hot[meetings->pairs[n].b] = true;
}

/* Finds for each vertex that of its new place. */
static bool find_places(cwi_anchors *a, const bool *moves, uint32_t *number)
{
    const size_t count = a->soup->vertex_count;
    for (uint32_t v = 0; v < count; v++)
        if (!moves[v] && !cwi_anchors_add(a, v))
            return false;
    for (uint32_t v = 0; v < count; v++) {
        number[v] = moves[v] ? cwi_anchors_find(a, a->soup->vertices[v]) : v;
        if (number[v] != CWI_NOTHING)
            continue;
        number[v] = v;
        if (!cwi_anchors_add(a, v))
            return false;
    }
    return true;
}

static void set_corners(cwi_grid_solids *s, const uint32_t *number, double *moved_mm)
{
    for (size_t t = 0; t < s->soup.triangle_count + s->flat_count; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t *v = &s->soup.triangles[t][k];
            const double *from = s->soup.vertices[*v], *to = s->soup.vertices[number[*v]];
            *moved_mm = fmax(*moved_mm, cwi_distance(to, from) / s->scale);
            if (s->moved)
                s->moved[t] |= number[*v] != *v;
            *v = number[*v];
        }
}

cw_status cwi_solids_snap(cwi_grid_solids *s, const cwi_meetings *meetings,
                          const cwi_seams *seams, double radius, bool edges_meet,
                          double *moved_mm, cw_error *err)
{
    const size_t count = s->soup.vertex_count, all = s->soup.triangle_count + s->flat_count;
    cwi_anchors a = {0};
    bool *hot = cwi_alloc_zeroed(all, sizeof *hot);
    bool *moves = cwi_alloc_zeroed(count, sizeof *moves); /* vertices of hot triangles */
    uint32_t *number = cwi_alloc_array(count, sizeof *number);
    cw_status st = CW_ERR_NO_MEMORY;
    if (cwi_anchors_init(&a, &s->soup, radius) && hot && moves && number) {
        mark_hot(meetings, seams, hot);
        for (size_t t = 0; t < all; t++)
            for (int k = 0; k < 3; k++)
                moves[s->soup.triangles[t][k]] |= hot[t];
        st = find_places(&a, moves, number) ? CW_OK : CW_ERR_NO_MEMORY;
    }
    if (st == CW_OK) {
        set_corners(s, number, moved_mm);
        st = cwi_insert_vertices(s, &a, &hot, edges_meet, moved_mm, err);
    } else
        st = cwi_fail_memory(err);
    cwi_anchors_free(&a);
    cwi_free(hot);
    cwi_free(moves);
    cwi_free(number);
    return st == CW_OK ? cwi_solids_set_flat_aside(s, err) : st;
}
