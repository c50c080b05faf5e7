/* The command uv: texture coordinates, one square for all parts of a file, and a normal map. */
#include "cli/assets/texture_options.h"
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/looks/looks_facts.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <stdio.h>
#include <string.h>

typedef struct uv_args {
    cli_mesh_args mesh;
    cli_texture_args texture;
    const char *looks;
} uv_args;

typedef struct uv_state {
    cw_atlas_facts facts;
    cli_mesh full;   /* of --bake */
    double reach_mm; /* 0: the default */
    cw_bake_facts baked;
    cli_maps maps;
    cli_looks_limit limit;
    cw_appearance looks, bare_looks; /* of --looks: with maps, and without */
} uv_state;

static const uv_args *args_of(const cli_mesh_run *r)
{
    return (const uv_args *)r->args;
}

static const uv_args defaults = {.texture = CLI_TEXTURE_DEFAULTS};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(""),
    CLI_HEADED("Texture"),
    CLI_ATLAS_OPTIONS(offsetof(uv_args, texture)),
    CLI_HEADED("Maps"),
    {"bake", 0, CLI_TEXT, "MESH",
     "Bake the surface of this mesh, which has more triangles, into maps of the output (none)",
     offsetof(cli_mesh_args, source), CLI_VALUES_MESH},
    {"maps", 0, CLI_TEXT, "NAME[,NAME...]", "Maps that --bake makes: normals (normals)",
     offsetof(uv_args, texture) + offsetof(cli_texture_args, maps)},
    {"reach", 0, CLI_LENGTH, "L",
     "How far the mesh of --bake may be (4% of the box's diagonal)",
     offsetof(uv_args, texture) + offsetof(cli_texture_args, reach)},
    {"looks", 0, CLI_TEXT, "none/N/NdB",
     "Compare the looks with the mesh of --bake; limits: mean CIEDE2000 of N, PSNR of NdB",
     offsetof(uv_args, looks)},
    CLI_HEADED("Parts"),
    CLI_MESH_MERGE,
    CLI_MESH_ORIENT,
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"maps reach looks", CLI_NEEDS, "bake"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    cli_json_texture(j, &args_of(r)->texture);
    if (args_of(r)->looks)
        cli_json_text(j, "looks", args_of(r)->looks);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_bool(j, "orient", r->args->orient);
    cli_json_count(j, "merged_vertices", r->pieces.merged);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const uv_state *s = r->state;
    if (!r->is_made)
        return;
    if (r->args->source)
        cli_json_mesh_file(j, "full", &s->full);
    cli_json_atlas(j, &s->facts);
    if (r->args->source)
        cli_json_maps(j, &s->baked);
    if (args_of(r)->looks)
        cli_looks_json(j, &s->looks, &s->bare_looks);
}

/* Says how the maps came out. */
static void report_bake(cli_mesh_run *r)
{
    const uv_state *s = r->state;
    const size_t used = strlen(r->found);
    char text[CLI_TEXTURE_TEXT];
    const double missed = cli_find_missed(&s->baked);
    cli_maps_text(&s->baked, s->full.path, text);
    snprintf(r->found + used, sizeof r->found - used, "; %s", text);
    if (missed > 0)
        cli_report_warn(
            &r->report,
            "%.2g %% of the texels found nothing within --reach %.3g mm of %s that faces "
            "the same way: they are flat",
            missed, s->baked.reach_mm, s->full.path);
}

static void report_looks(cli_mesh_run *r)
{
    const uv_state *s = r->state;
    const size_t used = strlen(r->found);
    char text[CLI_LOOKS_TEXT];
    cli_looks_text(&s->looks, &s->bare_looks, text);
    snprintf(r->found + used, sizeof r->found - used, "; looks: %s", text);
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const cw_atlas_facts *f = &((const uv_state *)r->state)->facts;
    char text[CLI_TEXTURE_TEXT];
    cli_atlas_text(f, text);
    snprintf(r->found, sizeof r->found, "; %s", text);
    if (r->args->source)
        report_bake(r);
    if (args_of(r)->looks)
        report_looks(r);
    if (f->flipped)
        cli_report_warn(&r->report, "single precision turned %s triangles over: --atlas %u",
                        cli_count(f->flipped), 2 * f->size);
    (void)err;
    return CW_OK;
}

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    cli_texture_args texture = args_of(r)->texture;
    if (r->args->source && !texture.maps)
        texture.maps = "normals";
    cw_status st = cli_check_texture(&texture, r->args->output, r->args->written.format, err);
    if (st == CW_OK && args_of(r)->looks)
        st = cli_looks_parse(args_of(r)->looks, &((uv_state *)r->state)->limit, err);
    return st;
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

