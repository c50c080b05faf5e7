/* Moves the surface of a solid or turns the solid into a shell, for the commands offset and
 * hollow: arguments, work, measurements and report. */
#include "cli/commands/offset_hollow.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/mesh_parts.h"
#include "cli/results/output_names.h"
#include "cli/results/write_result.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/level_set.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DRAINS = 16 };

/* As they are asked for: shares are not resolved before the mesh is read. */
typedef struct wishes {
    cli_length voxel, by, drain[MAX_DRAINS];
    double sign; /* of by */
    cw_drain drains[MAX_DRAINS];
    size_t drain_count;
} wishes;

typedef struct run_state {
    const cli_solid_args *args;
    bool hollow; /* else offset */
    wishes wishes;
    cli_mesh mesh;
    cli_pieces pieces; /* one */
    cw_hollow_facts facts;
    double voxel_mm, by_mm, wall_mm;
    double off_max_mm, off_rms_mm; /* of an offset */
    cw_offset_facts offset;
    char found[256]; /* for the line */
    cli_outputs outputs;
    cli_report report;
    double start;
} run_state;

const cli_solid_args cli_solid_defaults = {.measure = true, .sharp = true, .refine = true};

/* --- the report --------------------------------------------------------------------------- */

static void put_drains(cli_json *j, const wishes *w)
{
    cli_json_open(j, "drains", '[');
    for (size_t n = 0; n < w->drain_count; n++) {
        cli_json_open(j, NULL, '{');
        cli_json_number(j, "diameter_mm", w->drains[n].diameter_mm);
        cli_json_numbers(j, "direction", w->drains[n].direction, 3);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    if (s->hollow) {
        cli_json_number(j, "wall_mm", s->wall_mm);
        put_drains(j, &s->wishes);
    } else {
        cli_json_number(j, "by_mm", s->by_mm);
    }
    cli_json_number(j, "voxel_mm", s->voxel_mm);
    if (s->offset.asked_mm > 0) /* only offset takes others */
        cli_json_number(j, "voxel_asked_mm", s->offset.asked_mm);
    cli_json_count(j, "merged_vertices", s->pieces.merged);
    cli_json_written(j, &s->args->written, made->path);
}

static void put_hollow(cli_json *j, const run_state *s)
{
    cli_json_open(j, "hollow", '{');
    cli_json_count(j, "cavities", s->facts.cavities);
    cli_json_count(j, "sealed", s->facts.sealed);
    cli_json_number(j, "removed_mm3", s->facts.removed_mm3);
    if (s->args->measure) {
        cli_json_number(j, "wall_min_mm", s->facts.wall_min_mm);
        cli_json_number(j, "wall_max_mm", s->facts.wall_max_mm);
    }
    cli_json_close(j, '}');
}

static void put_offset(cli_json *j, const run_state *s)
{
    cli_json_open(j, "off", '{');
    cli_json_number(j, "max_mm", s->off_max_mm);
    cli_json_number(j, "rms_mm", s->off_rms_mm);
    cli_json_close(j, '}');
}

/* Writes the facts of a surface that was rebuilt in place (--by 0). */
static void put_anew(cli_json *j, const cw_offset_facts *f)
{
    cli_json_open(j, "anew", '{');
    cli_json_bool(j, "within_half_voxel", !f->is_astray);
    if (f->least_mm > 0)
        cli_json_number(j, "voxel_least_mm", f->least_mm);
    cli_json_count(j, "more_components", f->more_components);
    cli_json_count(j, "more_handles", f->more_handles);
    cli_json_close(j, '}');
}

static void put_facts(cli_json *j, const void *p)
{
    const run_state *s = p;
    if (s->mesh.file.format)
        cli_json_mesh_file(j, "input", &s->mesh);
    if (s->facts.cavities)
        put_hollow(j, s);
    if (s->off_max_mm > 0)
        put_offset(j, s);
    if (s->offset.asked_mm > 0 && s->by_mm == 0)
        put_anew(j, &s->offset);
}

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status parse_length(const char *option, const char *text, cli_length *out,
                              cw_error *err)
{
    if (cli_parse_length(text, out) && out->unit != CLI_VOXELS)
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s '%s': expected a length above 0 such as 0.1mm, or 0.05%% of the box's "
                    "diagonal",
                    option, text);
}

