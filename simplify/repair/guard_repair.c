/* The guard of a repair: a result whose inside, box or surface is not that of the input is not one. */
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/repair/line_volume.h"
#include "simplify/repair/repair_state.h"

#include <math.h>
#include <string.h>

/* How far the surface may move, as a fraction of the diagonal, where nothing else is asked for. */
static const double DEFAULT_MOVE = 0.01;

/* How much of the volume may change, for each fraction of the diagonal that the surface may move. */
static const double VOLUME_PER_MOVE = 2;

/* A result that leaves the box by less, as a fraction of the diagonal, is wholly seen by the lines: what they miss of its
 * volume, such as thin walls, they missed before, too. */
static const double SAME_BOX = 1e-3;

/* Fewer lines that changed say nothing. */
enum { MIN_LINES = 24 };

/* Finds the largest movement of vertices of the input, and how far new ones, such as those of patches, lie outside of
 * the input's box. */
static void measure_moves(cwi_repair *r, const double low[3], const double high[3])
{
    cw_repair_facts *f = &r->facts;
    for (size_t v = 0; v < r->mesh.vertex_count; v++) {
        const float *p = r->mesh.positions + 3 * v;
        const uint32_t source = r->mesh.labels ? r->mesh.labels[v] : CWI_NEW;
        if (source != CWI_NEW) {
            const double square =
                cwi_point_distance_sq(p, r->input->positions + 3 * (size_t)source);
            f->moved_mm = fmax(f->moved_mm, sqrt(square));
            continue;
        }
        double beyond[3];
        for (int a = 0; a < 3; a++)
            beyond[a] = fmax(fmax(low[a] - (double)p[a], (double)p[a] - high[a]), 0);
        f->beyond_mm = fmax(f->beyond_mm, cwi_length(beyond));
    }
}

static cw_status measure_volumes(cwi_repair *r, const cw_mesh *mesh, const double low[3],
                                 const double high[3], double near_mm, cwi_line_volumes *out,
                                 cw_error *err)
{
    cwi_line_crossings before = {0}, after = {0};
    cw_status st = cwi_find_line_crossings(r->unjudged ? r->input : mesh, r->unjudged, low,
                                           high, &before, err);
    if (st == CW_OK && r->facts.weld_mm > 0)
        st = cwi_hide_lines_at_borders(mesh, r->facts.weld_mm, &before, err);
    if (st == CW_OK)
        st =
            cwi_find_line_crossings(&r->mesh, r->mesh.attributes->data, low, high, &after, err);
    if (st == CW_OK && r->desc.outer_only) {
        cwi_keep_outer_crossings(&before);
        cwi_keep_outer_crossings(&after);
    }
    if (st == CW_OK)
        *out = cwi_compare_lines(&before, &after, near_mm);
    cwi_line_crossings_free(&before);
    cwi_line_crossings_free(&after);
    return st;
}

cw_status cwi_guard_repair(cwi_repair *r, const cw_mesh *mesh, cw_error *err)
{
    cw_repair_facts *f = &r->facts;
    double low[3], high[3], size[3];
    cwi_line_volumes volumes = {0};
    cw_mesh local = *mesh;
    memset(local.origin, 0, sizeof local.origin);
    cw_mesh_bounds(&local, low, high);
    cwi_sub(high, low, size);
    const double diagonal = cwi_length(size),
                 most = r->desc.max_move_mm > 0 ? r->desc.max_move_mm : DEFAULT_MOVE * diagonal;
    cw_status st = measure_volumes(r, mesh, low, high, most, &volumes, err);
    if (st != CW_OK)
        return st;
    measure_moves(r, low, high);
    f->volume_before_mm3 = volumes.volume_mm3;
    if (f->is_sound && volumes.volume_after_mm3 > 0 && f->beyond_mm < SAME_BOX * diagonal)
        f->volume_before_mm3 *= f->volume_after_mm3 / volumes.volume_after_mm3;
    f->volume_before_mm3 -= f->inner_mm3;
    f->max_move_mm = most;
    if (volumes.lines >= MIN_LINES && volumes.inside_mm > 0)
        f->volume_changed = volumes.changed_mm / volumes.inside_mm;
    f->changes_volume = f->volume_changed > VOLUME_PER_MOVE * most / diagonal;
    f->moves_far = f->moved_mm > most || f->beyond_mm > fmax(most, f->largest_hole_mm / 2);
    f->is_refused = f->changes_volume || f->moves_far;
    if (f->changes_volume)
        return cwi_fail(err, CW_ERR_CHECK,
                        "a repair would change %.3g %% of the volume of about %.5g mm3",
                        100 * f->volume_changed, f->volume_before_mm3);
    if (f->moves_far)
        return cwi_fail(err, CW_ERR_CHECK, "a repair would move the surface by %.3g mm",
                        fmax(f->moved_mm, f->beyond_mm));
    return CW_OK;
}
