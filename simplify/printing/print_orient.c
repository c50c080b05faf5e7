/* Finds the orientation that prints with the least support: directions by a histogram of normals, then poses at
 * rest, measured exactly. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/printing/pose_search.h"
#include "simplify/printing/print_limits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Directions that are compared; those from which the mesh rolls, besides the normals of flat parts; poses that are
 * measured. */
enum { DIRECTIONS = 10000, STARTS = 96, FLAT_STARTS = 64, AXES = 6, POSES = 32, CHUNK = 100 };

enum { CUBE_EDGE = 24, BINS = 6 * CUBE_EDGE * CUBE_EDGE };

/* Areas and heights that differ by less than this fraction count as equal. */
static const double EQUAL = 1e-3;

/* --- the histogram ------------------------------------------------------------------------ */

static size_t find_bin(const double n[3])
{
    const int a = cwi_longest_axis(n);
    size_t cell[2];
    for (int k = 0; k < 2; k++) {
        const double at = (n[(a + 1 + k) % 3] / fabs(n[a]) + 1) / 2 * CUBE_EDGE;
        cell[k] = at < CUBE_EDGE ? (size_t)at : CUBE_EDGE - 1;
    }
    return ((size_t)(2 * a + (n[a] < 0)) * CUBE_EDGE + cell[1]) * CUBE_EDGE + cell[0];
}

/* Adds up normals, the volume and its centre. */
static void sum_normals(cwi_pose_search *s, const double from[3], double *volume,
                        double moment[3])
{
    for (size_t t = 0; t < s->mesh->triangle_count; t++) {
        double corner[3][3], normal[3], p[3][3];
        cwi_mesh_corners(s->mesh, t, corner);
        cwi_mesh_normal(s->mesh, t, normal);
        for (int n = 0; n < 9; n++)
            p[n / 3][n % 3] = corner[n / 3][n % 3] - from[n % 3];
        const double part = cwi_dot(p[0], normal) / 6, length = cwi_length(normal);
        *volume += part;
        for (int a = 0; a < 3; a++)
            moment[a] += part * (p[0][a] + p[1][a] + p[2][a]) / 4;
        if (!(length > 0))
            continue;
        cwi_normal_bin *bin = &s->bins[find_bin(normal)];
        bin->area += length / 2;
        for (int a = 0; a < 3; a++)
            bin->normal[a] += normal[a];
        s->area += length / 2;
    }
}

static cw_status make_histogram(cwi_pose_search *s, cw_error *err)
{
    double low[3], high[3], middle[3], volume = 0, moment[3] = {0};
    s->bins = cwi_alloc_zeroed(BINS, sizeof *s->bins);
    if (!s->bins)
        return cwi_fail_memory(err);
    cwi_box_clear(low, high);
    for (size_t c = 0; c < 3 * s->mesh->triangle_count; c++)
        cwi_box_add_points(low, high, s->mesh->positions + 3 * (size_t)s->mesh->triangles[c],
                           1);
    cwi_midpoint(low, high, middle);
    s->diagonal = cwi_distance(low, high);
    sum_normals(s, middle, &volume, moment);
    for (int a = 0; a < 3; a++)
        s->body.center[a] = middle[a] + (volume > 0 ? moment[a] / volume : 0);
    for (size_t n = 0; n < BINS; n++)
        if (cwi_normalise(s->bins[n].normal))
            s->bins[s->bin_count++] = s->bins[n];
    return CW_OK;
}

/* Estimates the area of overhangs, without what faces straight down, if flat parts are assumed to stand on the
 * plate. */
static double estimate_overhang(const cwi_pose_search *s, const double down[3], bool stands)
{
    const double flat = 0.9986; /* the cosine of 3 degrees */
    double sum = 0;
    for (size_t n = 0; n < s->bin_count; n++) {
        const double along = cwi_dot(s->bins[n].normal, down);
        if (along > s->steep && !(stands && along > flat))
            sum += s->bins[n].area;
    }
    return sum;
}

static void estimate_chunk(void *context, size_t chunk)
{
    cwi_pose_search *s = context;
    const double golden = CWI_PI * (3 - sqrt(5));
    for (size_t n = chunk * CHUNK; n < (chunk + 1) * CHUNK; n++) {
        cwi_pose *c = &s->directions[n];
        const double z = 1 - (2 * (double)n + 1) / DIRECTIONS, r = sqrt(1 - z * z);
        c->down[0] = r * cos(golden * (double)n);
        c->down[1] = r * sin(golden * (double)n);
        c->down[2] = z;
        c->overhang = estimate_overhang(s, c->down, false);
    }
}

