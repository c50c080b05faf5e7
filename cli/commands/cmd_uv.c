/* The command uv: texture coordinates, one square for all parts of a file, and a normal map. */
#include "cli/assets/texture_options.h"
#include "cli/assets/uv_rebake.h"
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/looks/looks_facts.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/texture/gather_meshes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct uv_args {
    cli_mesh_args mesh;
    cli_texture_args texture;
    const char *rebake;
    const char *looks;
} uv_args;

typedef struct uv_state {
    cw_atlas_facts facts;
    cli_mesh full;   /* of --bake */
    double reach_mm; /* 0: the default */
    cw_bake_facts baked;
    cli_maps maps;
    cli_rebake rebaked; /* of --rebake */
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
    CLI_HEADED("Pictures"),
    {"bake", 0, CLI_TEXT, "MESH",
     "Bake the surface of this mesh, which has more triangles, into maps of the output (none)",
     offsetof(cli_mesh_args, source), CLI_VALUES_MESH},
    {"maps", 0, CLI_TEXT, "NAME[,NAME...]",
     "Maps that --bake makes: normals, occlusion, curvature, thickness, colors (normals)",
     offsetof(uv_args, texture) + offsetof(cli_texture_args, maps)},
    {"rebake", 0, CLI_TEXT, "MESH",
     "Carry the pictures of this textured mesh over into the output's texture (none)",
     offsetof(uv_args, rebake), CLI_VALUES_MESH},
    {"reach", 0, CLI_LENGTH, "L",
     "How far the mesh of --bake or --rebake may be (4% of the box's diagonal)",
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
    {"maps map-bits looks", CLI_NEEDS, "bake"},
    {"reach", CLI_NEEDS, "bake rebake"},
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
    if (args_of(r)->rebake)
        cli_json_mesh_file(j, "old", &s->rebaked.old);
    cli_json_atlas(j, &s->facts);
    if (r->args->source)
        cli_json_maps(j, "maps", &s->baked);
    if (args_of(r)->rebake)
        cli_json_maps(j, "pictures", &s->rebaked.facts);
    if (args_of(r)->looks)
        cli_looks_json(j, &s->looks, &s->bare_looks);
}

/* Says how maps or pictures came out. missing: what texels are that found nothing */
static void report_bake(cli_mesh_run *r, const char *what, const char *path,
                        const cw_bake_facts *f, const char *missing)
{
    const size_t used = strlen(r->found);
    char text[CLI_TEXTURE_TEXT];
    const double missed = cli_find_missed(f);
    cli_maps_text(f, what, path, text);
    snprintf(r->found + used, sizeof r->found - used, "; %s", text);
    if (missed > 0)
        cli_report_warn(
            &r->report,
            "%.2g %% of the texels found nothing within --reach %.3g mm of %s that faces "
            "the same way: they are %s",
            missed, f->reach_mm, path, missing);
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
    const uv_state *s = r->state;
    const cw_atlas_facts *f = &s->facts;
    char text[CLI_TEXTURE_TEXT];
    cli_atlas_text(f, text);
    snprintf(r->found, sizeof r->found, "; %s", text);
    if (r->args->source)
        report_bake(r, "maps", s->full.path, &s->baked, "flat");
    if (args_of(r)->rebake)
        report_bake(r, "pictures", s->rebaked.old.path, &s->rebaked.facts, "white");
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
    const cw_format *format = cw_mesh_format(r->args->output, r->args->written.format);
    if (args_of(r)->rebake && format && !(format->keeps & CW_KEEPS_PICTURES))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s holds no pictures; --rebake is for .glb, .gltf and .obj",
                        format->name);
    cw_status st = cli_check_texture(&texture, r->args->output, r->args->written.format, err);
    if (st == CW_OK && args_of(r)->looks)
        st = cli_looks_parse(args_of(r)->looks, &((uv_state *)r->state)->limit, err);
    return st;
}

/* --- work --------------------------------------------------------------------------------- */

/* Copies each piece, and lists what comes out. NULL without memory */
static cw_status copy_pieces(cli_pieces *p, cw_mesh ***list, cw_error *err)
{
    cw_status st = CW_OK;
    *list = calloc(p->count, sizeof **list);
    if (!*list)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        (*list)[n] = &p->piece[n].out;
        st = cwi_mesh_copy(&p->piece[n].input, &p->piece[n].out, err);
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
    return cli_find_length(&r->pieces, "--reach", &args_of(r)->texture.reach, &s->reach_mm,
                           err);
}

static const cw_image *image_or_none(const cw_image *image)
{
    return image->pixels ? image : NULL;
}

/* Compares the pieces and their maps with the full mesh. */
static cw_status compare_looks(cli_mesh_run *r, cw_mesh *const *list, const cw_image *images,
                               cw_error *err)
{
    uv_state *s = r->state;
    const cw_surface_look full = {.mesh = &s->full.mesh};
    const cw_appearance_desc desc = {.threads = r->threads,
                                     .progress = cli_progress(8, "view")};
    cw_surface_look *pieces = calloc(r->pieces.count, sizeof *pieces);
    for (size_t n = 0; n < r->pieces.count && pieces; n++)
        pieces[n] =
            (cw_surface_look){.mesh = list[n],
                              .normal_map = image_or_none(&images[CW_MAP_NORMALS]),
                              .color_map = image_or_none(&images[CW_MAP_COLORS]),
                              .occlusion_map = image_or_none(&images[CW_MAP_OCCLUSION])};
    cw_status st = pieces ? cw_appearance_measure(&full, 1, pieces, r->pieces.count, &desc,
                                                  &s->looks, &s->bare_looks, err)
                          : cwi_fail_memory(err);
    free(pieces);
    return st == CW_OK ? cli_looks_hold(&s->limit, &s->looks, err) : st;
}

