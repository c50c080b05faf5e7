#include "cli/commands.h"
#include "cli/compare.h"
#include "cli/console.h"
#include "cli/deliver.h"
#include "cli/output.h"
#include "cli/quantity.h"
#include "cli/template.h"
#include "cli/written.h"
#include "core/status.h"

#include <cubewright/simplify.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct simplify_args {
    cli_common common;
    cli_input input; /* of the source volume; limits and safety are the mesh's, too */
    cli_compress compress;
    cli_written written;
    const char *output, *json, *source, *mesh_reader;
    cli_length error, drop;
    cli_number ratio, iso;
    size_t triangles;
    cli_counts lod;
    int inside, progress;
    bool allow_intersections, merge, measure;
} simplify_args;

static const simplify_args defaults = {.measure = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "the mesh, in the format of its extension; may hold {stem}, with --lod {lod}",
     offsetof(simplify_args, output)},
    {"error", 'e', CLI_LENGTH, "L",
     "as far as this allows: 0.1mm, or 0.05% of the box's diagonal",
     offsetof(simplify_args, error)},
    {"triangles", 'n', CLI_COUNT, "N", "down to so many triangles, e.g. 50k",
     offsetof(simplify_args, triangles)},
    {"ratio", 0, CLI_NUMBER, "R", "down to this share of the triangles, e.g. 0.25",
     offsetof(simplify_args, ratio)},
    {"lod", 0, CLI_COUNTS, "N[,N...]",
     "levels of detail of so many triangles, e.g. 50k,12k,3k: a file each, glTF also one of "
     "all",
     offsetof(simplify_args, lod)},
    {"allow-intersections", 0, CLI_FLAG, NULL,
     "triangles may meet that did not: faster (none may)",
     offsetof(simplify_args, allow_intersections)},
    {"drop-components", 0, CLI_LENGTH, "L",
     "leave out components whose box has a shorter diagonal, e.g. 2mm, before all (none)",
     offsetof(simplify_args, drop)},
    {"merge", 0, CLI_FLAG, NULL,
     "all parts as one mesh (each by itself, where the format has parts)",
     offsetof(simplify_args, merge)},
    {"source", 's', CLI_TEXT, "VOLUME",
     "normals from this volume's field (those of the input, carried over)",
     offsetof(simplify_args, source)},
    {"iso", 'i', CLI_NUMBER, "V",
     "measure the distance to the source's surface at this isovalue, too",
     offsetof(simplify_args, iso)},
    {"inside", 0, CLI_CHOICE, "above/below", "which of the source's values are inside (above)",
     offsetof(simplify_args, inside)},
    {"measure", 0, CLI_FLAG, NULL,
     "measure the error, which takes longer than simplifying (on; --no-measure)",
     offsetof(simplify_args, measure)},
    {"json", 0, CLI_TEXT, "FILE", "write a report; - is the standard output",
     offsetof(simplify_args, json)},
    {"progress", 0, CLI_CHOICE, "auto/plain/json/none", "how to show it, on stderr (auto)",
     offsetof(simplify_args, progress)},
    {"mesh-reader", 0, CLI_TEXT, "NAME",
     "read the mesh as this format of 'formats' (by content)",
     offsetof(simplify_args, mesh_reader)},
    {"max-triangles", 0, CLI_COUNT, "N", "stop before reading more, e.g. 100M (no limit)",
     CLI_INPUT_ROW(simplify_args, max_triangles)},
    CLI_WRITTEN_OPTIONS(simplify_args),
    CLI_COMPRESS_OPTIONS(simplify_args),
    CLI_INPUT_OPTIONS(simplify_args),
};

/* A part of the input: by itself, as components are, so that parts stay apart. */
typedef struct piece {
    cw_mesh input; /* its arrays are those of run_state.mesh, welded */
    const char *name;
    cw_quality before;
    cw_mesh out;
} piece;

