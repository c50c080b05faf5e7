/* Moves the surface of a solid or turns the solid into a shell, for the commands offset and
 * hollow: arguments, work, measurements and report. */
#include "cli/commands/offset_hollow.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
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

typedef struct solid_state {
    wishes wishes;
    cw_hollow_facts facts;
    double voxel_mm, by_mm, wall_mm;
    double off_max_mm, off_rms_mm; /* of an offset */
    cw_offset_facts offset;
} solid_state;

static const cli_solid_args *args_of(const cli_mesh_run *r)
{
    return (const cli_solid_args *)r->args;
}

const cli_solid_args cli_solid_defaults = {.mesh.measure = true, .sharp = true, .refine = true};

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

static void put_voxel(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const solid_state *s = r->state;
    cli_json_number(j, "voxel_mm", s->voxel_mm);
    if (s->offset.asked_mm > 0) /* only offset takes others */
        cli_json_number(j, "voxel_asked_mm", s->offset.asked_mm);
    cli_json_count(j, "merged_vertices", r->pieces.merged);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_hollow_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const solid_state *s = r->state;
    cli_json_number(j, "wall_mm", s->wall_mm);
    put_drains(j, &s->wishes);
    put_voxel(j, r, made);
}

static void put_offset_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const solid_state *s = r->state;
    cli_json_number(j, "by_mm", s->by_mm);
    put_voxel(j, r, made);
}

