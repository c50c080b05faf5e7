/* Smooths a mesh: its vertices move by one of the methods. Then they go back into a ball around
 * their first position, and components get their volumes back. */
#include "simplify/smoothing/mesh_smooth.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"

#include <float.h>
#include <string.h>

enum { DEFAULT_ITERATIONS = 10, DEFAULT_STEPS = 3, VOLUME_ROUNDS = 4, ROUNDING_STEPS = 8 };

/* The default limit and width, in mean lengths of the edges. */
static const double DEFAULT_MOVE = 0.5, DEFAULT_WIDTH = 6;

/* Shares of the progress: neighbours, moves, and the search for triangles that meet. */
static const double RINGS_FRACTION = 0.1, MOVES_FRACTION = 0.5;

const char *cw_smooth_method_name(cw_smooth_method method)
{
    static const char *const names[] = {"taubin", "hc", "fair"};
    return (size_t)method < CW_SMOOTH_METHOD_COUNT ? names[method] : NULL;
}

static double measure_move(const float *position, const float *first)
{
    return sqrt(cwi_point_distance_sq(position, first));
}

/* Returns the mean over triangles of the mean length of their sides. */
static double mean_edge(const cw_mesh *mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (size_t c = 0; c < 3; c++)
            sum +=
                measure_move(cwi_mesh_point(mesh, t, c), cwi_mesh_point(mesh, t, (c + 1) % 3));
    return mesh->triangle_count ? sum / (3 * (double)mesh->triangle_count) : 0;
}

static cw_status resolve_desc(const cw_mesh *mesh, const cw_smooth_desc *desc,
                              cw_smooth_desc *out, cw_error *err)
{
    *out = desc ? *desc : (cw_smooth_desc){0};
    if (!cw_smooth_method_name(out->method))
        return cwi_fail(err, CW_ERR_ARGUMENT, "method is %d; it must be 0 to %d",
                        (int)out->method, CW_SMOOTH_METHOD_COUNT - 1);
    if (out->iterations > CW_SMOOTH_MAX_ITERATIONS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "iterations is %zu; it must be at most %zu",
                        out->iterations, CW_SMOOTH_MAX_ITERATIONS);
    if (!(out->max_move_mm >= 0) || !isfinite(out->max_move_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "max_move_mm is %g; it must be finite, and 0 or more",
                        out->max_move_mm);
    if (!(out->width_mm >= 0) || !isfinite(out->width_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "width_mm is %g; it must be finite, and 0 or more", out->width_mm);
    if (out->width_mm > 0 && out->method != CW_SMOOTH_FAIR)
        return cwi_fail(err, CW_ERR_ARGUMENT, "width_mm is for CW_SMOOTH_FAIR, not for %s",
                        cw_smooth_method_name(out->method));
    cw_status st = cwi_mesh_check_size(mesh, "smoothed", err);
    if (st != CW_OK)
        return st;
    if (out->iterations == 0)
        out->iterations = out->method == CW_SMOOTH_FAIR ? DEFAULT_STEPS : DEFAULT_ITERATIONS;
    if (out->max_move_mm == 0)
        out->max_move_mm = DEFAULT_MOVE * mean_edge(mesh);
    if (out->width_mm == 0)
        out->width_mm = DEFAULT_WIDTH * mean_edge(mesh);
    return CW_OK;
}

static cw_status alloc_positions(cwi_smoother *s, cw_error *err)
{
    const size_t numbers = 3 * s->mesh->vertex_count;
    s->from = cwi_alloc_large(numbers, sizeof *s->from);
    s->to = cwi_alloc_large(numbers, sizeof *s->to);
    s->rounded = cwi_alloc_large(numbers, sizeof *s->rounded);
    if (!s->from || !s->to || !s->rounded)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < numbers; n++)
        s->from[n] = (double)s->mesh->positions[n];
    return CW_OK;
}

/* Pulls a position into the ball around its first one. By averages vertices also move along the
 * surface: that part of a move is cut first, as the part along the normal is what removes noise.
 * Fairing hardly moves along the surface, and its moves are cut as they are.
 * normal  of the surface there, or 0 */
static void limit_move(const cwi_smoother *s, size_t v, const double normal[3])
{
    const float *first = s->mesh->positions + 3 * v;
    double *position = s->from + 3 * v, move[3], along[3];
    for (int a = 0; a < 3; a++)
        move[a] = position[a] - (double)first[a];
    if (!(cwi_length(move) > s->limit))
        return;
    double out = s->desc.method == CW_SMOOTH_FAIR ? 0 : cwi_dot(move, normal);
    for (int a = 0; a < 3; a++)
        along[a] = move[a] - out * normal[a];
    const double length = cwi_length(along);
    out = cwi_greater(-s->limit, cwi_lesser(s->limit, out));
    const double left = sqrt(cwi_greater(0, s->limit * s->limit - out * out));
    const double fraction = length > left ? left / length : 1;
    for (int a = 0; a < 3; a++)
        position[a] = (double)first[a] + out * normal[a] + fraction * along[a];
}

/* Pulls all positions into their balls, and moves each component along its normals to its first
 * volume by Newton's method: the gain for a move of 1 mm is the area. Each needs the other again,
 * so both take turns. Moving borders leave no volume to keep. */
static void limit_and_keep_volumes(cwi_smoother *s)
{
    cwi_kept_volumes *volumes = &s->volumes;
    double *gradients = s->to;
    for (int round = 0; round < VOLUME_ROUNDS; round++) {
        cwi_volumes_gradients(volumes, s->from, s->rings.border, gradients);
        for (size_t v = 0; v < s->mesh->vertex_count; v++) {
            const cwi_kept_volume *item = &volumes->items[volumes->component[v]];
            const bool stays = s->rings.border[v] != CWI_BORDER_NONE || item->is_branched ||
                               (item->is_open && s->desc.move_border);
            double *normal = gradients + 3 * v;
            if (!cwi_normalise(normal))
                memset(normal, 0, 3 * sizeof *normal);
            double gain =
                stays || !(item->area > 0) ? 0 : (item->before - item->now) / item->area;
            gain = cwi_greater(-s->limit, cwi_lesser(s->limit, gain));
            for (size_t a = 0; a < 3; a++)
                s->from[3 * v + a] += gain * normal[a];
            limit_move(s, v, normal);
        }
    }
}

/* Rounds positions to single precision. Where that leads out of the ball, the next numbers toward
 * the first position are taken: once or twice, or else the first position itself. */
static void round_places(cwi_smoother *s)
{
    for (size_t v = 0; v < s->mesh->vertex_count; v++) {
        const float *first = s->mesh->positions + 3 * v;
        float *position = s->rounded + 3 * v;
        for (size_t a = 0; a < 3; a++)
            position[a] = (float)s->from[3 * v + a];
        for (int step = 0; !(measure_move(position, first) <= s->limit); step++)
            for (int a = 0; a < 3; a++)
                position[a] =
                    step < ROUNDING_STEPS ? nextafterf(position[a], first[a]) : first[a];
    }
}

static void find_normal(const float *positions, const uint32_t *corners, double normal[3])
{
    cwi_facet_normal(positions + 3 * (size_t)corners[0], positions + 3 * (size_t)corners[1],
                     positions + 3 * (size_t)corners[2], normal);
}

static void count_facts(cwi_smoother *s, cw_smooth_facts *facts)
{
    const cw_mesh *mesh = s->mesh;
    double sum = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double move = measure_move(s->rounded + 3 * v, mesh->positions + 3 * v);
        facts->max_mm = cwi_greater(facts->max_mm, move);
        sum += move;
        facts->border += s->rings.border[v] == CWI_BORDER_OPEN;
        facts->junction += s->rings.border[v] == CWI_BORDER_JUNCTION;
    }
    facts->mean_mm = mesh->vertex_count ? sum / (double)mesh->vertex_count : 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double before[3], after[3];
        find_normal(mesh->positions, mesh->triangles + 3 * t, before);
        find_normal(s->rounded, mesh->triangles + 3 * t, after);
        facts->flipped +=
            cwi_normalise(before) && (!cwi_normalise(after) || !(cwi_dot(before, after) > 0));
    }
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        s->from[n] = (double)s->rounded[n];
    cwi_volumes_measure(&s->volumes, s->from);
    facts->volume_before_mm3 = cwi_volumes_sum(&s->volumes, true);
    facts->volume_after_mm3 = cwi_volumes_sum(&s->volumes, false);
    facts->limit_mm = s->desc.max_move_mm;
    facts->width_mm = s->desc.method == CW_SMOOTH_FAIR ? s->desc.width_mm : 0;
    facts->iterations = s->desc.iterations;
}

