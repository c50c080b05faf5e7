/* The command smooth: its options, the work part by part, and what is printed and reported. */
#include "cli/commands/smooth_together.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/mesh_parts.h"
#include "cli/results/mesh_write_options.h"
#include "cli/results/output_names.h"
#include "cli/results/smoothed.h"
#include "cli/results/write_result.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"

#include <cubewright/smooth.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct smooth_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    cli_written written;
    const char *output, *json;
    size_t iterations; /* OWN_ITERATIONS: those of the method */
    cli_length max_move, width;
    int method;
    int progress;
    bool keep_border, allow_intersections, merge, orient, measure;
} smooth_args;

typedef struct run_state {
    const smooth_args *args;
    int threads;
    cli_mesh mesh;
    cli_pieces pieces;
    double max_move_mm; /* 0: half the mean edge of each part */
    double width_mm;    /* 0: a multiple of it */
    cw_smooth_facts facts;
    bool is_smoothed;
    char found[320]; /* for the line */
    cli_outputs outputs;
    cli_report report;
    double start;
} run_state;

#define OWN_ITERATIONS SIZE_MAX

static const smooth_args defaults = {
    .iterations = OWN_ITERATIONS, .keep_border = true, .measure = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Mesh to write, in the format of its extension; may hold {stem}",
     offsetof(smooth_args, output), CLI_VALUES_MESH_OUTPUT},
    CLI_HEADED("Smoothing"),
    {"method", 0, CLI_CHOICE, "taubin/hc/fair",
     "How vertices move: taubin keeps large shapes, hc a little more detail, fair removes waves by "
     "their length (taubin)",
     offsetof(smooth_args, method)},
    {"iterations", 'n', CLI_COUNT, "N",
     "Number of iterations: more remove longer waves of noise, and more detail (10; of fair 3)",
     offsetof(smooth_args, iterations)},
    {"width", 0, CLI_LENGTH, "L",
     "Of --method fair: waves of this length keep half of their height, shorter ones less (6 mean "
     "edges)",
     offsetof(smooth_args, width)},
    {"max-move", 'm', CLI_LENGTH, "L",
     "How far a vertex may move: 0.1mm, 0.05% of the box's diagonal, or 0.5vox where the file "
     "tells the voxels (half the mean edge)",
     offsetof(smooth_args, max_move)},
    CLI_HEADED("What is preserved"),
    {"keep-border", 0, CLI_FLAG, NULL,
     "Keep the borders of open surfaces as they are (on; --no-keep-border smooths them)",
     offsetof(smooth_args, keep_border)},
    {"allow-intersections", 0, CLI_FLAG, NULL,
     "Allow new intersections of triangles, which is faster (off)",
     offsetof(smooth_args, allow_intersections)},
    {"merge", 0, CLI_FLAG, NULL,
     "Join all parts to one mesh (off: each by itself, where the format has parts)",
     offsetof(smooth_args, merge)},
    {"orient", 0, CLI_FLAG, NULL,
     "Flip shells that face the wrong way: outer ones outward, cavities inward (off)",
     offsetof(smooth_args, orient)},
    {"measure", 0, CLI_FLAG, NULL,
     "Measure the distance to the input, which takes longer than smoothing (on; --no-measure)",
     offsetof(smooth_args, measure)},
    CLI_JSON_OPTION(smooth_args),
    CLI_WRITTEN_OPTIONS(smooth_args),
    CLI_COMPRESS_OPTIONS(smooth_args),
    CLI_MESH_INPUT_OPTIONS(smooth_args),
    CLI_PROGRESS_OPTION(smooth_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"width", CLI_NEEDS, "method=fair"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    cli_json_text(j, "method", cw_smooth_method_name((cw_smooth_method)s->args->method));
    cli_json_count(j, "iterations", s->facts.iterations);
    if (s->args->method == CW_SMOOTH_FAIR)
        cli_json_number(j, "width_mm", s->facts.width_mm);
    cli_json_number(j, "max_move_mm", s->facts.limit_mm);
    cli_json_bool(j, "keep_border", s->args->keep_border);
    cli_json_bool(j, "allow_intersections", s->args->allow_intersections);
    cli_json_bool(j, "merge", s->args->merge);
    cli_json_bool(j, "orient", s->args->orient);
    cli_json_count(j, "merged_vertices", s->pieces.merged);
    cli_json_written(j, &s->args->written, made->path);
}

