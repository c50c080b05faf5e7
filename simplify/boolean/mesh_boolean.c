/* Booleans of meshes: gather, intersect, split, find what is inside, sew; then round, and again where rounding
 * made facets meet. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_attributes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    MAX_ROUNDS = 16,
    MAX_TRIES = 20,
    MAX_GROWTH = 8 /* of what meets, from the smallest of the rounds before */
};

/* A cell is thin below this multiple of the reach. */
static const double THIN_REACHES = 1.5;

typedef struct boolean {
    const cw_mesh *const *meshes;
    size_t count;
    cw_boolean_desc desc;
    cw_boolean_facts facts;
    double reach;    /* how far vertices move onto others, in grid units */
    bool edges_meet; /* edges that are so close get a vertex in common */
    size_t results;  /* 1, or 2 of a split */
    cw_mesh *out;
} boolean;

/* One arrangement, and what it takes. */
typedef struct round_state {
    cwi_grid_solids solids;
    cwi_meetings meetings;
    cwi_seams seams;
    cwi_triangle_parts parts;
    cwi_facets facets;
    cwi_space_cells cells;
    uint8_t *kept;
} round_state;

static void free_round(round_state *r)
{
    cwi_solids_free(&r->solids);
    cwi_meetings_free(&r->meetings);
    cwi_free(r->seams.points);
    cwi_free(r->seams.seams);
    cwi_free(r->parts.parts);
    cwi_free(r->parts.points);
    cwi_facets_free(&r->facets);
    cwi_space_cells_free(&r->cells);
    cwi_free(r->kept);
    *r = (round_state){0};
}

/* --- what is inside ----------------------------------------------------------------------- */

typedef struct choice {
    cw_boolean_op op;
    size_t count;
    bool marks_negative; /* with CWI_NEGATIVE, for facts on the inputs */
} choice;

static uint8_t choose_results(const choice *c, const int32_t *windings, size_t positive)
{
    const bool first = windings[0] > 0;
    switch (c->op) {
    case CW_BOOLEAN_DIFFERENCE:
        return first && positive == 1;
    case CW_BOOLEAN_INTERSECTION:
        return positive == c->count;
    case CW_BOOLEAN_XOR:
        return positive % 2;
    case CW_BOOLEAN_SPLIT:
        return (uint8_t)((first && positive == 1) | (first && positive > 1) << 1);
    default:
        return positive > 0;
    }
}

static uint8_t keep_cell(const void *context, const int32_t *windings, size_t positive,
                         size_t negative)
{
    const choice *c = context;
    const uint8_t results = choose_results(c, windings, positive);
    return c->marks_negative && negative ? results | CWI_NEGATIVE : results;
}

/* Builds the arrangement of the solids, and finds the cells that are kept. */
static cw_status arrange_solids(round_state *r, const choice *c, const cw_boolean_desc *d,
                                cw_error *err)
{
    const cwi_soup *s = &r->solids.soup;
    cw_status st = cwi_split_triangles(s, &r->seams, d->threads, &d->progress, &r->parts, err);
    if (st == CW_OK)
        st = cwi_merge_points(s, &r->parts, err);
    if (st == CW_OK)
        st = cwi_find_facets(s, &r->meetings, &r->parts, r->solids.inputs, &r->facets, err);
    if (st == CW_OK)
        st = cwi_find_cells(s, &r->parts, &r->facets, &r->cells, err);
    if (st == CW_OK) {
        r->kept = cwi_alloc_zeroed(r->cells.count, 1);
        st = r->kept ? cwi_find_windings(s, &r->parts, &r->facets, &r->cells, &r->meetings.tree,
                                         r->solids.inputs, r->solids.input_count, keep_cell, c,
                                         r->kept, err)
                     : cwi_fail_memory(err);
    }
    return st;
}

/* --- rounding ----------------------------------------------------------------------------- */

/* Rounds the vertices of sheets. *fresh: those that are no vertices of the solids. */
static float *round_vertices(const round_state *r, const cwi_sheets *sheets, double *moved_mm,
                             size_t *fresh)
{
    float *positions = cwi_alloc_array(sheets->vertex_count, 3 * sizeof *positions);
    *fresh = 0;
    for (size_t v = 0; v < sheets->vertex_count && positions; v++) {
        const cwi_exact_point p = cwi_point_at(&r->solids.soup, &r->parts, sheets->points[v]);
        double by[3];
        *fresh += p.kind != CWI_VERTEX;
        for (size_t k = 0; k < 3; k++) {
            const double x = p.x[k] / r->solids.scale;
            positions[3 * v + k] = (float)x;
            by[k] = (double)positions[3 * v + k] - x;
        }
        *moved_mm = fmax(*moved_mm, cwi_length(by));
    }
    return positions;
}

