/* Writes caps, which close the solid where the grid ends, and separates vertices of the border
 * that coincide. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/cases/cell_topology.h"
#include "core/mesh/mesh.h"
#include "core/mesh/weld.h"
#include "extract/dense/edge_crossing.h"
#include "extract/irregular/boundary_faces.h"

#include <string.h>

static void put_triangle(uint32_t *triangle, uint32_t a, uint32_t b, uint32_t c, bool flip)
{
    triangle[0] = a;
    triangle[flip ? 2 : 1] = b;
    triangle[flip ? 1 : 2] = c;
}

/* Writes a vertex with a zero normal, which later becomes that of the triangles around. */
static void put_vertex(cw_mesh *mesh, size_t vertex, const double p[3])
{
    for (size_t a = 0; a < 3; a++) {
        mesh->positions[3 * vertex + a] = (float)p[a];
        if (mesh->normals)
            mesh->normals[3 * vertex + a] = 0;
    }
}

static void put_mean(cw_mesh *mesh, size_t vertex, const uint32_t *of, int count)
{
    double p[3] = {0, 0, 0};
    for (int n = 0; n < count; n++)
        for (size_t a = 0; a < 3; a++)
            p[a] += (double)mesh->positions[3 * (size_t)of[n] + a] / count;
    put_vertex(mesh, vertex, p);
}

static void write_corners(const cwi_cells *g, const cwi_border_face *face, cw_mesh *mesh)
{
    for (int at = 0; at < 4; at++) {
        double p[3];
        if (face->corners[at] == CWI_NO_VERTEX)
            continue;
        cwi_place_of(g, cwi_sample_at(g, face->face, at), p);
        put_vertex(mesh, face->corners[at], p);
    }
}

/* Writes the vertices in the middle of sides and of polygons. */
static void write_middles(const cwi_cells *g, const cwi_border_face *face, cw_mesh *mesh)
{
    cwi_cap c;
    cwi_find_cap(g, face->face, &c);
    for (int polygon = 0; polygon < c.count; polygon++) {
        uint32_t own[CWI_CAP_CORNERS];
        const int size = c.size[polygon];
        for (int n = 0; n < size; n++)
            own[n] = cwi_cap_vertex(g, face, c.corner[polygon][n]);
        for (int n = 0; n < size; n++) {
            const cwi_cap_corner from = c.corner[polygon][n],
                                 to = c.corner[polygon][(n + 1) % size];
            if (from.crossing == to.crossing && face->middles[from.at] != CWI_NO_VERTEX)
                put_mean(mesh, face->middles[from.at],
                         (uint32_t[2]){own[n], own[(n + 1) % size]}, 2);
        }
        if (face->centres[polygon] != CWI_NO_VERTEX)
            put_mean(mesh, face->centres[polygon], own, size);
    }
}

/* Cuts an element's triangle in two at the segment from u to v, which has a vertex in its
 * middle. One takes the triangle's own place, the other follows the element's `count`
 * triangles. */
static void cut_triangle(const cwi_element *e, size_t count, const uint32_t segment[2],
                         uint32_t middle, cw_mesh *mesh)
{
    uint32_t *triangle = mesh->triangles + 3 * e->first_triangle, *last = triangle + 3 * count;
    const uint32_t u = segment[e->flip], v = segment[!e->flip];
    for (; triangle < last; triangle += 3)
        for (int n = 0; n < 3; n++) {
            if (triangle[n] != u || triangle[(n + 1) % 3] != v)
                continue;
            memcpy(last, triangle, 3 * sizeof *last);
            last[n] = middle;
            triangle[(n + 1) % 3] = middle;
            return;
        }
}

/* Cuts the surface's triangles along a cap's segments; the surface runs along a segment in the
 * direction opposite to the cap's. count: of the element's triangles so far */
static void cut_segments(const cwi_cells *g, const cwi_border_face *face, size_t *count,
                         cw_mesh *mesh)
{
    cwi_cap c;
    cwi_find_cap(g, face->face, &c);
    for (int polygon = 0; polygon < c.count; polygon++)
        for (int n = 0; n < c.size[polygon]; n++) {
            const uint32_t middle = cwi_cap_segment_middle(face, &c, polygon, n);
            const int next = (n + 1) % c.size[polygon];
            const uint32_t segment[2] = {cwi_cap_vertex(g, face, c.corner[polygon][next]),
                                         cwi_cap_vertex(g, face, c.corner[polygon][n])};
            if (middle != CWI_NO_VERTEX)
                cut_triangle(cwi_element_of(g, face->face), (*count)++, segment, middle, mesh);
        }
}

/* Cuts the surface along all caps. Border faces of an element follow each other. */
static void cut_surface(const cwi_cells *g, cw_mesh *mesh)
{
    size_t count = 0;
    for (size_t b = 0; b < g->border_count; b++) {
        const cwi_element *e = cwi_element_of(g, g->border[b].face);
        cwi_cell_plan plan;
        cwi_cell_plan_unpack(e->plan, &plan);
        if (b == 0 || e != cwi_element_of(g, g->border[b - 1].face))
            count = (size_t)plan.triangle_count;
        if (e->crossed)
            cut_segments(g, &g->border[b], &count, mesh);
    }
}