static void put_hollow(cli_json *j, const cli_mesh_run *r)
{
    const cw_hollow_facts *f = &((const solid_state *)r->state)->facts;
    if (!f->cavities)
        return;
    cli_json_open(j, "hollow", '{');
    cli_json_count(j, "cavities", f->cavities);
    cli_json_count(j, "sealed", f->sealed);
    cli_json_number(j, "removed_mm3", f->removed_mm3);
    if (r->args->measure) {
        cli_json_number(j, "wall_min_mm", f->wall_min_mm);
        cli_json_number(j, "wall_max_mm", f->wall_max_mm);
    }
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

static void put_offset(cli_json *j, const cli_mesh_run *r)
{
    const solid_state *s = r->state;
    if (s->off_max_mm > 0) {
        cli_json_open(j, "off", '{');
        cli_json_number(j, "max_mm", s->off_max_mm);
        cli_json_number(j, "rms_mm", s->off_rms_mm);
        cli_json_close(j, '}');
    }
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
        return cwi_fail_memory(err);
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

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const cli_solid_args *args = args_of(r);
    wishes *w = &((solid_state *)r->state)->wishes;
    cw_status st = CW_OK;
    r->reads_parts = false;
    if (args->wall.unit == CLI_VOXELS)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--wall: a mesh has no voxels; give mm, or %% of its box's diagonal");
    if (args->drain)
        st = parse_drains(args->drain, w, err);
    if (st == CW_OK && args->by)
        st = parse_by(args->by, w, err);
    if (st == CW_OK && args->voxel && strcmp(args->voxel, "auto") != 0)
        st = parse_length("--voxel", args->voxel, &w->voxel, err);
    if (st == CW_OK && !cw_level_set_available())
        st = cwi_fail(
            err, CW_ERR_UNSUPPORTED,
            "%s needs OpenVDB, which this build lacks: install libopenvdb-dev and build again",
            r->command->name);
    return st;
}

/* --- work --------------------------------------------------------------------------------- */

static double length_mm(const cli_mesh_run *r, const cli_length *length)
{
    return length->given ? cli_length_mm(length, r->pieces.diagonal_mm, 0) : 0;
}

static cw_status resolve_lengths(cli_mesh_run *r, cw_error *err)
{
    solid_state *s = r->state;
    wishes *w = &s->wishes;
    const cw_mesh *m = &r->pieces.piece->input;
    (void)err;
    if (m->colors || m->scalars || m->labels)
        cli_say("%s: colours, scalars and labels are not kept", r->mesh.path);
    s->voxel_mm = length_mm(r, &w->voxel);
    s->by_mm = w->sign * length_mm(r, &w->by);
    s->wall_mm = length_mm(r, &args_of(r)->wall);
    for (size_t n = 0; n < w->drain_count; n++)
        w->drains[n].diameter_mm = length_mm(r, &w->drain[n]);
    return CW_OK;
}

static cw_status hollow_mesh(cli_mesh_run *r, cw_error *err)
{
    solid_state *s = r->state;
    cli_piece *p = r->pieces.piece;
    const cw_hollow_desc desc = {.wall_mm = s->wall_mm,
                                 .drains = s->wishes.drains,
                                 .drain_count = s->wishes.drain_count,
                                 .voxel_mm = s->voxel_mm,
                                 .no_measure = !r->args->measure,
                                 .threads = r->threads,
                                 .max_bytes = cli_memory_limit(&r->args->input),
                                 .progress = cli_progress(1, "solid")};
    cw_status st = cw_mesh_hollow(&p->input, &desc, &p->out, &s->facts, err);
    s->voxel_mm = st == CW_OK ? s->facts.voxel_mm : s->voxel_mm;
    return st;
}

static cw_status report_hollow(cli_mesh_run *r, cw_error *err)
{
    const solid_state *s = r->state;
    const cw_hollow_facts *f = &s->facts;
    const char *path = r->mesh.path;
    const bool drains = s->wishes.drain_count > 0;
    (void)err;
    if (!drains)
        cli_say("%s: the outer surface stays as it is; the cavities have voxels of %.4g mm",
                path, s->voxel_mm);
    else
        cli_say("%s: rebuilt with voxels of %.4g mm", path, s->voxel_mm);
    if (f->sealed)
        cli_say("%s: %s cavit%s sealed%s", path, cli_count(f->sealed),
                f->sealed == 1 ? "y is" : "ies are",
                drains ? "" : ": print material stays inside (--drain 4mm@-z)");
    const int used =
        snprintf(r->found, sizeof r->found, "; %s cavit%s, %s sealed; %.6g mm3 removed",
                 cli_count(f->cavities), f->cavities == 1 ? "y" : "ies", cli_count(f->sealed),
                 f->removed_mm3);
    if (r->args->measure)
        snprintf(r->found + used, sizeof r->found - (size_t)used,
                 "; wall %.4g to %.4g mm thick", f->wall_min_mm, f->wall_max_mm);
    return CW_OK;
}

static cw_status report_offset(cli_mesh_run *r, cw_error *err)
{
    const cw_offset_facts *f = &((const solid_state *)r->state)->offset;
    (void)err;
    if (f->voxel_mm < f->asked_mm)
        cli_say(
            "%s: voxels of %.4g mm in place of %.4g mm, whose error would exceed half a voxel",
            r->mesh.path, f->voxel_mm, f->asked_mm);
    else if (f->least_mm > 0)
        cli_say(
            "%s: voxels of %.4g mm, and of %.4g mm where their error would exceed half a voxel",
            r->mesh.path, f->voxel_mm, f->least_mm);
    else
        cli_say("%s: voxels of %.4g mm", r->mesh.path, f->voxel_mm);
    if (f->more_components || f->more_handles)
        cli_say("%s: %s more components and %s more handles than the input: some parts are "
                "thinner than these voxels",
                r->mesh.path, cli_count(f->more_components), cli_count(f->more_handles));
    return CW_OK;
}

static cw_status offset_mesh(cli_mesh_run *r, cw_error *err)
{
    solid_state *s = r->state;
    cli_piece *p = r->pieces.piece;
    const cw_offset_desc desc = {.offset_mm = s->by_mm,
                                 .voxel_mm = s->voxel_mm,
                                 .no_sharpen = !args_of(r)->sharp,
                                 .no_refine = !args_of(r)->refine,
                                 .threads = r->threads,
                                 .max_bytes = cli_memory_limit(&r->args->input),
                                 .progress = cli_progress(1, "solid")};
    const cw_status st = cw_mesh_offset(&p->input, &desc, &p->out, &s->offset, err);
    s->voxel_mm = st == CW_OK ? s->offset.voxel_mm : s->voxel_mm;
    return st;
}

/* How far the result's distance from the input is off: squares over the surface from the mean
 * and the mean of squares. */
static cw_status measure_distance(cli_mesh_run *r, cw_error *err)
{
    solid_state *s = r->state;
    const cli_piece *p = r->pieces.piece;
    const double by = fabs(s->by_mm);
    const cw_mesh_distance_desc desc = {.threads = r->threads,
                                        .progress = cli_progress(1, "solid")};
    cw_distance d;
    float *each = cwi_alloc_array(p->out.vertex_count, sizeof *each);
    cw_status st = each ? cw_distance_to_mesh(&p->out, &p->input, &desc, &d, each, err)
                        : cwi_fail_memory(err);
    if (st == CW_OK) {
        double min_mm = d.max_mm;
        for (size_t n = 0; n < p->out.vertex_count; n++)
            min_mm = fmin(min_mm, (double)each[n]);
        s->off_max_mm = fmax(d.max_mm - by, by - min_mm);
        s->off_rms_mm = sqrt(fmax(d.rms_mm * d.rms_mm - 2 * by * d.mean_mm + by * by, 0));
        snprintf(r->found, sizeof r->found,
                 "; %.6g mm from the input, deviating by at most %.3g mm, RMS %.3g mm", by,
                 s->off_max_mm, s->off_rms_mm);
    }
    cwi_free(each);
    return st;
}

/* Checks that the result is closed and oriented. Parts that were not moved may touch themselves
 * in a vertex, or have triangles without area. */
static cw_status hold_bound(const cli_mesh_run *r, cw_error *err)
{
    const cw_quality_desc desc = {.threads = r->threads};
    cw_quality q;
    cw_status st = cw_quality_measure(&r->pieces.piece->out, &desc, &q, err);
    if (st == CW_OK && (q.open_edges || q.nonmanifold_edges || q.misoriented_edges))
        st = cwi_fail(err, CW_ERR_CHECK,
                      "the result is not as promised: %zu open, %zu non-manifold, %zu "
                      "misoriented edges; nothing is written",
                      q.open_edges, q.nonmanifold_edges, q.misoriented_edges);
    return st;
}

static cw_status measure_hollow(cli_mesh_run *r, cli_made *made, cw_error *err)
{
    (void)made; /* the work has measured the wall */
    const cw_status st = hold_bound(r, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, r->mesh.path);
}

static cw_status measure_offset(cli_mesh_run *r, cli_made *made, cw_error *err)
{
    const solid_state *s = r->state;
    cw_status st = hold_bound(r, err);
    if (st == CW_OK && r->args->measure) {
        cli_report_begin(&r->report);
        st = s->by_mm != 0 ? measure_distance(r, err)
                           : cli_compare_pieces(&r->pieces, r->threads, &made->compared, err);
        cli_report_end(&r->report, "measure", r->pieces.triangles, cli_made_triangles(r));
    }
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, r->mesh.path);
}

