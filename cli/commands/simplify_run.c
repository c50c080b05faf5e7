/* Runs the command simplify: reads the mesh, simplifies its parts or levels of detail,
 * measures the error, and writes the result. */
#include "cli/commands/simplify_run.h"
#include "cli/inputs/level_choice.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/detail_levels.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/mesh_parts.h"
#include "cli/results/output_names.h"
#include "cli/results/write_result.h"
#include "core/base/status.h"

#include <cubewright/simplify.h>

#include <stdlib.h>

typedef struct run_state {
    const cli_simplify_args *args;
    cli_number iso; /* of args, as a number */
    int threads;
    cli_mesh mesh;
    cli_volume source;
    cli_pieces pieces;
    double error_mm, drop_mm;
    cli_outputs outputs;
    cli_report report;
    double start;
} run_state;

/* Of the box's diagonal. */
static const double LARGE_ERROR = 0.05;

static const char *const attribute_names[3] = {"normal", "color", "scalar"};

static void put_attributes(cli_json *j, const cli_weights *weights)
{
    cli_json_open(j, "attributes", '{');
    for (int k = 0; k < 3; k++)
        if (weights->of[k] > 0)
            cli_json_number(j, attribute_names[k], weights->of[k]);
    cli_json_close(j, '}');
}

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    const cli_simplify_args *args = s->args;
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
        cli_json_count(j, "dropped_components", s->pieces.dropped);
    }
    cli_json_count(j, "merged_vertices", s->pieces.merged);
    cli_json_bool(j, "allow_intersections", args->allow_intersections);
    cli_json_bool(j, "keep_border", args->keep_border);
    cli_json_bool(j, "orient", args->orient);
    if (args->attributes.given)
        put_attributes(j, &args->attributes);
    cli_json_bool(j, "merge", args->merge);
    cli_json_text(j, "normals", args->source ? "field" : "carried");
    if (args->source)
        cli_json_text(j, "inside", args->inside ? "below" : "above");
    if (args->iso.given)
        cli_json_number(j, "iso", s->iso.value);
    cli_json_written(j, &args->written, made->path);
}

static void put_facts(cli_json *j, const void *p)
{
    const run_state *s = p;
    if (s->mesh.file.format)
        cli_json_mesh_file(j, "input", &s->mesh);
    if (s->source.format)
        cli_json_input(j, "source", &s->source);
}

/* --- before the input is read ------------------------------------------------------------ */

static cw_status check_against_inputs(const run_state *s, const char *output, cw_error *err)
{
    const char *inputs[2] = {s->args->common.inputs[0], s->args->source};
    return cli_check_output(output, inputs, s->args->source ? 2 : 1, err);
}

/* The report is an output, too: none is written when it is an input or a mesh. */
static cw_status check_outputs(run_state *s, cw_error *err)
{
    const cli_simplify_args *args = s->args;
    const cw_write_desc desc = cli_written_desc(&args->written, &args->compress, &s->mesh);
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->outputs.count && st == CW_OK; n++) {
        st = args->json ? cli_check_apart(args->json, s->outputs.path[n], err) : CW_OK;
        s->report.path = st == CW_OK ? args->json : NULL;
        if (st == CW_OK)
            st = check_against_inputs(s, s->outputs.path[n], err);
    }
    return st == CW_OK ? cli_check_outputs(&s->outputs, args->common.inputs, 1, &desc, err)
                       : st;
}

static cw_status check_args(run_state *s, cw_error *err)
{
    const cli_simplify_args *args = s->args;
    cw_status st = args->json ? check_against_inputs(s, args->json, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    st = cli_check_simplify_args(args, err);
    if (st != CW_OK)
        return st;
    if (!cw_simplify_available())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "simplify needs OpenMesh, which this build lacks: install "
                        "libopenmesh-dev and build again");
    st = args->lod.count
             ? cli_name_detail_levels(&s->outputs, args->output, args->written.format,
                                      args->common.inputs[0], &args->lod, err)
             : cli_name_output(&s->outputs, args->output, args->common.inputs[0], err);
    return st == CW_OK ? check_outputs(s, err) : st;
}