static void write_cap(const cwi_cells *g, const cwi_border_face *face, cw_mesh *mesh)
{
    const bool flip = cwi_element_of(g, face->face)->flip;
    uint32_t *triangle = mesh->triangles + 3 * (g->cap_triangle + face->first_triangle);
    cwi_cap c;
    cwi_find_cap(g, face->face, &c);
    for (int polygon = 0; polygon < c.count; polygon++) {
        uint32_t vertices[CWI_CAP_VERTICES];
        const int count = cwi_cap_vertices(g, face, &c, polygon, vertices);
        const int first = cwi_cap_fan(g, face->face, &c, polygon);
        const uint32_t centre = face->centres[polygon];
        for (int n = 0; n < count && centre != CWI_NO_VERTEX; n++, triangle += 3)
            put_triangle(triangle, centre, vertices[n], vertices[(n + 1) % count], flip);
        for (int n = 1; n + 1 < count && centre == CWI_NO_VERTEX; n++, triangle += 3)
            put_triangle(triangle, vertices[first], vertices[(first + n) % count],
                         vertices[(first + n + 1) % count], flip);
    }
}

void cwi_cells_write_caps(const cwi_cells *g, cw_mesh *mesh)
{
    for (size_t b = 0; b < g->border_count; b++)
        write_corners(g, &g->border[b], mesh);
    for (size_t b = 0; b < g->border_count; b++)
        write_middles(g, &g->border[b], mesh);
    for (size_t b = 0; b < g->border_count; b++)
        write_cap(g, &g->border[b], mesh);
    cut_surface(g, mesh);
}

/* --- vertices in one place --------------------------------------------------------------- */

/* State of the separation. Where cells touch in an edge or a sample only, or samples coincide,
 * several of the border's vertices stand in one place. */
typedef struct parting {
    const cwi_cells *g;
    cw_mesh *mesh;
    uint8_t *met;     /* 1: a vertex of the border; 2: one of several in its place */
    double (*sum)[4]; /* sum of the middles of their cells, and its count */
} parting;

/* Calls back for every vertex of every border face. */
static void each_vertex(parting *p, void (*work)(parting *p, const cwi_element *e, size_t v))
{
    const cwi_cells *g = p->g;
    for (size_t b = 0; b < g->border_count; b++) {
        const cwi_border_face *face = &g->border[b];
        cwi_cap c;
        cwi_find_cap(g, face->face, &c);
        for (int polygon = 0; polygon < c.count; polygon++) {
            uint32_t vertices[CWI_CAP_VERTICES];
            const int count = cwi_cap_vertices(g, face, &c, polygon, vertices);
            for (int n = 0; n < count; n++)
                if (vertices[n] != CWI_NO_VERTEX) /* open: corners are none */
                    work(p, cwi_element_of(g, face->face), vertices[n]);
        }
    }
}

static void meet_element(parting *p, const cwi_element *e, size_t v)
{
    (void)e;
    p->met[v] = 1;
}

static void add_middle(parting *p, const cwi_element *e, size_t v)
{
    const int count = cwi_shape_of(e)->corner_count;
    if (p->met[v] < 2)
        return;
    for (int c = 0; c < count; c++) {
        double at[3];
        cwi_place_of(p->g, e->corners[c], at);
        for (int a = 0; a < 3; a++)
            p->sum[v][a] += at[a] / count;
    }
    p->sum[v][3]++;
}

/* Marks the vertices that share their place with others. Returns false if there are none, or
 * (*enough) no memory. */
static bool find_crowded(parting *p, bool *enough)
{
    size_t count = 0;
    bool found = false;
    for (size_t v = 0; v < p->mesh->vertex_count; v++)
        count += p->met[v];
    uint32_t *vertices = cwi_alloc_array(count, sizeof *vertices),
             *map = cwi_alloc_array(count, sizeof *map);
    float *points = cwi_alloc_array(count, 3 * sizeof *points);
    *enough = vertices && map && points;
    for (size_t v = 0, n = 0; v < p->mesh->vertex_count && *enough; v++)
        if (p->met[v]) {
            memcpy(points + 3 * n, p->mesh->positions + 3 * v, 3 * sizeof *points);
            vertices[n++] = (uint32_t)v;
        }
    *enough = *enough && cwi_weld(points, count, map);
    for (size_t n = 0; n < count && *enough; n++)
        if (map[n] != n) {
            p->met[vertices[n]] = p->met[vertices[map[n]]] = 2;
            found = true;
        }
    cwi_free(vertices);
    cwi_free(map);
    cwi_free(points);
    return found;
}

static void move_apart(parting *p)
{
    each_vertex(p, add_middle);
    for (size_t v = 0; v < p->mesh->vertex_count; v++)
        for (size_t a = 0; a < 3 && p->met[v] == 2; a++) {
            float *x = p->mesh->positions + 3 * v + a;
            *x = (float)((double)*x + CWI_NUDGE * (p->sum[v][a] / p->sum[v][3] - (double)*x));
        }
}

cw_status cwi_cells_part(const cwi_cells *g, cw_mesh *mesh, cw_error *err)
{
    parting p = {.g = g, .mesh = mesh, .met = cwi_alloc_zeroed(mesh->vertex_count, 1)};
    bool enough = p.met != NULL;
    if (!g->border_count) {
        cwi_free(p.met);
        return CW_OK;
    }
    if (enough)
        each_vertex(&p, meet_element);
    if (enough && find_crowded(&p, &enough)) {
        p.sum = cwi_alloc_zeroed(mesh->vertex_count, sizeof *p.sum);
        enough = p.sum != NULL;
        if (enough)
            move_apart(&p);
    }
    cwi_free(p.met);
    cwi_free(p.sum);
    return enough ? CW_OK : cwi_fail_memory(err);
}