/* "4mm@-z" */
static cw_status parse_drain(const char *text, cli_length *wide, cw_drain *drain, cw_error *err)
{
    char copy[64];
    const char *at = strchr(text, '@');
    if (at && (size_t)(at - text) < sizeof copy) {
        const char *axis = at + 1 + (at[1] == '+' || at[1] == '-');
        memcpy(copy, text, (size_t)(at - text));
        copy[at - text] = '\0';
        if (*axis >= 'x' && *axis <= 'z' && !axis[1]) {
            drain->direction[*axis - 'x'] = at[1] == '-' ? -1 : 1;
            return parse_length("--drain", copy, wide, err);
        }
    }
    return cwi_fail(
        err, CW_ERR_ARGUMENT,
        "--drain '%s': expected a diameter and a direction, +x to -z, such as 4mm@-z", text);
}

static cw_status parse_drains(const char *text, wishes *w, cw_error *err)
{
    char *copy = malloc(strlen(text) + 1), *next = copy;
    if (!copy)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for drains");
    strcpy(copy, text);
    cw_status st = CW_OK;
    while (next && st == CW_OK) {
        char *here = next;
        next = strchr(here, ',');
        if (next)
            *next++ = '\0';
        st = w->drain_count < MAX_DRAINS
                 ? parse_drain(here, &w->drain[w->drain_count], &w->drains[w->drain_count], err)
                 : cwi_fail(err, CW_ERR_ARGUMENT, "--drain: more than %d", MAX_DRAINS);
        w->drain_count++;
    }
    free(copy);
    return st;
}

/* A length with a sign; 0 is one, too. */
static cw_status parse_by(const char *text, wishes *w, cw_error *err)
{
    const char *rest = text + (*text == '+' || *text == '-');
    const size_t zeros = strspn(rest, "0.");
    w->sign = *text == '-' ? -1 : 1;
    if (zeros && (!rest[zeros] || strcmp(rest + zeros, "mm") == 0))
        return CW_OK;
    if (*rest != '+' && *rest != '-' && cli_parse_length(rest, &w->by) &&
        w->by.unit != CLI_VOXELS)
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "--by '%s': expected a length such as 1mm, -0.5mm, 0 or 0.5%% of the box's "
                    "diagonal",
                    text);
}

static cw_status parse_wishes(const cli_solid_args *args, bool hollow, wishes *w, cw_error *err)
{
    cw_status st = CW_OK;
    if (hollow && args->wall.unit == CLI_VOXELS)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--wall: a mesh has no voxels; give mm, or %% of its box's diagonal");
    if (args->drain)
        st = parse_drains(args->drain, w, err);
    if (st == CW_OK && args->by)
        st = parse_by(args->by, w, err);
    if (st == CW_OK && args->voxel && strcmp(args->voxel, "auto") != 0)
        st = parse_length("--voxel", args->voxel, &w->voxel, err);
    return st;
}

