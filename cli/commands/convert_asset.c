/* Makes an asset for games or the web of a mesh: the stages of `extract --profile game` on it. */
#include "cli/commands/convert_asset.h"

#include "cli/assets/taken_levels.h"
#include "cli/assets/uv_rebake.h"
#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/results/detail_levels.h"
#include "cli/results/stage_facts.h"
#include "core/base/status.h"
#include "core/texture/gather_meshes.h"

#include <string.h>

/* The levels, and the run that makes them. */
typedef struct asset_run {
    cli_mesh_run *run;
    const cli_asset *asset;
    int pivot;
    double crease_degrees;
    cli_taken_levels taken;
    cli_rebake carried; /* the pictures that the mesh came with */
    double moved[3];    /* to the pivot */
    cli_pieces pieces;  /* the surface that the levels were made of is the only one */
} asset_run;

static cw_status run_stages(asset_run *a, cli_made *made, cw_error *err)
{
    cli_mesh_run *r = a->run;
    cli_texture_args texture = CLI_TEXTURE_DEFAULTS;
    cli_length handles = {0};
    cli_fill_texture(a->asset, &texture, &handles);
    const cw_close_handles_desc closing = {0};
    const cw_atlas_desc atlas = cli_atlas_desc(&texture);
    const cw_bake_desc bake = cli_bake_desc(&texture, 0);
    const cw_pipeline_desc desc = {.extract.threads = r->threads,
                                   .fill_voids = true,
                                   .close_handles = &closing,
                                   .lod = a->taken.lod.n,
                                   .lod_count = a->taken.lod.count,
                                   .atlas = &atlas,
                                   .bake = &bake,
                                   .crease_degrees = a->crease_degrees,
                                   .watch.begin = cli_stage_progress};
    cw_status st = cw_pipeline_run_mesh(&r->pieces.piece->input, &desc,
                                        cli_level_sink(&a->taken), &made->facts, err);
    if (st != CW_OK)
        return cli_explain_stages(r->mesh.path, st, err);
    cli_tell_stages(
        &(cli_staged){.subject = r->mesh.path, .facts = &made->facts, .report = &r->report});
    return CW_OK;
}

/* Carries the pictures of the mesh over into the square of the levels. */
static cw_status carry_pictures(asset_run *a, const cw_atlas_facts *atlas, cw_error *err)
{
    cli_mesh_run *r = a->run;
    const cli_piece *piece = r->pieces.piece;
    cw_part part = {.mesh = &piece->input, .textures = piece->textures};
    const cw_mesh *list[CLI_MAX_COUNTS];
    const cw_bake_desc desc = {
        .size = atlas->size, .margin = atlas->margin, .threads = r->threads};
    cw_mesh all = {0};
    if (!piece->textures)
        return CW_OK;
    for (size_t n = 0; n < a->taken.count; n++)
        list[n] = &a->taken.levels[n];
    cw_status st = cwi_gather_meshes(list, NULL, a->taken.count, true, true, &all, err);
    a->carried.old = (cli_mesh){.path = r->mesh.path, .parts = &part, .part_count = 1};
    if (st == CW_OK)
        st = cli_rebake_run(&a->carried, &all, &desc, &a->taken.maps.textures, err);
    a->carried.old = (cli_mesh){0}; /* it was borrowed */
    cw_mesh_free(&all);
    return st;
}

static cw_status make_levels(void *state, cw_mesh *levels, cw_error *err)
{
    asset_run *a = state;
    cli_mesh_run *r = a->run;
    cli_made *made = r->report.made;
    a->taken.levels = levels;
    cli_report_begin(&r->report);
    cw_status st = run_stages(a, made, err);
    if (st == CW_OK)
        st = carry_pictures(a, &made->facts.atlas, err);
    if (st == CW_OK)
        st = cli_move_taken(&a->taken, a->pivot, a->moved, err);
    if (st != CW_OK)
        return st;
    cli_report_end(&r->report, "simplify", a->taken.full.triangle_count, a->taken.triangles);
    st = cli_take_surface(&a->pieces, r->mesh.path, &a->taken.full, err);
    a->pieces.closed_mm = made->facts.handles.length_mm;
    return st == CW_OK ? cli_measure_pieces(&a->pieces, r->threads, err) : st;
}

/* Checks and measures a level: it is the result of the only piece for a while. */
static cw_status finish_level(void *state, cli_made *made, cw_mesh *level, cw_error *err)
{
    asset_run *a = state;
    cli_report *report = &a->run->report;
    made->facts = a->taken.facts[level - a->taken.levels];
    memcpy(made->pivot, a->moved, sizeof made->pivot);
    made->compared.other = "the full surface";
    a->pieces.piece->out = *level;
    cli_report_begin(report);
    cw_status st = cli_hold_pieces(&a->pieces, a->run->threads, err);
    if (st == CW_OK)
        st = cli_compare_pieces(&a->pieces, a->run->threads, &made->compared, err);
    if (st == CW_OK)
        cli_report_end(report, "measure", a->taken.full.triangle_count, level->triangle_count);
    a->pieces.piece->out = (cw_mesh){0};
    return st;
}

static cw_status deliver_level(void *state, size_t file, const cw_part *parts, size_t count,
                               cw_error *err)
{
    asset_run *a = state;
    cli_mesh_run *r = a->run;
    cli_delivery how = cli_mesh_delivery(r);
    how.unchecked = file == a->taken.lod.count; /* each was by itself */
    how.parts = how.unchecked ? "levels" : NULL;
    cw_status st = r->report.made[r->report.made_count - 1].path
                       ? cli_deliver(&r->report, &how, parts, count, 0, r->start, err)
                       : cli_deliver_step(&r->report, &how, parts->mesh, 0, r->start, err);
    r->start = cli_seconds();
    return st;
}

cw_status cli_convert_asset(cli_mesh_run *r, const cli_asset *asset, int pivot, double degrees,
                            cw_error *err)
{
    asset_run a = {.run = r,
                   .asset = asset,
                   .pivot = pivot,
                   .crease_degrees = degrees,
                   .taken.drops_equal = true};
    cli_detail_levels levels = {.lod = &a.taken.lod,
                                .name = r->args->written.name,
                                .files = &r->outputs,
                                .report = &r->report,
                                .pieces = &a.pieces,
                                .is_budget = true,
                                .maps = &a.taken.maps,
                                .make = make_levels,
                                .finish = finish_level,
                                .deliver = deliver_level,
                                .user = &a};
    cli_fill_levels(asset, &a.taken.lod);
    cw_status st = cli_weld_pieces(&r->pieces, &r->mesh, err);
    if (st == CW_OK)
        st = cli_make_detail_levels(&levels, err);
    cli_free_detail_levels(&levels);
    cli_free_pieces(&a.pieces);
    cli_free_taken(&a.taken);
    cli_rebake_free(&a.carried);
    return st;
}
