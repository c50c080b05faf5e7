/* Defects in colour: for looking at. */
#include <cubewright/check.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"

#include <math.h>
#include <string.h>

static const cw_paint paints[] = {
    {CW_DEFECT_INTERSECTING, "self-intersections", "orange", {255, 140, 0}},
    {CW_DEFECT_NONMANIFOLD, "non-manifold", "magenta", {230, 0, 230}},
    {CW_DEFECT_DUPLICATE, "duplicates", "purple", {120, 0, 200}},
    {CW_DEFECT_MISORIENTED, "misoriented", "blue", {30, 80, 255}},
    {CW_DEFECT_INSIDE_OUT, "wrong way round", "cyan", {0, 200, 220}},
    {CW_DEFECT_OPEN, "open edges", "red", {230, 20, 20}},
    {CW_DEFECT_DEGENERATE, "no area", "black", {0, 0, 0}},
    {CW_DEFECT_SLIVER, "needles and caps", "green", {0, 170, 60}},
};
enum { PAINTS = sizeof paints / sizeof *paints };

const cw_paint *cw_check_paints(size_t *count)
{
    *count = PAINTS;
    return paints;
}

/* The paint of a set of defects; PAINTS for none. */
static int paint_of(unsigned defects)
{
    int n = 0;
    while (n < PAINTS && !(defects & paints[n].defect))
        n++;
    return n;
}

/* Copies of vertex v, one a paint: a list through `next`. */
typedef struct copies {
    uint32_t *corner; /* the copy at each corner of the mesh */
    uint32_t *first;  /* of each vertex; UINT32_MAX: none */
    uint32_t *next;
    uint32_t *vertex; /* that was copied */
    uint8_t *paint;
    uint32_t count;
    uint8_t *flat; /* of each vertex of the mesh: whether it is a corner of one without area */
} copies;

static uint32_t copy_of(copies *c, uint32_t vertex, int paint)
{
    for (uint32_t n = c->first[vertex]; n != UINT32_MAX; n = c->next[n])
        if (c->paint[n] == paint)
            return n;
    const uint32_t n = c->count++;
    c->vertex[n] = vertex;
    c->paint[n] = (uint8_t)paint;
    c->next[n] = c->first[vertex];
    c->first[vertex] = n;
    return n;
}

/* Returns the defect of a triangle beside one without area, which cannot be seen itself. */
static unsigned flat_beside(const copies *c, const uint32_t *v)
{
    return c->flat[v[0]] | c->flat[v[1]] | c->flat[v[2]] ? CW_DEFECT_DEGENERATE : 0;
}

/* A vertex is copied once a paint around it: at most once a corner. */
static bool make_copies(copies *c, const cw_mesh *mesh, const uint8_t *defects)
{
    const size_t corners = 3 * mesh->triangle_count;
    c->corner = cwi_alloc_array(corners, sizeof *c->corner);
    c->first = cwi_alloc_array(mesh->vertex_count, sizeof *c->first);
    c->next = cwi_alloc_array(corners, sizeof *c->next);
    c->vertex = cwi_alloc_array(corners, sizeof *c->vertex);
    c->paint = cwi_alloc_array(corners, 1);
    c->flat = cwi_alloc_zeroed(mesh->vertex_count, 1);
    if (!c->corner || !c->first || !c->next || !c->vertex || !c->paint || !c->flat)
        return false;
    memset(c->first, 0xff, mesh->vertex_count * sizeof *c->first);
    for (size_t i = 0; i < corners; i++)
        c->flat[mesh->triangles[i]] |= (defects[i / 3] & CW_DEFECT_DEGENERATE) != 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const int paint = paint_of(defects[t] | flat_beside(c, mesh->triangles + 3 * t));
        for (size_t n = 3 * t; n < 3 * t + 3; n++)
            c->corner[n] = copy_of(c, mesh->triangles[n], paint);
    }
    return true;
}

static void free_copies(copies *c)
{
    cwi_free(c->corner);
    cwi_free(c->first);
    cwi_free(c->next);
    cwi_free(c->vertex);
    cwi_free(c->paint);
    cwi_free(c->flat);
}

/* From grey through yellow to red. */
static void color_of(double fraction, uint8_t rgb[3])
{
    static const double stops[3][3] = {{200, 200, 200}, {255, 220, 60}, {200, 0, 0}};
    const double at = 2 * fmin(fmax(fraction, 0), 1);
    const int stop = at >= 1;
    for (int a = 0; a < 3; a++)
        rgb[a] = (uint8_t)(stops[stop][a] +
                           (at - stop) * (stops[stop + 1][a] - stops[stop][a]) + 0.5);
}

static void fill_vertices(const copies *c, const cw_mesh *mesh, const float *distances,
                          double full_mm, cw_mesh *out)
{
    for (size_t n = 0; n < c->count; n++) {
        const size_t v = c->vertex[n];
        const double distance = distances ? fabs((double)distances[v]) : 0;
        memcpy(out->positions + 3 * n, mesh->positions + 3 * v, 3 * sizeof(float));
        if (out->normals)
            memcpy(out->normals + 3 * n, mesh->normals + 3 * v, 3 * sizeof(float));
        if (out->scalars)
            out->scalars[n] = distances[v];
        if (c->paint[n] < PAINTS)
            memcpy(out->colors + 4 * n, paints[c->paint[n]].rgb, 3);
        else
            color_of(full_mm > 0 ? distance / full_mm : 0, out->colors + 4 * n);
        out->colors[4 * n + 3] = 255;
    }
}

static cw_status fill_copies(const copies *c, const cw_mesh *mesh, const float *distances,
                             double full_mm, cw_mesh *out, cw_error *err)
{
    cw_status st =
        cwi_mesh_alloc(out, c->count, mesh->triangle_count, mesh->normals != NULL, err);
    if (st != CW_OK)
        return st;
    memcpy(out->triangles, c->corner, 3 * mesh->triangle_count * sizeof *c->corner);
    memcpy(out->origin, mesh->origin, sizeof out->origin);
    memcpy(out->affine, mesh->affine, sizeof out->affine);
    out->colors = cwi_alloc_array(c->count, 4);
    out->scalars = distances ? cwi_alloc_array(c->count, sizeof(float)) : NULL;
    if (!out->colors || (distances && !out->scalars))
        return cwi_fail_memory(err);
    fill_vertices(c, mesh, distances, full_mm, out);
    return CW_OK;
}

cw_status cw_check_paint(const cw_mesh *mesh, const uint8_t *defects, const float *distances,
                         double full_mm, cw_mesh *out, cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    copies c = {0};
    *out = (cw_mesh){0};
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && mesh->triangle_count > CWI_MAX_TRIANGLES)
        st = cwi_fail(err, CW_ERR_LIMIT, "%zu triangles are too many to paint",
                      mesh->triangle_count);
    if (st == CW_OK && !make_copies(&c, mesh, defects))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = fill_copies(&c, mesh, distances, full_mm, out, err);
    free_copies(&c);
    if (st != CW_OK)
        cw_mesh_free(out);
    return st;
}