/* The report is an output, too: none is written when it is the input or the mesh. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const cli_solid_args *args = s->args;
    cw_status st =
        args->json ? cli_check_output(args->json, args->common.inputs, 1, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    st = parse_wishes(args, s->hollow, &s->wishes, err);
    if (st == CW_OK)
        st = cli_check_compress(&args->compress, false, err);
    if (st == CW_OK && !cw_level_set_available())
        st = cwi_fail(
            err, CW_ERR_UNSUPPORTED,
            "%s needs OpenVDB, which this build lacks: install libopenvdb-dev and build again",
            s->report.command);
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

static double length_mm(const run_state *s, const cli_length *length)
{
    return length->given ? cli_length_mm(length, s->pieces.diagonal_mm, 0) : 0;
}

static cw_status read_input(run_state *s, cw_error *err)
{
    wishes *w = &s->wishes;
    cli_report_begin(&s->report);
    cw_status st = cli_read_mesh(s->args->common.inputs[0], s->args->input.reader,
                                 &s->args->input, &s->mesh, err);
    if (st == CW_OK)
        st = cli_weld_pieces(&s->pieces, &s->mesh, err);
    if (st != CW_OK)
        return st;
    const cw_mesh *m = &s->pieces.piece->input;
    if (m->colors || m->scalars || m->labels)
        cli_say("%s: colours, scalars and labels are not kept", s->mesh.path);
    s->voxel_mm = length_mm(s, &w->voxel);
    s->by_mm = w->sign * length_mm(s, &w->by);
    s->wall_mm = length_mm(s, &s->args->wall);
    for (size_t n = 0; n < w->drain_count; n++)
        w->drains[n].diameter_mm = length_mm(s, &w->drain[n]);
    cli_report_end(&s->report, "read", 1, m->triangle_count);
    return CW_OK;
}

static void tell_hollow(run_state *s)
{
    const cw_hollow_facts *f = &s->facts;
    const int used =
        snprintf(s->found, sizeof s->found, "; %s cavit%s, %s sealed; %.6g mm3 removed",
                 cli_count(f->cavities), f->cavities == 1 ? "y" : "ies", cli_count(f->sealed),
                 f->removed_mm3);
    if (s->args->measure)
        snprintf(s->found + used, sizeof s->found - (size_t)used,
                 "; wall %.4g to %.4g mm thick", f->wall_min_mm, f->wall_max_mm);
}

static cw_status hollow_mesh(run_state *s, cw_error *err)
{
    cli_piece *p = s->pieces.piece;
    const cw_hollow_desc desc = {.wall_mm = s->wall_mm,
                                 .drains = s->wishes.drains,
                                 .drain_count = s->wishes.drain_count,
                                 .voxel_mm = s->voxel_mm,
                                 .no_measure = !s->args->measure,
                                 .threads = (int)s->args->input.threads,
                                 .max_bytes = cli_memory_limit(&s->args->input),
                                 .progress = cli_progress(1, "solid")};
    cw_status st = cw_mesh_hollow(&p->input, &desc, &p->out, &s->facts, err);
    if (st != CW_OK)
        return st;
    s->voxel_mm = s->facts.voxel_mm;
    if (!desc.drain_count)
        cli_say("%s: the outer surface stays as it is; the cavities have voxels of %.4g mm",
                s->mesh.path, s->voxel_mm);
    else
        cli_say("%s: rebuilt with voxels of %.4g mm", s->mesh.path, s->voxel_mm);
    if (s->facts.sealed)
        cli_say("%s: %s cavit%s sealed%s", s->mesh.path, cli_count(s->facts.sealed),
                s->facts.sealed == 1 ? "y is" : "ies are",
                desc.drain_count ? "" : ": print material stays inside (--drain 4mm@-z)");
    tell_hollow(s);
    return CW_OK;
}

static void tell_offset(const run_state *s)
{
    const cw_offset_facts *f = &s->offset;
    if (f->voxel_mm < f->asked_mm)
        cli_say(
            "%s: voxels of %.4g mm in place of %.4g mm, whose error would exceed half a voxel",
            s->mesh.path, f->voxel_mm, f->asked_mm);
    else if (f->least_mm > 0)
        cli_say(
            "%s: voxels of %.4g mm, and of %.4g mm where their error would exceed half a voxel",
            s->mesh.path, f->voxel_mm, f->least_mm);
    else
        cli_say("%s: voxels of %.4g mm", s->mesh.path, f->voxel_mm);
    if (f->more_components || f->more_handles)
        cli_say("%s: %s more components and %s more handles than the input: some parts are "
                "thinner than these voxels",
                s->mesh.path, cli_count(f->more_components), cli_count(f->more_handles));
}

static cw_status offset_mesh(run_state *s, cw_error *err)
{
    cli_piece *p = s->pieces.piece;
    const cw_offset_desc desc = {.offset_mm = s->by_mm,
                                 .voxel_mm = s->voxel_mm,
                                 .no_sharpen = !s->args->sharp,
                                 .no_refine = !s->args->refine,
                                 .threads = (int)s->args->input.threads,
                                 .max_bytes = cli_memory_limit(&s->args->input),
                                 .progress = cli_progress(1, "solid")};
    const cw_status st = cw_mesh_offset(&p->input, &desc, &p->out, &s->offset, err);
    if (st != CW_OK)
        return st;
    s->voxel_mm = s->offset.voxel_mm;
    tell_offset(s);
    return CW_OK;
}

/* How far the result's distance from the input is off: squares over the surface from the mean
 * and the mean of squares. */
