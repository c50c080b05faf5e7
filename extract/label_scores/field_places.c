/* Puts the vertices of a label map where the fields of the labels around them are equal. */
#include "extract/label_scores/field_places.h"

#include "extract/label_scores/field_cell.h"
#include "extract/labels/label_cubes.h"

#include "core/base/parallel.h"

#include <math.h>
#include <string.h>

enum { PART = 1 << 12 };

/* Vertices of cubes with several were up to 0.125 voxels from the middle: all are in the box of at least
 * this much around it. */
static const double LEAST_BOX = 0.25;

/* The part of the way to their place that such vertices go at most: not to the surface of their tetrahedra. */
static const double INSIDE = 0.98;

typedef struct placer {
    const cwi_label_scores *fields;
    const cwi_label_net *net;
    const float *originals;
    const cw_labels_desc *desc;
    cw_mesh *mesh;
    const size_t *dim;
    cwi_label_rules rules;
    uint64_t cube_edges, tet_edges[CWI_TETS]; /* as of cwi_field_cell_mean() */
} placer;

/* A cube of the map. */
typedef struct cube {
    double first[3];    /* its corner 0, counted in voxels */
    bool beyond[3];     /* of axes: true if half of it is beyond the volume */
    uint32_t labels[8]; /* of corners, as they were extracted */
    cwi_field_cell cell;
} cube;

/* Lists the edges of the cube, and those of each tetrahedron: from lower to higher corners. */
static void list_edges(placer *p)
{
    for (int a = 0; a < 8; a++)
        for (int b = a + 1; b < 8; b++) {
            const uint64_t edge = (uint64_t)1 << (8 * a + b);
            p->cube_edges |= cwi_count_bits((uint32_t)(a ^ b)) == 1 ? edge : 0;
            for (int t = 0; t < CWI_TETS; t++)
                if (p->rules.tets[t] >> a & 1 && p->rules.tets[t] >> b & 1)
                    p->tet_edges[t] |= edge;
        }
}

/* Returns the label of a voxel as it was extracted. */
static uint32_t choose_label(const placer *p, uint32_t label)
{
    const cw_labels_desc *d = p->desc;
    for (size_t n = 0; n < d->label_count; n++)
        if (d->labels[n] == label)
            return label;
    return d->label_count ? d->background : label;
}

/* Finds the number of a label's field in the cell, and adds it if it is not there yet. */
static int need_field(const placer *p, cube *c, uint32_t label, uint32_t labels[8],
                      uint32_t groups[8])
{
    cwi_field_cell *cell = &c->cell;
    const uint32_t group = choose_label(p, label);
    int n = 0;
    while (n < cell->count && labels[n] != label)
        n++;
    if (n < cell->count)
        return n;
    labels[n] = label;
    groups[n] = group;
    cell->group[n] = 0;
    for (int i = 0; i < n; i++)
        if (groups[i] == group) {
            cell->group[n] = cell->group[i];
            break;
        } else if (cell->group[i] >= cell->group[n])
            cell->group[n] = cell->group[i] + 1;
    cell->count++;
    return n;
}

/* Returns a field at a corner of a cube. On the volume's border the cube's vertices are half a voxel
 * beyond, and fields go on as they change before. */
static double find_value(const placer *p, const cube *c, uint32_t field, const size_t at[3])
{
    const double value = cwi_label_score_value(p->fields, field, at);
    double beyond = value;
    for (int a = 0; a < 3; a++) {
        size_t before[3] = {at[0], at[1], at[2]};
        if (!c->beyond[a] || p->dim[a] < 2)
            continue;
        before[a] = at[a] == 0 ? 1 : at[a] - 1;
        beyond += 0.5 * (value - cwi_label_score_value(p->fields, field, before));
    }
    return isfinite(beyond) ? beyond : value;
}

/* Loads labels and fields of the cube around a vertex. Corners beyond the volume have those beside them,
 * and do not count. */
