/* Extracts the isosurface of an irregular grid: plans elements, places crossings, numbers
 * vertices, and writes the mesh. */
#include "extract/irregular/cell_surface.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/cases/cell_topology.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "extract/common/extract_limits.h"
#include "extract/common/field_normals.h"
#include "extract/dense/edge_crossing.h"

#include <math.h>
#include <string.h>

/* --- what the elements are made of ------------------------------------------------------- */

/* Plans an element. A hexahedron is treated as the trilinear field in it. Other cells have no
 * tunnels: slices of a wedge are linear, and every inside part of them reaches a corner. */
static void plan_element(const cwi_cells *g, const cwi_element *e, cwi_cell_plan *plan)
{
    const cwi_shape *s = cwi_shape_of(e);
    double values[8];
    unsigned config = s->first_config[e->inside], bit = 1;
    if (e->shape == CW_HEXAHEDRON && !g->desc->simple_topology &&
        cwi_case_is_ambiguous[e->inside]) {
        for (int c = 0; c < 8; c++)
            values[c] = cwi_value_of(g, e->corners[c]);
        cwi_cell_plan_make(e->inside, values, g->level.invert == g->level.strict, plan);
        return;
    }
    for (int face = 0; face < s->face_count; face++)
        if (s->ambiguous_faces[e->inside] >> face & 1) {
            config += cwi_cells_join(g, e, face) ? bit : 0;
            bit *= 2;
        }
    cwi_cell_plan_unpack(config, plan);
}

/* Plans a chunk, and stores counts in the places of first numbers. */
static void plan_chunk(void *context, size_t chunk)
{
    cwi_cells *g = context;
    size_t begin, end;
    cwi_chunk_of(g, chunk, &begin, &end);
    for (size_t n = begin; n < end; n++) {
        cwi_element *e = &g->elements[n];
        cwi_cell_plan plan;
        if (!e->crossed)
            continue;
        plan_element(g, e, &plan);
        e->plan = cwi_cell_plan_pack(&plan);
        e->first_inner = (uint32_t)plan.vertex_count;
        e->first_triangle = (size_t)plan.triangle_count;
    }
}

/* --- vertices on edges ------------------------------------------------------------------- */

/* Joins the crossings at a face. A crossing is one vertex in all cells around its edge that are
 * joined by faces there. Where cells touch in an edge only, each has its own vertex. */
static void join_crossings(cwi_cells *g, uint32_t face)
{
    const uint32_t other = g->across[face];
    const cwi_element *e = &g->elements[face / CWI_CELL_FACES];
    const int local = (int)(face % CWI_CELL_FACES);
    const cwi_shape *s = cwi_shape_of(e);
    if (other == CWI_NO_FACE || other < face)
        return;
    const cwi_element *o = &g->elements[other / CWI_CELL_FACES];
    for (int n = 0; n < s->face_size[local]; n++) {
        const int edge = s->face_edges[local][n];
        if (!(e->crossed >> edge & 1))
            continue;
        const int there =
            cwi_edge_of(o, (int)(other % CWI_CELL_FACES), e->corners[s->edges[edge][0]],
                        e->corners[s->edges[edge][1]]);
        cwi_sets_join(g->crossings, (uint32_t)cwi_crossing_slot(e, edge),
                      (uint32_t)cwi_crossing_slot(o, there));
    }
}

static cw_status place_crossings(cwi_cells *g, cw_error *err)
{
    for (size_t n = 0; n < g->count; n++) {
        g->elements[n].first_crossing = (uint32_t)g->crossing_count;
        g->crossing_count += (size_t)__builtin_popcount(g->elements[n].crossed);
    }
    if (g->crossing_count > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the surface crosses %zu edges of cells; %u can be",
                        g->crossing_count, UINT32_MAX);
    g->crossings = cwi_sets_alloc(g->crossing_count);
    if (!g->crossings)
        return cwi_fail_memory(err);
    for (uint32_t face = 0; face < g->count * CWI_CELL_FACES; face++)
        if (g->elements[face / CWI_CELL_FACES].crossed)
            join_crossings(g, face);
    return CW_OK;
}

/* Turns sets into vertices: a set's least comes first, and parents before their children. */
static void number_crossings(cwi_cells *g)
{
    uint32_t count = 0;
    size_t slot = 0;
    for (size_t n = 0; n < g->count; n++) {
        const cwi_element *e = &g->elements[n];
        g->elements[n].first_vertex = count;
        for (int left = __builtin_popcount(e->crossed); left > 0; left--, slot++) {
            const uint32_t parent = g->crossings[slot];
            g->crossings[slot] = parent == slot ? count++ : g->crossings[parent];
        }
    }
    g->edge_vertices = count;
}

/* Turns counts into first numbers. */
static void number_inner(cwi_cells *g)
{
    for (size_t n = 0; n < g->count; n++) {
        const uint32_t vertices = g->elements[n].first_inner;
        g->elements[n].first_inner = (uint32_t)(g->edge_vertices + g->inner_vertices);
        g->inner_vertices += vertices;
    }
}