typedef struct run_state {
    const simplify_args *args;
    cli_mesh mesh;
    cli_volume source;
    piece *pieces;
    size_t piece_count, triangles; /* of all pieces, before */
    cw_mesh lod[CLI_MAX_COUNTS];   /* levels of the only piece, until they are its result */
    char lod_names[CLI_MAX_COUNTS][24];
    bool unordered;               /* it was told that meshoptimizer is not there */
    size_t merged, dropped, kept; /* vertices; components */
    double diagonal_mm, error_mm, drop_mm;
    cli_outputs outputs;
    cli_report report;
    double start;
} run_state;

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    const simplify_args *args = s->args;
    if (args->error.given)
        cli_json_number(j, "error_mm", s->error_mm);
    if (args->triangles)
        cli_json_count(j, "triangles", args->triangles);
    if (args->ratio.given)
        cli_json_number(j, "ratio", args->ratio.value);
    if (args->lod.count) {
        cli_json_open(j, "lod", '[');
        for (size_t n = 0; n < args->lod.count; n++)
            cli_json_count(j, NULL, args->lod.n[n]);
        cli_json_close(j, ']');
    }
    if (args->drop.given) {
        cli_json_number(j, "drop_components_mm", s->drop_mm);
        cli_json_count(j, "dropped_components", s->dropped);
    }
    cli_json_count(j, "merged_vertices", s->merged);
    cli_json_bool(j, "allow_intersections", args->allow_intersections);
    cli_json_bool(j, "merge", args->merge);
    cli_json_text(j, "normals", args->source ? "field" : "carried");
    if (args->source)
        cli_json_text(j, "inside", args->inside ? "below" : "above");
    if (args->iso.given)
        cli_json_number(j, "iso", args->iso.value);
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

/* --- arguments --------------------------------------------------------------------------- */

static cw_status check_lod(const simplify_args *args, cw_error *err)
{
    const cli_counts *lod = &args->lod;
    if (args->error.given || args->triangles || args->ratio.given)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--lod says how far to go: --error, --triangles and --ratio are for one "
                       "mesh");
    for (size_t n = 0; n < lod->count; n++)
        if (!lod->n[n] || (n && lod->n[n] >= lod->n[n - 1]))
            return cw_fail(err, CW_ERR_ARGUMENT,
                           "--lod lists %zu triangles%s; each level needs some, and fewer than "
                           "the one before",
                           lod->n[n], n ? " behind as many or fewer" : "");
    return CW_OK;
}

static cw_status check_targets(const simplify_args *args, cw_error *err)
{
    if (args->lod.count) {
        cw_status st = check_lod(args, err);
        if (st != CW_OK)
            return st;
    } else if (!args->error.given && !args->triangles && !args->ratio.given) {
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "simplify needs to know how far to go: --error 0.1mm, --triangles 50k, "
                       "--ratio 0.25 or --lod 50k,12k,3k");
    }
    if (args->error.unit == CLI_VOXELS || args->drop.unit == CLI_VOXELS)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--%s: a mesh has no voxels; give mm, or %% of its box's diagonal",
                       args->error.unit == CLI_VOXELS ? "error" : "drop-components");
    if (args->ratio.given && !(args->ratio.value > 0 && args->ratio.value < 1))
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--ratio is a share of the triangles, above 0 and below 1, and not %g",
                       args->ratio.value);
    if (args->iso.given && !args->source)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--iso needs the volume it is of: --source VOLUME");
    if (args->iso.given && !args->measure)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--iso is there to be measured from: not with --no-measure");
    return CW_OK;
}

static cw_status check_against_inputs(const run_state *s, const char *output, cw_error *err)
{
    const char *inputs[2] = {s->args->common.inputs[0], s->args->source};
    return cli_check_output(output, inputs, s->args->source ? 2 : 1, err);
}

/* The report is an output, too: none is written when it is an input or a mesh. */
static cw_status check_outputs(run_state *s, cw_error *err)
{
    const simplify_args *args = s->args;
    const cw_write_desc desc = cli_written_desc(&args->written, &args->compress, &s->mesh);
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->outputs.count && st == CW_OK; n++) {
        st = args->json ? cli_check_apart(args->json, s->outputs.path[n], err) : CW_OK;
        s->report.path = st == CW_OK ? args->json : NULL;
        if (st == CW_OK)
            st = check_against_inputs(s, s->outputs.path[n], err);
    }
    return st == CW_OK ? cli_check_outputs(&s->outputs, args->common.inputs[0], &desc, err)
                       : st;
}

