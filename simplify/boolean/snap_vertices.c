/* Vertices of facets that cross after rounding, moved onto vertices close by: two sheets of surface that are closer
 * than floats can tell apart become one there, and cancel out. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* Vertices that keep their place, by cells as large as the radius. */
typedef struct anchors {
    const cwi_soup *s;
    double radius;
    uint32_t *heads, *next; /* lists of vertices: 1 + a vertex; 0: the end */
    size_t mask;
} anchors;

static size_t find_list(const anchors *a, const int64_t cell[3])
{
    return cwi_hash_cell(cell) & a->mask;
}

static void find_cell(const anchors *a, const double x[3], int64_t cell[3])
{
    for (int k = 0; k < 3; k++)
        cell[k] = (int64_t)floor(x[k] / a->radius);
}

static void add_anchor(anchors *a, uint32_t v)
{
    int64_t cell[3];
    find_cell(a, a->s->vertices[v], cell);
    const size_t list = find_list(a, cell);
    a->next[v] = a->heads[list];
    a->heads[list] = v + 1;
}

/* Returns the closest anchor within the radius, the first of equally close ones; CWI_NOTHING: none. */
static uint32_t find_anchor(const anchors *a, uint32_t v)
{
    const double *x = a->s->vertices[v];
    double closest_sq = a->radius * a->radius;
    uint32_t closest = CWI_NOTHING;
    int64_t own[3];
    find_cell(a, x, own);
    for (int n = 0; n < 27; n++) {
        const int64_t cell[3] = {own[0] + n % 3 - 1, own[1] + n / 3 % 3 - 1,
                                 own[2] + n / 9 - 1};
        for (uint32_t u = a->heads[find_list(a, cell)]; u; u = a->next[u - 1]) {
            double d[3];
            cwi_sub(a->s->vertices[u - 1], x, d);
            const double distance_sq = cwi_dot(d, d);
            if (distance_sq < closest_sq || (distance_sq == closest_sq && u - 1 < closest)) {
                closest_sq = distance_sq;
                closest = u - 1;
            }
        }
    }
    return closest;
}

static void mark_hot(const cwi_grid_solids *s, const cwi_meetings *meetings,
                     const cwi_seams *seams, bool *hot)
{
    for (size_t n = 0; n < seams->count; n++)
        for (int k = 0; k < 3; k++)
            hot[s->soup.triangles[seams->seams[n].triangle][k]] = true;
    for (size_t n = 0; n < meetings->count; n++)
        for (int k = 0; k < 6 && meetings->pairs[n].overlap; k++)
            hot[s->soup.triangles[k < 3 ? meetings->pairs[n].a : meetings->pairs[n].b][k % 3]] =
                true;
}

cw_status cwi_solids_snap(cwi_grid_solids *s, const cwi_meetings *meetings,
                          const cwi_seams *seams, double radius, double *moved_mm,
                          cw_error *err)
{
    const size_t count = s->soup.vertex_count;
    size_t capacity = 64;
    while (capacity < 2 * count)
        capacity *= 2;
    anchors a = {&s->soup, radius, cwi_alloc_zeroed(capacity, sizeof *a.heads),
                 cwi_alloc_array(count, sizeof *a.next), capacity - 1};
    bool *hot = cwi_alloc_zeroed(count, sizeof *hot);
    uint32_t *number = cwi_alloc_array(count, sizeof *number);
    const bool done = a.heads && a.next && hot && number;
    if (done) {
        mark_hot(s, meetings, seams, hot);
        for (uint32_t v = 0; v < count; v++)
            if (!hot[v])
                add_anchor(&a, v);
        for (uint32_t v = 0; v < count; v++) {
            number[v] = hot[v] ? find_anchor(&a, v) : v;
            if (number[v] == CWI_NOTHING) {
                number[v] = v;
                add_anchor(&a, v);
            }
            double d[3];
            cwi_sub(s->soup.vertices[number[v]], s->soup.vertices[v], d);
            *moved_mm = fmax(*moved_mm, cwi_length(d) / s->scale);
        }
        for (size_t t = 0; t < s->soup.triangle_count + s->flat_count; t++)
            for (int k = 0; k < 3; k++) {
                uint32_t *v = &s->soup.triangles[t][k];
                if (s->moved)
                    s->moved[t] |= number[*v] != *v;
                *v = number[*v];
            }
    }
    cwi_free(a.heads);
    cwi_free(a.next);
    cwi_free(hot);
    cwi_free(number);
    return done ? cwi_solids_set_flat_aside(s, err) : cwi_fail_memory(err);
}
