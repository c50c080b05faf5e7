/* The command repair: its options, the work part by part, and what is printed and reported. */
#include "cli/commands/repair_facts.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/mesh_parts.h"
#include "cli/results/mesh_write_options.h"
#include "cli/results/output_names.h"
#include "cli/results/write_result.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct repair_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    cli_written written;
    const char *output, *json;
    cli_length weld, fill, wrap;
    int progress;
    bool flat, keep_intersections, report_only, merge, measure;
} repair_args;

typedef struct run_state {
    const repair_args *args;
    int threads;
    cli_mesh mesh;
    cli_pieces pieces;
    cw_repair_desc desc;
    cw_repair_facts facts;
    bool is_repaired;
    char found[160]; /* for the line */
    cli_outputs outputs;
    cli_report report;
    double start;
} run_state;

static const repair_args defaults = {.measure = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Mesh to write, in the format of its extension; may hold {stem}",
     offsetof(repair_args, output), CLI_VALUES_MESH_OUTPUT},
    {"report-only", 0, CLI_FLAG, NULL,
     "Write no mesh; tell what is wrong and what would be done; exit 1 if anything is (off)",
     offsetof(repair_args, report_only)},
    CLI_HEADED("Repair"),
    {"weld", 0, CLI_LENGTH, "L",
     "Merge vertices this near to each other: 0.01mm, 0.001% of the diagonal (equal positions)",
     offsetof(repair_args, weld)},
    {"fill", 0, CLI_LENGTH, "L", "Largest hole to fill, across: 5mm, 2% of the diagonal (all)",
     offsetof(repair_args, fill)},
    {"flat", 0, CLI_FLAG, NULL,
     "Fill holes by the least area (off: smoothly, so that an open tube gets domes)",
     offsetof(repair_args, flat)},
    {"keep-intersections", 0, CLI_FLAG, NULL,
     "Leave triangles that intersect each other as they are (off)",
     offsetof(repair_args, keep_intersections)},
    {"wrap", 0, CLI_LENGTH, "L",
     "Last resort: if defects are left, wrap the mesh; closes gaps narrower than this; needs "
     "CGAL (GPL)",
     offsetof(repair_args, wrap)},
    CLI_HEADED("What is read and reported"),
    {"merge", 0, CLI_FLAG, NULL,
     "Join all parts to one mesh (off: each by itself, where the format has parts)",
     offsetof(repair_args, merge)},
    {"measure", 0, CLI_FLAG, NULL, "Measure the distance to the input (on; --no-measure)",
     offsetof(repair_args, measure)},
    CLI_JSON_OPTION(repair_args),
    CLI_WRITTEN_OPTIONS(repair_args),
    CLI_COMPRESS_OPTIONS(repair_args),
    CLI_MESH_INPUT_OPTIONS(repair_args),
    CLI_PROGRESS_OPTION(repair_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output report-only"},
    {"output", CLI_EXCLUDES, "report-only"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    cli_json_number(j, "weld_mm", s->desc.weld_mm);
    cli_json_number(j, "fill_mm", s->desc.max_hole_mm);
    cli_json_bool(j, "flat", s->args->flat);
    cli_json_bool(j, "keep_intersections", s->args->keep_intersections);
    cli_json_number(j, "wrap_mm", s->desc.wrap_mm);
    cli_json_bool(j, "report_only", s->args->report_only);
    cli_json_bool(j, "merge", s->args->merge);
    if (made->path)
        cli_json_written(j, &s->args->written, made->path);
}

static void put_facts(cli_json *j, const void *p)
{
    const run_state *s = p;
    if (s->mesh.file.format)
        cli_json_mesh_file(j, "input", &s->mesh);
    if (!s->is_repaired)
        return;
    cli_json_open(j, "repair", '{');
    cli_json_repair(j, &s->facts);
    cli_json_close(j, '}');
}

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status check_values(const repair_args *args, cw_error *err)
{
    return cli_check_compress(&args->compress, false, err);
}

/* The report is an output, too: none is written when it is the input or the mesh. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const repair_args *args = s->args;
    cw_status st =
        args->json ? cli_check_output(args->json, args->common.inputs, 1, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    st = check_values(args, err);
    if (st != CW_OK || args->report_only)
        return st;
    st = cli_name_output(&s->outputs, args->output, args->common.inputs[0], err);
    if (st == CW_OK && args->json) {
        st = cli_check_apart(args->json, s->outputs.path[0], err);
        s->report.path = st == CW_OK ? args->json : NULL;
    }
    const cw_write_desc desc = cli_written_desc(&args->written, &args->compress, &s->mesh);
    return st == CW_OK ? cli_check_outputs(&s->outputs, args->common.inputs, 1, &desc, err)
                       : st;
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status resolve_lengths(run_state *s, cw_error *err)
{
    const repair_args *args = s->args;
    s->desc = (cw_repair_desc){.flat_holes = args->flat,
                               .keep_crossings = args->keep_intersections,
                               .threads = s->threads};
    cw_status st = cli_find_length(&s->pieces, "--weld", &args->weld, &s->desc.weld_mm, err);
    if (st == CW_OK)
        st = cli_find_length(&s->pieces, "--fill", &args->fill, &s->desc.max_hole_mm, err);
    return st == CW_OK
               ? cli_find_length(&s->pieces, "--wrap", &args->wrap, &s->desc.wrap_mm, err)
               : st;
}

/* Fails before any work when a wrap is asked for that this build cannot make. */
static cw_status check_wrap(const repair_args *args, cw_error *err)
{
    if (!args->wrap.given || cw_repair_has_cgal())
        return CW_OK;
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "--wrap needs CGAL, which this build has not: package libcgal-dev, or "
                    "cubewright-cgal");
}

