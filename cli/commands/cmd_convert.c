/* The command convert: writes a mesh in another format, merged or split into its parts. */
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/inputs/cut_options.h"
#include "cli/results/mesh_write_options.h"
#include "cli/results/output_names.h"
#include "cli/results/write_result.h"
#include "core/base/status.h"

#include <string.h>

typedef struct convert_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    cli_written written;
    const char *output, *json;
    int progress;
    cli_plane cut;
    bool merge, split, check, orient;
} convert_args;

static const convert_args defaults = {.check = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Mesh to write, in the format of its extension; may hold {stem}, with --split {name} "
     "and {part}",
     offsetof(convert_args, output), CLI_VALUES_MESH_OUTPUT},
    CLI_HEADED("Parts and checks"),
    {"merge", 0, CLI_FLAG, NULL,
     "Join all parts to one mesh (off: keep parts where the format has them)",
     offsetof(convert_args, merge)},
    {"split", 0, CLI_FLAG, NULL, "Write a file for each part (off)",
     offsetof(convert_args, split)},
    {"orient", 0, CLI_FLAG, NULL,
     "Flip shells that face the wrong way: outer ones outward, cavities inward (off)",
     offsetof(convert_args, orient)},
    {"cut-plane", 0, CLI_PLANE, "PLANE",
     "Cut by a plane, keep what is above, and close it flat: z=5mm, z=10% of the box, -z=5mm keeps "
     "what is below, or x,y,z:nx,ny,nz (off)",
     offsetof(convert_args, cut)},
    {"check", 0, CLI_FLAG, NULL, "Measure the mesh: closed, manifold, size (on; --no-check)",
     offsetof(convert_args, check)},
    CLI_JSON_OPTION(convert_args),
    CLI_WRITTEN_OPTIONS(convert_args),
    CLI_COMPRESS_OPTIONS(convert_args),
    CLI_MESH_INPUT_OPTIONS(convert_args),
    CLI_PROGRESS_OPTION(convert_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"merge", CLI_EXCLUDES, "split"},
    CLI_COMPRESS_RULES,
};

typedef struct run_state {
    const convert_args *args;
    cli_mesh mesh;
    cw_cut_facts cut;
    cli_outputs outputs;
    cli_report report;
    double start;
} run_state;

static cw_write_desc write_desc(const run_state *s)
{
    return cli_written_desc(&s->args->written, &s->args->compress, &s->mesh);
}

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    const convert_args *args = s->args;
    cli_json_written(j, &args->written, made->path);
    cli_json_bool(j, "merge", args->merge);
    cli_json_bool(j, "split", args->split);
    cli_json_bool(j, "orient", args->orient);
    if (args->cut.given)
        cli_json_text(j, "cut_plane", cli_plane_text(&args->cut));
}

static void put_facts(cli_json *j, const void *p)
{
    const run_state *s = p;
    if (s->mesh.file.format)
        cli_json_mesh_file(j, "input", &s->mesh);
    if (s->args->cut.given)
        cli_json_cut(j, &s->cut);
}

/* The report is an output, too: none is written when it is the input or a mesh. */
static cw_status check_outputs(run_state *s, cw_error *err)
{
    const convert_args *args = s->args;
    const cw_write_desc desc = write_desc(s);
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->outputs.count && args->json && st == CW_OK; n++)
        st = cli_check_apart(args->json, s->outputs.path[n], err);
    if (st != CW_OK)
        s->report.path = NULL;
    return st == CW_OK ? cli_check_outputs(&s->outputs, args->common.inputs, 1, &desc, err)
                       : st;
}

/* Checks everything that can be refused before the input is read. The names of --split are
 * known only after reading. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const convert_args *args = s->args;
    const char *const *input = args->common.inputs;
    cw_status st = args->json ? cli_check_output(args->json, input, 1, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    st = cli_check_compress(&args->compress, false, err);
    if (st != CW_OK)
        return st;
    if (args->split)
        return CW_OK;
    st = cli_name_output(&s->outputs, args->output, input[0], err);
    return st == CW_OK ? check_outputs(s, err) : st;
}

static cw_status read_input(run_state *s, cw_error *err)
{
    const convert_args *args = s->args;
    const char *path = args->common.inputs[0];
    const cw_format *format = cw_mesh_format(args->output, args->written.format);
    const bool parts =
        args->split || (!args->merge && format && format->keeps & CW_KEEPS_PARTS);
    cli_report_begin(&s->report);
    cw_status st = parts ? cli_read_parts(path, args->input.reader, &args->input, &s->mesh, err)
                         : cli_read_mesh(path, args->input.reader, &args->input, &s->mesh, err);
    if (st == CW_OK && args->orient)
        st = cli_orient_mesh(&s->mesh, (int)args->input.threads, err);
    if (st == CW_OK && args->cut.given)
        st = cli_cut_parts(&args->cut, &s->mesh, &s->cut, err);
    if (st != CW_OK)
        return st;
    cli_report_end(&s->report, "read", 1, cli_mesh_triangles(&s->mesh));
    return cli_mesh_triangles(&s->mesh)
               ? CW_OK
               : cwi_fail(err, CW_ERR_EMPTY, "%s: it has no triangles", path);
}

static cw_status convert_file(run_state *s, size_t n, const cw_part *parts, size_t count,
                              cw_error *err)
{
    const cli_delivery how = {.input = s->mesh.path,
                              .write = write_desc(s),
                              .compress = &s->args->compress,
                              .threads = (int)s->args->input.threads,
                              .unchecked = !s->args->check,
                              .unpromised = true,
                              .tell_dropped = true};
    cli_made *made = cli_report_next(&s->report, s->outputs.path[n], 0);
    made->name = s->args->split ? parts->name ? parts->name : "" : NULL;
    cw_status st = cli_deliver(&s->report, &how, parts, count, 0, s->start, err);
    s->start = cli_seconds();
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status convert_parts(run_state *s, cw_error *err)
{
    const cli_mesh *m = &s->mesh;
    cw_status st = cli_report_reserve(&s->report, m->part_count, err);
    if (st == CW_OK)
        st = cli_name_part_outputs(&s->outputs, s->args->output, m->path, m->parts,
                                   m->part_count, err);
    if (st == CW_OK)
        st = check_outputs(s, err);
    for (size_t n = 0; n < m->part_count && st == CW_OK; n++)
        st = convert_file(s, n, &m->parts[n], 1, err);
    return st;
}

static cw_status convert_mesh(void *state, cw_error *err)
{
    run_state *s = state;
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = read_input(s, err);
    if (st != CW_OK)
        return st;
    if (s->args->split)
        return convert_parts(s, err);
    if (s->mesh.parts)
        return convert_file(s, 0, s->mesh.parts, s->mesh.part_count, err);
    return convert_file(s, 0, &(cw_part){.mesh = &s->mesh.mesh}, 1, err);
}

static cw_status run_convert(void *p, cw_error *err)
{
    const convert_args *args = p;
    run_state s = {.args = args, .start = cli_seconds()};
    s.report.command = "convert";
    s.report.several = args->split ? "parts" : NULL;
    s.report.main_step = "write";
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = convert_mesh,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.report, err);
    cli_free_mesh(&s.mesh);
    cli_free_outputs(&s.outputs);
    return st;
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