static cw_status measure_offset(run_state *s, cw_error *err)
{
    const cli_piece *p = s->pieces.piece;
    const double by = fabs(s->by_mm);
    const cw_mesh_distance_desc desc = {.threads = (int)s->args->input.threads,
                                        .progress = cli_progress(1, "solid")};
    cw_distance d;
    float *each = cwi_alloc_array(p->out.vertex_count, sizeof *each);
    cw_status st = each ? cw_distance_to_mesh(&p->out, &p->input, &desc, &d, each, err)
                        : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for distances");
    if (st == CW_OK) {
        double least = d.max_mm;
        for (size_t n = 0; n < p->out.vertex_count; n++)
            least = fmin(least, (double)each[n]);
        s->off_max_mm = fmax(d.max_mm - by, by - least);
        s->off_rms_mm = sqrt(fmax(d.rms_mm * d.rms_mm - 2 * by * d.mean_mm + by * by, 0));
        snprintf(s->found, sizeof s->found,
                 "; %.6g mm from the input, deviating by at most %.3g mm, RMS %.3g mm", by,
                 s->off_max_mm, s->off_rms_mm);
    }
    cwi_free(each);
    return st;
}

static cw_status measure_result(run_state *s, cli_made *made, cw_error *err)
{
    if (s->hollow || !s->args->measure)
        return CW_OK;
    cli_report_begin(&s->report);
    cw_status st = s->by_mm != 0 ? measure_offset(s, err)
                                 : cli_compare_pieces(&s->pieces, (int)s->args->input.threads,
                                                      &made->compared, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "measure", s->pieces.triangles,
                       s->pieces.piece->out.triangle_count);
    return st;
}

/* Checks that the result is closed and oriented. Parts that were not moved may touch themselves
 * in a vertex, or have triangles without area. */
static cw_status hold_bound(const run_state *s, cw_error *err)
{
    const cw_quality_desc desc = {.threads = (int)s->args->input.threads};
    cw_quality q;
    cw_status st = cw_quality_measure(&s->pieces.piece->out, &desc, &q, err);
    if (st == CW_OK && (q.open_edges || q.nonmanifold_edges || q.misoriented_edges))
        st = cwi_fail(err, CW_ERR_CHECK,
                      "the result is not as promised: %zu open, %zu non-manifold, %zu "
                      "misoriented edges; nothing is written",
                      q.open_edges, q.nonmanifold_edges, q.misoriented_edges);
    return st;
}

static cw_status deliver_mesh(run_state *s, cw_error *err)
{
    const cli_delivery how = {
        .input = s->mesh.path,
        .write = cli_written_desc(&s->args->written, &s->args->compress, &s->mesh),
        .compress = &s->args->compress,
        .threads = (int)s->args->input.threads,
        .unpromised = true,
        .found = s->found,
        .tell_dropped = true};
    const cw_part part = {.mesh = &s->pieces.piece->out, .name = s->pieces.piece->name};
    return cli_deliver(&s->report, &how, &part, 1, 0, s->start, err);
}

/* It is written all the same: details thinner than voxels may not matter. */
static cw_status hold_to_input(const run_state *s, cw_error *err)
{
    if (!s->offset.is_astray)
        return CW_OK;
    return cwi_fail(err, CW_ERR_CHECK,
                    "%s: written, but not within half a voxel of %.4g mm of the input both "
                    "ways: some parts are too thin; smaller voxels help",
                    s->mesh.path, s->offset.asked_mm);
}

static cw_status make_mesh(run_state *s, cli_made *made, cw_error *err)
{
    cli_report_begin(&s->report);
    cw_status st = s->hollow ? hollow_mesh(s, err) : offset_mesh(s, err);
    if (st == CW_OK) {
        cli_report_end(&s->report, s->report.command, s->pieces.triangles,
                       s->pieces.piece->out.triangle_count);
        st = hold_bound(s, err);
    }
    if (st == CW_OK)
        st = measure_result(s, made, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->mesh.path);
    st = deliver_mesh(s, err);
    return st == CW_OK ? hold_to_input(s, err) : st;
}

static cw_status offset_or_hollow(void *state, cw_error *err)
{
    run_state *s = state;
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = read_input(s, err);
    if (st != CW_OK)
        return st;
    cli_made *made = cli_report_next(&s->report, s->outputs.path[0], 0);
    st = make_mesh(s, made, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status run_solid(const cli_solid_args *args, const char *command, cw_error *err)
{
    run_state s = {
        .args = args, .hollow = strcmp(command, "hollow") == 0, .start = cli_seconds()};
    s.report.command = command;
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = offset_or_hollow,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.report, err);
    cli_free_pieces(&s.pieces);
    cli_free_mesh(&s.mesh);
    cli_free_outputs(&s.outputs);
    return st;
}

cw_status cli_run_hollow(void *args, cw_error *err)
{
    return run_solid(args, "hollow", err);
}

cw_status cli_run_offset(void *args, cw_error *err)
{
    return run_solid(args, "offset", err);
}
