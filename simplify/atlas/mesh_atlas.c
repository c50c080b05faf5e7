/* Makes the atlas of a mesh: charts, their places, and texture coordinates. */
#include "simplify/atlas/atlas_state.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh_attributes.h"
#include "core/texture/split_seams.h"
#include "simplify/atlas/pack_charts.h"

#include <math.h>

enum { DEFAULT_SIZE = 2048, MIN_SIZE = 64, DEFAULT_MARGIN = 2, MAX_MARGIN = 64 };

static const double DEFAULT_STRETCH = 1.25;

/* Charts on their way: nodes of the tree that are to be laid flat. */
typedef struct charting {
    const cwi_sheet *sheet;
    const cwi_chart_tree *tree;
    double max_stretch;
    uint32_t *index; /* triangles: scratch of charts */
    uint32_t *nodes; /* to be done now */
    cwi_chart *tried;
    bool *is_good;
    size_t node_count;
    cwi_chart *charts; /* finished */
    size_t chart_count, chart_room;
    bool no_memory;
} charting;

/* --- charts ------------------------------------------------------------------------------- */

static void try_chart(void *context, size_t n)
{
    charting *c = context;
    const uint32_t node = c->nodes[n];
    bool no_memory = false;
    c->is_good[n] =
        cwi_chart_make(&c->tried[n], c->sheet, c->tree->order + c->tree->begin[node],
                       c->tree->size[node], c->max_stretch, c->index, &no_memory);
    if (no_memory)
        cwi_set_flag(&c->no_memory);
}

/* Keeps the good charts of a round; lists the halves of the others for the next one. */
static bool keep_good(charting *c, uint32_t *next)
{
    const size_t tried = c->node_count;
    c->node_count = 0;
    for (size_t n = 0; n < tried; n++) {
        if (!c->is_good[n]) {
            const uint32_t *halves = c->tree->children[c->nodes[n] - c->tree->triangles];
            next[c->node_count++] = halves[0];
            next[c->node_count++] = halves[1];
            continue;
        }
        cwi_chart *grown =
            cwi_grow_array(c->charts, c->chart_count, &c->chart_room, sizeof *grown);
        if (!grown)
            return false;
        c->charts = grown;
        c->charts[c->chart_count++] = c->tried[n];
        c->tried[n] = (cwi_chart){0};
    }
    return true;
}

/* Tries the nodes that are listed; those that do not lie flat make room for their halves. */
static cw_status try_round(charting *c, double done, const cw_atlas_desc *desc, cw_error *err)
{
    const size_t count = c->node_count;
    uint32_t *next = cwi_alloc_array(2 * count, sizeof *next);
    c->tried = cwi_alloc_zeroed(count, sizeof *c->tried);
    c->is_good = cwi_alloc_zeroed(count, sizeof *c->is_good);
    cw_status st = cwi_progress(&desc->progress, "laying charts flat", done, err);
    bool ok = next && c->tried && c->is_good;
    if (ok && st == CW_OK) {
        cwi_parallel_for_all(count, (size_t)1 << 16, desc->threads, try_chart, c);
        ok = !c->no_memory && keep_good(c, next);
    }
    for (size_t n = 0; c->tried && n < count; n++)
        cwi_chart_free(&c->tried[n]);
    cwi_free(c->tried);
    cwi_free(c->is_good);
    cwi_free(c->nodes);
    c->nodes = next;
    return ok ? st : cwi_fail_memory(err);
}

