/* Welds vertices, and drops marked triangles and components that are small in diagonal or
 * volume. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/components.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/weld.h"

#include <cubewright/atlas.h>
#include <cubewright/mesh.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Leaves out the vertices that no triangle names; number has room for all. */
static void drop_unused(cw_mesh *m, uint32_t *number)
{
    uint32_t count = 0;
    memset(number, 0xff, m->vertex_count * sizeof *number);
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        number[m->triangles[c]] = 0;
    for (size_t v = 0; v < m->vertex_count; v++)
        if (number[v] == 0)
            number[v] = count++;
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        m->triangles[c] = number[m->triangles[c]];
    cwi_mesh_move_vertices(m, number, count);
}

cw_status cwi_mesh_drop_marked(cw_mesh *mesh, const bool *marked, cw_error *err)
{
    uint32_t *number = cwi_alloc_array(mesh->vertex_count, sizeof *number);
    size_t kept = 0;
    if (!number)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (!marked[t])
            cwi_mesh_move_triangle(mesh, t, kept++);
    mesh->triangle_count = kept;
    drop_unused(mesh, number);
    cwi_free(number);
    return CW_OK;
}

/* Gives each corner the texture coordinate of its vertex, if there is one: vertices at one position, split
 * along a seam, have several. */
static cw_status move_texture_to_corners(cw_mesh *mesh, cw_error *err)
{
    cw_attribute *uv = cw_mesh_attribute_find(mesh, CW_TEXTURE_COORDINATES);
    if (!uv || uv->on != CW_ON_VERTICES)
        return CW_OK;
    const size_t bytes = cwi_attribute_bytes(uv);
    char *moved = cwi_alloc_array(3 * mesh->triangle_count, bytes);
    if (!moved)
        return cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
        memcpy(moved + bytes * c, (const char *)uv->data + bytes * mesh->triangles[c], bytes);
    cwi_free(uv->data);
    uv->data = moved;
    uv->on = CW_ON_CORNERS;
    return CW_OK;
}

cw_status cw_mesh_weld(cw_mesh *mesh, size_t *merged, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cw_status st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return st;
    uint32_t *map = cwi_alloc_array(mesh->vertex_count, sizeof *map);
    if (!map || !cwi_weld(mesh->positions, mesh->vertex_count, map)) {
        cwi_free(map);
        return cwi_fail_memory(err);
    }
    size_t count = 0, kept = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        count += map[v] != v;
    st = count ? move_texture_to_corners(mesh, err) : CW_OK;
    if (st != CW_OK) {
        cwi_free(map);
        return st;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t *c = mesh->triangles + 3 * t;
        for (int k = 0; k < 3; k++)
            c[k] = map[c[k]];
        if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0])
            cwi_mesh_move_triangle(mesh, t, kept++);
    }
    mesh->triangle_count = kept;
    drop_unused(mesh, map);
    cwi_free(map);
    if (merged)
        *merged = count;
    return CW_OK;
}

/* --- components -------------------------------------------------------------------------- */

/* Returns the volume of a set, or the diagonal of its box. */
static double measure_set(const cwi_components *c, size_t set)
{
    const float *box = c->boxes[set];
    double length_sq = 0;
    if (c->sums)
        return cwi_volume_mm3(&c->unit, c->sums[set]);
    for (int a = 0; a < 3; a++) {
        const double side = (double)box[3 + a] - (double)box[a];
        length_sq += side * side;
    }
    return sqrt(length_sq);
}

static void count_component(cw_drop_counts *n, double size, bool keep)
{
    if (keep) {
        n->least_kept_mm3 = n->kept ? fmin(n->least_kept_mm3, size) : size;
        n->kept++;
        return;
    }
    n->dropped++;
    n->largest_mm3 = fmax(n->largest_mm3, size);
}

static void drop_components(cw_mesh *mesh, cwi_components *c, cw_drop_counts *counts)
{
    size_t triangles = 0;
    cwi_volume_sum dropped = 0;
    *counts = (cw_drop_counts){0};
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        const uint32_t set = c->set[corners[0]];
        const bool keep = !c->dropped[set];
        if (!c->met[set]) {
            count_component(counts, measure_set(c, set), keep);
            counts->cavities += !keep && c->cavity && c->cavity[set];
            dropped += keep || !c->sums ? 0 : c->sums[set];
        }
        c->met[set] = true;
        counts->triangles += !keep;
        if (keep)
            cwi_mesh_move_triangle(mesh, t, triangles++);
    }
    if (c->sums)
        counts->dropped_mm3 = cwi_volume_mm3(&c->unit, dropped);
    mesh->triangle_count = triangles;
    drop_unused(mesh, c->set);
}