static double volume_of(const round_state *r, const cwi_sheets *sheets)
{
    const cwi_soup *soup = &r->solids.soup;
    double sum = 0;
    if (!sheets->triangle_count)
        return 0;
    const cwi_exact_point origin =
        cwi_point_at(soup, &r->parts, sheets->points[sheets->triangles[0]]);
    for (size_t t = 0; t < sheets->triangle_count; t++) {
        const uint32_t *v = sheets->triangles + 3 * t;
        const uint32_t corners[3] = {sheets->points[v[0]], sheets->points[v[1]],
                                     sheets->points[v[2]]};
        sum += cwi_cone_volume(&r->solids, &r->parts, corners, origin.x);
    }
    return sum / 6 / pow(r->solids.scale, 3);
}

/* Finds where the triangles of a round meet. */
static cw_status find_seams(round_state *r, const cw_boolean_desc *d, cw_error *err)
{
    cwi_meetings_free(&r->meetings);
    cwi_free(r->seams.points);
    cwi_free(r->seams.seams);
    r->seams = (cwi_seams){0};
    cw_status st = cwi_find_meetings(&r->solids.soup, r->solids.moved, d->threads, &d->progress,
                                     &r->meetings, err);
    if (st == CW_OK)
        st = cwi_find_seams(&r->solids.soup, &r->meetings, d->threads, &d->progress, &r->seams,
                            err);
    return st;
}

/* Returns true if triangles cross or overlap; those that touch in corners do not. */
static bool has_meetings(const round_state *r)
{
    for (size_t n = 0; n < r->meetings.count; n++)
        if (r->meetings.pairs[n].overlap)
            return true;
    return r->seams.count;
}

/* Moves vertices that meet others onto what is close, and looks again for what meets. */
static cw_status snap_round(boolean *b, round_state *r, cw_error *err)
{
    const cw_status st = cwi_solids_snap(&r->solids, &r->meetings, &r->seams, b->reach,
                                         b->edges_meet, &b->facts.moved_mm, err);
    return st == CW_OK ? find_seams(r, &b->desc, err) : st;
}

/* Gives thin cells to what is around them. */
static cw_status absorb_cells(boolean *b, round_state *r, cw_error *err)
{
    return cwi_absorb_thin_cells(&r->solids, &r->parts, &r->facets, &r->cells,
                                 THIN_REACHES * b->reach, r->kept, &b->facts.moved_mm, err);
}

/* Unites the facets of a result with themselves, after its vertices were rounded. *sheets becomes the new
 * result. */
static cw_status unite_again(boolean *b, round_state *r, cwi_sheets *sheets, cw_error *err)
{
    const choice unite = {CW_BOOLEAN_UNION, 1, false};
    cw_status st = snap_round(b, r, err);
    if (st == CW_OK)
        st = arrange_solids(r, &unite, &b->desc, err);
    if (st == CW_OK)
        st = absorb_cells(b, r, err);
    if (st == CW_OK) {
        cwi_sheets_free(sheets);
        st = cwi_sew_sheets(&r->solids, &r->facets, &r->cells, r->kept, 1, sheets, err);
    }
    return st;
}

/* Rounds a result until no facets meet: each round is a union of the rounded facets with themselves. */
static cw_status round_result(boolean *b, const round_state *first, cwi_sheets *sheets,
                              float **positions, cw_error *err)
{
    round_state last = {0};
    cw_status st = CW_OK;
    size_t fewest = SIZE_MAX;
    for (int round = 0; st == CW_OK; round++) {
        size_t fresh;
        round_state r = {0};
        const size_t vertices = sheets->vertex_count - sheets->contact_vertices;
        cwi_free(*positions);
        const round_state *from = round ? &last : first;
        *positions = round_vertices(from, sheets, &b->facts.moved_mm, &fresh);
        if (!*positions) {
            st = cwi_fail_memory(err);
            break;
        }
        if (!fresh)
            break;
        b->facts.rounds += 1;
        st = cwi_solids_again(*positions, sheets, from->solids.soup.vertex_count,
                              first->solids.scale, &r.solids, err);
        if (st == CW_OK)
            st = find_seams(&r, &b->desc, err);
        const bool done = st == CW_OK && !has_meetings(&r) && !r.solids.dropped &&
                          r.solids.soup.vertex_count == vertices;
        if (r.seams.count < fewest)
            fewest = r.seams.count;
        if (st == CW_OK && !done &&
            (round == MAX_ROUNDS || r.seams.count / MAX_GROWTH > fewest + MAX_GROWTH * 8))
            st = cwi_fail(
                err, CW_ERR_CHECK,
                "after %d rounds facets still meet when they are rounded: surfaces are closer than "
                "floats can tell apart. Moving one mesh a little helps",
                round + 1);
        if (st == CW_OK && !done)
            st = unite_again(b, &r, sheets, err);
        free_round(&last);
        last = r;
        if (done)
            break;
    }
    free_round(&last);
    return st;
}

/* --- the result --------------------------------------------------------------------------- */

static cw_status fill_mesh(const boolean *b, const cwi_sheets *sheets, const float *positions,
                           cw_mesh *out, cw_error *err)
{
    memcpy(out->origin, b->meshes[0]->origin, sizeof out->origin);
    memcpy(out->affine, b->meshes[0]->affine, sizeof out->affine);
    out->vertex_count = sheets->vertex_count;
    out->triangle_count = sheets->triangle_count;
    out->positions = cwi_alloc_array(out->vertex_count, 3 * sizeof *out->positions);
    out->triangles = cwi_alloc_array(out->triangle_count, 3 * sizeof *out->triangles);
    if (!out->positions || !out->triangles)
        return cwi_fail_memory(err);
    memcpy(out->positions, positions, out->vertex_count * 3 * sizeof *positions);
    memcpy(out->triangles, sheets->triangles, out->triangle_count * 3 * sizeof *out->triangles);
    return CW_OK;
}