static void load_cube(const placer *p, size_t v, cube *c)
{
    uint32_t labels[8], groups[8];
    size_t at[8][3];
    *c = (cube){.cell.corners = 0xff};
    for (int a = 0; a < 3; a++) {
        c->first[a] = floor((double)p->originals[3 * v + (size_t)a]);
        c->beyond[a] = c->first[a] < 0 || c->first[a] >= (double)p->dim[a] - 1;
    }
    for (int n = 0; n < 8; n++) {
        bool is_out = false;
        for (int a = 0; a < 3; a++) {
            const double index = c->first[a] + (n >> a & 1), last = (double)p->dim[a] - 1;
            at[n][a] = (size_t)fmin(fmax(index, 0), last);
            is_out = is_out || index < 0 || index > last;
        }
        const uint32_t label = cwi_label_scores_label(p->fields, at[n]);
        c->cell.field_of[n] = need_field(p, c, label, labels, groups);
        c->labels[n] =
            is_out && !p->desc->leave_open ? p->desc->background : choose_label(p, label);
        c->cell.corners &= (uint8_t) ~(is_out << n);
    }
    for (int f = 0; f < c->cell.count; f++) {
        const uint32_t field = cwi_label_score_of(p->fields, labels[f]);
        for (int n = 0; n < 8; n++)
            c->cell.values[f][n] = find_value(p, c, field, at[n]);
    }
}

/* Returns the edges of the tetrahedra that share a vertex in a cube with several. */
static uint64_t find_part_edges(const placer *p, const cube *c, size_t v)
{
    uint8_t shape = cwi_label_cube(&p->rules, c->labels);
    uint64_t edges = 0;
    size_t first = v;
    bool is_same = true;
    for (int a = 2; a >= 0; a--)
        if (c->beyond[a] && !p->desc->leave_open)
            shape = (uint8_t)(CWI_CUBE_PRISMS | a);
    while (is_same && first > 0) {
        for (int a = 0; a < 3; a++)
            is_same = is_same &&
                      floor((double)p->originals[3 * (first - 1) + (size_t)a]) == c->first[a];
        first -= is_same;
    }
    for (int t = 0; t < CWI_TETS; t++)
        if ((shape & CWI_CUBE_PRISMS || shape >> t & 1) &&
            cwi_label_cube_vertex(&p->rules, shape, t) == v - first)
            edges |= p->tet_edges[t];
    return edges;
}

/* Places a vertex within its bound. It stays in the plane of a cap, or where a border is open. One that
 * shares its cube moves straight towards its place, so that it stays inside of its tetrahedra. */
static void place_vertex(const placer *p, size_t v)
{
    const float *from = p->originals + 3 * v;
    const bool is_alone = !(p->net->kinds[v] & CWI_NET_FIXED);
    const double bound = p->desc->max_move, box = fmax(bound, LEAST_BOX);
    double at[3], move[3], low[3], high[3];
    cube c;
    load_cube(p, v, &c);
    if (!cwi_field_cell_mean(&c.cell, is_alone ? p->cube_edges : find_part_edges(p, &c, v), at))
        return;
    if (is_alone)
        cwi_field_cell_meet(&c.cell, at);
    double share = is_alone ? 1 : INSIDE;
    for (int a = 0; a < 3; a++) {
        const double here = (double)from[a], middle = c.first[a] + 0.5;
        low[a] = fmax(here - bound, middle - box);
        high[a] = fmin(here + bound, middle + box);
        move[a] = c.beyond[a] ? 0 : c.first[a] + at[a] - here;
        if (!is_alone && here + share * move[a] > high[a])
            share = (high[a] - here) / move[a];
        if (!is_alone && here + share * move[a] < low[a])
            share = (low[a] - here) / move[a];
    }
    for (int a = 0; a < 3; a++)
        if (!c.beyond[a])
            p->mesh->positions[3 * v + (size_t)a] =
                (float)fmin(fmax((double)from[a] + share * move[a], low[a]), high[a]);
    if (!is_alone)
        p->net->kinds[v] &= (uint8_t)~CWI_NET_BACK;
}

static void place_part(void *context, size_t n)
{
    const placer *p = context;
    for (size_t v = n * PART; v < (n + 1) * PART && v < p->mesh->vertex_count; v++)
        place_vertex(p, v);
}

cw_status cwi_label_scores_place(void *context, cwi_label_net *net, const float *originals,
                                 float *spare, cw_label_surfaces *surfaces,
                                 const cw_labels_desc *desc, const size_t dim[3], cw_error *err)
{
    placer p = {.fields = context,
                .net = net,
                .originals = originals,
                .desc = desc,
                .mesh = &surfaces->mesh,
                .dim = dim};
    (void)spare;
    cwi_label_rules_make(&p.rules);
    list_edges(&p);
    return cwi_parallel_for((p.mesh->vertex_count + PART - 1) / PART, 64 * PART, desc->threads,
                            &desc->progress, "placing", place_part, &p, err);
}