/* Finds the new positions, and leaves the mesh as it is. */
static cw_status smooth_positions(cwi_smoother *s, cw_smooth_facts *facts, cw_error *err)
{
    const cwi_part_progress first = {&s->desc.progress, 0, RINGS_FRACTION},
                            moves = {&s->desc.progress, RINGS_FRACTION, MOVES_FRACTION},
                            last = {&s->desc.progress, RINGS_FRACTION + MOVES_FRACTION,
                                    1 - RINGS_FRACTION - MOVES_FRACTION};
    const cw_progress first_progress = cwi_progress_part(&first),
                      moves_progress = cwi_progress_part(&moves),
                      last_progress = cwi_progress_part(&last);
    /* The last digits of a distance depend on how it is computed. */
    s->limit = s->desc.max_move_mm * (1 - 8 * DBL_EPSILON);
    cw_status st = cwi_rings_find(s->mesh, s->desc.threads, &first_progress, &s->rings, err);
    if (st == CW_OK)
        st = alloc_positions(s, err);
    if (st == CW_OK)
        st = cwi_volumes_find(s->mesh, s->rings.border, s->from, &s->volumes, err);
    if (st == CW_OK)
        st = s->desc.method == CW_SMOOTH_FAIR ? cwi_smooth_fair(s, &moves_progress, err)
                                              : cwi_smooth_average(s, &moves_progress, err);
    if (st != CW_OK)
        return st;
    limit_and_keep_volumes(s);
    round_places(s);
    if (!s->desc.allow_crossings)
        st = cwi_smooth_undo_crossings(s, facts, &last_progress, err);
    if (st == CW_OK)
        count_facts(s, facts);
    return st;
}

cw_status cw_mesh_smooth(cw_mesh *mesh, const cw_smooth_desc *desc, cw_smooth_facts *facts,
                         cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_smoother s = {.mesh = mesh};
    cw_smooth_facts found = {0};
    cw_status st = resolve_desc(mesh, desc, &s.desc, err);
    if (st == CW_OK)
        st = smooth_positions(&s, &found, err);
    if (st == CW_OK && mesh->normals) {
        cw_mesh moved = *mesh; /* with the same normals, which are the last thing to fail */
        moved.positions = s.rounded;
        st = cw_mesh_normals(&moved, err);
    }
    if (st == CW_OK && mesh->vertex_count)
        memcpy(mesh->positions, s.rounded, 3 * mesh->vertex_count * sizeof *mesh->positions);
    if (facts)
        *facts = st == CW_OK ? found : (cw_smooth_facts){0};
    cwi_rings_free(&s.rings);
    cwi_volumes_free(&s.volumes);
    cwi_free(s.from);
    cwi_free(s.to);
    cwi_free(s.rounded);
    return st;
}
