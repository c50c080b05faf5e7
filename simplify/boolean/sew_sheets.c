/* The facets around a result, sewn into manifold sheets: where several meet in an edge, those are neighbours that
 * have the inside of the result between them. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"

typedef struct sewing {
    const cwi_facets *f;
    const cwi_space_cells *cells;
    const uint8_t *kept;
    uint8_t bit;
    uint32_t *sets; /* of corners that are one vertex */
} sewing;

static bool is_inside(const sewing *s, uint32_t side)
{
    return s->kept[s->cells->sides[side]] & s->bit;
}

static bool is_kept(const sewing *s, uint32_t facet)
{
    return is_inside(s, 2 * facet) != is_inside(s, 2 * facet + 1);
}

static uint32_t point_of(const sewing *s, uint32_t corner)
{
    return s->f->corners[corner / 3][corner % 3];
}

static uint32_t next_corner(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static void sew_edge(const sewing *s, uint32_t c, uint32_t d)
{
    const uint32_t c1 = next_corner(c), d1 = next_corner(d);
    const bool same = point_of(s, c) == point_of(s, d);
    cwi_sets_join(s->sets, c, same ? d : d1);
    cwi_sets_join(s->sets, c1, same ? d1 : d);
}

/* Sews around an edge of many facets; returns how many sheets pass it. */
static size_t sew_ring(const sewing *s, const cwi_edge_ring *ring)
{
    const uint32_t *corners = s->cells->ring_corners + ring->first;
    size_t sheets = 0, first = ring->count, last = ring->count;
    for (size_t n = 0; n <= ring->count; n++) {
        const size_t i = n == ring->count ? first : n;
        if (i == ring->count || !is_kept(s, corners[i] / 3))
            continue;
        if (last != ring->count) { /* the wedge between the last facet and this one */
            const uint32_t c = corners[last];
            const bool rising = point_of(s, c) < point_of(s, next_corner(c));
            if (is_inside(s, 2 * (c / 3) + !rising)) {
                sew_edge(s, c, corners[i]);
                sheets++;
            }
        }
        last = i;
        first = first == ring->count ? i : first;
    }
    return sheets;
}

static void sew_all(const sewing *s, cwi_sheets *out)
{
    for (uint32_t c = 0; c < 3 * s->f->count; c++)
        if (s->cells->twins[c] != CWI_NOTHING && s->cells->twins[c] > c && is_kept(s, c / 3))
            sew_edge(s, c, s->cells->twins[c]);
    for (size_t n = 0; n < s->cells->ring_count; n++) {
        const size_t sheets = sew_ring(s, &s->cells->rings[n]);
        out->contact_edges += sheets > 1 ? sheets - 1 : 0;
    }
}

/* Numbers vertices in the order of triangles. `number` of a corner that names a set becomes its vertex. */
static void number_vertices(const sewing *s, const cwi_grid_solids *solids, uint32_t *number,
                            cwi_sheets *out)
{
    for (uint32_t f = 0; f < s->f->count; f++) {
        if (!is_kept(s, f))
            continue;
        const bool turned = is_inside(s, 2 * f);
        const size_t t = out->triangle_count++;
        out->sources[t] = solids->sources[s->f->sources[f]];
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t c = 3 * f + k, root = cwi_sets_find(s->sets, c);
            if (root == c) {
                out->points[out->vertex_count] = point_of(s, c);
                number[c] = (uint32_t)out->vertex_count++;
            }
            out->triangles[3 * t + (turned && k ? 3 - k : k)] = number[root];
        }
    }
}

static bool count_contacts(size_t points, cwi_sheets *out)
{
    bool *seen = cwi_alloc_zeroed(points, sizeof *seen);
    for (size_t v = 0; v < out->vertex_count && seen; v++) {
        out->contact_vertices += seen[out->points[v]];
        seen[out->points[v]] = true;
    }
    cwi_free(seen);
    return seen;
}

cw_status cwi_sew_sheets(const cwi_grid_solids *solids, const cwi_facets *facets,
                         const cwi_space_cells *cells, const uint8_t *kept, uint8_t bit,
                         cwi_sheets *out, cw_error *err)
{
    sewing s = {facets, cells, kept, bit, cwi_sets_alloc(3 * facets->count)};
    size_t count = 0, points = 0;
    uint32_t *number = cwi_alloc_array(3 * facets->count, sizeof *number);
    for (uint32_t f = 0; f < facets->count; f++) {
        count += is_kept(&s, f);
        for (int k = 0; k < 3; k++)
            points =
                facets->corners[f][k] >= points ? facets->corners[f][k] + (size_t)1 : points;
    }
    out->triangles = cwi_alloc_array(count, 3 * sizeof *out->triangles);
    out->sources = cwi_alloc_array(count, sizeof *out->sources);
    out->points = cwi_alloc_array(count, 3 * sizeof *out->points);
    bool done = s.sets && number && out->triangles && out->sources && out->points;
    if (done) {
        sew_all(&s, out);
        number_vertices(&s, solids, number, out);
        done = count_contacts(points, out);
    }
    cwi_free(number);
    cwi_free(s.sets);
    return done ? CW_OK : cwi_fail_memory(err);
}

void cwi_sheets_free(cwi_sheets *sheets)
{
    cwi_free(sheets->points);
    cwi_free(sheets->triangles);
    cwi_free(sheets->sources);
    *sheets = (cwi_sheets){0};
}