/* Judges an offset by its distance. It is written all the same: details thinner than voxels may not
 * matter. */
static cw_status judge_offset(cli_mesh_run *r, cw_error *err)
{
    const solid_state *s = r->state;
    if (!s->offset.is_astray)
        return CW_OK;
    return cwi_fail(err, CW_ERR_CHECK,
                    "%s: written, but not within half a voxel of %.4g mm of the input both "
                    "ways: some parts are too thin; smaller voxels help",
                    r->mesh.path, s->offset.asked_mm);
}

cw_status cli_run_hollow(void *args, cw_error *err)
{
    static const cli_mesh_command hollow = {
        .name = "hollow",
        .check = check_values,
        .resolve = resolve_lengths,
        .work = hollow_mesh,
        .report = report_hollow,
        .measure = measure_hollow,
        .put_params = put_hollow_params,
        .put_facts = put_hollow,
    };
    solid_state state = {0};
    return cli_run_mesh_command(&hollow, args, &state, 1, err);
}

cw_status cli_run_offset(void *args, cw_error *err)
{
    static const cli_mesh_command offset = {
        .name = "offset",
        .check = check_values,
        .resolve = resolve_lengths,
        .work = offset_mesh,
        .report = report_offset,
        .measure = measure_offset,
        .judge = judge_offset,
        .put_params = put_offset_params,
        .put_facts = put_offset,
    };
    solid_state state = {0};
    return cli_run_mesh_command(&offset, args, &state, 1, err);
}
