/* Finds where the grid ends: the border's faces, the caps in them, and the loops along them. */
#include "extract/irregular/boundary_faces.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"

#include <stdlib.h>
#include <string.h>

/* --- what a border face looks like ------------------------------------------------------- */

uint32_t cwi_crossing_at(const cwi_cells *g, uint32_t face, int position)
{
    const cwi_element *e = cwi_element_of(g, face);
    const int edge = cwi_shape_of(e)->face_edges[face % CWI_CELL_FACES][position];
    return g->crossings[cwi_crossing_slot(e, edge)];
}

uint32_t cwi_sample_at(const cwi_cells *g, uint32_t face, int position)
{
    const cwi_element *e = cwi_element_of(g, face);
    return e->corners[cwi_shape_of(e)->faces[face % CWI_CELL_FACES][position]];
}

static void add_corner(cwi_cap *c, bool crossing, uint8_t at)
{
    const int n = c->count - 1;
    c->corner[n][c->size[n]++] = (cwi_cap_corner){crossing, at};
}

/* Adds the run of inside corners that begins after ring position n, with the crossings at its
 * ends. */
static void add_run(cwi_cap *c, const cwi_element *e, const uint8_t *corners,
                    const uint8_t *ring, int size, int n)
{
    add_corner(c, true, ring[n]);
    for (n = (n + 1) % size; cwi_corner_inside(e, corners[ring[n]]); n = (n + 1) % size)
        add_corner(c, false, ring[n]);
    add_corner(c, true, ring[(n + size - 1) % size]);
}

void cwi_find_cap(const cwi_cells *g, uint32_t face, cwi_cap *c)
{
    const cwi_element *e = cwi_element_of(g, face);
    const int local = (int)(face % CWI_CELL_FACES);
    const uint8_t *corners = cwi_shape_of(e)->faces[local];
    uint8_t ring[4];
    const int size = cwi_face_ring(e, local, ring);
    const bool joined =
        cwi_shape_of(e)->ambiguous_faces[e->inside] >> local & 1 && cwi_cells_join(g, e, local);
    *c = (cwi_cap){0};
    for (int n = 0; n < size; n++) {
        if (cwi_corner_inside(e, corners[ring[n]]) ||
            !cwi_corner_inside(e, corners[ring[(n + 1) % size]]))
            continue;
        c->count += !(joined && c->count); /* the second run continues where the first ends */
        add_run(c, e, corners, ring, size, n);
    }
    if (c->count)
        return;
    c->count = 1; /* all corners are inside */
    for (int n = 0; n < size; n++)
        add_corner(c, false, ring[n]);
}

uint32_t cwi_cap_vertex(const cwi_cells *g, const cwi_border_face *face, cwi_cap_corner corner)
{
    return corner.crossing ? cwi_crossing_at(g, face->face, corner.at)
                           : face->corners[corner.at];
}

uint32_t cwi_cap_segment_middle(const cwi_border_face *face, const cwi_cap *c, int polygon,
                                int n)
{
    const cwi_cap_corner from = c->corner[polygon][n],
                         to = c->corner[polygon][(n + 1) % c->size[polygon]];
    return from.crossing && to.crossing ? face->middles[from.at] : CWI_NO_VERTEX;
}

int cwi_cap_vertices(const cwi_cells *g, const cwi_border_face *face, const cwi_cap *c,
                     int polygon, uint32_t vertices[CWI_CAP_VERTICES])
{
    int count = 0;
    for (int n = 0; n < c->size[polygon]; n++) {
        const cwi_cap_corner from = c->corner[polygon][n],
                             to = c->corner[polygon][(n + 1) % c->size[polygon]];
        vertices[count++] = cwi_cap_vertex(g, face, from);
        if (from.crossing == to.crossing && face->middles[from.at] != CWI_NO_VERTEX)
            vertices[count++] = face->middles[from.at];
    }
    return count;
}

static double square_of(const cwi_cells *g, uint32_t face, cwi_cap_corner a, cwi_cap_corner b)
{
    double p[3], q[3];
    cwi_place_of(g, cwi_sample_at(g, face, a.at), p);
    cwi_place_of(g, cwi_sample_at(g, face, b.at), q);
    return cwi_distance_sq(p, q);
}

/* Finds a corner that is on no edge of the face together with two others. Of five corners it is
 * the middle one of three samples, of six a crossing. */