/* --- starts and poses --------------------------------------------------------------------- */

static int compare_candidates(const void *a, const void *b)
{
    const cwi_pose *p = a, *q = b;
    if (p->overhang != q->overhang)
        return p->overhang < q->overhang ? -1 : 1;
    return memcmp(p->down, q->down, sizeof p->down);
}

static int compare_bins(const void *a, const void *b)
{
    const cwi_normal_bin *p = a, *q = b;
    if (p->area != q->area)
        return p->area > q->area ? -1 : 1;
    return memcmp(p->normal, q->normal, sizeof p->normal);
}

static bool is_near(const cwi_pose *list, size_t count, const double down[3], double cosine)
{
    for (size_t n = 0; n < count; n++)
        if (cwi_dot(list[n].down, down) > cosine)
            return true;
    return false;
}

static void add_start(cwi_pose_search *s, const double down[3])
{
    memcpy(s->poses[s->pose_count++].down, down, sizeof s->poses->down);
}

/* Lists where the mesh begins to roll: the best directions, 8 degrees apart, flat parts, the axes. */
static void list_starts(cwi_pose_search *s)
{
    const double apart = 0.9903; /* the cosine of 8 degrees */
    qsort(s->directions, DIRECTIONS, sizeof *s->directions, compare_candidates);
    for (size_t n = 0; n < DIRECTIONS && s->pose_count < STARTS; n++)
        if (!is_near(s->poses, s->pose_count, s->directions[n].down, apart))
            add_start(s, s->directions[n].down);
    qsort(s->bins, s->bin_count, sizeof *s->bins, compare_bins);
    for (size_t n = 0; n < s->bin_count && n < FLAT_STARTS; n++)
        add_start(s, s->bins[n].normal);
    for (int n = 0; n < AXES; n++) {
        double down[3] = {0};
        down[n / 2] = n % 2 ? 1 : -1;
        add_start(s, down);
    }
}

typedef struct rolling {
    cwi_pose_search *s;
    const cwi_rest_body *body;
} rolling;

static void roll_one(void *context, size_t n)
{
    rolling *r = context;
    if (!cwi_roll_to_rest(r->body, r->s->poses[n].down))
        cwi_set_flag(&r->s->no_memory);
}

static void roll_all(cwi_pose_search *s, const cwi_rest_body *body)
{
    rolling r = {s, body};
    cwi_parallel_for_all(s->pose_count, body->count, s->limits.threads, roll_one, &r);
}

/* Keeps poses that differ by half a degree, the best by their estimate. */
static void keep_best_poses(cwi_pose_search *s, size_t max)
{
    size_t kept = 0;
    for (size_t n = 0; n < s->pose_count; n++)
        s->poses[n].overhang = estimate_overhang(s, s->poses[n].down, true);
    qsort(s->poses, s->pose_count, sizeof *s->poses, compare_candidates);
    for (size_t n = 0; n < s->pose_count && kept < max; n++)
        if (!is_near(s->poses, kept, s->poses[n].down, 0.99996))
            s->poses[kept++] = s->poses[n];
    s->pose_count = kept;
}

/* --- choosing ----------------------------------------------------------------------------- */

/* Returns true if a pose is better than another one. */
static bool is_better(const cwi_pose_search *s, const cwi_pose *a, const cwi_pose *b)
{
    const bool stable[2] = {a->stand.tip_deg >= CW_MIN_TIP_DEG,
                            b->stand.tip_deg >= CW_MIN_TIP_DEG};
    if (stable[0] != stable[1])
        return stable[0];
    if (a->fits != b->fits)
        return a->fits;
    if (!stable[0])
        return a->stand.tip_deg > b->stand.tip_deg * (1 + EQUAL);
    const double area = EQUAL * s->area, length = EQUAL * s->diagonal;
    const double overhang =
                     rint(a->stand.overhang_mm2 / area) - rint(b->stand.overhang_mm2 / area),
                 height = rint(a->stand.height_mm / length) - rint(b->stand.height_mm / length);
    if (overhang != 0)
        return overhang < 0;
    if (height != 0)
        return height < 0;
    return a->stand.hull_mm2 > b->stand.hull_mm2 * (1 + EQUAL);
}