static cw_status make_result(boolean *b, round_state *r, size_t n, cw_error *err)
{
    cwi_sheets sheets = {0};
    float *positions = NULL;
    cw_status st = cwi_sew_sheets(&r->solids, &r->facets, &r->cells, r->kept, (uint8_t)(1 << n),
                                  &sheets, err);
    if (st == CW_OK) {
        b->facts.volume_mm3[n] = volume_of(r, &sheets);
        for (size_t v = 0; v < sheets.vertex_count; v++)
            b->facts.new_points += sheets.points[v] >= r->solids.soup.vertex_count;
        st = round_result(b, r, &sheets, &positions, err);
    }
    if (st == CW_OK) {
        b->facts.contact_edges += sheets.contact_edges;
        b->facts.contact_vertices += sheets.contact_vertices;
        st = fill_mesh(b, &sheets, positions, &b->out[n], err);
        if (st == CW_OK)
            st = cwi_carry_attributes(b->meshes, b->count, &sheets, &b->out[n], err);
    }
    cwi_sheets_free(&sheets);
    cwi_free(positions);
    return st;
}

/* Runs the boolean.
 * snap  vertices of inputs that meet are moved onto others, too */
static cw_status try_boolean(boolean *b, bool snap, cw_error *err)
{
    round_state r = {0};
    const choice c = {b->desc.op, b->count, true};
    b->facts = (cw_boolean_facts){0};
    cw_status st = cwi_solids_gather(b->meshes, b->count, &r.solids, err);
    if (st == CW_OK)
        st = find_seams(&r, &b->desc, err);
    b->facts.dropped = r.solids.dropped;
    b->facts.turned = r.solids.turned;
    b->facts.open_mesh = r.solids.open_mesh;
    b->facts.moved_mm = r.solids.moved_mm;
    for (size_t n = 0; n < r.seams.count && st == CW_OK; n++)
        b->facts.split_triangles +=
            n == 0 || r.seams.seams[n].triangle != r.seams.seams[n - 1].triangle;
    if (st == CW_OK && snap)
        st = snap_round(b, &r, err);
    if (st == CW_OK)
        st = arrange_solids(&r, &c, &b->desc, err);
    if (st == CW_OK)
        st = cwi_find_input_facts(b->meshes, &r.solids, &r.parts, &r.facets, &r.cells, r.kept,
                                  b->desc.inputs, &b->facts, err);
    if (st == CW_OK && snap)
        st = absorb_cells(b, &r, err);
    for (size_t n = 0; n < b->results && st == CW_OK; n++)
        st = make_result(b, &r, n, err);
    free_round(&r);
    return st;
}

/* Surfaces that are closer than floats can tell apart may cross again in each round: then the inputs are moved
 * onto each other first, farther from try to try. The first tries reach 1.5 last digits of the largest
 * coordinate; every other lets edges meet, too. */
static cw_status run_boolean(boolean *b, cw_error *err)
{
    cw_status st = CW_OK;
    for (int n = 0; n < MAX_TRIES; n++) {
        b->reach = ldexp(1.5, CWI_GRID_BITS - 24 + n / 2);
        b->edges_meet = n < 2 || n % 2;
        st = try_boolean(b, n > 0, err);
        if (st != CW_ERR_CHECK || !b->facts.rounds)
            break;
        for (size_t i = 0; i < b->results; i++)
            cw_mesh_free(&b->out[i]);
    }
    return st;
}

cw_status cw_mesh_boolean(const cw_mesh *const *meshes, size_t count,
                          const cw_boolean_desc *desc, cw_mesh *out, cw_boolean_facts *facts,
                          cw_error *err)
{
    CWI_REQUIRE(err, meshes, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_VERSION(err, facts, 0);
    boolean b = {.meshes = meshes,
                 .count = count,
                 .desc = desc ? *desc : (cw_boolean_desc){0},
                 .out = out};
    if (count == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a boolean needs at least one mesh");
    if (b.desc.op < 0 || b.desc.op >= CW_BOOLEAN_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "op is %d: expected a cw_boolean_op",
                        (int)b.desc.op);
    b.results = b.desc.op == CW_BOOLEAN_SPLIT ? 2 : 1;
    for (size_t n = 0; n < b.results; n++)
        out[n] = (cw_mesh){0};
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = meshes[n] ? cw_mesh_check(meshes[n], err)
                       : cwi_fail(err, CW_ERR_ARGUMENT, "meshes[%zu] is NULL", n);
    if (st == CW_OK)
        st = run_boolean(&b, err);
    for (size_t n = 0; n < b.results && st != CW_OK; n++)
        cw_mesh_free(&out[n]);
    if (facts)
        *facts = b.facts;
    return st;
}
