/* The facets around a result, sewn into manifold sheets: where several meet in an edge, those are neighbours that
 * have the inside of the result between them. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"

typedef struct sewing {
    const cwi_facets *f;
    const cwi_space_cells *cells;
    const uint8_t *kept;
    uint8_t bit;
    uint32_t *mates; /* of each edge of a kept facet: that of its neighbour */
    uint32_t *sets;  /* of corners that are one vertex */
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

static void set_mates(const sewing *s, uint32_t c, uint32_t d)
{
    s->mates[c] = d;
    s->mates[d] = c;
}

/* Returns the other edge that the facet of edge c has at a point. */
static uint32_t other_edge(const sewing *s, uint32_t c, uint32_t point)
{
    return point_of(s, c) == point ? cwi_corner_prev(c) : cwi_corner_next(c);
}

/* Returns true if the facets around a point, from one to the next, lead from edge c to edge d or e. */
static bool leads_to(const sewing *s, uint32_t c, uint32_t d, uint32_t e, uint32_t point)
{
    uint32_t at = c;
    do {
        at = s->mates[other_edge(s, at, point)];
        if (at == d || at == e)
            return true;
    } while (at != c);
    return false;
}

/* Returns true if the inside of the result is behind a facet for what turns counter-clockwise about an edge. */
static bool begins_wedge(const sewing *s, uint32_t c)
{
    const bool rising = point_of(s, c) < point_of(s, cwi_corner_next(c));
    return is_inside(s, 2 * (c / 3) + !rising);
}

/* Returns true if sheets at an edge pass through each other: of two pairs, each has one facet between the other's. */
static bool do_pairs_cross(const sewing *s, const uint32_t *corners, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        size_t between = 0, end = n + 1;
        if (!is_kept(s, corners[n] / 3))
            continue;
        while (end < count && corners[end] != s->mates[corners[n]])
            end++;
        for (size_t m = n + 1; m < end && end < count; m++) {
            size_t mate = n + 1;
            while (mate < end && corners[mate] != s->mates[corners[m]])
                mate++;
            between += is_kept(s, corners[m] / 3) && mate == end;
        }
        if (between)
            return true;
    }
    return false;
}

/* Parts two sheets at an edge, whose facets are neighbours around both of its ends: with the same vertices, the
 * edge would have four facets. When the sheets exchange a facet, each end gets two fans. Fans are only ever
 * divided, so that no edge before is joined again. */
static void part_sheets(const sewing *s, const uint32_t *corners, size_t count, uint32_t c,
                        uint32_t d)
{
    const uint32_t c2 = s->mates[c], d2 = s->mates[d];
    if (!leads_to(s, c, d, d2, point_of(s, c)) ||
        !leads_to(s, c, d, d2, point_of(s, cwi_corner_next(c))))
        return;
    set_mates(s, c, d2);
    set_mates(s, d, c2);
    if (do_pairs_cross(s, corners, count)) {
        set_mates(s, c, c2);
        set_mates(s, d, d2);
    }
}

/* Pairs the facets around an edge that have the inside between them; returns how many sheets pass the edge. */
static size_t pair_ring(const sewing *s, const cwi_edge_ring *ring)
{
    const uint32_t *corners = s->cells->ring_corners + ring->first;
    size_t sheets = 0, first = ring->count, last = ring->count;
    for (size_t n = 0; n <= ring->count; n++) {
        const size_t i = n == ring->count ? first : n;
        if (i == ring->count || !is_kept(s, corners[i] / 3))
            continue;
        if (last != ring->count) { /* the wedge between the last facet and this one */
            if (begins_wedge(s, corners[last])) {
                set_mates(s, corners[last], corners[i]);
                sheets++;
            }
        }
        last = i;
        first = first == ring->count ? i : first;
    }
    return sheets;
}

static void part_ring(const sewing *s, const cwi_edge_ring *ring)
{
    const uint32_t *corners = s->cells->ring_corners + ring->first;
    for (size_t n = 0; n < ring->count; n++)
        for (size_t m = n + 1; m < ring->count; m++)
            if (is_kept(s, corners[n] / 3) && is_kept(s, corners[m] / 3) &&
                begins_wedge(s, corners[n]) && begins_wedge(s, corners[m]))
                part_sheets(s, corners, ring->count, corners[n], corners[m]);
}

static void sew_all(const sewing *s, cwi_sheets *out)
{
    for (uint32_t c = 0; c < 3 * s->f->count; c++)
        s->mates[c] = s->cells->twins[c];
    for (size_t n = 0; n < s->cells->ring_count; n++) {
        const size_t sheets = pair_ring(s, &s->cells->rings[n]);
        out->contact_edges += sheets > 1 ? sheets - 1 : 0;
    }
    for (size_t n = 0; n < s->cells->ring_count && out->contact_edges; n++)
        part_ring(s, &s->cells->rings[n]);
    for (uint32_t c = 0; c < 3 * s->f->count; c++) {
        const uint32_t d = s->mates[c];
        if (d == CWI_NOTHING || d < c || !is_kept(s, c / 3))
            continue;
        const bool same = point_of(s, c) == point_of(s, d);
        cwi_sets_join(s->sets, c, same ? d : cwi_corner_next(d));
        cwi_sets_join(s->sets, cwi_corner_next(c), same ? cwi_corner_next(d) : d);
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
    sewing s = {facets,
                cells,
                kept,
                bit,
                cwi_alloc_array(3 * facets->count, sizeof *s.mates),
                cwi_sets_alloc(3 * facets->count)};
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
    bool done = s.mates && s.sets && number && out->triangles && out->sources && out->points;
    if (done) {
        sew_all(&s, out);
        number_vertices(&s, solids, number, out);
        done = count_contacts(points, out);
    }
    cwi_free(number);
    cwi_free(s.mates);
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