static bool is_gltf(const simplify_args *args)
{
    const cw_format *format = cw_mesh_format(args->output, args->written.format);
    return format && (strcmp(format->name, "glb") == 0 || strcmp(format->name, "gltf") == 0);
}

/* What can be refused before the input is read. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const simplify_args *args = s->args;
    cw_status st = args->json ? check_against_inputs(s, args->json, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    st = check_targets(args, err);
    if (st == CW_OK)
        st = cli_check_compress(&args->compress, false, err);
    if (st != CW_OK)
        return st;
    if (!args->output)
        return cw_fail(err, CW_ERR_ARGUMENT, "simplify needs an output: -o FILE");
    if (!cw_simplify_available())
        return cw_fail(err, CW_ERR_UNSUPPORTED,
                       "simplify needs OpenMesh, which this build is without: install "
                       "libopenmesh-dev and build again");
    st = args->lod.count
             ? cli_name_lod_outputs(&s->outputs, args->output, args->common.inputs[0],
                                    args->lod.count, is_gltf(args), err)
             : cli_name_output(&s->outputs, args->output, args->common.inputs[0], err);
    return st == CW_OK ? check_outputs(s, err) : st;
}

/* --- input ------------------------------------------------------------------------------- */

/* The parts as they are read: their box is what shares are of. */
static void measure_box(run_state *s)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (const piece *p = s->pieces; p < s->pieces + s->piece_count; p++) {
        double from[3], to[3];
        cw_mesh_bounds(&p->input, from, to);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], from[a]);
            high[a] = fmax(high[a], to[a]);
        }
    }
    s->diagonal_mm = hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    s->error_mm = s->args->error.given ? cli_length_mm(&s->args->error, s->diagonal_mm, 0) : 0;
    s->drop_mm = s->args->drop.given ? cli_length_mm(&s->args->drop, s->diagonal_mm, 0) : 0;
}

/* Welds all parts; those without triangles go. */
static cw_status weld_pieces(run_state *s, cw_error *err)
{
    const cli_mesh *m = &s->mesh;
    const size_t count = m->parts ? m->part_count : 1;
    cw_status st = CW_OK;
    s->pieces = calloc(count ? count : 1, sizeof *s->pieces);
    if (!s->pieces)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu parts", count);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        size_t merged;
        piece *p = &s->pieces[s->piece_count];
        *p = (piece){.input = m->parts ? *m->parts[n].mesh : m->mesh,
                     .name = m->parts ? m->parts[n].name : NULL};
        st = cw_mesh_weld(&p->input, &merged, err);
        s->merged += merged;
        s->piece_count += st == CW_OK && p->input.triangle_count > 0;
    }
    if (st == CW_OK && s->merged)
        cli_say("%s: %s vertices were at the place of another and made one with it", m->path,
                cli_count(s->merged));
    return st;
}

static cw_status drop_components(run_state *s, cw_error *err)
{
    const size_t count = s->piece_count;
    cw_status st = CW_OK;
    if (!s->args->drop.given)
        return CW_OK;
    s->piece_count = 0;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        size_t dropped = 0, kept = 0;
        piece *p = &s->pieces[s->piece_count];
        *p = s->pieces[n];
        st = cw_mesh_drop_components(&p->input, s->drop_mm, &dropped, &kept, err);
        s->dropped += dropped;
        s->kept += kept;
        s->piece_count += kept > 0;
    }
    if (st == CW_OK && !s->piece_count)
        return cw_fail(err, CW_ERR_EMPTY,
                       "no component has a diagonal of %.6g mm: nothing is left", s->drop_mm);
    if (st == CW_OK)
        cli_say("%s: %s component%s kept, %s dropped (< %.6g mm)", s->mesh.path,
                cli_count(s->kept), s->kept == 1 ? "" : "s", cli_count(s->dropped), s->drop_mm);
    return st;
}