static cw_status read_input(run_state *s, cw_error *err)
{
    const repair_args *args = s->args;
    const char *path = args->common.inputs[0], *reader = args->input.reader;
    const cw_format *format =
        args->output ? cw_mesh_format(args->output, args->written.format) : NULL;
    const bool parts =
        !args->merge && (args->report_only || (format && format->keeps & CW_KEEPS_PARTS));
    cli_report_begin(&s->report);
    cw_status st = parts ? cli_read_parts(path, reader, &args->input, &s->mesh, err)
                         : cli_read_mesh(path, reader, &args->input, &s->mesh, err);
    if (st == CW_OK)
        st = cli_take_pieces(&s->pieces, &s->mesh, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "read", 1, s->pieces.triangles);
    return st == CW_OK ? resolve_lengths(s, err) : st;
}

static cw_status repair_piece(run_state *s, cli_piece *p, cw_repair_facts *facts, cw_error *err)
{
    cw_repair_desc desc = s->desc;
    desc.progress = cli_progress((double)p->input.triangle_count / 1e6, "Mtriangle");
    return cw_mesh_repair(&p->input, &desc, s->args->report_only ? NULL : &p->out, facts, err);
}

/* Repairs all parts. Those without volume are left out, unless there is no other. */
static cw_status repair_pieces(run_state *s, cw_error *err)
{
    const size_t count = s->pieces.count;
    size_t kept = 0;
    cw_status st = CW_OK;
    cli_report_begin(&s->report);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        cli_piece *p = &s->pieces.piece[n];
        cw_repair_facts facts = {0};
        st = repair_piece(s, p, &facts, err);
        const bool is_empty = st == CW_ERR_EMPTY;
        if (is_empty) {
            facts.is_sound = true;
            st = CW_OK;
        }
        cli_add_repair(&s->facts, &facts, n == 0);
        if (st == CW_OK && !is_empty)
            s->pieces.piece[kept++] = *p;
        if (st == CW_OK && (is_empty || kept - 1 != n))
            p->out = (cw_mesh){0};
    }
    s->pieces.count = st == CW_OK ? kept : count;
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    s->is_repaired = true;
    cli_report_end(&s->report, "repair", s->pieces.triangles, s->pieces.triangles);
    cli_tell_repair(s->mesh.path, &s->facts, s->desc.max_hole_mm, s->args->report_only);
    if (kept)
        return CW_OK;
    return cwi_fail(err, CW_ERR_EMPTY,
                    "%s: it encloses no volume: nothing is left; --wrap 0.5mm makes a solid of "
                    "its sheets",
                    s->mesh.path);
}