/* --- input ------------------------------------------------------------------------------- */

static double length_mm(const run_state *s, const cli_length *length)
{
    return length->given ? cli_length_mm(length, s->pieces.diagonal_mm, 0) : 0;
}

/* Shares are of the box of what was read. */
static cw_status take_pieces(run_state *s, cw_error *err)
{
    cw_status st = cli_weld_pieces(&s->pieces, &s->mesh, err);
    s->error_mm = length_mm(s, &s->args->error);
    s->drop_mm = length_mm(s, &s->args->drop);
    if (st == CW_OK && s->args->drop.given)
        st = cli_drop_from_pieces(&s->pieces, s->drop_mm, err);
    return st == CW_OK ? cli_measure_pieces(&s->pieces, s->threads, err) : st;
}

static cw_status check_attributes(const run_state *s, cw_error *err)
{
    for (size_t n = 0; n < s->pieces.count; n++) {
        const cw_mesh *m = &s->pieces.piece[n].input;
        const void *const array[3] = {m->normals, m->colors, m->scalars};
        for (int k = 0; k < 3; k++)
            if (s->args->attributes.of[k] > 0 && !array[k])
                return cwi_fail(err, CW_ERR_ARGUMENT, "%s: --attributes: it has no %ss%s",
                                s->mesh.path, attribute_names[k],
                                s->pieces.count > 1 ? " in one of its parts" : "");
    }
    return CW_OK;
}

static cw_status read_inputs(run_state *s, cw_error *err)
{
    const cli_simplify_args *args = s->args;
    const char *path = args->common.inputs[0];
    const cli_input source = cli_source_input(&args->input);
    const cw_format *format = cw_mesh_format(args->output, args->written.format);
    const bool parts =
        !args->merge && !args->lod.count && format && format->keeps & CW_KEEPS_PARTS;
    cli_report_begin(&s->report);
    cw_status st = parts ? cli_read_parts(path, args->mesh_reader, &args->input, &s->mesh, err)
                         : cli_read_mesh(path, args->mesh_reader, &args->input, &s->mesh, err);
    if (st == CW_OK && args->orient)
        st = cli_orient_mesh(&s->mesh, s->threads, err);
    if (st == CW_OK && args->source)
        st = cli_read_volume(args->source, &source, false, &s->source, err);
    if (st == CW_OK && args->source)
        st = cli_choose_level(&s->source, &source, &s->iso, err);
    if (st == CW_OK)
        st = take_pieces(s, err);
    for (size_t n = 0; n < s->pieces.count && st == CW_OK && args->source; n++)
        st = cli_check_place(&s->source, &s->pieces.piece[n].input, err);
    if (st == CW_OK)
        st = check_attributes(s, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "read", 1, s->pieces.triangles);
    return st;
}

/* --- work -------------------------------------------------------------------------------- */

/* Parts share the triangles in proportion to what they have. */
static size_t share_of(const run_state *s, const cli_piece *p)
{
    const double share = (double)p->input.triangle_count / (double)s->pieces.triangles;
    const size_t triangles = (size_t)(share * (double)s->args->triangles);
    return s->args->triangles && !triangles ? 1 : triangles;
}

/* Returns the requested maximum number of triangles; 0: none was given. */
static size_t target_of(const run_state *s)
{
    const size_t rest = (size_t)(s->args->ratio.value * (double)s->pieces.triangles);
    return rest > s->args->triangles ? rest : s->args->triangles;
}

static void tell_missed(run_state *s, size_t target, size_t triangles)
{
    if (s->args->error.given && target && triangles > target)
        cli_say("%s: %s triangles, not %s: fewer would exceed the error limit of %.6g mm",
                s->mesh.path, cli_count(triangles), cli_count(target), s->error_mm);
    else
        cli_tell_missed(&s->report, &s->pieces, target, triangles, s->args->keep_border);
}

