/* The command simplify: its options, the work on parts or levels of detail, and the error that is measured. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/level_choice.h"
#include "cli/results/detail_levels.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/stage_facts.h"
#include "core/base/status.h"

#include <cubewright/simplify.h>

/* The input's settings are of the source volume; limits, safety and claims are the mesh's, too. */
typedef struct simplify_args {
    cli_mesh_args mesh;
    const char *mesh_reader;
    cli_length error, drop, handles;
    cli_number ratio, iso;
    size_t triangles;
    cli_counts lod;
    cli_weights attributes; /* normal, color, scalar */
    int inside;
    bool allow_intersections, keep_border;
} simplify_args;

typedef struct simplify_state {
    cli_number iso; /* of the arguments, as a number */
    cli_volume source;
    double error_mm, drop_mm;
    cw_close_handles_facts handles; /* of --close-handles */
} simplify_state;

static const simplify_args *args_of(const cli_mesh_run *r)
{
    return (const simplify_args *)r->args;
}

static const simplify_args defaults = {.mesh.measure = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(", with --lod {lod}"),
    CLI_HEADED("Target"),
    {"error", 'e', CLI_MESH_LENGTH, "L", "Error limit: 0.1mm, or 0.05% of the box's diagonal",
     offsetof(simplify_args, error)},
    {"triangles", 'n', CLI_COUNT, "N", "Triangle count to reach, such as 50k",
     offsetof(simplify_args, triangles)},
    {"ratio", 0, CLI_NUMBER, "R", "Fraction of the triangles to keep, such as 0.25",
     offsetof(simplify_args, ratio)},
    {"lod", 0, CLI_COUNTS, "N[,N...]",
     "Triangle counts of levels of detail, such as 50k,12k,3k: a file each, and a glTF with "
     "all",
     offsetof(simplify_args, lod)},
    CLI_HEADED("What is preserved"),
    {"attributes", 0, CLI_WEIGHTS, "normal/color/scalar",
     "Attributes to keep sharp, with weights: normal:0.5,color:1 (as the shape allows)",
     offsetof(simplify_args, attributes)},
    {"allow-intersections", 0, CLI_FLAG, NULL,
     "Allow new intersections of triangles, which is faster (off)",
     offsetof(simplify_args, allow_intersections)},
    {"keep-border", 0, CLI_FLAG, NULL,
     "Keep the borders of open surfaces as they are, so that tiles still fit (off)",
     offsetof(simplify_args, keep_border)},
    {"drop-components", 0, CLI_MESH_LENGTH, "L",
     "Leave out components with a shorter box diagonal at the start, such as 2mm (none)",
     offsetof(simplify_args, drop)},
    {"close-handles", 0, CLI_MESH_LENGTH, "auto/L",
     "Close handles and tunnels at the start, by loops up to 4mm, or auto: 3% of the box's diagonal "
     "(none)",
     offsetof(simplify_args, handles)},
    CLI_MESH_MERGE,
    CLI_MESH_ORIENT,
    CLI_HEADED("Source volume and error"),
    {"source", 's', CLI_TEXT, "VOLUME",
     "Volume to take normals from (off: carry over the input's)",
     offsetof(cli_mesh_args, source), CLI_VALUES_VOLUME},
    {"iso", 'i', CLI_LEVEL, "V",
     "Isovalue of the source, to measure the distance to its surface, too",
     offsetof(simplify_args, iso)},
    {"inside", 0, CLI_CHOICE, "above/below", "Which values of the source are inside (above)",
     offsetof(simplify_args, inside)},
    CLI_MESH_MEASURE(
        "Measure the error, which takes longer than simplifying (on; --no-measure)"),
    CLI_FORCE_OPTION(simplify_args, mesh.common),
    CLI_MESH_WRITING,
    CLI_HEADED("Reading the source"),
    CLI_CLAIM_OPTIONS("source", "the source", CLI_INPUT_ROW(cli_mesh_args, source_claim)),
    CLI_INPUT_OPTIONS(cli_mesh_args),
    {"max-triangles", 0, CLI_COUNT, "N",
     "Stop before reading more triangles than this, such as 100M (no limit)",
     CLI_INPUT_ROW(cli_mesh_args, max_triangles)},
    {"mesh-reader", 0, CLI_TEXT, "NAME",
     "Read the mesh as this format; names as in 'formats' (by content)",
     offsetof(simplify_args, mesh_reader), CLI_VALUES_MESH_READER},
    CLI_PROGRESS_OPTION(cli_mesh_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "error triangles ratio lod"},
    {NULL, CLI_NEEDS, "output"},
    {"lod", CLI_EXCLUDES, "error triangles ratio"},
    {"iso", CLI_NEEDS, "source"},
    {"iso", CLI_EXCLUDES, "no-measure"},
    CLI_COMPRESS_RULES,
};

