/* Moves the surface of a solid or turns the solid into a shell, for the commands offset and
 * hollow: arguments, work, measurements and report. */
#define _GNU_SOURCE /* asprintf */
#include "cli/commands/offset_hollow.h"
#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <cubewright/boolean.h>
#include <cubewright/level_set.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct solid_state {
    cw_drain drains[CLI_MAX_DRAINS]; /* as many as were asked for */
    cw_hollow_facts facts;
    double voxel_mm, by_mm, wall_mm;
    double off_max_mm, off_rms_mm; /* of an offset */
    cw_offset_facts offset;
    cli_lattice lattice;
    cw_mesh united; /* the input of hollow, where its triangles intersected */
} solid_state;

static const cli_solid_args *args_of(const cli_mesh_run *r)
{
    return (const cli_solid_args *)r->args;
}

const cli_solid_args cli_solid_defaults = {.mesh.measure = true, .sharp = true, .refine = true};

/* --- the report --------------------------------------------------------------------------- */

static void put_drains(cli_json *j, const cw_drain *drains, size_t count)
{
    cli_json_open(j, "drains", '[');
    for (size_t n = 0; n < count; n++) {
        cli_json_open(j, NULL, '{');
        cli_json_number(j, "diameter_mm", drains[n].diameter_mm);
        cli_json_numbers(j, "direction", drains[n].direction, 3);
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
    put_drains(j, s->drains, args_of(r)->drain.count);
    cli_json_lattice(j, &s->lattice, r->args->source);
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
    cli_json_count(j, "filled", f->filled);
    cli_json_number(j, "filled_mm3", f->filled_mm3);
    cli_json_number(j, "removed_mm3", f->removed_mm3);
    if (r->args->measure) {
        cli_json_number(j, "wall_min_mm", f->wall_min_mm);
        cli_json_number(j, "wall_max_mm", f->wall_max_mm);
    }
    if (args_of(r)->infill.given)
        cli_json_lattice_facts(j, f, r->args->measure);
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

/* "4mm@-z" */
static bool parse_drain(char *text, cli_length *wide, double direction[3])
{
    char *at = strchr(text, '@');
    if (!at)
        return false;
    const char *axis = at + 1 + (at[1] == '+' || at[1] == '-');
    *at = '\0';
    if (*axis < 'x' || *axis > 'z' || axis[1])
        return false;
    direction[*axis - 'x'] = at[1] == '-' ? -1 : 1;
    return cli_parse_length(text, CLI_IN_MM | CLI_IN_PERCENT, wide);
}

static bool parse_drains(const cli_option *o, const char *text, void *field)
{
    cli_drains *out = field;
    char item[CWI_ITEM_BYTES];
    (void)o;
    *out = (cli_drains){0};
    for (;; text++) {
        const size_t length = strcspn(text, ","), n = out->count++;
        if (n == CLI_MAX_DRAINS || length >= sizeof item)
            return false;
        memcpy(item, text, length);
        item[length] = '\0';
        if (!parse_drain(item, &out->wide[n], out->direction[n]))
            return false;
        text += length;
        if (!*text)
            return true;
    }
}

const cli_kind cli_kind_drains = {
    .size = sizeof(cli_drains),
    .parse = parse_drains,
    .expected = "diameters and directions (+x to -z) of up to 16 holes, such as 4mm@-z or "
                "4mm@-z,3mm@+x",
    .unit_rule = CLI_UNITS_MM " or % of the box's diagonal",
};

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    bool is_file;
    r->reads_parts = false;
    const cw_status st = cli_check_infill_by(r->args->source, &is_file, err);
    if (st != CW_OK)
        return st;
    if (cw_level_set_available())
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_UNSUPPORTED,
        "%s needs OpenVDB, which this build lacks: install libopenvdb-dev and build again",
        r->command->name);
}

/* --- work --------------------------------------------------------------------------------- */

static double length_mm(const cli_mesh_run *r, const cli_length *length)
{
    return length->given ? cli_length_mm(length, r->pieces.diagonal_mm, 0) : 0;
}