static cw_status bake_full(cli_mesh_run *r, cw_mesh *const *list, const cw_bake_desc *desc,
                           cw_error *err)
{
    uv_state *s = r->state;
    cw_image images[CW_MAP_COUNT] = {{0}};
    cw_status st = s->full.mesh.normals ? CW_OK : cw_mesh_weld(&s->full.mesh, NULL, err);
    if (st == CW_OK && !s->full.mesh.normals)
        st = cw_mesh_normals(&s->full.mesh, err);
    if (st == CW_OK)
        st = cw_bake_meshes((const cw_mesh *const *)list, r->pieces.count, &s->full.mesh, desc,
                            images, &s->baked, err);
    if (st == CW_ERR_ARGUMENT && cli_find_maps(&args_of(r)->texture) >> CW_MAP_COLORS & 1)
        r->blamed = s->full.path;
    if (st == CW_OK)
        st = cli_encode_maps(images, &s->maps, err);
    if (st == CW_OK && args_of(r)->looks)
        st = compare_looks(r, list, images, err);
    for (int m = 0; m < CW_MAP_COUNT; m++)
        cw_image_free(&images[m]);
    return st;
}

static cw_status bake_pictures(cli_mesh_run *r, cw_mesh *const *list, const cw_bake_desc *desc,
                               cw_error *err)
{
    uv_state *s = r->state;
    cw_mesh all = {0};
    cw_status st = cwi_gather_meshes((const cw_mesh *const *)list, NULL, r->pieces.count, true,
                                     true, &all, err);
    if (st == CW_OK)
        st = cli_rebake_run(&s->rebaked, &all, desc, &s->maps.textures, err);
    cw_mesh_free(&all);
    return st;
}

/* Bakes the maps of all pieces. Normals that the full mesh lacks are made once its corners are
 * joined. */
static cw_status bake(cli_mesh_run *r, cw_mesh *const *list, cw_error *err)
{
    uv_state *s = r->state;
    cw_bake_desc desc = cli_bake_desc(&args_of(r)->texture, s->reach_mm);
    cw_status st = CW_OK;
    desc.size = s->facts.size;
    desc.margin = s->facts.margin;
    desc.threads = r->threads;
    desc.progress = cli_progress((double)desc.size * desc.size / 1e6, "Mtexel");
    for (size_t n = 0; n < r->pieces.count && st == CW_OK; n++)
        st = list[n]->normals ? CW_OK : cw_mesh_normals(list[n], err);
    if (st == CW_OK && r->args->source)
        st = bake_full(r, list, &desc, err);
    if (st == CW_OK && args_of(r)->rebake)
        st = bake_pictures(r, list, &desc, err);
    r->pieces.textures = args_of(r)->rebake ? &s->maps.textures : cli_find_textures(&s->maps);
    return st;
}

/* Forgets the pictures that the mesh came with, and says so unless they are carried over. */
static void drop_pictures(cli_mesh_run *r)
{
    bool had_pictures = false;
    for (size_t n = 0; n < r->pieces.count; n++) {
        had_pictures = had_pictures || r->pieces.piece[n].textures;
        r->pieces.piece[n].textures = NULL;
    }
    if (had_pictures && !args_of(r)->rebake)
        cli_say(
            "%s: pictures lost: they lie by the texture coordinates that it had; --rebake %s "
            "carries them over",
            r->mesh.path, r->mesh.path);
}

static cw_status lay_flat(cli_mesh_run *r, cw_error *err)
{
    uv_state *s = r->state;
    cw_mesh **list = NULL;
    cw_atlas_desc desc = cli_atlas_desc(&args_of(r)->texture);
    desc.threads = r->threads;
    desc.progress = cli_progress((double)r->pieces.triangles / 1e6, "Mtriangle");
    drop_pictures(r);
    cw_status st = copy_pieces(&r->pieces, &list, err);
    if (st == CW_OK)
        st = cw_meshes_atlas(list, NULL, r->pieces.count, &desc, &s->facts, err);
    if (st == CW_OK && (r->args->source || args_of(r)->rebake))
        st = bake(r, list, err);
    free(list);
    return st;
}

/* Writes the maps that the file has no place for. */
static cw_status write_maps(cli_mesh_run *r, cw_error *err)
{
    return cli_write_maps(&((const uv_state *)r->state)->maps, r->outputs.path[0],
                          r->args->written.no_clobber, err);
}

static const cli_mesh_command uv = {
    .name = "uv",
    .check = check_values,
    .prepare = read_full,
    .resolve = resolve_reach,
    .work = lay_flat,
    .report = report_facts,
    .judge = write_maps,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_uv(void *args, cw_error *err)
{
    uv_state state = {0};
    const cw_status st = cli_run_mesh_command(&uv, args, &state, 1, err);
    cli_free_mesh(&state.full);
    cli_free_maps(&state.maps);
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