static void put_facts(cli_json *j, const void *p)
{
    const run_state *s = p;
    if (s->mesh.file.format)
        cli_json_mesh_file(j, "input", &s->mesh);
    if (!s->is_smoothed)
        return;
    cli_json_smoothed(j, &s->facts);
}

static void tell_facts(run_state *s)
{
    const cw_smooth_facts *f = &s->facts;
    char text[CLI_SMOOTHED_TEXT];
    cli_smoothed_text(f, text);
    snprintf(s->found, sizeof s->found, "; %s", text);
    if (f->border)
        cli_say("%s: %s vertices at borders %s", s->mesh.path, cli_count(f->border),
                s->args->keep_border ? "stay (--no-keep-border smooths them)"
                                     : "move along them");
    if (f->junction)
        cli_say("%s: %s vertices at edges of three or more triangles %s", s->mesh.path,
                cli_count(f->junction), s->args->keep_border ? "stay" : "move along them");
    if (f->put_back)
        cli_say("%s: %s vertices stay, because their triangles would intersect others or lose "
                "their area",
                s->mesh.path, cli_count(f->put_back));
    if (f->undecided)
        cli_report_warn(&s->report, "too many triangles are in one place: new intersections "
                                    "there were not looked for");
}

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status check_values(const smooth_args *args, cw_error *err)
{
    if (args->iterations != OWN_ITERATIONS &&
        (args->iterations < 1 || args->iterations > CW_SMOOTH_MAX_ITERATIONS))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--iterations %zu: expected 1 to %zu",
                        args->iterations, CW_SMOOTH_MAX_ITERATIONS);
    return cli_check_compress(&args->compress, false, err);
}

/* The report is an output, too: none is written when it is the input or the mesh. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const smooth_args *args = s->args;
    cw_status st =
        args->json ? cli_check_output(args->json, args->common.inputs, 1, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    st = check_values(args, err);
    if (st == CW_OK)
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
    cw_status st =
        cli_find_length(&s->pieces, "--max-move", &s->args->max_move, &s->max_move_mm, err);
    return st == CW_OK
               ? cli_find_length(&s->pieces, "--width", &s->args->width, &s->width_mm, err)
               : st;
}

static cw_status read_input(run_state *s, cw_error *err)
{
    const smooth_args *args = s->args;
    const char *path = args->common.inputs[0], *reader = args->input.reader;
    const cw_format *format = cw_mesh_format(args->output, args->written.format);
    const bool parts = !args->merge && format && format->keeps & CW_KEEPS_PARTS;
    cli_report_begin(&s->report);
    cw_status st = parts ? cli_read_parts(path, reader, &args->input, &s->mesh, err)
                         : cli_read_mesh(path, reader, &args->input, &s->mesh, err);
    if (st == CW_OK && args->orient)
        st = cli_orient_mesh(&s->mesh, s->threads, err);
    if (st == CW_OK)
        st = cli_weld_pieces(&s->pieces, &s->mesh, err);
    if (st == CW_OK)
        st = cli_measure_pieces(&s->pieces, s->threads, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "read", 1, s->pieces.triangles);
    return st == CW_OK ? resolve_lengths(s, err) : st;
}

/* Adds the facts of a part to those of others. Until the last is there, mean_mm is a sum. */
static void add_facts(cw_smooth_facts *sum, const cw_smooth_facts *f, size_t vertices)
{
    sum->limit_mm = fmax(sum->limit_mm, f->limit_mm);
    sum->width_mm = fmax(sum->width_mm, f->width_mm);
    sum->iterations = f->iterations;
    sum->max_mm = fmax(sum->max_mm, f->max_mm);
    sum->mean_mm += f->mean_mm * (double)vertices;
    sum->volume_before_mm3 += f->volume_before_mm3;
    sum->volume_after_mm3 += f->volume_after_mm3;
    sum->flipped += f->flipped;
    sum->border += f->border;
    sum->junction += f->junction;
    sum->put_back += f->put_back;
    sum->undecided = sum->undecided || f->undecided;
}