static cw_status drop_smaller(cw_mesh *mesh, double min_value, bool by_volume,
                              cw_drop_counts *counts, cw_error *err)
{
    cwi_components c = {0};
    cw_status st = cwi_components_find(mesh, NULL, &c, err);
    if (st == CW_OK && by_volume)
        st = cwi_components_measure(mesh, &c, err);
    if (st == CW_OK) {
        for (size_t n = 0; n < c.count; n++)
            c.dropped[n] = !(measure_set(&c, n) >= min_value);
        drop_components(mesh, &c, counts);
    }
    cwi_components_free(&c);
    return st;
}

cw_status cw_mesh_drop_components(cw_mesh *mesh, double diagonal_mm, size_t *dropped,
                                  size_t *kept, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cw_drop_counts counts;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && !(diagonal_mm >= 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "diagonal_mm is %g; it must be 0 or more",
                      diagonal_mm);
    if (st == CW_OK)
        st = drop_smaller(mesh, diagonal_mm, false, &counts, err);
    if (st == CW_OK && dropped)
        *dropped = counts.dropped;
    if (st == CW_OK && kept)
        *kept = counts.kept;
    return st;
}

cw_status cw_mesh_drop_volumes(cw_mesh *mesh, double least_mm3, cw_drop_counts *counts,
                               cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cw_drop_counts own;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && !(least_mm3 >= 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "least_mm3 is %g; it must be 0 or more", least_mm3);
    return st == CW_OK ? drop_smaller(mesh, least_mm3, true, counts ? counts : &own, err) : st;
}

/* A component and its volume. */
typedef struct ranked_set {
    cwi_volume_sum volume;
    size_t set;
} ranked_set;

/* Larger volumes come first, and of equal ones that with the first vertex. */
static int compare_ranks(const void *a, const void *b)
{
    const ranked_set *x = a, *y = b;
    return x->volume != y->volume ? (x->volume < y->volume ? 1 : -1)
                                  : (x->set > y->set) - (x->set < y->set);
}

/* Marks all components but the largest. */
static cw_status mark_smaller(const cw_mesh *mesh, cwi_components *c, size_t kept,
                              cw_error *err)
{
    size_t count = 0;
    ranked_set *ranks = cwi_alloc_array(c->count, sizeof *ranks);
    if (!ranks)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t set = c->set[mesh->triangles[3 * t]];
        if (!c->dropped[set])
            ranks[count++] = (ranked_set){c->sums[set], set};
        c->dropped[set] = true;
    }
    qsort(ranks, count, sizeof *ranks, compare_ranks);
    for (size_t n = 0; n < count && n < kept; n++)
        c->dropped[ranks[n].set] = false;
    cwi_free(ranks);
    return CW_OK;
}

cw_status cw_mesh_keep_largest(cw_mesh *mesh, size_t count, cw_drop_counts *counts,
                               cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cwi_components c = {0};
    cw_drop_counts own;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && count < 1)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "count is 0; 1 or more was expected");
    if (st == CW_OK)
        st = cwi_components_find(mesh, NULL, &c, err);
    if (st == CW_OK)
        st = cwi_components_measure(mesh, &c, err);
    if (st == CW_OK)
        st = mark_smaller(mesh, &c, count, err);
    if (st == CW_OK)
        drop_components(mesh, &c, counts ? counts : &own);
    cwi_components_free(&c);
    return st;
}

cw_status cw_mesh_drop_distant(cw_mesh *mesh, const float *distance_mm, double limit_mm,
                               cw_drop_counts *counts, double *farthest_mm, cw_error *err)
{
    CWI_REQUIRE(err, mesh, distance_mm);
    cwi_components c = {0};
    cw_drop_counts own;
    double farthest = 0;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && !(limit_mm >= 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "limit_mm is %g; it must be 0 or more", limit_mm);
    if (st == CW_OK)
        st = cwi_components_find(mesh, NULL, &c, err);
    if (st == CW_OK)
        st = cwi_components_measure(mesh, &c, err);
    if (st == CW_OK) {
        memset(c.dropped, true, c.count * sizeof *c.dropped);
        for (uint32_t v = 0; v < mesh->vertex_count; v++)
            if ((double)distance_mm[v] <= limit_mm)
                c.dropped[c.set[v]] = false;
        for (size_t n = 0; n < 3 * mesh->triangle_count; n++) {
            const uint32_t v = mesh->triangles[n];
            if (c.dropped[c.set[v]])
                farthest = fmax(farthest, (double)distance_mm[v]);
        }
        drop_components(mesh, &c, counts ? counts : &own);
    }
    if (st == CW_OK && farthest_mm)
        *farthest_mm = farthest;
    cwi_components_free(&c);
    return st;
}