static cw_status measure_pieces(run_state *s, cw_error *err)
{
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL,
                                  .threads = (int)s->args->input.threads};
    cw_status st = CW_OK;
    for (piece *p = s->pieces; p < s->pieces + s->piece_count && st == CW_OK; p++) {
        st = cw_quality_measure(&p->input, &desc, &p->before, err);
        s->triangles += p->input.triangle_count;
    }
    return st;
}

static cw_status take_pieces(run_state *s, cw_error *err)
{
    cw_status st = weld_pieces(s, err);
    if (st == CW_OK && !s->piece_count)
        st = cw_fail(err, CW_ERR_EMPTY, "there are no triangles in it");
    if (st == CW_OK)
        measure_box(s);
    if (st == CW_OK)
        st = drop_components(s, err);
    if (st == CW_OK)
        st = measure_pieces(s, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, s->mesh.path);
}

static cw_status read_inputs(run_state *s, cw_error *err)
{
    const simplify_args *args = s->args;
    const char *path = args->common.inputs[0];
    const cw_format *format = cw_mesh_format(args->output, args->written.format);
    const bool parts =
        !args->merge && !args->lod.count && format && format->keeps & CW_KEEPS_PARTS;
    cli_report_begin(&s->report);
    cw_status st = parts ? cli_read_parts(path, args->mesh_reader, &args->input, &s->mesh, err)
                         : cli_read_mesh(path, args->mesh_reader, &args->input, &s->mesh, err);
    if (st == CW_OK && args->source)
        st = cli_read_volume(args->source, &args->input, false, &s->source, err);
    if (st == CW_OK)
        st = take_pieces(s, err);
    for (size_t n = 0; n < s->piece_count && st == CW_OK && args->source; n++)
        st = cli_check_place(&s->source, &s->pieces[n].input, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "read", 1, s->triangles);
    return st;
}

/* --- work -------------------------------------------------------------------------------- */

/* Parts share the triangles in proportion to what they have. */
static size_t share_of(const run_state *s, const piece *p)
{
    const double share = (double)p->input.triangle_count / (double)s->triangles;
    const size_t triangles = (size_t)(share * (double)s->args->triangles);
    return s->args->triangles && !triangles ? 1 : triangles;
}

/* What the result was to have, at most; 0: nothing was said. */
static size_t target_of(const run_state *s)
{
    const double share = s->args->ratio.given ? s->args->ratio.value : 0;
    const size_t rest = (size_t)(share * (double)s->triangles);
    return rest > s->args->triangles ? rest : s->args->triangles;
}

static void tell_missed(run_state *s, size_t target, size_t triangles)
{
    if (target && s->triangles <= target)
        cli_say("%s: has no more than the %s triangles asked for: they stay", s->mesh.path,
                cli_count(target));
    if (!target || triangles <= target)
        return;
    if (s->args->error.given)
        cli_say("%s: %s triangles, and not %s: with fewer it would be more than %.6g mm off",
                s->mesh.path, cli_count(triangles), cli_count(target), s->error_mm);
    else
        cli_report_warn(&s->report,
                        "%s triangles were asked for, %s are left: where more would go, the "
                        "surface would tear, turn over or meet itself",
                        cli_count(target), cli_count(triangles));
}

static cw_status simplify(run_state *s, cw_error *err)
{
    const simplify_args *args = s->args;
    size_t triangles = 0;
    cw_status st = CW_OK;
    cli_report_begin(&s->report);
    for (piece *p = s->pieces; p < s->pieces + s->piece_count && st == CW_OK; p++) {
        const cw_simplify_desc desc = {
            .error_mm = s->error_mm,
            .triangles = share_of(s, p),
            .ratio = args->ratio.given ? args->ratio.value : 0,
            .allow_crossings = args->allow_intersections,
            .threads = (int)args->input.threads,
            .progress = cli_progress((double)p->input.triangle_count / 1e6, "Mtriangle")};
        st = cw_simplify(&p->input, &desc, &p->out, NULL, err);
        triangles += p->out.triangle_count;
    }
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    cli_report_end(&s->report, "simplify", s->triangles, triangles);
    tell_missed(s, target_of(s), triangles);
    return CW_OK;
}

