/* The command remesh: its options, the work part by part, and what is printed and reported. */
#include "cli/commands/smooth_together.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/mesh_parts.h"
#include "cli/results/mesh_write_options.h"
#include "cli/results/output_names.h"
#include "cli/results/write_result.h"
#include "core/base/status.h"

#include <cubewright/remesh.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct remesh_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    cli_written written;
    const char *output, *json;
    cli_length edge, shortest, error;
    cli_number features, min_angle;
    size_t iterations; /* 0: those of the library */
    int progress;
    bool adaptive, fem, merge, measure;
} remesh_args;

typedef struct run_state {
    const remesh_args *args;
    int threads;
    cli_mesh mesh;
    cli_pieces pieces;
    cw_remesh_desc desc;
    cw_remesh_facts facts; /* of all parts; mean and fraction are sums until the last one */
    bool is_remeshed;
    char found[256]; /* for the line */
    cli_outputs outputs;
    cli_report report;
    double start;
} run_state;

/* The smallest angle of --fem, degrees. */
static const double FEM_ANGLE = 25;

static const remesh_args defaults = {.measure = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Mesh to write, in the format of its extension; may hold {stem}",
     offsetof(remesh_args, output), CLI_VALUES_MESH_OUTPUT},
    CLI_HEADED("Triangles"),
    {"edge", 'e', CLI_LENGTH, "L",
     "Length of edges, or the longest with --adaptive: 1mm, 0.5% of the box's diagonal, 2vox "
     "where the file tells the voxels",
     offsetof(remesh_args, edge)},
    {"adaptive", 0, CLI_FLAG, NULL, "Shorter edges where the surface is curved (off)",
     offsetof(remesh_args, adaptive)},
    {"shortest", 0, CLI_LENGTH, "L", "Of --adaptive: the shortest wanted length (edge / 10)",
     offsetof(remesh_args, shortest)},
    {"fem", 0, CLI_FLAG, NULL,
     "For finite elements: no angle below 25 degrees, or a warning that tells where (off)",
     offsetof(remesh_args, fem)},
    {"min-angle", 0, CLI_NUMBER, "DEG", "Another smallest angle, up to 40 (that of --fem)",
     offsetof(remesh_args, min_angle)},
    {"iterations", 'n', CLI_COUNT, "N", "Number of iterations, up to 100 (5)",
     offsetof(remesh_args, iterations)},
    CLI_HEADED("What is preserved"),
    {"error", 0, CLI_LENGTH, "L",
     "How far both surfaces may be apart; --adaptive makes edges for it (edge / 10)",
     offsetof(remesh_args, error)},
    {"features", 0, CLI_NUMBER, "DEG",
     "Keep edges where the surface turns by more than this (40); 180 keeps borders alone",
     offsetof(remesh_args, features)},
    {"merge", 0, CLI_FLAG, NULL,
     "Join all parts to one mesh (off: each by itself, where the format has parts)",
     offsetof(remesh_args, merge)},
    {"measure", 0, CLI_FLAG, NULL, "Measure the distance to the input (on; --no-measure)",
     offsetof(remesh_args, measure)},
    CLI_JSON_OPTION(remesh_args),
    CLI_WRITTEN_OPTIONS(remesh_args),
    CLI_COMPRESS_OPTIONS(remesh_args),
    CLI_MESH_INPUT_OPTIONS(remesh_args),
    CLI_PROGRESS_OPTION(remesh_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {NULL, CLI_NEEDS, "edge"},
    {"shortest", CLI_NEEDS, "adaptive"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    cli_json_number(j, "edge_mm", s->desc.edge_mm);
    cli_json_bool(j, "adaptive", s->args->adaptive);
    cli_json_number(j, "shortest_mm", s->facts.shortest_mm);
    cli_json_number(j, "error_mm", s->facts.error_mm);
    cli_json_number(j, "features_deg", s->facts.feature_deg);
    cli_json_number(j, "min_angle_deg", s->desc.min_angle_deg);
    cli_json_count(j, "iterations", s->facts.iterations);
    cli_json_bool(j, "merge", s->args->merge);
    cli_json_count(j, "merged_vertices", s->pieces.merged);
    cli_json_written(j, &s->args->written, made->path);
}

static void put_facts(cli_json *j, const void *p)
{
    const run_state *s = p;
    const cw_remesh_facts *f = &s->facts;
    if (s->mesh.file.format)
        cli_json_mesh_file(j, "input", &s->mesh);
    if (!s->is_remeshed)
        return;
    cli_json_open(j, "remesh", '{');
    cli_json_count(j, "triangles_before", f->triangles_before);
    cli_json_count(j, "triangles_after", f->triangles_after);
    cli_json_number(j, "min_edge_mm", f->min_edge_mm);
    cli_json_number(j, "mean_edge_mm", f->mean_edge_mm);
    cli_json_number(j, "max_edge_mm", f->max_edge_mm);
    cli_json_number(j, "fitting_edges", f->fitting_edges);
    cli_json_number(j, "smallest_deg", f->smallest_deg);
    cli_json_open(j, "where", '[');
    for (int k = 0; k < 3; k++)
        cli_json_number(j, NULL, f->where[k]);
    cli_json_close(j, ']');
    cli_json_count(j, "below", f->below);
    cli_json_count(j, "features_before", f->features_before);
    cli_json_count(j, "features_after", f->features_after);
    cli_json_count(j, "border_before", f->border_before);
    cli_json_count(j, "border_after", f->border_after);
    cli_json_count(j, "intersections_before", f->crossings_before);
    cli_json_count(j, "intersections_after", f->crossings_after);
    cli_json_count(j, "beyond", f->beyond);
    cli_json_count(j, "attempts", f->attempts);
    cli_json_close(j, '}');
}

/* Adds the facts of a part to those of others. */
static void add_facts(cw_remesh_facts *sum, const cw_remesh_facts *f, bool is_first)
{
    const double triangles = (double)f->triangles_after;
    cw_remesh_facts all = *f;
    all.mean_edge_mm = sum->mean_edge_mm + f->mean_edge_mm * triangles;
    all.fitting_edges = sum->fitting_edges + f->fitting_edges * triangles;
    all.triangles_before += sum->triangles_before;
    all.triangles_after += sum->triangles_after;
    all.below += sum->below;
    all.features_before += sum->features_before;
    all.features_after += sum->features_after;
    all.border_before += sum->border_before;
    all.border_after += sum->border_after;
    all.crossings_before += sum->crossings_before;
    all.crossings_after += sum->crossings_after;
    all.beyond += sum->beyond;
    all.is_undecided = all.is_undecided || sum->is_undecided;
    if (!is_first) {
        all.min_edge_mm = fmin(all.min_edge_mm, sum->min_edge_mm);
        all.max_edge_mm = fmax(all.max_edge_mm, sum->max_edge_mm);
        all.attempts = all.attempts > sum->attempts ? all.attempts : sum->attempts;
        if (sum->smallest_deg < all.smallest_deg) {
            all.smallest_deg = sum->smallest_deg;
            memcpy(all.where, sum->where, sizeof all.where);
        }
    }
    *sum = all;
}

static void tell_facts(run_state *s)
{
    const cw_remesh_facts *f = &s->facts;
    snprintf(s->found, sizeof s->found,
             "; edges %.3g mm on average, %.1f %% of them fit; smallest angle %.1f degrees",
             f->mean_edge_mm, 100 * f->fitting_edges, f->smallest_deg);
    if (f->features_after || f->border_after)
        cli_say("%s: %s edges at features and %s at borders are kept", s->mesh.path,
                cli_count(f->features_after), cli_count(f->border_after));
    if (f->below)
        cli_report_warn(&s->report,
                        "%s triangles have an angle below %g degrees; the smallest, %.2g "
                        "degrees, is at %.6g %.6g %.6g mm",
                        cli_count(f->below), f->min_angle_deg, f->smallest_deg, f->where[0],
                        f->where[1], f->where[2]);
    if (f->is_undecided)
        cli_report_warn(&s->report, "too many triangles are in one place: new intersections "
                                    "there were not looked for");
}

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status check_degrees(const char *option, const cli_number *number, double most,
                               cw_error *err)
{
    return !number->given || (number->value > 0 && number->value <= most)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s %g: expected degrees, above 0 and up to %g",
                          option, number->value, most);
}