static const char *const attribute_names[3] = {"normal", "color", "scalar"};

static void put_attributes(cli_json *j, const cli_weights *weights)
{
    cli_json_open(j, "attributes", '{');
    for (int k = 0; k < 3; k++)
        if (weights->of[k] > 0)
            cli_json_number(j, attribute_names[k], weights->of[k]);
    cli_json_close(j, '}');
}

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const simplify_state *s = r->state;
    const simplify_args *args = args_of(r);
    if (args->error.given)
        cli_json_number(j, "error_mm", s->error_mm);
    if (args->triangles)
        cli_json_count(j, "triangles", args->triangles);
    if (args->ratio.given)
        cli_json_number(j, "ratio", args->ratio.value);
    if (args->lod.count)
        cli_json_lod(j, &args->lod);
    if (args->drop.given) {
        cli_json_number(j, "drop_components_mm", s->drop_mm);
        cli_json_count(j, "dropped_components", r->pieces.dropped);
    }
    cli_json_count(j, "merged_vertices", r->pieces.merged);
    cli_json_bool(j, "allow_intersections", args->allow_intersections);
    cli_json_bool(j, "keep_border", args->keep_border);
    cli_json_bool(j, "orient", r->args->orient);
    if (args->attributes.given)
        put_attributes(j, &args->attributes);
    cli_json_bool(j, "merge", r->args->merge);
    cli_json_text(j, "normals", r->args->source ? "field" : "carried");
    if (r->args->source)
        cli_json_text(j, "inside", args->inside ? "below" : "above");
    if (args->iso.given)
        cli_json_number(j, "iso", s->iso.value);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const simplify_state *s = r->state;
    if (args_of(r)->handles.given)
        cli_json_handles(j, &s->handles);
    if (s->source.format)
        cli_json_input(j, "source", &s->source);
}

/* --- before the input is read ------------------------------------------------------------ */

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const simplify_args *args = args_of(r);
    ((simplify_state *)r->state)->iso = args->iso;
    r->reader = args->mesh_reader;
    r->reads_parts = r->reads_parts && !args->lod.count;
    r->report.several = args->lod.count ? "levels" : NULL;
    if (args->ratio.given && !(args->ratio.value > 0 && args->ratio.value < 1))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--ratio %g: a fraction above 0 and below 1 was expected",
                        args->ratio.value);
    if (!cw_simplify_available())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "simplify needs OpenMesh, which this build lacks: install "
                        "libopenmesh-dev and build again");
    return args->lod.count ? cli_check_lod(&args->lod, err) : CW_OK;
}

static cw_status name_outputs(cli_mesh_run *r, cw_error *err)
{
    const cli_mesh_args *args = r->args;
    const cli_counts *lod = &args_of(r)->lod;
    return lod->count ? cli_name_detail_levels(&r->outputs, args->output, args->written.format,
                                               args->common.inputs[0], lod, false, err)
                      : cli_name_output(&r->outputs, args->output, args->common.inputs[0], err);
}