static cw_status copy_pieces(run_state *s, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->pieces.count && st == CW_OK; n++)
        st = cwi_mesh_copy(&s->pieces.piece[n].input, &s->pieces.piece[n].out, err);
    return st;
}

static cw_status smooth_apart(run_state *s, cw_smooth_desc desc, cw_error *err)
{
    size_t vertices = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->pieces.count && st == CW_OK; n++) {
        cw_mesh *out = &s->pieces.piece[n].out;
        cw_smooth_facts facts = {0};
        desc.progress = cli_progress((double)out->triangle_count / 1e6, "Mtriangle");
        st = cw_mesh_smooth(out, &desc, &facts, err);
        add_facts(&s->facts, &facts, out->vertex_count);
        vertices += out->vertex_count;
    }
    s->facts.mean_mm /= (double)vertices;
    return st;
}

static cw_status smooth_pieces(run_state *s, cw_error *err)
{
    const smooth_args *args = s->args;
    const cw_smooth_desc desc = {
        .method = (cw_smooth_method)args->method,
        .iterations = args->iterations == OWN_ITERATIONS ? 0 : args->iterations,
        .width_mm = s->width_mm,
        .max_move_mm = s->max_move_mm,
        .move_border = !args->keep_border,
        .allow_crossings = args->allow_intersections,
        .threads = s->threads,
        .progress = cli_progress((double)s->pieces.triangles / 1e6, "Mtriangle")};
    cli_report_begin(&s->report);
    cw_status st = copy_pieces(s, err);
    const bool together = st == CW_OK && cli_share_vertices(&s->pieces);
    if (together)
        cli_say("%s: its parts share vertices, and are smoothed together", s->mesh.path);
    if (st == CW_OK)
        st = together ? cli_smooth_together(&s->pieces, &desc, &s->facts, err)
                      : smooth_apart(s, desc, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    s->is_smoothed = true;
    cli_report_end(&s->report, "smooth", s->pieces.triangles, s->pieces.triangles);
    tell_facts(s);
    return CW_OK;
}

/* Measures the distance both ways, and holds it to the limit. The measurement has other rounding
 * errors than the moves. */
static cw_status measure_result(run_state *s, cli_made *made, cw_error *err)
{
    cw_status st = cli_hold_pieces(&s->pieces, s->threads, err);
    if (st != CW_OK || !s->args->measure)
        return st;
    cli_report_begin(&s->report);
    made->compared.promised_mm = s->facts.limit_mm * (1 + 1e-6);
    st = cli_compare_pieces(&s->pieces, s->threads, &made->compared, err);
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
    cw_status st = cli_list_parts(&s->pieces, &parts, err);
    if (st == CW_OK)
        st = cli_deliver(&s->report, &how, parts, s->pieces.count, 0, s->start, err);
    free(parts);
    return st;
}

static cw_status smooth_mesh(void *state, cw_error *err)
{
    run_state *s = state;
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = read_input(s, err);
    if (st != CW_OK)
        return st;
    cli_made *made = cli_report_next(&s->report, s->outputs.path[0], 0);
    st = smooth_pieces(s, err);
    if (st == CW_OK)
        st = measure_result(s, made, err);
    if (st == CW_OK)
        st = deliver_result(s, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status run_smooth(void *p, cw_error *err)
{
    const smooth_args *args = p;
    run_state s = {.args = args, .threads = (int)args->input.threads, .start = cli_seconds()};
    s.report.command = "smooth";
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = smooth_mesh,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.report, err);
    cli_free_pieces(&s.pieces);
    cli_free_mesh(&s.mesh);
    cli_free_outputs(&s.outputs);
    return st;
}

const cli_command cli_smooth = {
    .name = "smooth",
    .usage = "MESH -o MESH [--iterations N] [--max-move L] [options]",
    .about = "Smooth a noisy mesh: every vertex moves, within a limit",
    .page = cli_page_smooth,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(smooth_args),
    .defaults = &defaults,
    .run = run_smooth,
};
