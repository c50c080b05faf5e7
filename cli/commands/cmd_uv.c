/* The command uv: texture coordinates, one square for all parts of a file, and a normal map. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/commands/uv_rebake.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <cubewright/atlas.h>
#include <cubewright/bake.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct uv_args {
    cli_mesh_args mesh;
    size_t atlas, margin;
    cli_number density;
    cli_length reach;
    const char *rebake;
} uv_args;

typedef struct uv_state {
    cw_atlas_facts facts;
    cli_mesh full; /* of --bake */
    double reach_mm;
    cw_bake_facts baked;
    cw_textures textures;
    uint8_t *png;       /* of textures; owned */
    cli_rebake rebaked; /* of --rebake */
} uv_state;

static const uv_args *args_of(const cli_mesh_run *r)
{
    return (const uv_args *)r->args;
}

/* Of --reach, as a share of the box's diagonal. */
static const double DEFAULT_REACH = 0.04;

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
    CLI_HEADED("Pictures"),
    {"bake", 0, CLI_TEXT, "MESH",
     "Bake the normals of this mesh, which has more triangles, into a normal map of the output (none)",
     offsetof(cli_mesh_args, source), CLI_VALUES_MESH},
    {"rebake", 0, CLI_TEXT, "MESH",
     "Carry the pictures of this textured mesh over into the output's texture (none)",
     offsetof(uv_args, rebake), CLI_VALUES_MESH},
    {"reach", 0, CLI_LENGTH, "L",
     "How far the mesh of --bake or --rebake may be (4% of the box's diagonal)",
     offsetof(uv_args, reach)},
    CLI_HEADED("Parts"),
    CLI_MESH_MERGE,
    CLI_MESH_ORIENT,
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"reach", CLI_NEEDS, "bake rebake"},
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
    if (args->mesh.source || args->rebake)
        cli_json_number(j, "reach_mm", ((const uv_state *)r->state)->reach_mm);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_bool(j, "orient", r->args->orient);
    cli_json_count(j, "merged_vertices", r->pieces.merged);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_bake(cli_json *j, const char *key, const cw_bake_facts *f, bool has_normals)
{
    cli_json_open(j, key, '{');
    cli_json_count(j, "texels", f->texels);
    cli_json_count(j, "missed", f->missed);
    cli_json_number(j, "max_mm", f->max_mm);
    cli_json_number(j, "mean_mm", f->mean_mm);
    if (has_normals)
        cli_json_number(j, "mean_deg", f->mean_deg);
    cli_json_close(j, '}');
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const uv_state *s = r->state;
    const cw_atlas_facts *f = &s->facts;
    if (!r->is_made)
        return;
    if (r->args->source)
        cli_json_mesh_file(j, "full", &s->full);
    if (args_of(r)->rebake)
        cli_json_mesh_file(j, "old", &s->rebaked.old);
    cli_json_open(j, "atlas", '{');
    cli_json_count(j, "charts", f->charts);
    cli_json_count(j, "seams", f->seams);
    cli_json_count(j, "vertices", f->vertices);
    cli_json_number(j, "texels_per_mm", f->texels_per_mm);
    cli_json_number(j, "stretch", f->stretch);
    cli_json_number(j, "coverage", f->coverage);
    cli_json_count(j, "flipped", f->flipped);
    cli_json_close(j, '}');
    if (r->args->source)
        put_bake(j, "normal_map", &s->baked, true);
    if (args_of(r)->rebake)
        put_bake(j, "pictures", &s->rebaked.facts, false);
}

/* Says how a normal map or pictures came out. */
static void report_bake(cli_mesh_run *r, const char *what, const char *path,
                        const cw_bake_facts *f, const char *missing)
{
    const uv_state *s = r->state;
    const size_t used = strlen(r->found);
    const double missed = f->texels ? 100 * (double)f->missed / (double)f->texels : 0;
    snprintf(r->found + used, sizeof r->found - used,
             "; %s of %s, at most %.3g mm away, mean %.2g mm; %.2g %% of the texels missed",
             what, path, f->max_mm, f->mean_mm, missed);
    if (missed > 1)
        cli_report_warn(
            &r->report,
            "%.2g %% of the texels found nothing within --reach %.3g mm of %s that faces "
            "the same way: they are %s",
            missed, s->reach_mm, path, missing);
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const cw_atlas_facts *f = &((const uv_state *)r->state)->facts;
    snprintf(
        r->found, sizeof r->found,
        "; %s chart%s, %s edges of seams, %s vertices with one coordinate each; %u x %u texels, "
        "%.0f %% covered, %.3g for a mm; stretch %.3f",
        cli_count(f->charts), f->charts == 1 ? "" : "s", cli_count(f->seams),
        cli_count(f->vertices), f->size, f->size, 100 * f->coverage, f->texels_per_mm,
        f->stretch);
    const uv_state *s = r->state;
    if (r->args->source)
        report_bake(r, "normal map", s->full.path, &s->baked, "flat");
    if (args_of(r)->rebake)
        report_bake(r, "pictures", s->rebaked.old.path, &s->rebaked.facts, "white");
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
    const cw_format *format = cw_mesh_format(args->mesh.output, args->mesh.written.format);
    if ((args->mesh.source || args->rebake) && format && !(format->keeps & CW_KEEPS_PICTURES))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s holds no pictures; --%s is for .glb, .gltf and .obj", format->name,
                        args->mesh.source ? "bake" : "rebake");
    if (args->density.given && !(args->density.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--texel-density %g: expected more than 0",
                        args->density.value);
    return CW_OK;
}

/* --- work --------------------------------------------------------------------------------- */

