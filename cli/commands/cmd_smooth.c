/* The command smooth: its options, the work part by part, and what is printed and reported. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/commands/smooth_together.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/stage_facts.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"

#include <cubewright/smooth.h>

#include <math.h>
#include <stdio.h>

typedef struct smooth_args {
    cli_mesh_args mesh;
    size_t iterations; /* OWN_ITERATIONS: those of the method */
    cli_length max_move, width;
    int method;
    bool keep_border, allow_intersections;
} smooth_args;

typedef struct smooth_state {
    double max_move_mm; /* 0: half the mean edge of each part */
    double width_mm;    /* 0: a multiple of it */
    cw_smooth_facts facts;
} smooth_state;

static const smooth_args *args_of(const cli_mesh_run *r)
{
    return (const smooth_args *)r->args;
}

#define OWN_ITERATIONS SIZE_MAX

static const smooth_args defaults = {
    .iterations = OWN_ITERATIONS, .keep_border = true, .mesh.measure = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(""),
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
    CLI_MESH_MERGE,
    CLI_MESH_ORIENT,
    CLI_MESH_MEASURE(
        "Measure the distance to the input, which takes longer than smoothing (on; --no-measure)"),
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"width", CLI_NEEDS, "method=fair"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const smooth_args *args = args_of(r);
    const smooth_state *s = r->state;
    cli_json_text(j, "method", cw_smooth_method_name((cw_smooth_method)args->method));
    cli_json_count(j, "iterations", s->facts.iterations);
    if (args->method == CW_SMOOTH_FAIR)
        cli_json_number(j, "width_mm", s->facts.width_mm);
    cli_json_number(j, "max_move_mm", s->facts.limit_mm);
    cli_json_bool(j, "keep_border", args->keep_border);
    cli_json_bool(j, "allow_intersections", args->allow_intersections);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_bool(j, "orient", r->args->orient);
    cli_json_count(j, "merged_vertices", r->pieces.merged);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const smooth_state *s = r->state;
    if (r->is_made)
        cli_json_smoothed(j, &s->facts);
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const cw_smooth_facts *f = &((const smooth_state *)r->state)->facts;
    const bool keeps = args_of(r)->keep_border;
    char text[CLI_SMOOTHED_TEXT];
    cli_smoothed_text(f, text);
    snprintf(r->found, sizeof r->found, "; %s", text);
    if (f->border)
        cli_say("%s: %s vertices at borders %s", r->mesh.path, cli_count(f->border),
                keeps ? "stay (--no-keep-border smooths them)" : "move along them");
    if (f->junction)
        cli_say("%s: %s vertices at edges of three or more triangles %s", r->mesh.path,
                cli_count(f->junction), keeps ? "stay" : "move along them");
    if (f->put_back)
        cli_say("%s: %s vertices stay, because their triangles would intersect others or lose "
                "their area",
                r->mesh.path, cli_count(f->put_back));
    if (f->undecided)
        cli_report_warn(&r->report, "too many triangles are in one place: new intersections "
                                    "there were not looked for");
    (void)err;
    return CW_OK;
}

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const smooth_args *args = args_of(r);
    if (args->iterations != OWN_ITERATIONS &&
        (args->iterations < 1 || args->iterations > CW_SMOOTH_MAX_ITERATIONS))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--iterations %zu: expected 1 to %zu",
                        args->iterations, CW_SMOOTH_MAX_ITERATIONS);
    return CW_OK;
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status resolve_lengths(cli_mesh_run *r, cw_error *err)
{
    const smooth_args *args = args_of(r);
    smooth_state *s = r->state;
    cw_status st =
        cli_find_length(&r->pieces, "--max-move", &args->max_move, &s->max_move_mm, err);
    return st == CW_OK ? cli_find_length(&r->pieces, "--width", &args->width, &s->width_mm, err)
                       : st;
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

static cw_status copy_pieces(cli_pieces *p, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++)
        st = cwi_mesh_copy(&p->piece[n].input, &p->piece[n].out, err);
    return st;
}

static cw_status smooth_apart(cli_pieces *p, cw_smooth_desc desc, cw_smooth_facts *sum,
                              cw_error *err)
{
    size_t vertices = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        cw_mesh *out = &p->piece[n].out;
        cw_smooth_facts facts = {0};
        desc.progress = cli_progress((double)out->triangle_count / 1e6, "Mtriangle");
        st = cw_mesh_smooth(out, &desc, &facts, err);
        add_facts(sum, &facts, out->vertex_count);
        vertices += out->vertex_count;
    }
    sum->mean_mm /= (double)vertices;
    return st;
}

static cw_status smooth_pieces(cli_mesh_run *r, cw_error *err)
{
    const smooth_args *args = args_of(r);
    smooth_state *s = r->state;
    cli_pieces *p = &r->pieces;
    const cw_smooth_desc desc = {
        .method = (cw_smooth_method)args->method,
        .iterations = args->iterations == OWN_ITERATIONS ? 0 : args->iterations,
        .width_mm = s->width_mm,
        .max_move_mm = s->max_move_mm,
        .move_border = !args->keep_border,
        .allow_crossings = args->allow_intersections,
        .threads = r->threads,
        .progress = cli_progress((double)p->triangles / 1e6, "Mtriangle")};
    cw_status st = copy_pieces(p, err);
    const bool together = st == CW_OK && cli_share_vertices(p);
    if (together)
        cli_say("%s: its parts share vertices, and are smoothed together", r->mesh.path);
    if (st == CW_OK)
        st = together ? cli_smooth_together(p, &desc, &s->facts, err)
                      : smooth_apart(p, desc, &s->facts, err);
    /* the measurement has other rounding errors than the moves */
    r->promised_mm = s->facts.limit_mm * (1 + 1e-6);
    return st;
}

static const cli_mesh_command smooth = {
    .name = "smooth",
    .holds_topology = true,
    .check = check_values,
    .resolve = resolve_lengths,
    .work = smooth_pieces,
    .report = report_facts,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_smooth(void *args, cw_error *err)
{
    smooth_state state = {0};
    return cli_run_mesh_command(&smooth, args, &state, 1, err);
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