int cwi_cap_fan(const cwi_cells *g, uint32_t face, const cwi_cap *c, int polygon)
{
    const cwi_cap_corner *corner = c->corner[polygon];
    if (c->size[polygon] == 4)
        return corner[0].crossing || square_of(g, face, corner[0], corner[2]) >
                                         square_of(g, face, corner[1], corner[3]);
    return c->size[polygon] > 4 ? 2 : 0;
}

static bool is_border(const cwi_cells *g, uint32_t face)
{
    const cwi_element *e = cwi_element_of(g, face);
    const int local = (int)(face % CWI_CELL_FACES);
    return local < cwi_shape_of(e)->face_count && g->across[face] == CWI_NO_FACE &&
           cwi_face_matters(g, e, local);
}

/* --- vertices ---------------------------------------------------------------------------- */

/* Returns the sample that the edge from a position in a face leads to. */
static uint32_t sample_after(const cwi_cells *g, uint32_t face, int position)
{
    const int size = cwi_shape_of(cwi_element_of(g, face))->face_size[face % CWI_CELL_FACES];
    return cwi_sample_at(g, face, (position + 1) % size);
}

/* Turns about an edge of a border face, through the cells there, to the border face on their
 * other side. */
static uint32_t turn_about(const cwi_cells *g, uint32_t face, int position)
{
    const uint32_t s = cwi_sample_at(g, face, position), t = sample_after(g, face, position);
    for (;;) {
        const cwi_element *e = cwi_element_of(g, face);
        const uint32_t local = face % CWI_CELL_FACES;
        const uint8_t *faces = cwi_shape_of(e)->edge_faces[cwi_edge_of(e, (int)local, s, t)];
        face += (faces[0] == local ? faces[1] : faces[0]) - local;
        if (g->across[face] == CWI_NO_FACE)
            return face;
        face = g->across[face];
    }
}