static cw_status resolve_lengths(cli_mesh_run *r, cw_error *err)
{
    solid_state *s = r->state;
    const cli_solid_args *args = args_of(r);
    const cw_mesh *m = &r->pieces.piece->input;
    if (m->colors || m->scalars || m->labels)
        cli_say("%s: colours, scalars and labels are not kept", r->mesh.path);
    s->voxel_mm = length_mm(r, &args->voxel);
    s->by_mm = length_mm(r, &args->by);
    s->wall_mm = length_mm(r, &args->wall);
    for (size_t n = 0; n < args->drain.count; n++) {
        s->drains[n].diameter_mm = length_mm(r, &args->drain.wide[n]);
        memcpy(s->drains[n].direction, args->drain.direction[n], sizeof s->drains[n].direction);
    }
    return cli_open_lattice(&args->infill, r->args->source, &r->args->input,
                            r->pieces.diagonal_mm, &s->lattice, err);
}

/* Writes "cubewright COMMAND in.stl -o in-made.stl", to be typed; NULL without memory. */
static char *make_command(const char *path, const char *command, const char *made)
{
    size_t size;
    char *text = NULL, *name = NULL, *stem = cli_stem(path);
    const cw_format *f = cw_mesh_format(path, NULL);
    const bool is_writable = f && f->writes_mesh && f->in_this_build;
    FILE *out = stem ? cwi_text_open(&text, &size) : NULL;
    if (out &&
        asprintf(&name, "%s-%s%s", stem, made, is_writable ? strrchr(path, '.') : ".ply") > 0) {
        fprintf(out, "cubewright %s ", command);
        cli_put_word(out, path);
        fputs(" -o ", out);
        cli_put_word(out, name);
    }
    free(stem);
    free(name);
    return cwi_text_close(out, &text) ? text : NULL;
}

/* Adds the command that turns the input into a solid. */
static cw_status name_way(const cli_mesh_run *r, cw_status st, cw_error *err)
{
    const cw_mesh *m = &r->pieces.piece->input;
    const cw_quality_desc desc = {.threads = r->threads};
    const cw_error why = *err;
    cw_quality q;
    if (st != CW_ERR_ARGUMENT || cw_quality_measure(m, &desc, &q, NULL) != CW_OK)
        return st;
    const bool is_broken =
        q.open_edges || q.nonmanifold_edges > q.contact_edges || q.misoriented_edges;
    if (!q.triangles || (!is_broken && !(q.volume_mm3 < 0)))
        return st;
    char *command = is_broken ? make_command(r->mesh.path, "repair", "repaired")
                              : make_command(r->mesh.path, "convert --orient", "oriented");
    if (command)
        cwi_fail(err, st, "%s: %s", why.message, command);
    free(command);
    return st;
}

/* Unites what crosses in the input: the surface of the union stays as the outer one. */
static cw_status unite_input(cli_mesh_run *r, cw_error *err)
{
    solid_state *s = r->state;
    const cli_piece *p = r->pieces.piece;
    const cw_mesh *const meshes[] = {&p->input};
    const cw_crossings_desc desc = {.weld = CW_WELD_LOCAL, .threads = r->threads};
    const cw_boolean_desc unite = {.threads = r->threads};
    cw_boolean_facts facts = {0};
    cw_crossings found = {0};
    cw_status st = cw_self_intersections(&p->input, &desc, &found, err);
    const size_t count = found.count;
    cw_crossings_free(&found);
    if (st != CW_OK || !count)
        return st;
    st = cw_mesh_boolean(meshes, 1, &unite, &s->united, &facts, err);
    if (st == CW_OK && (facts.negative_regions || facts.turned || !s->united.triangle_count))
        st = cwi_fail(err, CW_ERR_CHECK,
                      "shells that intersect are inside out: 'repair' makes one solid of them");
    if (st == CW_OK)
        cli_say("%s: %s pair%s of triangles intersect: the shells are united first",
                r->mesh.path, cli_count(count), count == 1 ? "" : "s");
    return st;
}

