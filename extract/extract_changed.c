/* Follows a volume that changes: what an extractor keeps of it is brought up to date, and the
 * bricks of the surface that differ are extracted again. */
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/extract_internal.h"

/* Share of the voxels beyond which all of them are read again. */
#define LARGE_SHARE 0.125

/* Forgets all that was known of the voxels. The octree is not grown with the next surface: that
 * may be the only one before the voxels change again. */
static void forget_voxels(cw_extractor *e)
{
    e->plan.tree.grown = false;
    e->plan.tree.waits = true;
    cwi_grid_forget(&e->plan.grid, e->has_nodata);
}

/* Brings the ranges of the leaves around a box of voxels up to date. Leaf b is over padded samples
 * 8 b to 8 b + 8, and voxel i is sample i + 1. */
static void update_ranges(cwi_plan *p, const cw_box *box)
{
    cwi_leaf_box leaves;
    for (int a = 0; a < 3; a++) {
        leaves.first[a] = box->first[a] / CWI_BRICK;
        leaves.end[a] = (box->first[a] + box->count[a]) / CWI_BRICK + 1;
    }
    p->engine->measure_leaves(&p->grid, &leaves, p->tree.level[0]);
    cwi_octree_update(&p->tree, &leaves);
}

static bool is_large(const cw_volume *v, const cw_box *box)
{
    double share = 1;
    for (int a = 0; a < 3; a++)
        share *= (double)box->count[a] / (double)v->dim[a];
    return share > LARGE_SHARE;
}

static cw_status check_box(const cw_volume *v, const cw_box *box, cw_error *err)
{
    cw_volume part = *v;
    if (v->cells)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s has no boxes of voxels; without a box all of it has changed",
                        cwi_volume_kind(v));
    return cwi_volume_shrink(&part, box, err);
}

cw_status cw_extractor_update(cw_extractor *e, const cw_box *box, cw_error *err)
{
    CWI_REQUIRE(err, e);
    cwi_plan *p = &e->plan;
    const cw_status st = box ? check_box(&p->grid.volume, box, err) : CW_OK;
    if (st != CW_OK || !cwi_plan_is_dense(p))
        return st;
    cwi_bricks_touch(&e->bricks, box);
    if (!box || is_large(&p->grid.volume, box)) {
        forget_voxels(e);
        return CW_OK;
    }
    cwi_grid_update(&p->grid, p->engine, box, e->has_nodata);
    if (p->tree.grown)
        update_ranges(p, box);
    return CW_OK;
}

static cw_status check_settings(const cw_volume *v, const cw_extract_desc *d, cw_error *err)
{
    cw_status st = cwi_volume_expect_dense(v, "extraction of changed bricks", err);
    if (st == CW_OK && d->cubic_placement)
        st = cwi_volume_expect_even(v, "cubic placement", err);
    if (st == CW_OK && d->snap != 0)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "snap is %g; a surface made by bricks is not snapped", d->snap);
    return st;
}

/* Sets the level and the live cells. Where voxels without value matter, that takes the whole
 * volume. */
static cw_status prepare_grid(cw_extractor *e, const cw_extract_desc *d, cw_error *err)
{
    cwi_plan *p = &e->plan;
    cwi_bit_grid *g = &p->grid;
    const bool by_gaps = d->leave_open || e->has_nodata;
    if ((by_gaps && !g->gaps_known) || (d->leave_open && g->has_gaps))
        return cwi_grid_classify(g, p->engine, &p->tree, d, err);
    const cw_status st = cwi_grid_set_level(g, d, err);
    return st == CW_OK ? cwi_grid_set_live(g, d->leave_open, err) : st;
}

cw_status cw_extractor_extract_changed(cw_extractor *e, const cw_extract_desc *desc,
                                       cw_brick_sink sink, cw_error *err)
{
    CWI_REQUIRE(err, e);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    cwi_plan *p = &e->plan;
    cw_status st = check_settings(&p->grid.volume, &d, err);
    if (st == CW_OK)
        st = prepare_grid(e, &d, err);
    if (st == CW_OK)
        st = cwi_bricks_begin(&e->bricks, p, &d, err);
    return st == CW_OK ? cwi_bricks_extract(&e->bricks, p, sink, err) : st;
}
