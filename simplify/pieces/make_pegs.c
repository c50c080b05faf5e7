/* Makes pegs, holes and dowels as turned solids, and joins them to the pieces by exact booleans. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/pieces/peg_sizes.h"
#include "simplify/pieces/pieces_state.h"

#include <cubewright/boolean.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sides of a peg. Those of its hole stand beside them, so the gap is even. */
enum { SIDES = 48, MAX_RINGS = 4 };

/* A taper at a tip, in radii: it finds its hole. */
static const double TAPER = 0.2;

/* A solid of revolution: circles from the first height to the last. */
typedef struct profile {
    size_t count;
    double height[MAX_RINGS], radius[MAX_RINGS];
} profile;

/* Makes the solid about the axis of a peg. */
static cw_status turn_solid(const cwi_cutter *c, const cw_peg *peg, const profile *p,
                            cw_mesh *out, cw_error *err)
{
    const cwi_cut_plane *plane = &c->planes[c->out->sections[peg->section].plane];
    const cw_status st = cwi_mesh_alloc(
        out, p->count * SIDES, 2 * SIDES * (p->count - 1) + 2 * (SIDES - 2), false, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, c->mesh->origin, sizeof out->origin);
    uint32_t *t = out->triangles;
    for (uint32_t n = 0; n < p->count * SIDES; n++) {
        const uint32_t ring = n / SIDES, next = n % SIDES + 1 < SIDES ? n + 1 : n + 1 - SIDES;
        const double angle = 2 * CWI_PI * (double)(n % SIDES) / SIDES;
        double x[3];
        cwi_add_scaled(peg->center, p->height[ring], peg->direction, x);
        cwi_add_scaled(x, p->radius[ring] * cos(angle), plane->u, x);
        cwi_add_scaled(x, p->radius[ring] * sin(angle), plane->v, x);
        for (uint32_t k = 0; k < 3; k++)
            out->positions[3 * n + k] = (float)x[k];
        if (ring + 1 < p->count) {
            const uint32_t two[6] = {n, next, n + SIDES, next, next + SIDES, n + SIDES};
            memcpy(t, two, sizeof two);
            t += 6;
        }
    }
    const uint32_t top = (uint32_t)(p->count - 1) * SIDES;
    for (uint32_t n = 1; n + 1 < SIDES; n++) {
        const uint32_t ends[6] = {0, n + 1, n, top, top + n, top + n + 1};
        memcpy(t, ends, sizeof ends);
        t += 6;
    }
    return CW_OK;
}

/* --- the solids of a peg ------------------------------------------------------------------ */

static void add_ring(profile *p, double height, double radius)
{
    p->height[p->count] = height;
    p->radius[p->count++] = radius;
}

static profile find_peg(const cw_pieces_desc *d, const cw_peg *peg)
{
    const cwi_peg_sizes s = cwi_find_peg_sizes(d, peg->diameter_mm, peg->length_mm);
    const double taper = fmin(TAPER * s.radius, peg->length_mm / 4), half = peg->length_mm / 2;
    profile p = {0};
    if (d->dowels) {
        add_ring(&p, -half, s.radius - taper);
        add_ring(&p, -half + taper, s.radius);
        add_ring(&p, half - taper, s.radius);
        add_ring(&p, half, s.radius - taper);
    } else {
        add_ring(&p, -s.root, s.radius);
        add_ring(&p, peg->length_mm - taper, s.radius);
        add_ring(&p, peg->length_mm, s.radius - taper);
    }
    return p;
}

/* The hole goes on beyond the section, into the air, so that nothing of the section stays over it. */
static profile find_hole(const cw_pieces_desc *d, const cw_peg *peg, int side)
{
    const cwi_peg_sizes s = cwi_find_peg_sizes(d, peg->diameter_mm, peg->length_mm);
    profile p = {0};
    add_ring(&p, side ? -s.radius : -s.hole[0], s.hole_radius);
    add_ring(&p, side ? s.hole[1] : s.radius, s.hole_radius);
    return p;
}

/* --- one piece ---------------------------------------------------------------------------- */

/* Lists the pegs or holes of a piece as solids. holes: those below and above; else pegs
 * list  has room for all pegs */