static void number_triangles(cwi_cells *g)
{
    for (size_t n = 0; n < g->count; n++) {
        const size_t triangles = g->elements[n].first_triangle;
        g->elements[n].first_triangle = g->cap_triangle;
        g->cap_triangle += triangles;
    }
    g->counts.triangles = g->cap_triangle + g->cap_triangles;
}

/* --- the plan ---------------------------------------------------------------------------- */

/* Returns the bytes of all arrays that exist at some time; gradients as if there were one per
 * crossing. */
static size_t working_bytes(const cwi_cells *g)
{
    const size_t gradients =
        g->volume.dim[0] * sizeof(uint32_t) + g->edge_vertices * 12 * sizeof(double);
    return g->volume.dim[0] + g->chunks * sizeof *g->chunk_corners +
           g->count * (sizeof *g->elements + CWI_CELL_FACES * sizeof *g->across) +
           g->crossing_count * sizeof *g->crossings + g->border_count * sizeof *g->border +
           g->pairing_bytes + (g->desc->no_normals ? 0 : gradients);
}

static cw_status finish_counts(cwi_cells *g, cw_error *err)
{
    g->counts.vertices = g->edge_vertices + g->inner_vertices + g->cap_vertices;
    if (g->counts.vertices > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the surface has %zu vertices; a mesh holds %u",
                        g->counts.vertices, UINT32_MAX);
    g->counts.bytes =
        cwi_extract_mesh_bytes(&g->counts, !g->desc->no_normals) + working_bytes(g);
    return cwi_extract_check_limits(g->desc, &g->counts, err);
}

/* Finds everything that is known of the surface before it is made. */
static cw_status make_plan(cwi_cells *g, cw_error *err)
{
    cw_status st = cwi_cells_gather(g, err);
    if (st != CW_OK || !g->count)
        return st;
    st = cwi_cells_pair_faces(g, err);
    if (st == CW_OK)
        st = cwi_cells_orient(g, err);
    if (st == CW_OK)
        st = cwi_parallel_for(cwi_chunks_of(g), CWI_CELL_CHUNK * 64, g->desc->threads,
                              &g->desc->progress, "planning", plan_chunk, g, err);
    if (st == CW_OK)
        st = place_crossings(g, err);
    if (st != CW_OK)
        return st;
    number_crossings(g);
    number_inner(g);
    st = cwi_cells_find_border(g, err);
    if (st != CW_OK)
        return st;
    number_triangles(g);
    return finish_counts(g, err);
}

/* --- the mesh ---------------------------------------------------------------------------- */

typedef struct writing {
    const cwi_cells *g;
    cwi_gradients gradients;
    cw_mesh *mesh;
} writing;

/* Writes the outward direction at a point in a cell; zero where the gradient gives none. */
static void write_normal(const writing *w, const cwi_element *e, const double weights[8],
                         float *normal)
{
    const double outward = w->g->level.invert ? 1 : -1;
    double sum[3] = {0, 0, 0};
    for (int c = 0; c < cwi_shape_of(e)->corner_count; c++)
        for (int a = 0; a < 3; a++)
            sum[a] += weights[c] * w->gradients.at[w->gradients.rows[e->corners[c]]][a];
    const bool known = cwi_normalise(sum);
    for (int a = 0; a < 3; a++)
        normal[a] = known ? (float)(outward * sum[a]) : 0;
}

/* Writes a vertex at the point of a cell that the weights of the cell's corners give. */
static void write_vertex(const writing *w, const cwi_element *e, const double weights[8],
                         size_t vertex)
{
    double position[3] = {0, 0, 0};
    for (int c = 0; c < cwi_shape_of(e)->corner_count; c++) {
        double p[3];
        if (weights[c] == 0)
            continue;
        cwi_place_of(w->g, e->corners[c], p);
        for (int a = 0; a < 3; a++)
            position[a] += weights[c] * p[a];
    }
    for (size_t a = 0; a < 3; a++)
        w->mesh->positions[3 * vertex + a] = (float)position[a];
    if (w->mesh->normals)
        write_normal(w, e, weights, w->mesh->normals + 3 * vertex);
}

/* Returns the fraction of an edge, from its first corner, at which it is crossed. Every cell
 * computes it from the edge's lower sample. */
static double crossing_of(const cwi_cells *g, const cwi_element *e, int edge)
{
    const uint32_t a = e->corners[cwi_shape_of(e)->edges[edge][0]],
                   b = e->corners[cwi_shape_of(e)->edges[edge][1]];
    const double t = cwi_edge_crossing(cwi_stored_at(g, a < b ? a : b),
                                       cwi_stored_at(g, a < b ? b : a), g->level.at);
    return a < b ? t : 1 - t;
}

static void add_crossing(const cwi_element *e, const double fractions[12], int edge,
                         double weight, double weights[8])
{
    const uint8_t *corners = cwi_shape_of(e)->edges[edge];
    weights[corners[0]] += weight * (1 - fractions[edge]);
    weights[corners[1]] += weight * fractions[edge];
}

/* Computes the weights of a cube's corners for a vertex inside, from its own coordinates. */
static void weigh_cube(const double p[3], double weights[8])
{
    for (int c = 0; c < 8; c++)
        weights[c] =
            (c & 1 ? p[0] : 1 - p[0]) * (c & 2 ? p[1] : 1 - p[1]) * (c & 4 ? p[2] : 1 - p[2]);
}

