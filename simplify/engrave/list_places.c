/* Lists places for text: middles of plane faces, and points spread evenly over the surface. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/engrave/engrave_state.h"

#include <stdlib.h>
#include <string.h>

/* Plane faces and points that are looked at, at most. */
enum { MAX_FACES = 48, POINTS = 500, MIDDLES = 6 };

/* Steps of normals, for 1, and of distances along them, for the diagonal. Triangles in the same steps are of a face. */
static const double NORMAL_STEPS = 32, DISTANCE_STEPS = 500;

/* Triangles with the same plane, summed by their areas. */
typedef struct plane_face {
    int32_t key[4];
    double area, center[3], normal[3];
    double moment[6]; /* xx, yy, zz, xy, yz, zx */
} plane_face;

typedef struct face_table {
    plane_face *faces;
    size_t capacity; /* a power of 2 */
} face_table;

static plane_face *find_face(face_table *table, const int32_t key[4])
{
    uint64_t hash = 0;
    for (int n = 0; n < 4; n++)
        hash = (hash ^ (uint32_t)key[n]) * 0x9e3779b97f4a7c15u;
    for (size_t slot = hash >> 20;; slot++) {
        plane_face *face = &table->faces[slot & (table->capacity - 1)];
        if (face->area == 0)
            memcpy(face->key, key, sizeof face->key);
        if (memcmp(face->key, key, sizeof face->key) == 0)
            return face;
    }
}

/* Adds all triangles to faces. shift: of the steps, so that a face between two of them is whole in one pass of two */
static void add_triangles(face_table *table, const cwi_ray_target *target, double shift)
{
    static const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
    for (size_t t = 0; t < target->mesh->triangle_count; t++) {
        double p[3][3], normal[3], middle[3];
        int32_t key[4];
        cwi_mesh_corners(target->mesh, t, p);
        cwi_triangle_normal(p[0], p[1], p[2], normal);
        const double area = cwi_length(normal) / 2;
        if (!(area > 0) || !cwi_normalise(normal))
            continue;
        cwi_triangle_centroid(p[0], p[1], p[2], middle);
        const double distance =
            cwi_dot(normal, middle) / target->diagonal; /* far from 0 it overflows no step */
        for (int a = 0; a < 3; a++)
            key[a] = (int32_t)floor(normal[a] * NORMAL_STEPS + 0.5 + shift);
        key[3] = (int32_t)fmin(fmax(floor(distance * DISTANCE_STEPS + shift), -2e9), 2e9);
        plane_face *face = find_face(table, key);
        face->area += area;
        for (int a = 0; a < 3; a++) {
            face->center[a] += area * middle[a];
            face->normal[a] += area * normal[a];
        }
        for (int m = 0; m < 6; m++) {
            const int i = pairs[m][0], j = pairs[m][1];
            face->moment[m] += area / 12 * 9 * middle[i] * middle[j];
            for (int c = 0; c < 3; c++)
                face->moment[m] += area / 12 * p[c][i] * p[c][j];
        }
    }
}

/* Orders faces by their areas, largest first, and equal ones by their planes. */
static int compare_faces(const void *a, const void *b)
{
    const plane_face *f = a, *g = b;
    if (f->area != g->area)
        return f->area > g->area ? -1 : 1;
    for (int n = 0; n < 4; n++)
        if (f->key[n] != g->key[n])
            return f->key[n] < g->key[n] ? -1 : 1;
    return 0;
}

/* Finds the longer side of a face: the direction in which its area spreads most. Reads from left to right, or from the
 * front to the back. Returns false for faces about as wide as long. */
