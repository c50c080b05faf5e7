/* The command convert: writes a mesh in another format, merged or split into its parts. */
#include "cli/assets/orient_print.h"
#include "cli/commands/command_rows.h"
#include "cli/commands/convert_asset.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/cut_options.h"
#include "cli/inputs/place_options.h"
#include "cli/results/detail_levels.h"
#include "core/base/status.h"

#include <stdlib.h>

typedef struct convert_args {
    cli_mesh_args mesh;
    cli_placing placing;
    cli_plane cut;
    cli_number crease;
    cli_number orient_print;
    bool split, check;
    int profile; /* 0: none, else 1 + that of cli_find_asset() */
    int pivot;   /* of a profile's levels */
} convert_args;

typedef struct convert_state {
    cw_cut_facts cut;
    cw_orient_facts orient; /* of --orient-print */
} convert_state;

static const convert_args *args_of(const cli_mesh_run *r)
{
    return (const convert_args *)r->args;
}

static const cli_asset *asset_of(const cli_mesh_run *r)
{
    return cli_find_asset(args_of(r)->profile - 1);
}

static const convert_args defaults = {.mesh.compress.kind = -1, .check = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(", with --split {name} and {part}"),
    CLI_HEADED("Parts and checks"),
    {"merge", 0, CLI_FLAG, NULL,
     "Join all parts to one mesh (off: keep parts where the format has them)",
     offsetof(cli_mesh_args, merge)},
    {"split", 0, CLI_FLAG, NULL,
     "Write a file for each part; of a mesh that is one, for each component (off)",
     offsetof(convert_args, split)},
    CLI_MESH_ORIENT,
    CLI_ORIENT_PRINT_OPTION(offsetof(convert_args, orient_print)),
    {"cut-plane", 0, CLI_PLANE, "PLANE",
     "Cut by a plane, keep what is above, and close it flat: z=5mm, z=10% of the box, -z=5mm keeps "
     "what is below, or x,y,z:nx,ny,nz (off)",
     offsetof(convert_args, cut)},
    {"crease-angle", 0, CLI_NUMBER, "off/DEG",
     "New normals, which part at edges with a larger angle, for GLB and OBJ (off)",
     offsetof(convert_args, crease)},
    {"check", 0, CLI_FLAG, NULL, "Measure the mesh: closed, manifold, size (on; --no-check)",
     offsetof(convert_args, check)},
    {"profile", 'p', CLI_CHOICE, "none/" CLI_ASSET_CHOICES,
     "Make an asset within a budget: levels of detail, texture coordinates and a normal map (none)",
     offsetof(convert_args, profile)},
    CLI_PLACING_OPTIONS(offsetof(convert_args, placing)),
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"merge", CLI_EXCLUDES, "split"},
    {"profile", CLI_EXCLUDES, "split cut-plane no-check"},
    CLI_COMPRESS_RULES,
};

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const convert_args *args = args_of(r);
    cli_json_written(j, &r->args->written, made->path);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_bool(j, "split", args->split);
    cli_json_bool(j, "orient", r->args->orient);
    if (asset_of(r))
        cli_json_text(j, "profile", asset_of(r)->name);
    cli_json_placing(j, &args->placing);
    cli_json_pivot(j, args->pivot);
    if (args->cut.given)
        cli_json_text(j, "cut_plane", cli_plane_text(&args->cut));
    if (cli_crease_degrees(&args->crease) > 0)
        cli_json_number(j, "crease_angle", args->crease.value);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const convert_state *s = r->state;
    if (args_of(r)->cut.given)
        cli_json_cut(j, &s->cut);
    cli_json_orient(j, &s->orient);
}

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    r->reads_parts = (r->reads_parts || args_of(r)->split) && !asset_of(r);
    r->report.several = args_of(r)->split ? "parts" : asset_of(r) ? "levels" : NULL;
    if (asset_of(r) && !cw_simplify_available())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "--profile needs OpenMesh, which this build lacks: install "
                        "libopenmesh-dev and build again");
    if (asset_of(r) && !cli_is_gltf(r->args->output, r->args->written.format))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--profile %s: levels and maps in one file are for .glb and .gltf",
                        asset_of(r)->name);
    cw_status st = cli_check_crease(&args_of(r)->crease, err);
    if (st == CW_OK)
        st = cli_check_orient(&args_of(r)->orient_print, err);
    return st == CW_OK ? cli_check_placing(&args_of(r)->placing, err) : st;
}

/* The names of --split are known only after reading. */
static cw_status name_outputs(cli_mesh_run *r, cw_error *err)
{
    cli_counts lod = {0};
    if (asset_of(r)) {
        cli_fill_levels(asset_of(r), &lod);
        return cli_name_detail_levels(&r->outputs, r->args->output, r->args->written.format,
                                      r->args->common.inputs[0], &lod, true, err);
    }
    return args_of(r)->split
               ? CW_OK
               : cli_name_output(&r->outputs, r->args->output, r->args->common.inputs[0], err);
}

/* Gives a mesh new normals, which part at creases. Vertices that were split where they part are one then. */
static cw_status part_normals(cw_mesh *mesh, double degrees, size_t *creases, cw_error *err)
{
    size_t found = 0;
    cw_status st = cw_mesh_weld(mesh, NULL, err);
    if (st == CW_OK)
        st = cw_mesh_normals(mesh, err);
    if (st == CW_OK)
        st = cw_mesh_crease_normals(mesh, degrees, NULL, &found, err);
    *creases += found;
    return st;
}