static cw_status list_solids(const cwi_cutter *c, size_t piece, bool holes, cw_mesh *list,
                             size_t *count, cw_error *err)
{
    const cw_pieces *o = c->out;
    const cw_pieces_desc *d = &o->settings;
    cw_status st = CW_OK;
    *count = 0;
    for (size_t n = 0; n < o->peg_count && st == CW_OK; n++) {
        const cw_piece_section *s = &o->sections[o->pegs[n].section];
        const bool is_below = s->below == piece;
        if (!is_below && s->above != piece)
            continue;
        if (holes != (d->dowels || !is_below) || (!holes && d->dowels))
            continue;
        const profile p =
            holes ? find_hole(d, &o->pegs[n], !is_below) : find_peg(d, &o->pegs[n]);
        st = turn_solid(c, &o->pegs[n], &p, &list[*count], err);
        *count += st == CW_OK;
    }
    return st;
}

/* Unites a piece with solids, or takes them away. */
static cw_status combine(cwi_cutter *c, cw_piece *piece, const cw_mesh *list, size_t count,
                         cw_boolean_op op, cw_error *err)
{
    cw_boolean_facts facts = {0};
    cw_mesh out = {0};
    const cw_mesh **meshes = cwi_alloc_array(count + 1, sizeof *meshes);
    if (!meshes)
        return cwi_fail_memory(err);
    meshes[0] = &piece->mesh;
    for (size_t n = 0; n < count; n++)
        meshes[n + 1] = &list[n];
    const cw_boolean_desc desc = {.op = op, .threads = c->out->settings.threads};
    const cw_status st = cw_mesh_boolean(meshes, count + 1, &desc, &out, &facts, err);
    cwi_free(meshes);
    if (st != CW_OK)
        return st;
    cw_mesh_attribute_remove(&out, "input");
    cw_mesh_free(&piece->mesh);
    piece->mesh = out;
    piece->volume_mm3 = facts.volume_mm3[0];
    return CW_OK;
}

static cw_status change_piece(cwi_cutter *c, size_t n, cw_mesh *list, cw_error *err)
{
    cw_piece *piece = &c->out->pieces[n];
    cw_status st = CW_OK;
    for (int holes = 0; holes < 2 && st == CW_OK; holes++) {
        size_t count;
        st = list_solids(c, n, holes, list, &count, err);
        if (st == CW_OK && count)
            st = combine(c, piece, list, count,
                         holes ? CW_BOOLEAN_DIFFERENCE : CW_BOOLEAN_UNION, err);
        for (size_t k = 0; k < count; k++)
            cw_mesh_free(&list[k]);
        *(holes ? &piece->holes : &piece->pegs) = count;
    }
    return st;
}

/* Adds the dowels behind the pieces. */
static cw_status add_dowels(cwi_cutter *c, cw_error *err)
{
    cw_pieces *o = c->out;
    cw_piece *grown = cwi_realloc_array(o->pieces, o->count + o->peg_count, sizeof *grown);
    cw_status st = grown ? CW_OK : cwi_fail_memory(err);
    if (grown)
        o->pieces = grown;
    for (size_t n = 0; n < o->peg_count && st == CW_OK; n++) {
        cw_piece *dowel = &o->pieces[o->count];
        const profile p = find_peg(&o->settings, &o->pegs[n]);
        *dowel = (cw_piece){.is_dowel = true};
        st = turn_solid(c, &o->pegs[n], &p, &dowel->mesh, err);
        if (st != CW_OK)
            break;
        o->count++;
        st = combine(c, dowel, NULL, 0, CW_BOOLEAN_UNION, err); /* for its volume */
    }
    return st;
}

cw_status cwi_make_pegs(cwi_cutter *c, cw_error *err)
{
    cw_pieces *o = c->out;
    const size_t pieces = o->count;
    cw_status st = CW_OK;
    cw_mesh *list = cwi_alloc_zeroed(o->peg_count, sizeof *list);
    if (!list)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < pieces && st == CW_OK; n++) {
        st = cwi_progress(&o->settings.progress, "pegs", 0.6 + 0.4 * (double)n / (double)pieces,
                          err);
        if (st == CW_OK)
            st = change_piece(c, n, list, err);
    }
    cwi_free(list);
    if (st == CW_OK && o->settings.dowels)
        st = add_dowels(c, err);
    for (size_t n = 0; n < o->peg_count; n++)
        for (int k = 0; k < 3; k++)
            o->pegs[n].center[k] += c->mesh->origin[k];
    return st;
}
