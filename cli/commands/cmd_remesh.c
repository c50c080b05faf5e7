/* The command remesh: its options, the work part by part, and what is printed and reported. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/commands/smooth_together.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"

#include <cubewright/remesh.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct remesh_args {
    cli_mesh_args mesh;
    cli_length edge, shortest, error;
    cli_number features, min_angle;
    size_t iterations; /* 0: those of the library */
    bool adaptive, fem;
} remesh_args;

typedef struct remesh_state {
    cw_remesh_desc desc;
    cw_remesh_facts facts; /* of all parts; mean and fraction are sums until the last one */
} remesh_state;

static const remesh_args *args_of(const cli_mesh_run *r)
{
    return (const remesh_args *)r->args;
}

/* The smallest angle of --fem, degrees. */
static const double FEM_ANGLE = 25;

static const remesh_args defaults = {.mesh.measure = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(""),
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
    CLI_MESH_MERGE,
    CLI_MESH_MEASURE("Measure the distance to the input (on; --no-measure)"),
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {NULL, CLI_NEEDS, "edge"},
    {"shortest", CLI_NEEDS, "adaptive"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const remesh_state *s = r->state;
    cli_json_number(j, "edge_mm", s->desc.edge_mm);
    cli_json_bool(j, "adaptive", args_of(r)->adaptive);
    cli_json_number(j, "shortest_mm", s->facts.shortest_mm);
    cli_json_number(j, "error_mm", s->facts.error_mm);
    cli_json_number(j, "features_deg", s->facts.feature_deg);
    cli_json_number(j, "min_angle_deg", s->desc.min_angle_deg);
    cli_json_count(j, "iterations", s->facts.iterations);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_count(j, "merged_vertices", r->pieces.merged);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const cw_remesh_facts *f = &((const remesh_state *)r->state)->facts;
    if (!r->is_made)
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

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const cw_remesh_facts *f = &((const remesh_state *)r->state)->facts;
    (void)err;
    snprintf(r->found, sizeof r->found,
             "; edges %.3g mm on average, %.1f %% of them fit; smallest angle %.1f degrees",
             f->mean_edge_mm, 100 * f->fitting_edges, f->smallest_deg);
    if (f->features_after || f->border_after)
        cli_say("%s: %s edges at features and %s at borders are kept", r->mesh.path,
                cli_count(f->features_after), cli_count(f->border_after));
    if (f->below)
        cli_report_warn(&r->report,
                        "%s triangles have an angle below %g degrees; the smallest, %.2g "
                        "degrees, is at %.6g %.6g %.6g mm",
                        cli_count(f->below), f->min_angle_deg, f->smallest_deg, f->where[0],
                        f->where[1], f->where[2]);
    if (f->is_undecided)
        cli_report_warn(&r->report, "too many triangles are in one place: new intersections "
                                    "there were not looked for");
    return CW_OK;
}

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status check_degrees(const char *option, const cli_number *number, double max,
                               cw_error *err)
{
    return !number->given || (number->value > 0 && number->value <= max)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s %g: expected degrees, above 0 and up to %g",
                          option, number->value, max);
}

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const remesh_args *args = args_of(r);
    if (args->iterations > CW_REMESH_MAX_ITERATIONS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--iterations %zu: expected 1 to %zu",
                        args->iterations, CW_REMESH_MAX_ITERATIONS);
    cw_status st = check_degrees("--features", &args->features, 180, err);
    return st == CW_OK ? check_degrees("--min-angle", &args->min_angle, 40, err) : st;
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status resolve_desc(cli_mesh_run *r, cw_error *err)
{
    const remesh_args *args = args_of(r);
    cw_remesh_desc *d = &((remesh_state *)r->state)->desc;
    *d = (cw_remesh_desc){.iterations = args->iterations,
                          .threads = r->threads,
                          .is_adaptive = args->adaptive,
                          .feature_deg = args->features.given ? args->features.value : 0,
                          .min_angle_deg = args->min_angle.given ? args->min_angle.value
                                           : args->fem           ? FEM_ANGLE
                                                                 : 0};
    cw_status st = cli_find_length(&r->pieces, "--edge", &args->edge, &d->edge_mm, err);
    if (st == CW_OK)
        st = cli_find_length(&r->pieces, "--shortest", &args->shortest, &d->shortest_mm, err);
    return st == CW_OK ? cli_find_length(&r->pieces, "--error", &args->error, &d->error_mm, err)
                       : st;
}

static cw_status remesh_pieces(cli_mesh_run *r, cw_error *err)
{
    remesh_state *s = r->state;
    cw_status st = CW_OK;
    if (cli_share_vertices(&r->pieces))
        cli_report_warn(&r->report, "its parts share vertices, and each is remeshed by itself: "
                                    "they do not fit together afterwards");
    for (size_t n = 0; n < r->pieces.count && st == CW_OK; n++) {
        cli_piece *p = &r->pieces.piece[n];
        cw_remesh_facts facts = {0};
        s->desc.progress = cli_progress((double)p->input.triangle_count / 1e6, "Mtriangle");
        st = cw_mesh_remesh(&p->input, &s->desc, &p->out, &facts, err);
        add_facts(&s->facts, &facts, n == 0);
    }
    if (st != CW_OK)
        return st;
    s->facts.mean_edge_mm /= (double)s->facts.triangles_after;
    s->facts.fitting_edges /= (double)s->facts.triangles_after;
    /* the measurement has other rounding errors than the work */
    r->promised_mm = s->facts.error_mm * (1 + 1e-6);
    return CW_OK;
}

/* Fails before anything is written if triangles meet that did not meet before, or the surfaces may be
 * farther from each other than they may. */
static cw_status measure_result(cli_mesh_run *r, cli_made *made, cw_error *err)
{
    const cw_remesh_facts *f = &((const remesh_state *)r->state)->facts;
    if (f->crossings_after > f->crossings_before)
        return cwi_fail(
            err, CW_ERR_CHECK,
            "%s: not as promised: %zu pairs of triangles intersect, and %zu did before; %s; "
            "nothing is written",
            r->mesh.path, f->crossings_after, f->crossings_before,
            f->crossings_before ? "'repair' makes a surface that does not intersect itself"
                                : "a smaller --edge helps");
    if (f->beyond)
        return cwi_fail(
            err, CW_ERR_CHECK,
            "%s: not as promised: %zu triangles may be farther than %.6g mm from the other "
            "surface; a larger --error, or a smaller --edge, helps; nothing is written",
            r->mesh.path, f->beyond, f->error_mm);
    return cli_compare_made(r, made, err);
}

static const cli_mesh_command remesh = {
    .name = "remesh",
    .holds_topology = true,
    .check = check_values,
    .resolve = resolve_desc,
    .work = remesh_pieces,
    .loses_texture = true,
    .report = report_facts,
    .measure = measure_result,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_remesh(void *args, cw_error *err)
{
    remesh_state state = {0};
    return cli_run_mesh_command(&remesh, args, &state, 1, err);
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
