/* Gives labels the volumes of their voxels.
 * Source  conjugate gradients [Hestenes1952], on a graph of labels whose edges are interfaces */
#include "extract/labels/label_pressures.h"

#include "extract/labels/find_label.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

enum { FULL_ROUNDS = 1, FIRST_ROUNDS = 4, SMALL = 64 /* voxels */, SOLVER_ROUNDS = 300 };

/* The fraction of its volume that a label may lack before triangles that cross are looked for. */
static const double MAX_FIRST_DEFICIT = 1e-3;

/* The square of the residual, relative to its first one, that ends the solver. */
static const double MAX_RESIDUAL_SQ = 1e-8;

/* The least part of a pressure's effect that is reckoned with. */
static const double MIN_EFFECT = 0.05;

/* Finds the labels that lack too much volume, and their patches. Returns true if there are none. */
static bool find_deficits(cwi_label_pressures *p, double max_deficit, bool takes_all)
{
    const cw_label_surfaces *f = p->moves.surfaces;
    bool is_kept = true;
    for (size_t n = 0; n < p->labels; n++)
        p->deficits[n] = (double)f->labels[n].voxels;
    for (size_t n = 0; n < f->patch_count; n++) {
        p->deficits[p->sides[n][0]] -= p->moves.patches[n].volume;
        p->deficits[p->sides[n][1]] += p->moves.patches[n].volume;
    }
    for (size_t n = 0; n < p->labels; n++) {
        const bool lacks = fabs(p->deficits[n]) > max_deficit * (double)f->labels[n].voxels;
        p->are_active[n] = takes_all || lacks;
        is_kept = is_kept && !lacks;
    }
    p->active_count = 0;
    for (size_t n = 0; n < f->patch_count; n++)
        if (p->are_active[p->sides[n][0]] || p->are_active[p->sides[n][1]])
            p->active[p->active_count++] = (uint32_t)n;
    return is_kept;
}

/* Finds how volumes change with pressures: by areas, less what bounds hold. A patch whose pressures
 * changed their order is free again. */
static void find_weights(const cwi_label_pressures *p, const double *before)
{
    for (size_t i = 0; i < p->active_count; i++) {
        const cwi_patch_facts *patch = &p->moves.patches[p->active[i]];
        double effect = patch->extent > 0 ? patch->effect / patch->extent : 1;
        const uint32_t *side = p->sides[p->active[i]];
        const bool turns =
            before && patch->difference * (before[side[0]] - before[side[1]]) < 0;
        if (patch->effect > 0 && !turns)
            effect *= 1 - patch->held / patch->effect;
        p->weights[i] = patch->area * fmax(effect, MIN_EFFECT);
    }
}

/* Multiplies by the graph Laplacian of labels, whose edges are weighted patches: how volumes change
 * with pressures. Labels that lack nothing have none. */
static void apply_laplacian(const cwi_label_pressures *p, const double *x, double *y)
{
    memset(y, 0, (p->labels + 1) * sizeof *y);
    for (size_t i = 0; i < p->active_count; i++) {
        const uint32_t *side = p->sides[p->active[i]];
        const double flow = p->weights[i] * (x[side[0]] - x[side[1]]);
        y[side[0]] += flow;
        y[side[1]] -= flow;
    }
    for (size_t n = 0; n <= p->labels; n++)
        if (!p->are_active[n])
            y[n] = 0;
}

static double dot_all(const double *x, const double *y, size_t count)
{
    double sum = 0;
    for (size_t n = 0; n < count; n++)
        sum += x[n] * y[n];
    return sum;
}

/* Solves for the pressures that add the missing volumes, by conjugate gradients. */
static void solve_pressures(const cwi_label_pressures *p)
{
    const size_t count = p->labels + 1;
    double *x = p->pressures, *r = x + count, *d = r + count, *q = d + count;
    memset(x, 0, count * sizeof *x);
    for (size_t n = 0; n < count; n++)
        r[n] = d[n] = p->are_active[n] ? p->deficits[n] : 0;
    double residual_sq = dot_all(r, r, count);
    const double end = MAX_RESIDUAL_SQ * residual_sq;
    for (int n = 0; n < SOLVER_ROUNDS && residual_sq > end; n++) {
        apply_laplacian(p, d, q);
        const double curvature = dot_all(d, q, count);
        if (!(curvature > 0))
            return;
        const double step = residual_sq / curvature;
        for (size_t i = 0; i < count; i++) {
            x[i] += step * d[i];
            r[i] -= step * q[i];
        }
        const double next_sq = dot_all(r, r, count);
        for (size_t i = 0; i < count; i++)
            d[i] = r[i] + next_sq / residual_sq * d[i];
        residual_sq = next_sq;
    }
}

/* Gives patches the differences of pressures across them. */
static void set_differences(cwi_label_pressures *p)
{
    for (size_t n = 0; n < p->moves.surfaces->patch_count; n++)
        p->moves.patches[n].difference = 0;
    for (size_t i = 0; i < p->active_count; i++) {
        const uint32_t *side = p->sides[p->active[i]];
        p->moves.patches[p->active[i]].difference =
            p->pressures[side[0]] - p->pressures[side[1]];
    }
}