static cw_status make_charts(charting *c, const cw_atlas_desc *desc, cw_error *err)
{
    const size_t nodes = c->tree->triangles + c->tree->mergers;
    c->index = cwi_alloc_zeroed(c->tree->triangles, sizeof *c->index);
    for (size_t n = 0; n < nodes; n++)
        c->node_count += c->tree->is_root[n];
    c->nodes = cwi_alloc_array(c->node_count, sizeof *c->nodes);
    if (!c->index || !c->nodes)
        return cwi_fail_memory(err);
    c->node_count = 0;
    for (size_t n = 0; n < nodes; n++)
        if (c->tree->is_root[n])
            c->nodes[c->node_count++] = (uint32_t)n;
    cw_status st = CW_OK;
    while (c->node_count && st == CW_OK) {
        size_t left = 0;
        for (size_t n = 0; n < c->node_count; n++)
            left += c->tree->size[c->nodes[n]];
        st = try_round(c, 1 - (double)left / (double)c->tree->triangles, desc, err);
    }
    if (st == CW_OK)
        st = cwi_charts_merge(c->charts, &c->chart_count, c->sheet, c->max_stretch, c->index,
                              desc, err);
    return st;
}

static void free_charting(charting *c)
{
    for (size_t n = 0; n < c->chart_count; n++)
        cwi_chart_free(&c->charts[n]);
    cwi_free(c->charts);
    cwi_free(c->index);
    cwi_free(c->nodes);
}

/* --- texture coordinates ------------------------------------------------------------------ */

static void set_coordinates(const charting *c, const cwi_atlas_packing *p, float (*uv)[2])
{
    for (size_t n = 0; n < c->chart_count; n++) {
        const cwi_chart *chart = &c->charts[n];
        const cwi_chart_place *place = &p->places[n];
        for (size_t corner = 0; corner < 3 * chart->triangles; corner++) {
            const double *from = chart->uv[chart->corners[corner]];
            float *to = uv[3 * (size_t)chart->triangle[corner / 3] + corner % 3];
            const double x = place->turn[0] * from[0] - place->turn[1] * from[1],
                         y = place->turn[1] * from[0] + place->turn[0] * from[1];
            to[0] = (float)((p->density * x + place->shift[0]) / p->size);
            to[1] = (float)(1 - (p->density * y + place->shift[1]) / p->size);
        }
    }
}

/* Returns the area of a triangle in the texture; negative if it is seen from behind. */
static double signed_area(const float (*uv)[2])
{
    const double ux = (double)uv[1][0] - (double)uv[0][0],
                 uy = (double)uv[1][1] - (double)uv[0][1],
                 vx = (double)uv[2][0] - (double)uv[0][0],
                 vy = (double)uv[2][1] - (double)uv[0][1];
    return (uy * vx - ux * vy) / 2; /* y goes down */
}

/* Returns true if the two triangles along a side lie side by side in the texture, too. */
static bool is_joined(const float (*uv)[2], uint32_t corner, uint32_t twin)
{
    const uint32_t after = cwi_corner_next(corner), twin_after = cwi_corner_next(twin);
    return uv[corner][0] == uv[twin_after][0] && uv[corner][1] == uv[twin_after][1] &&
           uv[after][0] == uv[twin][0] && uv[after][1] == uv[twin][1];
}

static void find_facts(const charting *c, const cwi_atlas_packing *p, const float (*uv)[2],
                       cw_atlas_facts *facts)
{
    const cwi_sheet *sheet = c->sheet;
    double stretch = 0;
    *facts = (cw_atlas_facts){.size = p->size,
                              .margin = p->margin,
                              .charts = c->chart_count,
                              .texels_per_mm = p->density};
    for (size_t n = 0; n < c->chart_count; n++) {
        const cwi_chart *chart = &c->charts[n];
        double area = 0;
        for (size_t t = 0; t < chart->triangles; t++)
            area += chart->area[t];
        stretch += area * chart->stretch * chart->stretch;
    }
    facts->stretch = sqrt(stretch / sheet->area);
    for (size_t t = 0; t < sheet->mesh->triangle_count; t++) {
        const double area = signed_area(uv + 3 * t);
        facts->coverage += fabs(area);
        facts->flipped += area < 0;
    }
    for (size_t corner = 0; corner < 3 * sheet->mesh->triangle_count; corner++) {
        const uint32_t twin = sheet->twin[corner];
        if (twin != CWI_NO_CORNER && twin > corner)
            facts->seams += !is_joined(uv, (uint32_t)corner, twin);
    }
}