static cw_status check_values(const remesh_args *args, cw_error *err)
{
    if (args->iterations > CW_REMESH_MAX_ITERATIONS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--iterations %zu: expected 1 to %zu",
                        args->iterations, CW_REMESH_MAX_ITERATIONS);
    cw_status st = check_degrees("--features", &args->features, 180, err);
    if (st == CW_OK)
        st = check_degrees("--min-angle", &args->min_angle, 40, err);
    return st == CW_OK ? cli_check_compress(&args->compress, false, err) : st;
}

/* The report is an output, too: none is written when it is the input or the mesh. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const remesh_args *args = s->args;
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

static cw_status resolve_desc(run_state *s, cw_error *err)
{
    const remesh_args *args = s->args;
    cw_remesh_desc *d = &s->desc;
    *d = (cw_remesh_desc){.iterations = args->iterations,
                          .threads = s->threads,
                          .is_adaptive = args->adaptive,
                          .feature_deg = args->features.given ? args->features.value : 0,
                          .min_angle_deg = args->min_angle.given ? args->min_angle.value
                                           : args->fem           ? FEM_ANGLE
                                                                 : 0};
    cw_status st = cli_find_length(&s->pieces, "--edge", &args->edge, &d->edge_mm, err);
    if (st == CW_OK)
        st = cli_find_length(&s->pieces, "--shortest", &args->shortest, &d->shortest_mm, err);
    return st == CW_OK ? cli_find_length(&s->pieces, "--error", &args->error, &d->error_mm, err)
                       : st;
}

static cw_status read_input(run_state *s, cw_error *err)
{
    const remesh_args *args = s->args;
    const char *path = args->common.inputs[0], *reader = args->input.reader;
    const cw_format *format = cw_mesh_format(args->output, args->written.format);
    const bool parts = !args->merge && format && format->keeps & CW_KEEPS_PARTS;
    cli_report_begin(&s->report);
    cw_status st = parts ? cli_read_parts(path, reader, &args->input, &s->mesh, err)
                         : cli_read_mesh(path, reader, &args->input, &s->mesh, err);
    if (st == CW_OK)
        st = cli_weld_pieces(&s->pieces, &s->mesh, err);
    if (st == CW_OK)
        st = cli_measure_pieces(&s->pieces, s->threads, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "read", 1, s->pieces.triangles);
    return st == CW_OK ? resolve_desc(s, err) : st;
}

static cw_status remesh_pieces(run_state *s, cw_error *err)
{
    cw_status st = CW_OK;
    cli_report_begin(&s->report);
    if (cli_share_vertices(&s->pieces))
        cli_report_warn(&s->report, "its parts share vertices, and each is remeshed by itself: "
                                    "they do not fit together afterwards");
    for (size_t n = 0; n < s->pieces.count && st == CW_OK; n++) {
        cli_piece *p = &s->pieces.piece[n];
        cw_remesh_facts facts = {0};
        s->desc.progress = cli_progress((double)p->input.triangle_count / 1e6, "Mtriangle");
        st = cw_mesh_remesh(&p->input, &s->desc, &p->out, &facts, err);
        add_facts(&s->facts, &facts, n == 0);
    }
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    s->facts.mean_edge_mm /= (double)s->facts.triangles_after;
    s->facts.fitting_edges /= (double)s->facts.triangles_after;
    s->is_remeshed = true;
    cli_report_end(&s->report, "remesh", s->pieces.triangles, s->pieces.triangles);
    tell_facts(s);
    return CW_OK;
}

/* Measures the distance both ways, and holds it to the limit. The measurement has other rounding
 * errors than the work. */