/* Moves all vertices by the pressures that add the missing volumes, as far as bounds let them. */
static cw_status press_once(cwi_label_pressures *p, const cw_labels_desc *desc, cw_error *err)
{
    find_weights(p, NULL);
    solve_pressures(p);
    find_weights(p, p->pressures);
    solve_pressures(p);
    set_differences(p);
    return cwi_label_moves_apply(&p->moves, desc, err);
}

cw_status cwi_label_pressures_set(cwi_label_pressures *p, const cw_labels_desc *desc,
                                  cw_error *err)
{
    for (size_t n = 0; n < p->moves.surfaces->patch_count; n++)
        p->moves.patches[n].is_changed = true;
    const cw_status st = cwi_label_moves_measure(&p->moves, desc, err);
    if (st != CW_OK)
        return st;
    find_deficits(p, 0, true);
    return press_once(p, desc, err);
}

cw_status cwi_label_pressures_keep(cwi_label_pressures *p, double max_deficit, int full_rounds,
                                   int rounds, bool *is_kept, const cw_labels_desc *desc,
                                   cw_error *err)
{
    cw_status st = CW_OK;
    for (int round = 0; st == CW_OK; round++) {
        st = cwi_label_moves_measure(&p->moves, desc, err);
        const bool is_done = st == CW_OK && find_deficits(p, max_deficit, round < full_rounds);
        *is_kept = is_done && round == 0;
        if (st != CW_OK || is_done || round == rounds)
            break;
        st = press_once(p, desc, err);
    }
    return st;
}

static void restore_vertex(cwi_label_moves *m, size_t v)
{
    memcpy(m->places + 3 * v, m->originals + 3 * v, 3 * sizeof *m->places);
    m->net->kinds[v] |= CWI_NET_BACK;
    cwi_label_moves_mark(m, v);
    if (m->moved)
        m->moved[v] = 1;
}

void cwi_label_pressures_restore_small(cwi_label_pressures *p, double max_deficit)
{
    cwi_label_moves *m = &p->moves;
    const cw_label_surfaces *f = m->surfaces;
    for (size_t n = 0; n < f->patch_count; n++)
        for (int side = 0; side < 2; side++) {
            const uint32_t label = p->sides[n][side];
            const double voxels =
                label < p->labels ? (double)f->labels[label].voxels : INFINITY;
            if (voxels > SMALL || fabs(p->deficits[label]) <= max_deficit * voxels)
                continue;
            const size_t end = 3 * (f->patches[n].first + f->patches[n].count);
            for (size_t i = 3 * f->patches[n].first; i < end; i++)
                restore_vertex(m, f->mesh.triangles[i]);
        }
}

cw_status cwi_label_pressures_keep_first(cwi_label_pressures *p, const cw_labels_desc *desc,
                                         cw_error *err)
{
    bool is_kept;
    for (size_t n = 0; n < p->moves.surfaces->patch_count; n++)
        p->moves.patches[n].is_changed = true;
    return cwi_label_pressures_keep(p, MAX_FIRST_DEFICIT, FULL_ROUNDS, FIRST_ROUNDS, &is_kept,
                                    desc, err);
}

bool cwi_label_pressures_init(cwi_label_pressures *p)
{
    const cw_label_surfaces *f = p->moves.surfaces;
    p->labels = f->label_count;
    if (!cwi_label_moves_init(&p->moves))
        return false;
    p->sides = cwi_alloc_array(f->patch_count, sizeof *p->sides);
    p->deficits = cwi_alloc_zeroed(p->labels + 1, sizeof *p->deficits);
    p->are_active = cwi_alloc_zeroed(p->labels + 1, sizeof *p->are_active);
    p->active = cwi_alloc_array(f->patch_count, sizeof *p->active);
    p->weights = cwi_alloc_array(f->patch_count, sizeof *p->weights);
    p->pressures = cwi_alloc_zeroed(4 * (p->labels + 1), sizeof *p->pressures);
    if (!p->sides || !p->deficits || !p->are_active || !p->active || !p->weights ||
        !p->pressures)
        return false;
    for (size_t n = 0; n < f->patch_count; n++)
        for (int side = 0; side < 2; side++)
            p->sides[n][side] = (uint32_t)cwi_find_label(f, f->patches[n].labels[side]);
    return true;
}

void cwi_label_pressures_free(cwi_label_pressures *p)
{
    cwi_label_moves_free(&p->moves);
    cwi_free(p->sides);
    cwi_free(p->deficits);
    cwi_free(p->are_active);
    cwi_free(p->active);
    cwi_free(p->weights);
    cwi_free(p->pressures);
    p->sides = NULL;
    p->deficits = p->weights = p->pressures = NULL;
    p->are_active = NULL;
    p->active = NULL;
}