/* Returns true if a pose is better than the present one by more than what counts as equal. */
static bool is_worth_turning(const cwi_pose_search *s, const cwi_pose *a, const cwi_pose *now)
{
    const bool stands = now->stand.tip_deg >= CW_MIN_TIP_DEG;
    if (a->stand.tip_deg < CW_MIN_TIP_DEG && a->fits == now->fits)
        return a->stand.tip_deg > now->stand.tip_deg + 1; /* neither stands */
    if (!stands || a->fits != now->fits)
        return is_better(s, a, now);
    const double overhang = now->stand.overhang_mm2 - a->stand.overhang_mm2,
                 height = now->stand.height_mm - a->stand.height_mm;
    if (fabs(overhang) > EQUAL * s->area)
        return overhang > 0;
    if (fabs(height) > EQUAL * s->diagonal)
        return height > 0;
    return a->stand.hull_mm2 > now->stand.hull_mm2 * (1 + 10 * EQUAL);
}

/* --- the call ----------------------------------------------------------------------------- */

static cw_status find_poses(cwi_pose_search *s, cw_error *err)
{
    cwi_rest_body few = {0};
    s->directions = cwi_alloc_zeroed(DIRECTIONS, sizeof *s->directions);
    s->poses = cwi_alloc_zeroed(STARTS + FLAT_STARTS + AXES + 1, sizeof *s->poses);
    cw_status st = s->directions && s->poses ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_rest_body_thin(&s->body, &few, err);
    if (st == CW_OK)
        st = cwi_rest_body_drop_inner(&few, 0, err);
    if (st == CW_OK)
        st = cwi_rest_body_drop_inner(&s->body, s->limits.layer_mm, err);
    if (st == CW_OK) {
        cwi_parallel_for_all(DIRECTIONS / CHUNK, CHUNK * s->bin_count, s->limits.threads,
                             estimate_chunk, s);
        list_starts(s);
        roll_all(s, &few);
        keep_best_poses(s, POSES);
        roll_all(s, &s->body);
        keep_best_poses(s, POSES);
    }
    cwi_rest_body_free(&few);
    return st;
}

/* Measures the poses, and the present one first. */
static void choose_pose(cwi_pose_search *s, cw_orient_facts *facts)
{
    size_t best = 0;
    for (size_t n = s->pose_count; n > 0; n--)
        s->poses[n] = s->poses[n - 1];
    s->pose_count++;
    memcpy(s->poses[0].down, (const double[3]){0, 0, -1}, sizeof s->poses[0].down);
    cwi_measure_poses(s);
    for (size_t n = 0; n < s->pose_count; n++) {
        facts->unstable += s->poses[n].stand.tip_deg < CW_MIN_TIP_DEG;
        if (is_better(s, &s->poses[n], &s->poses[best]))
            best = n;
    }
    if (!is_worth_turning(s, &s->poses[best], &s->poses[0]))
        best = 0;
    facts->directions = DIRECTIONS;
    facts->poses = s->pose_count;
    facts->before = s->poses[0].stand;
    facts->after = s->poses[best].stand;
    facts->is_kept = best == 0;
    facts->is_stable = facts->after.tip_deg >= CW_MIN_TIP_DEG;
    cwi_turn_down(s->poses[best].down, facts->matrix);
}

/* Lets the matrix turn the mesh about the middle of its box. */
static void turn_about_middle(const cw_mesh *mesh, double m[12])
{
    double low[3], high[3], middle[3];
    if (!cw_mesh_bounds(mesh, low, high))
        return;
    cwi_midpoint(low, high, middle);
    for (int a = 0; a < 3; a++)
        m[4 * a + 3] = middle[a] - cwi_dot(m + 4 * a, middle);
}

cw_status cw_orient_print(const cw_mesh *mesh, const cw_print_desc *desc,
                          cw_orient_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, facts);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_pose_search s = {.mesh = mesh};
    *facts = (cw_orient_facts){0};
    cw_status st = cwi_print_limits(desc, &s.limits, err);
    if (st == CW_OK)
        st = cwi_mesh_check_size(mesh, "oriented", err);
    if (st == CW_OK && !mesh->triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY, "the mesh has no triangles");
    if (st == CW_OK)
        st = cwi_rest_body_make(mesh, &s.body, err);
    if (st == CW_OK)
        st = make_histogram(&s, err);
    if (st == CW_OK) {
        s.steep = sin(s.limits.overhang_deg * CWI_PI / 180);
        st = find_poses(&s, err);
    }
    if (st == CW_OK)
        choose_pose(&s, facts);
    if (st == CW_OK && s.no_memory)
        st = cwi_fail_memory(err);
    if (st == CW_OK && !facts->is_kept)
        turn_about_middle(mesh, facts->matrix);
    cwi_rest_body_free(&s.body);
    cwi_free(s.bins);
    cwi_free(s.directions);
    cwi_free(s.poses);
    return st;
}