static cw_status simplify_levels(run_state *s, cw_error *err)
{
    const simplify_args *args = s->args;
    const cw_simplify_desc desc = {.allow_crossings = args->allow_intersections,
                                   .threads = (int)args->input.threads,
                                   .progress =
                                       cli_progress((double)s->triangles / 1e6, "Mtriangle")};
    size_t triangles = 0;
    cli_report_begin(&s->report);
    cw_status st = cw_simplify_levels(&s->pieces->input, &desc, args->lod.n, args->lod.count,
                                      s->lod, NULL, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    for (size_t n = 0; n < args->lod.count; n++)
        triangles += s->lod[n].triangle_count;
    cli_report_end(&s->report, "simplify", s->triangles, triangles);
    return CW_OK;
}

/* The promise that holds in any case. */
static cw_status hold_to_topology(run_state *s, cw_error *err)
{
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL,
                                  .threads = (int)s->args->input.threads};
    cw_status st = CW_OK;
    for (const piece *p = s->pieces; p < s->pieces + s->piece_count && st == CW_OK; p++) {
        cw_quality after;
        st = cw_quality_measure(&p->out, &desc, &after, err);
        if (st == CW_OK)
            st = cli_hold_to_topology(&p->before, &after, err);
    }
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, s->mesh.path);
}