static cw_status measure_result(run_state *s, cli_made *made, cw_error *err)
{
    cw_status st = cli_hold_pieces(&s->pieces, s->threads, err);
    if (st != CW_OK || !s->args->measure)
        return st;
    cli_report_begin(&s->report);
    made->compared.promised_mm = s->facts.error_mm * (1 + 1e-6);
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

/* Fails if triangles meet that did not meet before. */
static cw_status judge_result(const run_state *s, cw_error *err)
{
    const cw_remesh_facts *f = &s->facts;
    return f->crossings_after <= f->crossings_before
               ? CW_OK
               : cwi_fail(err, CW_ERR_CHECK,
                          "%s: %zu pairs of triangles intersect, and %zu did before; a smaller "
                          "--error or --edge helps",
                          s->outputs.path[0], f->crossings_after, f->crossings_before);
}

static cw_status remesh_mesh(void *state, cw_error *err)
{
    run_state *s = state;
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = read_input(s, err);
    if (st != CW_OK)
        return st;
    cli_made *made = cli_report_next(&s->report, s->outputs.path[0], 0);
    st = remesh_pieces(s, err);
    if (st == CW_OK)
        st = measure_result(s, made, err);
    if (st == CW_OK)
        st = deliver_result(s, err);
    if (st == CW_OK)
        st = judge_result(s, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status run_remesh(void *p, cw_error *err)
{
    const remesh_args *args = p;
    run_state s = {.args = args, .threads = (int)args->input.threads, .start = cli_seconds()};
    s.report.command = "remesh";
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = remesh_mesh,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.report, err);
    cli_free_pieces(&s.pieces);
    cli_free_mesh(&s.mesh);
    cli_free_outputs(&s.outputs);
    return st;
}

const cli_command cli_remesh = {
    .name = "remesh",
    .usage = "MESH -o MESH --edge L [--adaptive] [--fem] [options]",
    .about = "Remesh: triangles of a wanted size and shape, on the same surface",
    .page = cli_page_remesh,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(remesh_args),
    .defaults = &defaults,
    .run = run_remesh,
};