static cw_status count_vertices(const cw_mesh *mesh, cw_atlas_facts *facts, cw_error *err)
{
    cwi_texture_seams seams;
    cw_status st = cwi_seams_find(mesh, &seams, err);
    facts->vertices = seams.count;
    cwi_seams_free(&seams);
    return st;
}

/* --- the whole ---------------------------------------------------------------------------- */

static cw_status check_settings(const cw_atlas_desc *d, cw_error *err)
{
    if (d->size < MIN_SIZE || d->size > CW_ATLAS_MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->size %u: expected %d to %u", d->size,
                        MIN_SIZE, CW_ATLAS_MAX_SIZE);
    if (d->margin < 1 || d->margin > MAX_MARGIN)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->margin %u: expected 1 to %d", d->margin,
                        MAX_MARGIN);
    if (!(d->texels_per_mm >= 0) || isinf(d->texels_per_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "desc->texels_per_mm %g: expected a positive, finite number",
                        d->texels_per_mm);
    if (!(d->max_stretch > 1))
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->max_stretch %g: expected more than 1",
                        d->max_stretch);
    return CW_OK;
}

static cw_status pack_and_set(cw_mesh *mesh, const charting *c, const cw_atlas_desc *d,
                              cw_atlas_facts *facts, cw_error *err)
{
    cwi_atlas_packing packing = {.size = d->size,
                                 .margin = d->margin,
                                 .density = d->texels_per_mm,
                                 .threads = d->threads};
    float(*uv)[2] = NULL;
    packing.places = cwi_alloc_array(c->chart_count, sizeof *packing.places);
    cw_status st = packing.places ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_charts_pack(&packing, c->charts, c->chart_count, &d->progress, err);
    if (st == CW_OK)
        st = cwi_texture_add(mesh, CW_ON_CORNERS, &uv, err);
    if (st == CW_OK) {
        set_coordinates(c, &packing, uv);
        if (facts) {
            find_facts(c, &packing, (const float(*)[2])uv, facts);
            st = count_vertices(mesh, facts, err);
        }
    }
    cwi_free(packing.places);
    return st;
}

static cw_status make_atlas(cw_mesh *mesh, const cw_atlas_desc *d, cw_atlas_facts *facts,
                            cw_error *err)
{
    cwi_sheet sheet = {0};
    cwi_chart_tree tree = {0};
    charting c = {.sheet = &sheet, .tree = &tree, .max_stretch = d->max_stretch};
    cw_status st = cwi_progress(&d->progress, "merging triangles", 0, err);
    if (st == CW_OK)
        st = cwi_sheet_init(&sheet, mesh, err);
    if (st == CW_OK && !(sheet.area > 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no triangle with an area");
    if (st == CW_OK)
        st = cwi_chart_tree_build(&tree, &sheet, err);
    if (st == CW_OK)
        st = make_charts(&c, d, err);
    if (st == CW_OK)
        st = pack_and_set(mesh, &c, d, facts, err);
    free_charting(&c);
    cwi_chart_tree_free(&tree);
    cwi_sheet_free(&sheet);
    return st;
}

cw_status cw_mesh_atlas(cw_mesh *mesh, const cw_atlas_desc *desc, cw_atlas_facts *facts,
                        cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_atlas_desc d = desc ? *desc : (cw_atlas_desc){0};
    d.size = d.size ? d.size : DEFAULT_SIZE;
    d.margin = d.margin ? d.margin : DEFAULT_MARGIN;
    d.max_stretch = d.max_stretch != 0 ? d.max_stretch : DEFAULT_STRETCH;
    cw_status st = check_settings(&d, err);
    if (st == CW_OK)
        st = cw_mesh_check(mesh, err);
    return st == CW_OK ? make_atlas(mesh, &d, facts, err) : st;
}