/* Returns the index of a face among the border's faces, which are in order. */
static size_t border_index(const cwi_cells *g, uint32_t face)
{
    size_t low = 0, high = g->border_count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (g->border[middle].face <= face)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Returns the position of a sample in a face; the last one if it has several. */
static int corner_position(const cwi_cells *g, uint32_t face, uint32_t sample)
{
    const cwi_element *e = cwi_element_of(g, face);
    uint8_t ring[4];
    const int size = cwi_face_ring(e, (int)(face % CWI_CELL_FACES), ring);
    int n = 0;
    while (n + 1 < size && cwi_sample_at(g, face, ring[n]) != sample)
        n++;
    return ring[n];
}

/* Joins corners of caps to those at the same sample in the next face around it. Where the
 * border meets itself there, each of its sheets becomes a set. */
static void join_corners(const cwi_cells *g, uint32_t *sets)
{
    for (size_t b = 0; b < g->border_count; b++) {
        const uint32_t face = g->border[b].face;
        const cwi_element *e = cwi_element_of(g, face);
        uint8_t ring[4];
        const int size = cwi_face_ring(e, (int)(face % CWI_CELL_FACES), ring);
        for (int n = 0; n < size; n++) {
            const int ends[2] = {ring[n], ring[(n + 1) % size]};
            uint32_t next = CWI_NO_FACE;
            for (int i = 0; i < 2; i++) {
                const uint32_t sample = cwi_sample_at(g, face, ends[i]);
                if (g->sides[sample] != CWI_INSIDE)
                    continue;
                if (next == CWI_NO_FACE)
                    next = turn_about(g, face, ends[0]);
                cwi_sets_join(sets, (uint32_t)(4 * b + (size_t)ends[i]),
                              (uint32_t)(4 * border_index(g, next)) +
                                  (uint32_t)corner_position(g, next, sample));
            }
        }
    }
}

/* Turns sets into numbers, in the order of faces. */
static void number_corners(cwi_cells *g, const uint32_t *sets)
{
    const uint32_t first = (uint32_t)(g->edge_vertices + g->inner_vertices);
    for (size_t b = 0; b < g->border_count; b++) {
        cwi_border_face *face = &g->border[b];
        cwi_cap c;
        cwi_find_cap(g, face->face, &c);
        for (int polygon = 0; polygon < c.count; polygon++)
            for (int n = 0; n < c.size[polygon]; n++) {
                const int at = c.corner[polygon][n].at;
                const size_t slot = 4 * b + (size_t)at;
                if (c.corner[polygon][n].crossing)
                    continue;
                const uint32_t parent = sets[slot];
                face->corners[at] = parent == slot ? first + (uint32_t)g->cap_vertices++
                                                   : g->border[parent / 4].corners[parent % 4];
            }
    }
}

/* --- sides that caps would share --------------------------------------------------------- */

/* Kinds of sides. Two sheets of the border may share two vertices, and so a side: where cells
 * touch in an edge, or do not fit together. Such a side gets a vertex in its middle, and a cap
 * with such sides or diagonals gets one inside. */
typedef enum side_kind {
    SIDE_EDGE,    /* between two samples, and two caps */
    SIDE_SEGMENT, /* between two crossings: of a cap and the surface */
    SIDE_DIAGONAL /* of a cap */
} side_kind;

typedef struct side {
    uint32_t ends[2], border; /* the lower end first; the first of its border faces */
    uint8_t kind, at;         /* the position that leads along it; or the polygon */
} side;

typedef struct sides {
    side *items;
    size_t count;
} sides;

static void add_side(sides *s, side_kind kind, size_t border, int at, uint32_t u, uint32_t v)
{
    s->items[s->count++] =
        (side){{u < v ? u : v, u < v ? v : u}, (uint32_t)border, (uint8_t)kind, (uint8_t)at};
}

/* Returns the border face, and the position in it, on the other side of an edge. */
static size_t partner_of(const cwi_cells *g, size_t border, int at, int *there)
{
    const uint32_t face = g->border[border].face, next = turn_about(g, face, at);
    *there = cwi_edge_position(cwi_element_of(g, next), (int)(next % CWI_CELL_FACES),
                               cwi_sample_at(g, face, at), sample_after(g, face, at));
    return border_index(g, next);
}

static void add_sides_of(sides *s, const cwi_cells *g, size_t border)
{
    const cwi_border_face *face = &g->border[border];
    cwi_cap c;
    cwi_find_cap(g, face->face, &c);
    for (int polygon = 0; polygon < c.count; polygon++) {
        const cwi_cap_corner *corner = c.corner[polygon];
        const int size = c.size[polygon], first = cwi_cap_fan(g, face->face, &c, polygon);
        for (int n = 0; n < size; n++) {
            const cwi_cap_corner next = corner[(n + 1) % size];
            const uint32_t u = cwi_cap_vertex(g, face, corner[n]),
                           v = cwi_cap_vertex(g, face, next);
            int there;
            if (corner[n].crossing != next.crossing)
                continue;
            if (corner[n].crossing)
                add_side(s, SIDE_SEGMENT, border, corner[n].at, u, v);
            else if (partner_of(g, border, corner[n].at, &there) > border)
                add_side(s, SIDE_EDGE, border, corner[n].at, u, v);
        }
        for (int n = 2; n + 1 < size; n++)
            add_side(s, SIDE_DIAGONAL, border, polygon, cwi_cap_vertex(g, face, corner[first]),
                     cwi_cap_vertex(g, face, corner[(first + n) % size]));
    }
}

static int compare_sides(const void *a, const void *b)
{
    const side *s = a, *t = b;
    for (int n = 0; n < 2; n++)
        if (s->ends[n] != t->ends[n])
            return s->ends[n] < t->ends[n] ? -1 : 1;
    return 0;
}

static void mark_side(cwi_cells *g, const side *s)
{
    int there;
    if (s->kind == SIDE_DIAGONAL) {
        g->border[s->border].centres[s->at] = CWI_WANTED;
        return;
    }
    g->border[s->border].middles[s->at] = CWI_WANTED;
    if (s->kind == SIDE_EDGE) {
        const size_t partner = partner_of(g, s->border, s->at, &there);
        g->border[partner].middles[there] = CWI_WANTED;
    }
}

static cw_status mark_shared_sides(cwi_cells *g, cw_error *err)
{
    enum { MAXIMUM = 8 }; /* sides of a cap, each counted once, and diagonals */
    sides s = {.items = cwi_alloc_array(g->border_count, MAXIMUM * sizeof *s.items)};
    if (!s.items)
        return cwi_fail_memory(err);
    for (size_t b = 0; b < g->border_count; b++)
        add_sides_of(&s, g, b);
    qsort(s.items, s.count, sizeof *s.items, compare_sides);
    for (size_t n = 1; n < s.count; n++)
        if (compare_sides(&s.items[n - 1], &s.items[n]) == 0) {
            mark_side(g, &s.items[n - 1]);
            mark_side(g, &s.items[n]);
        }
    cwi_free(s.items);
    return CW_OK;
}

/* Numbers the vertex in the middle of an edge; both caps there share it. */
static void number_middle(cwi_cells *g, size_t border, int at)
{
    const cwi_element *e = cwi_element_of(g, g->border[border].face);
    const int edge = cwi_shape_of(e)->face_edges[g->border[border].face % CWI_CELL_FACES][at];
    const uint32_t vertex =
        (uint32_t)(g->edge_vertices + g->inner_vertices + g->cap_vertices++);
    int there;
    g->border[border].middles[at] = vertex;
    if (e->crossed >> edge & 1)
        return;
    const size_t partner = partner_of(g, border, at, &there);
    g->border[partner].middles[there] = vertex;
}

/* Numbers the marked vertices, and the caps' triangles. Cut triangles of the surface add to the
 * counts of their elements. */
static void number_caps(cwi_cells *g)
{
    for (size_t b = 0; b < g->border_count; b++) {
        cwi_border_face *face = &g->border[b];
        cwi_cap c;
        cwi_find_cap(g, face->face, &c);
        face->first_triangle = g->cap_triangles;
        for (int at = 0; at < 4; at++)
            if (face->middles[at] == CWI_WANTED)
                number_middle(g, b, at);
        for (int polygon = 0; polygon < c.count; polygon++) {
            uint32_t vertices[CWI_CAP_VERTICES];
            const int count = cwi_cap_vertices(g, face, &c, polygon, vertices);
            if (count > c.size[polygon] || face->centres[polygon] == CWI_WANTED)
                face->centres[polygon] =
                    (uint32_t)(g->edge_vertices + g->inner_vertices + g->cap_vertices++);
            g->cap_triangles +=
                (size_t)count - (face->centres[polygon] == CWI_NO_VERTEX ? 2 : 0);
            for (int n = 0; n < c.size[polygon]; n++)
                g->elements[face->face / CWI_CELL_FACES].first_triangle +=
                    cwi_cap_segment_middle(face, &c, polygon, n) != CWI_NO_VERTEX;
        }
    }
}

static cw_status plan_caps(cwi_cells *g, cw_error *err)
{
    if (g->border_count > UINT32_MAX / 4)
        return cwi_fail(err, CW_ERR_LIMIT, "the grid's border has %zu faces; at most %u can be",
                        g->border_count, UINT32_MAX / 4);
    uint32_t *sets = cwi_sets_alloc(4 * g->border_count);
    if (!sets)
        return cwi_fail_memory(err);
    join_corners(g, sets);
    number_corners(g, sets);
    cwi_free(sets);
    cw_status st = mark_shared_sides(g, err);
    if (st == CW_OK)
        number_caps(g);
    return st;
}

/* ----------------------------------------------------------------------------------------- */

/* Counts the loops. Each crossing on the border is an end of two of the segments in faces
 * there. So there are equally many of both, and the segments form loops. */
static cw_status count_loops(cwi_cells *g, cw_error *err)
{
    uint32_t *sets = cwi_sets_alloc(g->edge_vertices);
    if (!sets)
        return cwi_fail_memory(err);
    g->counts.border_loops = 0;
    for (size_t b = 0; b < g->border_count; b++) {
        const uint32_t face = g->border[b].face;
        cwi_cap c;
        cwi_find_cap(g, face, &c);
        for (int polygon = 0; polygon < c.count; polygon++)
            for (int n = 0; n < c.size[polygon]; n++) {
                const cwi_cap_corner from = c.corner[polygon][n],
                                     to = c.corner[polygon][(n + 1) % c.size[polygon]];
                if (!from.crossing || !to.crossing)
                    continue;
                const uint32_t u = cwi_crossing_at(g, face, from.at),
                               v = cwi_crossing_at(g, face, to.at);
                g->counts.border_loops += cwi_sets_find(sets, u) == cwi_sets_find(sets, v);
                cwi_sets_join(sets, u, v);
            }
    }
    cwi_free(sets);
    return CW_OK;
}

cw_status cwi_cells_find_border(cwi_cells *g, cw_error *err)
{
    size_t count = 0;
    for (uint32_t face = 0; face < g->count * CWI_CELL_FACES; face++)
        count += is_border(g, face);
    g->border = cwi_alloc_array(count, sizeof *g->border);
    if (!g->border)
        return cwi_fail_memory(err);
    for (uint32_t face = 0; face < g->count * CWI_CELL_FACES; face++)
        if (is_border(g, face)) {
            cwi_border_face *border = &g->border[g->border_count++];
            memset(border, 0xff, sizeof *border); /* all are CWI_NO_VERTEX */
            border->face = face;
        }
    cw_status st = count_loops(g, err);
    return st == CW_OK && !g->desc->leave_open ? plan_caps(g, err) : st;
}
