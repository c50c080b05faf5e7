/* The command convert: writes a mesh in another format, merged or split into its parts. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/inputs/cut_options.h"
#include "core/base/status.h"

typedef struct convert_args {
    cli_mesh_args mesh;
    cli_plane cut;
    bool split, check;
} convert_args;

static const convert_args *args_of(const cli_mesh_run *r)
{
    return (const convert_args *)r->args;
}

static const convert_args defaults = {.check = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(", with --split {name} and {part}"),
    CLI_HEADED("Parts and checks"),
    {"merge", 0, CLI_FLAG, NULL,
     "Join all parts to one mesh (off: keep parts where the format has them)",
     offsetof(cli_mesh_args, merge)},
    {"split", 0, CLI_FLAG, NULL, "Write a file for each part (off)",
     offsetof(convert_args, split)},
    CLI_MESH_ORIENT,
    {"cut-plane", 0, CLI_PLANE, "PLANE",
     "Cut by a plane, keep what is above, and close it flat: z=5mm, z=10% of the box, -z=5mm keeps "
     "what is below, or x,y,z:nx,ny,nz (off)",
     offsetof(convert_args, cut)},
    {"check", 0, CLI_FLAG, NULL, "Measure the mesh: closed, manifold, size (on; --no-check)",
     offsetof(convert_args, check)},
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"merge", CLI_EXCLUDES, "split"},
    CLI_COMPRESS_RULES,
};

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const convert_args *args = args_of(r);
    cli_json_written(j, &r->args->written, made->path);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_bool(j, "split", args->split);
    cli_json_bool(j, "orient", r->args->orient);
    if (args->cut.given)
        cli_json_text(j, "cut_plane", cli_plane_text(&args->cut));
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    if (args_of(r)->cut.given)
        cli_json_cut(j, r->state);
}

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    (void)err;
    r->reads_parts = r->reads_parts || args_of(r)->split;
    r->report.several = args_of(r)->split ? "parts" : NULL;
    return CW_OK;
}

/* The names of --split are known only after reading. */
static cw_status name_outputs(cli_mesh_run *r, cw_error *err)
{
    return args_of(r)->split
               ? CW_OK
               : cli_name_output(&r->outputs, r->args->output, r->args->common.inputs[0], err);
}

static cw_status cut_mesh(cli_mesh_run *r, cw_error *err)
{
    const cli_plane *cut = &args_of(r)->cut;
    return cut->given ? cli_cut_parts(cut, &r->mesh, r->state, err) : CW_OK;
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

static cw_status convert_parts(cli_mesh_run *r, cw_error *err)
{
    const cli_mesh *m = &r->mesh;
    cw_status st = cli_report_reserve(&r->report, m->part_count, err);
    if (st == CW_OK)
        st = cli_name_part_outputs(&r->outputs, r->args->output, m->path, m->parts,
                                   m->part_count, err);
    if (st == CW_OK)
        st = cli_check_mesh_outputs(r, err);
    for (size_t n = 0; n < m->part_count && st == CW_OK; n++)
        st = convert_file(r, n, &m->parts[n], 1, err);
    return st;
}

static cw_status convert_mesh(cli_mesh_run *r, cw_error *err)
{
    const cli_mesh *m = &r->mesh;
    if (!cli_mesh_triangles(m))
        return cwi_fail(err, CW_ERR_EMPTY, "%s: it has no triangles", m->path);
    if (args_of(r)->split)
        return convert_parts(r, err);
    return m->parts ? convert_file(r, 0, m->parts, m->part_count, err)
                    : convert_file(r, 0, &(cw_part){.mesh = &m->mesh}, 1, err);
}

static const cli_mesh_command convert = {
    .name = "convert",
    .main_step = "write",
    .piecing = CLI_PIECES_NONE,
    .check = check_values,
    .name_outputs = name_outputs,
    .prepare = cut_mesh,
    .make = convert_mesh,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_convert(void *args, cw_error *err)
{
    cw_cut_facts cut = {0};
    return cli_run_mesh_command(&convert, args, &cut, 1, err);
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