/* --- input ------------------------------------------------------------------------------- */

static double length_mm(const cli_mesh_run *r, const cli_length *length)
{
    return length->given ? cli_length_mm(length, r->pieces.diagonal_mm, 0) : 0;
}

static cw_status check_attributes(const cli_mesh_run *r, cw_error *err)
{
    for (size_t n = 0; n < r->pieces.count; n++) {
        const cw_mesh *m = &r->pieces.piece[n].input;
        const void *const array[3] = {m->normals, m->colors, m->scalars};
        for (int k = 0; k < 3; k++)
            if (args_of(r)->attributes.of[k] > 0 && !array[k])
                return cwi_fail(err, CW_ERR_ARGUMENT, "%s: --attributes: it has no %ss%s",
                                r->mesh.path, attribute_names[k],
                                r->pieces.count > 1 ? " in one of its parts" : "");
    }
    return CW_OK;
}

static cw_status read_source(cli_mesh_run *r, cw_error *err)
{
    simplify_state *s = r->state;
    const cli_input source = cli_source_input(&r->args->input);
    if (!r->args->source)
        return CW_OK;
    cw_status st = cli_read_volume(r->args->source, &source, false, &s->source, err);
    return st == CW_OK ? cli_choose_level(&s->source, &source, &s->iso, err) : st;
}

/* Refuses a large error limit: most often the file is in another unit than millimetres. */
static cw_status check_error(const cli_mesh_run *r, double error_mm, cw_error *err)
{
    const bool known = r->mesh.file.known & CW_KNOWN_UNIT;
    if (r->args->common.force)
        return CW_OK;
    return cli_check_error_limit(
        "--error", error_mm, r->pieces.diagonal_mm,
        known || args_of(r)->error.unit != CLI_MM
            ? NULL
            : "; the file names no unit and was taken as mm (--input-unit)",
        err);
}

/* Shares are of the box of what was read. */
static cw_status resolve_lengths(cli_mesh_run *r, cw_error *err)
{
    simplify_state *s = r->state;
    s->error_mm = length_mm(r, &args_of(r)->error);
    s->drop_mm = length_mm(r, &args_of(r)->drop);
    r->promised_mm = s->error_mm;
    cw_status st = check_error(r, s->error_mm, err);
    if (st == CW_OK && args_of(r)->drop.given)
        st = cli_drop_from_pieces(&r->pieces, s->drop_mm, err);
    for (size_t n = 0; n < r->pieces.count && st == CW_OK && r->args->source; n++)
        st = cli_check_overlap(&s->source, &r->pieces.piece[n].input, err);
    return st == CW_OK ? check_attributes(r, err) : st;
}

/* --- work -------------------------------------------------------------------------------- */

/* Parts share the triangles in proportion to what they have. */
static size_t share_of(const cli_mesh_run *r, const cli_piece *p)
{
    const double fraction = (double)p->input.triangle_count / (double)r->pieces.triangles;
    const size_t triangles = (size_t)(fraction * (double)args_of(r)->triangles);
    return args_of(r)->triangles && !triangles ? 1 : triangles;
}

/* Returns the requested maximum number of triangles; 0: none was given. */
static size_t target_of(const cli_mesh_run *r)
{
    const size_t rest = (size_t)(args_of(r)->ratio.value * (double)r->pieces.triangles);
    return rest > args_of(r)->triangles ? rest : args_of(r)->triangles;
}

static void tell_missed(cli_mesh_run *r, size_t target, size_t triangles)
{
    const double error_mm = r->promised_mm;
    if (args_of(r)->error.given && target && triangles > target)
        cli_say("%s: %s triangles, not %s: fewer would exceed the error limit of %.6g mm",
                r->mesh.path, cli_count(triangles), cli_count(target), error_mm);
    else
        cli_report_missed(&r->report, &r->pieces, target, triangles, args_of(r)->keep_border);
}