static cw_status measure_result(run_state *s, cli_made *made, cw_error *err)
{
    if (!s->args->measure)
        return CW_OK;
    cli_report_begin(&s->report);
    cw_status st = cli_compare_pieces(&s->pieces, s->threads, &made->compared, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "measure", s->pieces.triangles, s->pieces.triangles);
    return st;
}

static cw_status deliver_result(run_state *s, cw_error *err)
{
    const cli_delivery how = {
        .input = s->mesh.path,
        .write = cli_written_desc(&s->args->written, &s->args->compress, &s->mesh),
        .compress = &s->args->compress,
        .threads = s->threads,
        .unpromised = true,
        .found = s->found,
        .tell_dropped = true};
    cw_part *parts = NULL;
    snprintf(s->found, sizeof s->found, "; %s",
             !s->facts.crossings_after && !s->facts.is_undecided ? "no triangles intersect"
                                                                 : "triangles intersect");
    cw_status st = cli_list_parts(&s->pieces, &parts, err);
    if (st == CW_OK)
        st = cli_deliver(&s->report, &how, parts, s->pieces.count, 0, s->start, err);
    free(parts);
    return st;
}

/* Tells what is left in the mesh that was written, and what may help. */
static cw_status judge_result(const run_state *s, cw_error *err)
{
    char left[128];
    cli_name_left_defects(&s->facts, left, sizeof left);
    if (!left[0])
        return CW_OK;
    const char *advice = s->facts.holes_left   ? "a larger --fill closes more"
                         : s->args->wrap.given ? "try another --wrap"
                                               : "--wrap 0.5mm makes a solid around it";
    return cwi_fail(err, CW_ERR_CHECK, "%s: %s; %s", s->outputs.path[0], left, advice);
}

/* Ends a report: fails if a repair is needed. */
static cw_status judge_input(const run_state *s, cw_error *err)
{
    char left[128];
    const char *path = s->mesh.path;
    cli_name_left_defects(&s->facts, left, sizeof left);
    if (!s->facts.is_needed) {
        cli_result("%s: closed, manifold, and no triangles intersect: nothing to repair\n",
                   path);
        return CW_OK;
    }
    return left[0]
               ? cwi_fail(err, CW_ERR_CHECK, "%s: needs repair, and then %s", path, left)
               : cwi_fail(err, CW_ERR_CHECK, "%s: needs repair, which makes it sound", path);
}

static void warn_without_cgal(run_state *s)
{
    if (s->facts.lacks_cgal)
        cli_report_warn(&s->report, "shells that intersect were not united, which needs CGAL "
                                    "(libcgal-dev): triangles around were replaced");
}

static cw_status repair_mesh(void *state, cw_error *err)
{
    run_state *s = state;
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = check_wrap(s->args, err);
    if (st == CW_OK)
        st = read_input(s, err);
    if (st != CW_OK)
        return st;
    cli_made *made =
        cli_report_next(&s->report, s->args->report_only ? NULL : s->outputs.path[0], 0);
    st = repair_pieces(s, err);
    if (st == CW_OK)
        warn_without_cgal(s);
    if (st == CW_OK && s->args->report_only)
        st = judge_input(s, err);
    else if (st == CW_OK) {
        st = measure_result(s, made, err);
        if (st == CW_OK)
            st = deliver_result(s, err);
        if (st == CW_OK)
            st = judge_result(s, err);
    }
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status run_repair(void *p, cw_error *err)
{
    const repair_args *args = p;
    run_state s = {.args = args, .threads = (int)args->input.threads, .start = cli_seconds()};
    s.report.command = "repair";
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = repair_mesh,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.report, err);
    cli_free_pieces(&s.pieces);
    cli_free_mesh(&s.mesh);
    cli_free_outputs(&s.outputs);
    return st;
}

const cli_command cli_repair = {
    .name = "repair",
    .usage = "MESH -o MESH [--fill L] [--wrap L] [options]",
    .about = "Repair a broken mesh: a closed manifold without intersections",
    .page = cli_page_repair,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(repair_args),
    .defaults = &defaults,
    .run = run_repair,
};
