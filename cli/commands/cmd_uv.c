/* The command uv: texture coordinates, one square for all parts of a file. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <cubewright/atlas.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct uv_args {
    cli_mesh_args mesh;
    size_t atlas, margin;
    cli_number density;
} uv_args;

static const uv_args *args_of(const cli_mesh_run *r)
{
    return (const uv_args *)r->args;
}

static const uv_args defaults = {.atlas = 2048, .margin = 2};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(""),
    CLI_HEADED("Texture"),
    {"atlas", 0, CLI_COUNT, "N", "Texels along each side of the texture (2048)",
     offsetof(uv_args, atlas)},
    {"margin", 0, CLI_COUNT, "N", "Texels that stay free around each chart (2)",
     offsetof(uv_args, margin)},
    {"texel-density", 0, CLI_NUMBER, "D", "Texels for each mm (as many as fit)",
     offsetof(uv_args, density)},
    CLI_HEADED("Parts"),
    CLI_MESH_MERGE,
    CLI_MESH_ORIENT,
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const uv_args *args = args_of(r);
    cli_json_count(j, "atlas", args->atlas);
    cli_json_count(j, "margin", args->margin);
    if (args->density.given)
        cli_json_number(j, "texels_per_mm", args->density.value);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_bool(j, "orient", r->args->orient);
    cli_json_count(j, "merged_vertices", r->pieces.merged);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const cw_atlas_facts *f = r->state;
    if (!r->is_made)
        return;
    cli_json_open(j, "atlas", '{');
    cli_json_count(j, "charts", f->charts);
    cli_json_count(j, "seams", f->seams);
    cli_json_count(j, "vertices", f->vertices);
    cli_json_number(j, "texels_per_mm", f->texels_per_mm);
    cli_json_number(j, "stretch", f->stretch);
    cli_json_number(j, "coverage", f->coverage);
    cli_json_count(j, "flipped", f->flipped);
    cli_json_close(j, '}');
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const cw_atlas_facts *f = r->state;
    snprintf(
        r->found, sizeof r->found,
        "; %s chart%s, %s edges of seams, %s vertices with one coordinate each; %u x %u texels, "
        "%.0f %% covered, %.3g for a mm; stretch %.3f",
        cli_count(f->charts), f->charts == 1 ? "" : "s", cli_count(f->seams),
        cli_count(f->vertices), f->size, f->size, 100 * f->coverage, f->texels_per_mm,
        f->stretch);
    if (f->flipped)
        cli_report_warn(&r->report, "single precision turned %s triangles over: --atlas %u",
                        cli_count(f->flipped), 2 * f->size);
    (void)err;
    return CW_OK;
}

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const uv_args *args = args_of(r);
    if (args->atlas < 64 || args->atlas > CW_ATLAS_MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--atlas %zu: expected 64 to %u", args->atlas,
                        CW_ATLAS_MAX_SIZE);
    if (args->margin < 1 || args->margin > 64)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--margin %zu: expected 1 to 64", args->margin);
    if (args->density.given && !(args->density.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--texel-density %g: expected more than 0",
                        args->density.value);
    return CW_OK;
}

/* --- work --------------------------------------------------------------------------------- */

/* Joins the surfaces of all pieces, without their attributes. */
static cw_status join_pieces(const cli_pieces *p, cw_mesh *all, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        cw_mesh bare = p->piece[n].input;
        bare.normals = bare.scalars = NULL;
        bare.colors = NULL;
        bare.labels = NULL;
        bare.attribute_count = 0;
        st = n ? cwi_mesh_append(all, &bare, err) : cwi_mesh_copy(&bare, all, err);
    }
    return st;
}

/* Copies each piece, with its share of the texture coordinates of all. */
static cw_status share_coordinates(cli_pieces *p, const cw_mesh *all, cw_error *err)
{
    const cw_attribute *from = cw_mesh_attribute_find(all, CW_TEXTURE_COORDINATES);
    size_t corner = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        cw_mesh *out = &p->piece[n].out;
        cw_attribute *added = NULL;
        st = cwi_mesh_copy(&p->piece[n].input, out, err);
        cw_mesh_attribute_remove(out, CW_TEXTURE_COORDINATES);
        if (st == CW_OK)
            st = cw_mesh_attribute_add(out, from, &added, err);
        if (st == CW_OK)
            memcpy(added->data, (const float *)from->data + 2 * corner,
                   6 * out->triangle_count * sizeof(float));
        corner += 3 * out->triangle_count;
    }
    return st;
}

static cw_status lay_flat(cli_mesh_run *r, cw_error *err)
{
    const uv_args *args = args_of(r);
    cw_mesh all = {0};
    const cw_atlas_desc desc = {
        .size = (uint32_t)args->atlas,
        .margin = (uint32_t)args->margin,
        .texels_per_mm = args->density.given ? args->density.value : 0,
        .threads = r->threads,
        .progress = cli_progress((double)r->pieces.triangles / 1e6, "Mtriangle")};
    cw_status st = join_pieces(&r->pieces, &all, err);
    if (st == CW_OK)
        st = cw_mesh_atlas(&all, &desc, r->state, err);
    if (st == CW_OK)
        st = share_coordinates(&r->pieces, &all, err);
    cw_mesh_free(&all);
    return st;
}

static const cli_mesh_command uv = {
    .name = "uv",
    .check = check_values,
    .work = lay_flat,
    .report = report_facts,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_uv(void *args, cw_error *err)
{
    cw_atlas_facts facts = {0};
    return cli_run_mesh_command(&uv, args, &facts, 1, err);
}

const cli_command cli_uv = {
    .name = "uv",
    .usage = "MESH -o MESH [--atlas N] [--margin N] [options]",
    .about = "Give a mesh texture coordinates: charts laid flat in a square",
    .page = cli_page_uv,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(uv_args),
    .defaults = &defaults,
    .run = run_uv,
};