static bool find_long_side(const plane_face *face, const double normal[3], double side[3])
{
    static const int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    double spread[3][3], v[3] = {1, 0.37, 0.11}, w[3], across[3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            spread[r][c] = face->moment[at[r][c]] / face->area -
                           face->center[r] * face->center[c] / (face->area * face->area);
    for (int n = 0; n < 60; n++) { /* the power method */
        for (int r = 0; r < 3; r++)
            w[r] = cwi_dot(spread[r], v);
        cwi_add_scaled(w, -cwi_dot(w, normal), normal, w);
        memcpy(v, w, sizeof v);
        if (!cwi_normalise(v))
            return false;
    }
    cwi_cross(normal, v, across);
    double along_sq = 0, across_sq = 0;
    for (int r = 0; r < 3; r++) {
        along_sq += v[r] * cwi_dot(spread[r], v);
        across_sq += across[r] * cwi_dot(spread[r], across);
    }
    const bool is_backward = fabs(v[0]) > 0.01 ? v[0] < 0 : v[1] < 0;
    for (int a = 0; a < 3; a++)
        side[a] = is_backward ? -v[a] : v[a];
    return along_sq > 1.5 * across_sq;
}

/* Adds a place, upright; where it lies flat, with two or three directions of reading. */
static void add_places(cwi_text_place *places, size_t *count, const double center[3],
                       const double normal[3], double area, const plane_face *face)
{
    double hints[3][3] = {{1, 0, 0}, {0, 1, 0}};
    const int more = face && find_long_side(face, normal, hints[2]);
    if (more) {
        double swap[3];
        memcpy(swap, hints[0], sizeof swap);
        memcpy(hints[0], hints[2], sizeof swap);
        memcpy(hints[2], swap, sizeof swap);
    }
    const int number = fabs(normal[2]) > 0.85 ? 2 + more : 1;
    for (int n = 0; n < number; n++) {
        cwi_text_place *p = &places[(*count)++];
        *p = (cwi_text_place){.area = area};
        memcpy(p->center, center, sizeof p->center);
        memcpy(p->normal, normal, sizeof p->normal);
        memcpy(p->hint, hints[n], sizeof p->hint);
        cwi_set_frame(p);
    }
}

static cw_status add_faces(const cwi_ray_target *target, double shift, cwi_text_place *places,
                           size_t *count, cw_error *err)
{
    face_table table = {.capacity = 16};
    while (table.capacity < 2 * target->mesh->triangle_count)
        table.capacity *= 2;
    table.faces = cwi_alloc_zeroed(table.capacity, sizeof *table.faces);
    if (!table.faces)
        return cwi_fail_memory(err);
    add_triangles(&table, target, shift);
    size_t used = 0;
    for (size_t n = 0; n < table.capacity; n++)
        if (table.faces[n].area > 0)
            table.faces[used++] = table.faces[n];
    qsort(table.faces, used, sizeof *table.faces, compare_faces);
    for (size_t n = 0; n < used && n < MAX_FACES; n++) {
        plane_face *face = &table.faces[n];
        double center[3], normal[3];
        for (int a = 0; a < 3; a++) {
            center[a] = face->center[a] / face->area;
            normal[a] = face->normal[a];
        }
        if (cwi_normalise(normal))
            add_places(places, count, center, normal, face->area, face);
    }
    cwi_free(table.faces);
    return CW_OK;
}

/* Adds a point for each equal part of the area. */
static void add_points(const cwi_ray_target *target, cwi_text_place *places, size_t *count)
{
    double whole = 0, sum = 0;
    for (size_t t = 0; t < target->mesh->triangle_count; t++)
        whole += cwi_mesh_area(target->mesh, t);
    size_t next = 0;
    for (size_t t = 0; t < target->mesh->triangle_count && next < POINTS; t++) {
        sum += cwi_mesh_area(target->mesh, t);
        for (; next < POINTS && ((double)next + 0.5) * whole <= sum * POINTS; next++) {
            double p[3][3], normal[3], center[3];
            cwi_mesh_corners(target->mesh, t, p);
            cwi_triangle_normal(p[0], p[1], p[2], normal);
            if (!cwi_normalise(normal))
                continue;
            double u = fmod(0.5 + (double)next * 0.7548776662466927, 1); /* spread evenly */
            double v = fmod(0.5 + (double)next * 0.5698402909980532, 1);
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            for (int a = 0; a < 3; a++)
                center[a] = p[0][a] + u * (p[1][a] - p[0][a]) + v * (p[2][a] - p[0][a]);
            add_places(places, count, center, normal, 0, NULL);
        }
    }
}

/* Adds the points of the surface that are before the middle of the box: along a direction, or along the axes, from the
 * front first. */
static void add_middles(const cwi_ray_target *target, const double *direction,
                        cwi_text_place *places, size_t *count)
{
    static const double axes[MIDDLES][3] = {{0, -1, 0}, {1, 0, 0}, {-1, 0, 0},
                                            {0, 1, 0},  {0, 0, 1}, {0, 0, -1}};
    for (int n = 0; n < (direction ? 1 : MIDDLES); n++) {
        double height, lean;
        cwi_text_place p = {.hint = {1, 0, 0}};
        memcpy(p.normal, direction ? direction : axes[n], sizeof p.normal);
        cwi_add_scaled(target->middle, target->diagonal, p.normal, p.center);
        cwi_set_frame(&p);
        if (!cwi_find_height(target, &p, 0, 0, 2 * target->diagonal, &height, &lean))
            continue;
        cwi_add_scaled(p.center, height, p.normal, p.center);
        add_places(places, count, p.center, p.normal, 0, NULL);
    }
}

cw_status cwi_list_places(const cwi_ray_target *target, const double *direction,
                          cwi_text_place **places, size_t *count, cw_error *err)
{
    *count = 0;
    *places = cwi_alloc_array(2 * 3 * MAX_FACES + 2 * (POINTS + MIDDLES), sizeof **places);
    if (!*places)
        return cwi_fail_memory(err);
    add_middles(target, direction, *places, count);
    cw_status st = add_faces(target, 0, *places, count, err);
    if (st == CW_OK)
        st = add_faces(target, 0.5, *places, count, err);
    if (st == CW_OK)
        add_points(target, *places, count);
    return st;
}