/* Returns the settings for a mesh of that number of triangles, without its target. */
static cw_simplify_desc simplify_desc(const cli_mesh_run *r, size_t triangles)
{
    return (cw_simplify_desc){.allow_crossings = args_of(r)->allow_intersections,
                              .keep_border = args_of(r)->keep_border,
                              .normal_weight = (float)args_of(r)->attributes.of[0],
                              .color_weight = (float)args_of(r)->attributes.of[1],
                              .scalar_weight = (float)args_of(r)->attributes.of[2],
                              .threads = r->threads,
                              .progress = cli_progress((double)triangles / 1e6, "Mtriangle")};
}

static cw_status simplify_parts(cli_mesh_run *r, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < r->pieces.count && st == CW_OK; n++) {
        cli_piece *p = &r->pieces.piece[n];
        cw_simplify_desc desc = simplify_desc(r, p->input.triangle_count);
        desc.error_mm = r->promised_mm;
        desc.triangles = share_of(r, p);
        desc.ratio = args_of(r)->ratio.value;
        /* parts by material share a border, which must fit */
        desc.keep_border = desc.keep_border || (p->textures && r->pieces.count > 1);
        st = cw_simplify(&p->input, &desc, &p->out, NULL, err);
    }
    return st;
}

static cw_status report_result(cli_mesh_run *r, cw_error *err)
{
    (void)err;
    tell_missed(r, target_of(r), cli_made_triangles(r));
    return CW_OK;
}

static cw_status simplify_levels(void *state, cw_mesh *levels, cw_error *err)
{
    cli_mesh_run *r = state;
    const cli_counts *lod = &args_of(r)->lod;
    const cw_simplify_desc desc = simplify_desc(r, r->pieces.triangles);
    size_t triangles = 0;
    cli_report_begin(&r->report);
    cw_status st = cw_simplify_levels(&r->pieces.piece->input, &desc, lod->n, lod->count,
                                      levels, NULL, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, r->mesh.path);
    for (size_t n = 0; n < lod->count; n++)
        triangles += levels[n].triangle_count;
    cli_report_end(&r->report, "simplify", r->pieces.triangles, triangles);
    return CW_OK;
}

/* Measures the distance to the input, and to the source's surface: of all parts the farthest there, as
 * they are on one surface. */
static cw_status measure_error(cli_mesh_run *r, cli_made *made, cw_error *err)
{
    const simplify_state *s = r->state;
    cli_comparison *c = &made->compared;
    if (!r->args->measure)
        return CW_OK;
    cli_report_begin(&r->report);
    c->promised_mm = s->error_mm;
    cw_status st = cli_compare_pieces(&r->pieces, r->threads, c, err);
    for (size_t n = 0; n < r->pieces.count && st == CW_OK && args_of(r)->iso.given; n++) {
        st = cli_compare_with_field(&r->pieces.piece[n].out, &s->source, s->iso.value,
                                    args_of(r)->inside, r->threads, c, err);
        st = st == CW_OK ? st : cwi_fail_in(err, st, r->mesh.path);
    }
    if (st == CW_OK)
        cli_report_end(&r->report, "measure", c->with_input.from_reference.triangles,
                       c->with_input.to_reference.triangles);
    return st;
}

static cw_status shade_mesh(cli_mesh_run *r, cw_error *err)
{
    const simplify_state *s = r->state;
    const cw_normals_desc desc = {.inside_is_low = args_of(r)->inside, .threads = r->threads};
    cw_status st = CW_OK;
    if (!r->args->source)
        return CW_OK;
    cli_report_begin(&r->report);
    for (size_t n = 0; n < r->pieces.count && st == CW_OK; n++)
        st = cw_extract_normals(&s->source.view, &desc, &r->pieces.piece[n].out, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->source.path);
    cli_report_end(&r->report, "normals", 1, r->pieces.count);
    return CW_OK;
}