/* How far from the source's surface: of all parts the farthest, as they are on one surface. */
static cw_status measure_from_field(run_state *s, const cw_mesh *mesh, cli_comparison *c,
                                    cw_error *err)
{
    const cw_field_distance_desc desc = {
        .isovalue = s->args->iso.value,
        .inside_is_low = s->args->inside,
        .threads = (int)s->args->input.threads,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    cw_distance d;
    cw_status st = cw_distance_to_field(mesh, &s->source.view, &desc, &d, NULL, err);
    if (st == CW_OK && (!c->has_field || d.max_mm > c->to_field.max_mm))
        c->to_field = d;
    c->has_field = st == CW_OK;
    return st;
}

static cw_status measure(run_state *s, cli_made *made, cw_error *err)
{
    cli_comparison *c = &made->compared;
    double area[2] = {0, 0};
    cw_status st = CW_OK;
    if (!s->args->measure)
        return CW_OK;
    c->diagonal_mm = s->diagonal_mm;
    c->promised_mm = s->error_mm;
    cli_report_begin(&s->report);
    for (const piece *p = s->pieces; p < s->pieces + s->piece_count && st == CW_OK; p++) {
        st = cli_compare(&p->out, &p->input, s->error_mm / 100, (int)s->args->input.threads, c,
                         area, err);
        if (st == CW_OK && s->args->iso.given)
            st = measure_from_field(s, &p->out, c, err);
    }
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    cli_report_end(&s->report, "measure", c->from_input.triangles, c->to_input.triangles);
    const double most = fmax(c->to_input.max_mm, c->from_input.max_mm);
    return s->error_mm > 0 && most > s->error_mm
               ? cw_fail(err, CW_ERR_CHECK,
                         "%s: not as promised: %.6g mm from the input, and not %.6g; nothing "
                         "is written",
                         s->mesh.path, most, s->error_mm)
               : CW_OK;
}

static cw_status shade(run_state *s, cw_error *err)
{
    const cw_normals_desc desc = {.inside_is_low = s->args->inside,
                                  .threads = (int)s->args->input.threads};
    cw_status st = CW_OK;
    if (!s->args->source)
        return CW_OK;
    cli_report_begin(&s->report);
    for (piece *p = s->pieces; p < s->pieces + s->piece_count && st == CW_OK; p++)
        st = cw_extract_normals(&s->source.view, &desc, &p->out, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->source.path);
    cli_report_end(&s->report, "normals", 1, s->piece_count);
    return CW_OK;
}

/* Levels are for drawing: their triangles and vertices are put in the order that is fast. */
static cw_status order(run_state *s, cw_error *err)
{
    cw_error why = {0};
    const cw_status st = cw_mesh_optimize(&s->pieces->out, &why);
    if (st == CW_ERR_UNSUPPORTED) {
        if (!s->unordered)
            cli_say("levels are not put in the order that draws fast: %s", why.message);
        s->unordered = true;
        return CW_OK;
    }
    return st == CW_OK ? CW_OK : cw_fail(err, st, "%s: %s", s->mesh.path, why.message);
}

static cw_status deliver_parts(run_state *s, const cw_part *parts, size_t count, bool levels,
                               cw_error *err)
{
    const cli_delivery how = {
        .input = s->mesh.path,
        .write = cli_written_desc(&s->args->written, &s->args->compress, &s->mesh),
        .compress = &s->args->compress,
        .threads = (int)s->args->input.threads,
        .unchecked = levels, /* each was by itself */
        .unpromised = true,
        .levels = levels,
        .tell_dropped = true};
    return cli_deliver(&s->report, &how, parts, count, 0, s->start, err);
}

static cw_status deliver(run_state *s, cw_error *err)
{
    cw_part *parts = calloc(s->piece_count, sizeof *parts);
    if (!parts)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu parts", s->piece_count);
    for (size_t n = 0; n < s->piece_count; n++)
        parts[n] = (cw_part){.mesh = &s->pieces[n].out, .name = s->pieces[n].name};
    cw_status st = deliver_parts(s, parts, s->piece_count, false, err);
    free(parts);
    return st;
}

/* Measures what became of the pieces, shades it and writes it. */
static cw_status finish(run_state *s, cli_made *made, cw_error *err)
{
    cw_status st = hold_to_topology(s, err);
    if (st == CW_OK)
        st = measure(s, made, err);
    if (st == CW_OK)
        st = shade(s, err);
    if (st == CW_OK && s->args->lod.count)
        st = order(s, err);
    if (st == CW_OK)
        st = deliver(s, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

/* One file with all levels; names of nodes are as those of the files. */
static cw_status deliver_levels(run_state *s, cw_error *err)
{
    const size_t count = s->args->lod.count;
    const char *path = s->outputs.path[count];
    char names[CLI_MAX_COUNTS][256],
        *stem = cli_stem(s->args->written.name ? s->args->written.name : path);
    cw_part parts[CLI_MAX_COUNTS];
    cli_made *made = cli_report_next(&s->report, path, 0);
    made->name = "all";
    if (!stem)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for names");
    for (size_t n = 0; n < count; n++) {
        const cli_comparison *c = &s->report.made[n].compared;
        snprintf(names[n], sizeof names[n], "%.200s-lod%zu", stem, n);
        parts[n] = (cw_part){
            .mesh = &s->lod[n],
            .name = names[n],
            .level = n,
            .max_error_mm = fmax(c->to_input.max_mm, c->from_input.max_mm),
            .rms_error_mm = cli_both_rms(c),
        };
    }
    cw_status st = deliver_parts(s, parts, count, true, err);
    if (st != CW_OK)
        made->error = *err;
    free(stem);
    return st;
}

/* Each level is the result of the only piece for a while. */
static cw_status make_levels(run_state *s, cw_error *err)
{
    const size_t count = s->args->lod.count;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        cli_made *made = cli_report_next(&s->report, s->outputs.path[n], 0);
        snprintf(s->lod_names[n], sizeof s->lod_names[n], "lod%zu", n);
        made->name = s->lod_names[n];
        if (n == 0)
            st = simplify_levels(s, err);
        if (st != CW_OK)
            return st;
        tell_missed(s, s->args->lod.n[n], s->lod[n].triangle_count);
        s->pieces->out = s->lod[n];
        st = finish(s, made, err);
        s->lod[n] = s->pieces->out;
        s->pieces->out = (cw_mesh){0};
        s->start = cli_seconds();
    }
    return st == CW_OK && s->outputs.count > count ? deliver_levels(s, err) : st;
}

static cw_status pipeline(run_state *s, cw_error *err)
{
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = read_inputs(s, err);
    if (st != CW_OK)
        return st;
    if (s->args->lod.count)
        return make_levels(s, err);
    cli_made *made = cli_report_next(&s->report, s->outputs.path[0], 0);
    st = simplify(s, err);
    return st == CW_OK ? finish(s, made, err) : st;
}

static void free_state(run_state *s)
{
    for (size_t n = 0; n < s->piece_count; n++)
        cw_mesh_free(&s->pieces[n].out);
    for (size_t n = 0; n < CLI_MAX_COUNTS; n++)
        cw_mesh_free(&s->lod[n]);
    free(s->pieces);
    cli_free_mesh(&s->mesh);
    cli_free_volume(&s->source);
    cli_free_outputs(&s->outputs);
    cli_report_free(&s->report);
}

static cw_status run(void *p, cw_error *err)
{
    const simplify_args *args = p;
    run_state s = {.args = args, .start = cli_seconds()};
    s.report.command = "simplify";
    s.report.several = args->lod.count ? "levels" : NULL;
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    if (args->json && strcmp(args->json, "-") == 0)
        cli_results_to_stderr();
    cw_status st = cli_report_reserve(&s.report, args->lod.count + 1, err);
    if (st == CW_OK)
        st = pipeline(&s, err);
    st = cli_report_write(&s.report, st, err);
    free_state(&s);
    return st;
}

const cli_command cli_simplify = {
    .name = "simplify",
    .usage = "MESH -o MESH --error L|--triangles N|--ratio R|--lod N,... [options]",
    .about = "a mesh with fewer triangles, under a promise of how far it is from the input",
    .more =
        "Reads a mesh, collapses edges, those first that move the surface least, measures how\n"
        "far the result is from the input, and writes it. Of several targets the one that is\n"
        "met first ends it.\n\n"
        "With --error no point of the result is farther from the input, and none of the input\n"
        "farther from the result. In any case components, handles and border loops stay what\n"
        "they are, nothing turns over, and no triangles meet that did not meet before\n"
        "(--allow-intersections drops the last). Where that leaves more triangles than asked\n"
        "for, it is told. Exit code 1, and no file, when the result should not be as "
        "promised.\n\n"
        "The error that is printed, and in the report, is measured both ways over the whole\n"
        "surfaces: the largest distance, the root of the mean square, the 99th percentile.\n"
        "--no-measure skips it.\n\n"
        "Vertices at equal positions are made one first. --drop-components then leaves out\n"
        "specks; the error is measured against what is left.\n\n"
        "Parts (of OBJ, 3MF, glTF) stay parts where the output's format has them: each is\n"
        "simplified by itself, with its share of the triangles, and crossings are looked for\n"
        "within each. --merge makes them one mesh.\n\n"
        "--lod makes levels of detail, each from the one before, of all parts merged: a file\n"
        "each, whose names tell them apart by {lod}, or by -lod0, -lod1, ... without it. "
        "Where\n"
        "that is glTF, the file named itself holds them all: its scene shows level 0, and the\n"
        "extension MSFT_lod names the others, with the share of the screen below which each\n"
        "is enough. Most engines read a file a level; few know MSFT_lod. Triangles and errors\n"
        "of each are in the report and in the extras of its node.\n\n"
        "Normals, colours, scalars and labels are those of the closest point of the input.\n"
        "--source takes normals from the field of the volume that the mesh is a surface of, "
        "so\n"
        "that it shades as the full one does; with --iso the distance to the field's surface\n"
        "is measured, too.\n\n"
        "Examples\n"
        "  cubewright simplify bone.stl --error 0.1mm -o small.stl\n"
        "  cubewright simplify bone.glb --triangles 50k --error 0.05% -o web.glb \\\n"
        "      --compress meshopt\n"
        "  cubewright simplify scan.ply --drop-components 2mm --error 0.2mm -o scan.glb\n"
        "  cubewright simplify cloud.glb --lod 50k,12k,3k -o cloud-web.glb\n"
        "  cubewright simplify bone.glb --ratio 0.1 -o tenth.glb --source ct.nrrd --iso 300\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .size = sizeof(simplify_args),
    .defaults = &defaults,
    .run = run,
};