/* Adds a mesh to those joined before, with its normals if asked for, and one attribute or none. */
static cw_status join_mesh(const cw_mesh *mesh, bool normals, cw_attribute *attribute,
                           bool is_first, cw_mesh *all, cw_error *err)
{
    cw_mesh bare = *mesh;
    bare.normals = normals ? mesh->normals : NULL;
    bare.scalars = NULL;
    bare.colors = NULL;
    bare.labels = NULL;
    bare.attributes = attribute;
    bare.attribute_count = attribute ? 1 : 0;
    return is_first ? cwi_mesh_copy(&bare, all, err) : cwi_mesh_append(all, &bare, err);
}

/* Joins the surfaces of all pieces. */
static cw_status join_pieces(const cli_pieces *p, cw_mesh *all, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++)
        st = join_mesh(&p->piece[n].input, false, NULL, n == 0, all, err);
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

/* Reads the mesh whose normals are baked, and the one whose pictures are. */
static cw_status read_full(cli_mesh_run *r, cw_error *err)
{
    uv_state *s = r->state;
    const char *rebake = args_of(r)->rebake;
    cw_status st = r->args->source ? cli_read_reference(r->args->source, NULL, &r->args->input,
                                                        &s->full, err)
                                   : CW_OK;
    if (st == CW_OK && rebake && r->outputs.count)
        st = cli_check_output(r->outputs.path[0], &rebake, 1, err);
    return st == CW_OK && rebake ? cli_rebake_read(rebake, &r->args->input, &s->rebaked, err)
                                 : st;
}

static cw_status resolve_reach(cli_mesh_run *r, cw_error *err)
{
    uv_state *s = r->state;
    cw_status st =
        cli_find_length(&r->pieces, "--reach", &args_of(r)->reach, &s->reach_mm, err);
    if (st == CW_OK && !(s->reach_mm > 0))
        s->reach_mm = DEFAULT_REACH * r->pieces.diagonal_mm;
    return st;
}

/* Joins the finished pieces, with their normals and coordinates alone. */
static cw_status join_finished(cli_pieces *p, cw_mesh *all, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        cw_mesh *out = &p->piece[n].out;
        if (!out->normals)
            st = cw_mesh_normals(out, err);
        if (st == CW_OK)
            st = join_mesh(out, true, cw_mesh_attribute_find(out, CW_TEXTURE_COORDINATES),
                           n == 0, all, err);
    }
    return st;
}

/* Bakes the normal map of all pieces. Normals that the full mesh lacks are made once its corners are
 * joined. */
static cw_status bake(cli_mesh_run *r, cw_error *err)
{
    const uv_args *args = args_of(r);
    uv_state *s = r->state;
    cw_mesh all = {0};
    cw_image image = {0};
    const cw_bake_desc desc = {
        .size = (uint32_t)args->atlas,
        .margin = (uint32_t)args->margin,
        .reach_mm = s->reach_mm,
        .threads = r->threads,
        .progress = cli_progress((double)(args->atlas * args->atlas) / 1e6, "Mtexel")};
    const bool has_full = r->args->source != NULL;
    cw_status st = join_finished(&r->pieces, &all, err);
    if (st == CW_OK && has_full && !s->full.mesh.normals)
        st = cw_mesh_weld(&s->full.mesh, NULL, err);
    if (st == CW_OK && has_full)
        st = cw_bake_normals(&all, &s->full.mesh, &desc, &image, &s->baked, err);
    if (st == CW_OK && has_full)
        st = cw_image_encode(&image, false, &s->png, &s->textures.normal.size, err);
    s->textures.normal.bytes = s->png;
    if (st == CW_OK && args_of(r)->rebake)
        st = cli_rebake_run(&s->rebaked, &all, &desc, &s->textures, err);
    r->pieces.textures = &s->textures;
    cw_image_free(&image);
    cw_mesh_free(&all);
    return st;
}

static cw_status lay_flat(cli_mesh_run *r, cw_error *err)
{
    const uv_args *args = args_of(r);
    uv_state *s = r->state;
    cw_mesh all = {0};
    const cw_atlas_desc desc = {
        .size = (uint32_t)args->atlas,
        .margin = (uint32_t)args->margin,
        .texels_per_mm = args->density.given ? args->density.value : 0,
        .threads = r->threads,
        .progress = cli_progress((double)r->pieces.triangles / 1e6, "Mtriangle")};
    bool had_pictures = false;
    for (size_t n = 0; n < r->pieces.count; n++) {
        had_pictures = had_pictures || r->pieces.piece[n].textures;
        r->pieces.piece[n].textures = NULL;
    }
    cw_status st = join_pieces(&r->pieces, &all, err);
    if (st == CW_OK && had_pictures && !args->rebake)
        cli_say(
            "%s: pictures lost: they lie by the texture coordinates that it had; --rebake %s "
            "carries them over",
            r->mesh.path, r->mesh.path);
    if (st == CW_OK)
        st = cw_mesh_atlas(&all, &desc, &s->facts, err);
    if (st == CW_OK)
        st = share_coordinates(&r->pieces, &all, err);
    cw_mesh_free(&all);
    return st == CW_OK && (r->args->source || args->rebake) ? bake(r, err) : st;
}

static const cli_mesh_command uv = {
    .name = "uv",
    .check = check_values,
    .prepare = read_full,
    .resolve = resolve_reach,
    .work = lay_flat,
    .report = report_facts,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_uv(void *args, cw_error *err)
{
    uv_state state = {0};
    const cw_status st = cli_run_mesh_command(&uv, args, &state, 1, err);
    cli_free_mesh(&state.full);
    cw_bytes_free(state.png);
    cli_rebake_free(&state.rebaked);
    return st;
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