/* Checks and measures what became of the pieces, and shades it. */
static cw_status finish_pieces(cli_mesh_run *r, cli_made *made, cw_error *err)
{
    cw_status st = cli_hold_pieces(&r->pieces, r->threads, err);
    if (st == CW_OK)
        st = measure_error(r, made, err);
    return st == CW_OK ? shade_mesh(r, err) : st;
}

/* A level is the result of the only piece for a while. */
static cw_status finish_level(void *state, cli_made *made, cw_mesh *level, cw_error *err)
{
    cli_mesh_run *r = state;
    r->pieces.piece->out = *level;
    cw_status st = finish_pieces(r, made, err);
    *level = r->pieces.piece->out;
    r->pieces.piece->out = (cw_mesh){0};
    return st;
}

static cw_status deliver_level(void *state, size_t file, const cw_part *parts, size_t count,
                               cw_error *err)
{
    cli_mesh_run *r = state;
    cli_delivery how = cli_mesh_delivery(r);
    how.unchecked = file == args_of(r)->lod.count; /* each was by itself */
    how.parts = how.unchecked ? "levels" : NULL;
    cw_status st = cli_deliver(&r->report, &how, parts, count, 0, r->start, err);
    r->start = cli_seconds();
    return st;
}

static cw_status make_levels(cli_mesh_run *r, cw_error *err)
{
    cli_detail_levels levels = {.lod = &args_of(r)->lod,
                                .name = r->args->written.name,
                                .files = &r->outputs,
                                .report = &r->report,
                                .pieces = &r->pieces,
                                .keeps_border = args_of(r)->keep_border,
                                .make = simplify_levels,
                                .finish = finish_level,
                                .deliver = deliver_level,
                                .user = r};
    cw_status st = cli_make_detail_levels(&levels, err);
    cli_free_detail_levels(&levels);
    return st;
}

/* Closes small handles; what is made is then held against the closed surface. */
static cw_status close_handles(cli_mesh_run *r, cw_error *err)
{
    simplify_state *s = r->state;
    const cli_length *length = &args_of(r)->handles;
    const size_t before = r->pieces.triangles;
    if (!length->given)
        return CW_OK;
    cli_report_begin(&r->report);
    cw_status st = cli_close_handles(&r->pieces, length->is_word ? 0 : length_mm(r, length),
                                     r->threads, &s->handles, err);
    if (st == CW_OK)
        st = cli_measure_pieces(&r->pieces, r->threads, err);
    if (st == CW_OK)
        cli_report_end(&r->report, "close_handles", before, r->pieces.triangles);
    return st;
}

static cw_status make_result(cli_mesh_run *r, cw_error *err)
{
    const cw_status st = close_handles(r, err);
    if (st != CW_OK)
        return st;
    return args_of(r)->lod.count ? make_levels(r, err) : cli_make_mesh(r, err);
}

static const cli_mesh_command simplify = {
    .name = "simplify",
    .holds_topology = true,
    .check = check_values,
    .name_outputs = name_outputs,
    .prepare = read_source,
    .resolve = resolve_lengths,
    .make = make_result,
    .work = simplify_parts,
    .report = report_result,
    .measure = finish_pieces,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_simplify(void *p, cw_error *err)
{
    const simplify_args *args = p;
    simplify_state state = {0};
    cw_status st =
        cli_run_mesh_command(&simplify, &args->mesh, &state, args->lod.count + 1, err);
    cli_free_volume(&state.source);
    return st;
}

const cli_command cli_simplify = {
    .name = "simplify",
    .usage = "MESH -o MESH --error L|--triangles N|--ratio R|--lod N,... [options]",
    .about = "Reduce the triangles of a mesh, within a guaranteed error limit",
    .page = cli_page_simplify,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(simplify_args),
    .defaults = &defaults,
    .run = run_simplify,
};