/* Reads the mesh whose normals are baked. */
static cw_status read_full(cli_mesh_run *r, cw_error *err)
{
    uv_state *s = r->state;
    return r->args->source
               ? cli_read_reference(r->args->source, NULL, &r->args->input, &s->full, err)
               : CW_OK;
}

static cw_status resolve_reach(cli_mesh_run *r, cw_error *err)
{
    uv_state *s = r->state;
    return cli_find_length(&r->pieces, "--reach", &args_of(r)->texture.reach, &s->reach_mm,
                           err);
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

/* Compares the mesh and its normal map with the full mesh. */
static cw_status compare_looks(cli_mesh_run *r, const cw_mesh *all, const cw_image *normals,
                               cw_error *err)
{
    uv_state *s = r->state;
    const cw_surface_look full = {.mesh = &s->full.mesh},
                          low = {.mesh = all, .normal_map = normals->pixels ? normals : NULL};
    const cw_appearance_desc desc = {.threads = r->threads,
                                     .progress = cli_progress(8, "view")};
    cw_status st =
        cw_appearance_measure(&full, 1, &low, 1, &desc, &s->looks, &s->bare_looks, err);
    return st == CW_OK ? cli_looks_hold(&s->limit, &s->looks, err) : st;
}

/* Bakes the maps of all pieces. Normals that the full mesh lacks are made once its corners are
 * joined. */
static cw_status bake(cli_mesh_run *r, cw_error *err)
{
    uv_state *s = r->state;
    cw_mesh all = {0};
    cw_image images[CW_MAP_COUNT] = {{0}};
    cw_bake_desc desc = cli_bake_desc(&args_of(r)->texture, s->reach_mm);
    desc.size = s->facts.size;
    desc.margin = s->facts.margin;
    desc.threads = r->threads;
    desc.progress = cli_progress((double)desc.size * desc.size / 1e6, "Mtexel");
    cw_status st = join_finished(&r->pieces, &all, err);
    if (st == CW_OK && !s->full.mesh.normals)
        st = cw_mesh_weld(&s->full.mesh, NULL, err);
    if (st == CW_OK && !s->full.mesh.normals)
        st = cw_mesh_normals(&s->full.mesh, err);
    if (st == CW_OK)
        st = cw_bake_normals(&all, &s->full.mesh, &desc, &images[CW_MAP_NORMALS], &s->baked,
                             err);
    if (st == CW_OK)
        st = cli_encode_maps(images, &s->maps, err);
    if (st == CW_OK && args_of(r)->looks)
        st = compare_looks(r, &all, &images[CW_MAP_NORMALS], err);
    r->pieces.textures = &s->maps.textures;
    for (int m = 0; m < CW_MAP_COUNT; m++)
        cw_image_free(&images[m]);
    cw_mesh_free(&all);
    return st;
}

static cw_status lay_flat(cli_mesh_run *r, cw_error *err)
{
    uv_state *s = r->state;
    cw_mesh all = {0};
    cw_atlas_desc desc = cli_atlas_desc(&args_of(r)->texture);
    desc.threads = r->threads;
    desc.progress = cli_progress((double)r->pieces.triangles / 1e6, "Mtriangle");
    cw_status st = join_pieces(&r->pieces, &all, err);
    if (st == CW_OK)
        st = cw_mesh_atlas(&all, &desc, &s->facts, err);
    if (st == CW_OK)
        st = share_coordinates(&r->pieces, &all, err);
    cw_mesh_free(&all);
    return st == CW_OK && r->args->source ? bake(r, err) : st;
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
    cli_free_maps(&state.maps);
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