/* Computes the weights for other cells. Only cones have a vertex inside: in the middle of their
 * loop's points. */
static void weigh_cone(const cwi_element *e, const cwi_config *config,
                       const double fractions[12], int n, double weights[8])
{
    const uint8_t *edges = config->loop_edges;
    int loop = 0;
    for (; !config->cone[loop] || n-- > 0; loop++)
        edges += config->loop_length[loop];
    for (int i = 0; i < config->loop_length[loop]; i++)
        add_crossing(e, fractions, edges[i], 1.0 / config->loop_length[loop], weights);
}

static void write_triangles(const writing *w, const cwi_element *e, const cwi_cell_plan *plan,
                            const cwi_cell *cell)
{
    uint32_t *out = w->mesh->triangles + 3 * e->first_triangle;
    for (int n = 0; n < 3 * plan->triangle_count; n++) {
        const int name = cell->triangles[e->flip && n % 3 ? n - n % 3 + 3 - n % 3 : n];
        out[n] = name < CWI_CELL_INNER ? w->g->crossings[cwi_crossing_slot(e, name)]
                                       : e->first_inner + (uint32_t)(name - CWI_CELL_INNER);
    }
}

static void write_element(const writing *w, const cwi_element *e)
{
    const cwi_cells *g = w->g;
    double fractions[12] = {0};
    cwi_cell_plan plan;
    cwi_cell cell;
    cwi_cell_plan_unpack(e->plan, &plan);
    for (int edge = 0; edge < 12; edge++) {
        if (!(e->crossed >> edge & 1))
            continue;
        const uint32_t vertex = g->crossings[cwi_crossing_slot(e, edge)];
        if (vertex < e->first_vertex && !plan.vertex_count)
            continue;
        fractions[edge] = crossing_of(g, e, edge);
        double weights[8] = {0};
        add_crossing(e, fractions, edge, 1, weights);
        if (vertex >= e->first_vertex)
            write_vertex(w, e, weights, vertex);
    }
    cwi_cell_build(&plan, fractions, &cell);
    for (int n = 0; n < plan.vertex_count; n++) {
        double weights[8] = {0};
        if (e->shape == CW_HEXAHEDRON)
            weigh_cube(cell.vertices[n], weights);
        else
            weigh_cone(e, plan.config, fractions, n, weights);
        write_vertex(w, e, weights, e->first_inner + (size_t)n);
    }
    write_triangles(w, e, &plan, &cell);
}

static void write_chunk(void *context, size_t chunk)
{
    const writing *w = context;
    size_t begin, end;
    cwi_chunk_of(w->g, chunk, &begin, &end);
    for (size_t n = begin; n < end; n++)
        if (w->g->elements[n].crossed)
            write_element(w, &w->g->elements[n]);
}

static cw_status write_parts(writing *w, cw_error *err)
{
    const cwi_cells *g = w->g;
    cw_status st = w->mesh->normals ? cwi_cells_gradients(g, &w->gradients, err) : CW_OK;
    if (st == CW_OK)
        st = cwi_parallel_for(cwi_chunks_of(g), CWI_CELL_CHUNK * 64, g->desc->threads,
                              &g->desc->progress, "marching", write_chunk, w, err);
    cwi_gradients_free(&w->gradients);
    if (st != CW_OK)
        return st;
    if (!g->desc->leave_open)
        cwi_cells_write_caps(g, w->mesh);
    st = cwi_cells_part(g, w->mesh, err);
    return st == CW_OK && w->mesh->normals
               ? cwi_repair_normals(
                     w->mesh, cwi_voxel_scale(&g->volume) / (g->reach > 0 ? g->reach : 1), err)
               : st;
}

static cw_status write_mesh(const cwi_cells *g, cw_mesh *mesh, cw_error *err)
{
    cw_status st = cwi_mesh_alloc(mesh, g->counts.vertices, g->counts.triangles,
                                  !g->desc->no_normals, err);
    if (st != CW_OK)
        return st;
    cwi_affine_apply(g->volume.affine[0], g->centre, mesh->origin);
    memcpy(mesh->affine, g->volume.affine, sizeof mesh->affine);
    writing w = {.g = g, .mesh = mesh};
    st = write_parts(&w, err);
    if (st != CW_OK)
        cw_mesh_free(mesh);
    return st;
}

cw_status cwi_cells_extract(const cw_volume *volume, const cw_extract_desc *desc, cw_mesh *mesh,
                            cw_extract_counts *counts, cw_error *err)
{
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    cwi_cells g;
    if (mesh)
        memset(mesh, 0, sizeof *mesh);
    cw_status st = cwi_cells_init(&g, volume, &d, err);
    if (st == CW_OK)
        st = make_plan(&g, err);
    if (st == CW_OK && mesh && g.counts.triangles)
        st = write_mesh(&g, mesh, err);
    if (st == CW_OK && counts)
        *counts = g.counts;
    cwi_cells_free(&g);
    return st;
}