/* Returns the settings for a mesh of that number of triangles, without its target. */
static cw_simplify_desc simplify_desc(const run_state *s, size_t triangles)
{
    return (cw_simplify_desc){.allow_crossings = s->args->allow_intersections,
                              .keep_border = s->args->keep_border,
                              .normal_weight = (float)s->args->attributes.of[0],
                              .color_weight = (float)s->args->attributes.of[1],
                              .scalar_weight = (float)s->args->attributes.of[2],
                              .threads = s->threads,
                              .progress = cli_progress((double)triangles / 1e6, "Mtriangle")};
}

/* A bound as large as the details of the shape leaves little of it, most often because the file
 * is in another unit than millimetres. */
static void warn_of_large_error(run_state *s)
{
    const double share = s->error_mm / s->pieces.diagonal_mm;
    if (!(share > LARGE_ERROR))
        return;
    const bool known = s->mesh.file.known & CW_KNOWN_UNIT;
    cli_report_warn(
        &s->report,
        "--error %.6g mm is %.3g %% of the diagonal of the box, %.6g mm: little of the "
        "shape may be left%s",
        s->error_mm, 100 * share, s->pieces.diagonal_mm,
        known || s->args->error.unit != CLI_MM
            ? ""
            : "; the file names no unit and was taken as mm (--input-unit)");
}

static cw_status simplify_parts(run_state *s, cw_error *err)
{
    size_t triangles = 0;
    cw_status st = CW_OK;
    warn_of_large_error(s);
    cli_report_begin(&s->report);
    for (size_t n = 0; n < s->pieces.count && st == CW_OK; n++) {
        cli_piece *p = &s->pieces.piece[n];
        cw_simplify_desc desc = simplify_desc(s, p->input.triangle_count);
        desc.error_mm = s->error_mm;
        desc.triangles = share_of(s, p);
        desc.ratio = s->args->ratio.value;
        st = cw_simplify(&p->input, &desc, &p->out, NULL, err);
        triangles += p->out.triangle_count;
    }
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    cli_report_end(&s->report, "simplify", s->pieces.triangles, triangles);
    tell_missed(s, target_of(s), triangles);
    return CW_OK;
}