static cw_status hollow_mesh(cli_mesh_run *r, cw_error *err)
{
    cw_status st = unite_input(r, err);
    if (st != CW_OK)
        return st;
    solid_state *s = r->state;
    cli_piece *p = r->pieces.piece;
    const cw_hollow_desc desc = {.wall_mm = s->wall_mm,
                                 .drains = s->drains,
                                 .drain_count = args_of(r)->drain.count,
                                 .voxel_mm = s->voxel_mm,
                                 .no_measure = !r->args->measure,
                                 .threads = r->threads,
                                 .max_bytes = cli_memory_limit(&r->args->input),
                                 .progress = cli_progress(1, "solid"),
                                 .infill = args_of(r)->infill.given ? &s->lattice.desc : NULL};
    st = cw_mesh_hollow(s->united.triangle_count ? &s->united : &p->input, &desc, &p->out,
                        &s->facts, err);
    s->voxel_mm = st == CW_OK ? s->facts.voxel_mm : s->voxel_mm;
    return name_way(r, st, err);
}

static cw_status report_hollow(cli_mesh_run *r, cw_error *err)
{
    const solid_state *s = r->state;
    const cw_hollow_facts *f = &s->facts;
    const char *path = r->mesh.path;
    const bool drains = args_of(r)->drain.count > 0;
    const double wide = fmin(4, r->pieces.diagonal_mm / 10); /* fits small solids, too */
    const bool has_lattice = args_of(r)->infill.given;
    char way[80] = "", lattice[160] = "";
    (void)err;
    if (has_lattice)
        cli_describe_lattice(&s->lattice.desc, f, lattice, sizeof lattice);
    if (!drains)
        snprintf(way, sizeof way, ": print material stays inside (--drain %.2gmm@-z)", wide);
    cli_say("%s: the outer surface stays as it is%s; the cavities have voxels of %.4g mm", path,
            drains ? " around the drains" : "", s->voxel_mm);
    if (f->sealed)
        cli_say("%s: %s cavit%s sealed%s", path, cli_count(f->sealed),
                f->sealed == 1 ? "y is" : "ies are", way);
    int used =
        snprintf(r->found, sizeof r->found, "; %s cavit%s, %s sealed", cli_count(f->cavities),
                 f->cavities == 1 ? "y" : "ies", cli_count(f->sealed));
    if (f->filled)
        used += snprintf(r->found + used, sizeof r->found - (size_t)used, ", %s %s (%.3g mm3)",
                         cli_count(f->filled),
                         has_lattice && drains ? "too small or without a drain left filled"
                                               : "too small left filled",
                         f->filled_mm3);
    if (has_lattice && drains)
        cli_say("%s: %s drain%s so that each channel of the lattice has one", path,
                cli_count(f->drains), f->drains == 1 ? "" : "s");
    if (f->loose)
        cli_say("%s: %s piece%s of the lattice that the drains cut loose %s left out", path,
                cli_count(f->loose), f->loose == 1 ? "" : "s", f->loose == 1 ? "is" : "are");
    used += snprintf(r->found + used, sizeof r->found - (size_t)used, "; %.6g mm3 removed",
                     f->removed_mm3);
    if (r->args->measure)
        snprintf(r->found + used, sizeof r->found - (size_t)used,
                 "; wall %.4g to %.4g mm thick%s", f->wall_min_mm, f->wall_max_mm, lattice);
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
    return name_way(r, st, err);
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
 * in edges and vertices, or have triangles without area. */
static cw_status hold_bound(const cli_mesh_run *r, cw_error *err)
{
    const cw_quality_desc desc = {.threads = r->threads};
    cw_quality q;
    cw_status st = cw_quality_measure(&r->pieces.piece->out, &desc, &q, err);
    const size_t nonmanifold = q.nonmanifold_edges - q.contact_edges;
    if (st == CW_OK && (q.open_edges || nonmanifold || q.misoriented_edges))
        st = cwi_fail(err, CW_ERR_CHECK,
                      "the result is not as promised: %zu open, %zu non-manifold, %zu "
                      "misoriented edges; nothing is written",
                      q.open_edges, nonmanifold, q.misoriented_edges);
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
    const cw_status st = cli_run_mesh_command(&hollow, args, &state, 1, err);
    cw_mesh_free(&state.united);
    cli_free_lattice(&state.lattice);
    return st;
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