static cw_status part_all_normals(cli_mesh_run *r, cw_error *err)
{
    const double degrees = args_of(r)->crease.value;
    cli_mesh *m = &r->mesh;
    size_t creases = 0;
    cw_status st = m->parts ? CW_OK : part_normals(&m->mesh, degrees, &creases, err);
    for (size_t n = 0; m->parts && n < m->part_count && st == CW_OK; n++)
        st = part_normals((cw_mesh *)(uintptr_t)m->parts[n].mesh, degrees, &creases, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, m->path);
    cli_say("%s: normals part at %s edge%s", m->path, cli_count(creases),
            creases == 1 ? "" : "s");
    return CW_OK;
}

/* Turns the mesh for printing, places it, then cuts it there. */
static cw_status change_mesh(cli_mesh_run *r, cw_error *err)
{
    const convert_args *args = args_of(r);
    cw_status st = CW_OK;
    convert_state *s = r->state;
    if (args->orient_print.given)
        st = cli_orient_for_print(&args->orient_print, r->threads, &r->mesh, &s->orient, err);
    if (st == CW_OK && cli_places(&args->placing))
        st = cli_place_parts(&args->placing, &r->mesh, err);
    if (st == CW_OK && args->cut.given)
        st = cli_cut_parts(&args->cut, &r->mesh, &s->cut, err);
    return st == CW_OK && cli_crease_degrees(&args->crease) > 0 && !asset_of(r)
               ? part_all_normals(r, err)
               : st;
}

static cw_status convert_file(cli_mesh_run *r, size_t n, const cw_part *parts, size_t count,
                              cw_error *err)
{
    cli_delivery how = cli_mesh_delivery(r);
    how.unchecked = !args_of(r)->check;
    cli_made *made = cli_report_next(&r->report, r->outputs.path[n], 0);
    made->name = args_of(r)->split ? parts->name ? parts->name : "" : NULL;
    cw_status st = cli_deliver(&r->report, &how, parts, count, 0, r->start, err);
    r->start = cli_seconds();
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status convert_parts(cli_mesh_run *r, const cw_part *parts, size_t count,
                               cw_error *err)
{
    cw_status st = cli_report_reserve(&r->report, count, err);
    if (st == CW_OK)
        st = cli_name_part_outputs(&r->outputs, r->args->output, r->mesh.path, parts, count,
                                   err);
    if (st == CW_OK)
        st = cli_check_mesh_outputs(r, err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = convert_file(r, n, &parts[n], 1, err);
    return st;
}

/* Splits a mesh that is one part into its solids, each with its label. */
static cw_status convert_solids(cli_mesh_run *r, const cw_mesh *mesh, const cw_label *label,
                                cw_error *err)
{
    cw_mesh *solids = NULL;
    size_t count = 0;
    cw_status st = cw_mesh_split(mesh, &solids, &count, err);
    cw_part *parts = st == CW_OK ? calloc(count, sizeof *parts) : NULL;
    if (st == CW_OK && !parts)
        st = cwi_fail(err, CW_ERR_NO_MEMORY, "out of memory");
    for (size_t n = 0; n < count && parts; n++)
        parts[n] = (cw_part){.mesh = &solids[n], .label = label};
    if (st == CW_OK)
        st = convert_parts(r, parts, count, err);
    free(parts);
    cw_meshes_free(solids, count);
    return st;
}

static cw_status convert_mesh(cli_mesh_run *r, cw_error *err)
{
    const cli_mesh *m = &r->mesh;
    if (!cli_mesh_triangles(m))
        return cwi_fail(err, CW_ERR_EMPTY, "%s: it has no triangles", m->path);
    if (asset_of(r))
        return cli_convert_asset(r, asset_of(r), args_of(r)->pivot,
                                 cli_crease_degrees(&args_of(r)->crease), err);
    if (args_of(r)->split && m->part_count > 1)
        return convert_parts(r, m->parts, m->part_count, err);
    if (args_of(r)->split)
        return convert_solids(r, m->parts ? m->parts[0].mesh : &m->mesh,
                              m->parts ? m->parts[0].label : NULL, err);
    return m->parts ? convert_file(r, 0, m->parts, m->part_count, err)
                    : convert_file(r, 0, &(cw_part){.mesh = &m->mesh, .textures = m->textures},
                                   1, err);
}

static const cli_mesh_command convert = {
    .name = "convert",
    .main_step = "write",
    .piecing = CLI_PIECES_NONE,
    .check = check_values,
    .name_outputs = name_outputs,
    .prepare = change_mesh,
    .make = convert_mesh,
    .put_params = put_params,
    .put_facts = put_facts,
};

/* Sets what a profile asks for and was not given. Its levels are moved to the pivot when they are made. */
static void fill_profile(convert_args *args)
{
    const cli_asset *asset = cli_find_asset(args->profile - 1);
    int *compression = &args->mesh.compress.kind;
    if (*compression < 0)
        *compression = asset ? asset->compression : CW_COMPRESS_NONE;
    if (asset) {
        args->pivot = args->placing.pivot;
        args->placing.pivot = CLI_PIVOT_FILE;
    }
}

static cw_status run_convert(void *args, cw_error *err)
{
    convert_state state = {0};
    fill_profile(args);
    return cli_run_mesh_command(&convert, args, &state, 1 + CW_BUDGET_LEVELS, err);
}

const cli_command cli_convert = {
    .name = "convert",
    .usage = "MESH -o MESH [options]",
    .about = "Convert a mesh to another format, unit or coordinate frame",
    .page = cli_page_convert,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(convert_args),
    .defaults = &defaults,
    .run = run_convert,
};