static cw_status simplify_levels(void *state, cw_mesh *levels, cw_error *err)
{
    run_state *s = state;
    const cli_counts *lod = &s->args->lod;
    const cw_simplify_desc desc = simplify_desc(s, s->pieces.triangles);
    size_t triangles = 0;
    cli_report_begin(&s->report);
    cw_status st = cw_simplify_levels(&s->pieces.piece->input, &desc, lod->n, lod->count,
                                      levels, NULL, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    for (size_t n = 0; n < lod->count; n++)
        triangles += levels[n].triangle_count;
    cli_report_end(&s->report, "simplify", s->pieces.triangles, triangles);
    return CW_OK;
}

/* How far from the input, and from the source's surface: of all parts the farthest there, as
 * they are on one surface. */
static cw_status measure_error(run_state *s, cli_made *made, cw_error *err)
{
    cli_comparison *c = &made->compared;
    if (!s->args->measure)
        return CW_OK;
    cli_report_begin(&s->report);
    c->promised_mm = s->error_mm;
    cw_status st = cli_compare_pieces(&s->pieces, s->threads, c, err);
    for (size_t n = 0; n < s->pieces.count && st == CW_OK && s->args->iso.given; n++) {
        st = cli_compare_with_field(&s->pieces.piece[n].out, &s->source, s->iso.value,
                                    s->args->inside, s->threads, c, err);
        st = st == CW_OK ? st : cwi_fail_in(err, st, s->mesh.path);
    }
    if (st == CW_OK)
        cli_report_end(&s->report, "measure", c->with_input.from_reference.triangles,
                       c->with_input.to_reference.triangles);
    return st;
}

static cw_status shade_mesh(run_state *s, cw_error *err)
{
    const cw_normals_desc desc = {.inside_is_low = s->args->inside, .threads = s->threads};
    cw_status st = CW_OK;
    if (!s->args->source)
        return CW_OK;
    cli_report_begin(&s->report);
    for (size_t n = 0; n < s->pieces.count && st == CW_OK; n++)
        st = cw_extract_normals(&s->source.view, &desc, &s->pieces.piece[n].out, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->source.path);
    cli_report_end(&s->report, "normals", 1, s->pieces.count);
    return CW_OK;
}

static cw_status deliver_parts(run_state *s, const cw_part *parts, size_t count, bool levels,
                               cw_error *err)
{
    const cli_delivery how = {
        .input = s->mesh.path,
        .write = cli_written_desc(&s->args->written, &s->args->compress, &s->mesh),
        .compress = &s->args->compress,
        .threads = s->threads,
        .unchecked = levels, /* each was by itself */
        .unpromised = true,
        .parts = levels ? "levels" : NULL,
        .tell_dropped = true};
    return cli_deliver(&s->report, &how, parts, count, 0, s->start, err);
}

static cw_status deliver_result(run_state *s, cw_error *err)
{
    cw_part *parts = NULL;
    cw_status st = cli_list_parts(&s->pieces, &parts, err);
    if (st == CW_OK)
        st = deliver_parts(s, parts, s->pieces.count, false, err);
    free(parts);
    return st;
}

/* Checks and measures what became of the pieces, and shades it. */
static cw_status finish_pieces(run_state *s, cli_made *made, cw_error *err)
{
    cw_status st = cli_hold_pieces(&s->pieces, s->threads, err);
    if (st == CW_OK)
        st = measure_error(s, made, err);
    return st == CW_OK ? shade_mesh(s, err) : st;
}

/* A level is the result of the only piece for a while. */
static cw_status finish_level(void *state, cli_made *made, cw_mesh *level, cw_error *err)
{
    run_state *s = state;
    s->pieces.piece->out = *level;
    cw_status st = finish_pieces(s, made, err);
    *level = s->pieces.piece->out;
    s->pieces.piece->out = (cw_mesh){0};
    return st;
}

static cw_status deliver_levels(void *state, size_t file, const cw_part *parts, size_t count,
                                cw_error *err)
{
    run_state *s = state;
    cw_status st = deliver_parts(s, parts, count, file == s->args->lod.count, err);
    s->start = cli_seconds();
    return st;
}

static cw_status make_levels(run_state *s, cw_error *err)
{
    cli_detail_levels levels = {.lod = &s->args->lod,
                                .name = s->args->written.name,
                                .files = &s->outputs,
                                .report = &s->report,
                                .pieces = &s->pieces,
                                .keeps_border = s->args->keep_border,
                                .make = simplify_levels,
                                .finish = finish_level,
                                .deliver = deliver_levels,
                                .user = s};
    cw_status st = cli_make_detail_levels(&levels, err);
    cli_free_detail_levels(&levels);
    return st;
}

static cw_status make_result(run_state *s, cw_error *err)
{
    cli_made *made = cli_report_next(&s->report, s->outputs.path[0], 0);
    cw_status st = simplify_parts(s, err);
    if (st != CW_OK)
        return st;
    st = finish_pieces(s, made, err);
    if (st == CW_OK)
        st = deliver_result(s, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status simplify_mesh(void *state, cw_error *err)
{
    run_state *s = state;
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = read_inputs(s, err);
    if (st != CW_OK)
        return st;
    return s->args->lod.count ? make_levels(s, err) : make_result(s, err);
}

static void free_state(run_state *s)
{
    cli_free_pieces(&s->pieces);
    cli_free_mesh(&s->mesh);
    cli_free_volume(&s->source);
    cli_free_outputs(&s->outputs);
}

cw_status cli_run_simplify(void *p, cw_error *err)
{
    const cli_simplify_args *args = p;
    run_state s = {.args = args,
                   .iso = args->iso,
                   .threads = (int)args->input.threads,
                   .start = cli_seconds()};
    s.report.command = "simplify";
    s.report.several = args->lod.count ? "levels" : NULL;
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .meshes = args->lod.count + 1,
                         .body = simplify_mesh,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.report, err);
    free_state(&s);
    return st;
}
