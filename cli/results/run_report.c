/* Collects the meshes, steps and warnings of a run, and writes them as the JSON report. */
#define _GNU_SOURCE /* reallocarray */
#include "cli/results/run_report.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/run_config.h"
#include "cli/framework/standard_streams.h"
#include "cli/results/check_verdicts.h"
#include "cli/results/compress_options.h"
#include "cli/results/stage_facts.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/atomic_file.h"

#include <cubewright/level_set.h>
#include <cubewright/simplify.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct cli_kept cli_kept[] = {
    {CW_KEEPS_PARTS, "parts"},
    {CW_KEEPS_SHARING, "shared vertices"},
    {CW_KEEPS_NORMALS, "normals"},
    {CW_KEEPS_COLORS, "colours"},
    {CW_KEEPS_SCALARS, "scalars"},
    {CW_KEEPS_LABELS, "labels"},
    {CW_KEEPS_AFFINE, "affine"},
    {CW_KEEPS_FACE_COLORS, "face colours"},
    {CW_KEEPS_OPACITY, "opacity"},
    {CW_KEEPS_TEXTURE, "texture coordinates"},
    {CW_KEEPS_PICTURES, "pictures"},
    {CW_KEEPS_MATERIALS, "metallic-roughness and occlusion pictures"},
    {CW_KEEPS_CREASES, "normals parted at creases"},
    {CW_KEEPS_ATTRIBUTES, "attributes"},
};
const size_t cli_kept_count = sizeof cli_kept / sizeof *cli_kept;

cw_status cli_report_reserve(cli_report *report, size_t meshes, cw_error *err)
{
    const size_t steps = (meshes + 1) * CLI_STEPS_PER_MESH;
    cli_made *made = reallocarray(report->made, meshes, sizeof *made);
    report->made = made ? made : report->made;
    cli_step *step = reallocarray(report->steps, steps, sizeof *step);
    report->steps = step ? step : report->steps;
    if (!made || !step)
        return cwi_fail_memory(err);
    report->step_room = steps;
    return CW_OK;
}

cli_made *cli_report_next(cli_report *report, const char *path, double iso)
{
    cli_made *made = &report->made[report->made_count++];
    *made = (cli_made){.path = path, .iso = iso};
    return made;
}

void cli_report_begin(cli_report *report)
{
    report->step_start = cli_seconds();
}

void cli_report_end(cli_report *report, const char *name, size_t in, size_t out)
{
    const cli_step s = {.name = name,
                        .made = report->made_count - 1,
                        .seconds = cli_seconds() - report->step_start,
                        .peak_bytes = cli_peak_bytes(),
                        .in = in,
                        .out = out};
    if (report->step_count < report->step_room)
        report->steps[report->step_count++] = s;
    cli_say_step(s.name, s.seconds);
}

void cli_report_read(cli_report *report, const cli_volume *volume)
{
    const cw_volume *v = &volume->view;
    const size_t voxels = v->dim[0] * v->dim[1] * v->dim[2];
    for (int n = 0; n < volume->change_count; n++)
        report->step_start += volume->changes[n].seconds;
    cli_report_end(report, "read", 1, voxels);
    for (int n = 0; n < volume->change_count; n++) {
        report->step_start = cli_seconds() - volume->changes[n].seconds;
        cli_report_end(report, volume->changes[n].name, voxels, voxels);
    }
}

static void put_features(cli_json *j)
{
    size_t count;
    const cw_format *formats = cw_formats(&count);
    cli_json_open(j, "features", '[');
    if (cw_quality_has_cgal())
        cli_json_text(j, NULL, "cgal");
    if (cw_simplify_available())
        cli_json_text(j, NULL, "simplify");
    if (cw_level_set_available())
        cli_json_text(j, NULL, "level-set");
    for (size_t i = 0; i < count; i++)
        if (formats[i].in_this_build)
            cli_json_text(j, NULL, formats[i].name);
    cli_json_close(j, ']');
}

static void put_steps(cli_json *j, const cli_report *r)
{
    const char *main_step = r->main_step ? r->main_step : r->command;
    cli_json_open(j, "steps", '[');
    for (size_t i = 0; i < r->step_count; i++) {
        const cli_step *s = &r->steps[i];
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "name", s->name);
        if (strcmp(s->name, main_step) == 0) {
            cli_json_open(j, "params", '{');
            r->params(j, r->args, &r->made[s->made]);
            cli_json_close(j, '}');
        }
        cli_json_number(j, "seconds", rint(s->seconds * 1e6) / 1e6);
        cli_json_count(j, "peak_bytes", s->peak_bytes);
        cli_json_count(j, "in", s->in);
        cli_json_count(j, "out", s->out);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_mesh(cli_json *j, const cli_made *made)
{
    const cw_quality *q = &made->quality;
    const double box[6] = {q->min[0], q->min[1], q->min[2], q->max[0], q->max[1], q->max[2]};
    cli_json_open(j, "mesh", '{');
    cli_json_count(j, "vertices", q->vertices);
    cli_json_count(j, "triangles", q->triangles);
    cli_json_count(j, "components", q->components);
    cli_json_int(j, "euler", q->euler);
    cli_json_count(j, "open_edges", q->open_edges);
    cli_json_count(j, "nonmanifold_edges", q->nonmanifold_edges);
    cli_json_count(j, "contact_edges", q->contact_edges);
    cli_json_count(j, "nonmanifold_vertices", q->nonmanifold_vertices);
    cli_json_count(j, "contact_vertices", q->contact_vertices);
    cli_json_count(j, "misoriented_edges", q->misoriented_edges);
    cli_json_count(j, "border_loops", q->border_loops);
    cli_json_int(j, "genus", q->genus);
    if (made->shells) {
        cli_json_count(j, "cavities", q->cavities);
        cli_json_count(j, "inside_out", q->inside_out);
        cli_json_count(j, "nested", q->nested);
        cli_json_count(j, "one_sided", q->one_sided);
        cli_json_count(j, "facing_wrong", q->to_turn);
    }
    if (made->crossings)
        cli_json_count(j, "self_intersections", made->crossings->count);
    cli_json_count(j, "degenerate", q->degenerate);
    cli_json_count(j, "duplicates", q->duplicates);
    cli_json_count(j, "needles", q->needles);
    cli_json_count(j, "caps", q->caps);
    cli_json_numbers(j, "box", box, 6);
    cli_json_number(j, "area", q->area_mm2);
    cli_json_number(j, "volume", q->volume_mm3);
    cli_json_text(j, "unit", "mm");
    cli_json_close(j, '}');
}

static void put_snap(cli_json *j, const cw_snap_counts *c)
{
    cli_json_open(j, "snap", '{');
    cli_json_count(j, "vertices", c->vertices);
    cli_json_number(j, "max_error", c->max_error_mm);
    cli_json_number(j, "mean_error", c->mean_error_mm);
    cli_json_number(j, "max_moved", c->max_moved_mm);
    cli_json_text(j, "unit", "mm");
    cli_json_number(j, "max_error_voxels", c->max_error_voxels);
    cli_json_number(j, "mean_error_voxels", c->mean_error_voxels);
    cli_json_number(j, "max_moved_voxels", c->max_moved_voxels);
    cli_json_close(j, '}');
}

static void put_comparison(cli_json *j, const cli_comparison *c)
{
    cli_json_errors(
        j, &(cw_findings){.to_field = c->has_field ? &c->to_field : NULL,
                          .to_reference = c->made ? &c->with_input.to_reference : NULL,
                          .from_reference = c->made ? &c->with_input.from_reference : NULL});
}

static void put_texture(cli_json *j, const cw_texture_distance *d)
{
    cli_json_open(j, "texture", '{');
    cli_json_number(j, "max_moved", d->max_mm);
    cli_json_number(j, "mean_moved", d->mean_mm);
    cli_json_number(j, "side", d->side_mm);
    cli_json_count(j, "samples", d->samples);
    cli_json_text(j, "unit", "mm");
    cli_json_close(j, '}');
}

static void put_views(cli_json *j, const cli_proof *p)
{
    cli_json_open(j, "views", '[');
    for (size_t n = 0; n < p->count; n++) {
        cli_json_open(j, NULL, '{');
        cli_json_number(j, "max_pixels", p->views[n].pixels);
        cli_json_number(j, "share_beyond_2_of_255", p->views[n].apart);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

/* Writes the promise about the pictures of cameras, what was measured, and what it saved.
 * full_to_field  how far the full mesh is from the field; NULL: not measured */
static void put_proof(cli_json *j, const cli_proof *p, const cw_distance *full_to_field)
{
    cli_json_open(j, "proof", '{');
    cli_json_text(j, "against", "full mesh");
    if (p->count)
        cli_json_number(j, "promised_pixels", p->promised_pixels);
    cli_json_number(j, "promised_mm", p->promised_mm);
    cli_json_number(j, "max_mm", p->mm);
    if (full_to_field)
        cli_json_number(j, "full_max_from_field_mm", full_to_field->max_mm);
    if (p->count)
        put_views(j, p);
    if (p->voxels) {
        cli_json_count(j, "culled_triangles", p->culled);
        cli_json_count(j, "voxels", p->voxels);
        cli_json_count(j, "seen_voxels", p->seen_voxels);
    }
    cli_json_count(j, "full_triangles", p->full_triangles);
    cli_json_number(j, "full_seconds", p->full_seconds);
    cli_json_count(j, "full_bytes", p->full_bytes);
    cli_json_count(j, "slab_bytes", p->bytes);
    cli_json_close(j, '}');
}

static void put_crop(cli_json *j, const cli_crop_proof *p)
{
    cli_json_open(j, "crop", '{');
    cli_json_text(j, "against", "whole volume");
    cli_json_count(j, "voxels", p->voxels);
    cli_json_count(j, "whole_voxels", p->whole_voxels);
    cli_json_count(j, "triangles", p->triangles);
    cli_json_count(j, "whole_triangles", p->whole_triangles);
    cli_json_number(j, "max_mm", p->apart_mm);
    cli_json_number(j, "extract_seconds", p->seconds);
    cli_json_number(j, "whole_extract_seconds", p->whole_seconds);
    cli_json_count(j, "bytes", p->bytes);
    cli_json_count(j, "whole_bytes", p->whole_bytes);
    cli_json_close(j, '}');
}

static void put_facts(cli_json *j, const cli_made *m)
{
    if (m->measured)
        put_mesh(j, m);
    if (m->snapped)
        put_snap(j, &m->snap);
    if (m->compared.made || m->compared.has_field)
        put_comparison(j, &m->compared);
    if (m->switch_m > 0)
        cli_json_number(j, "switch_distance_m", m->switch_m);
    if (m->pivot[0] != 0 || m->pivot[1] != 0 || m->pivot[2] != 0)
        cli_json_numbers(j, "moved_to_pivot_mm", m->pivot, 3);
    cli_json_orient(j, &m->orient);
    if (m->compared.has_texture)
        put_texture(j, &m->compared.texture);
    cli_json_stages(j, &m->facts, m->least_mm3);
    if (m->print.count)
        cli_json_verdicts(j, m->print.verdicts, m->print.count);
    if (m->print.facts.area_mm2 > 0)
        cli_json_print(j, &m->print.facts);
    if (m->crop.made)
        put_crop(j, &m->crop);
    if (m->proof.made)
        put_proof(j, &m->proof, m->compared.has_full_field ? &m->compared.full_to_field : NULL);
}

static void put_moment(cli_json *j, const cli_made *m)
{
    cli_json_count(j, "step", m->moment->number);
    if (m->timed)
        cli_json_number(j, "time", m->moment->time_s);
    cli_json_text(j, "input", cli_shown_path(m->moment->path));
}

static void put_several(cli_json *j, const cli_report *r)
{
    cli_json_open(j, r->several, '[');
    for (const cli_made *m = r->made; m < r->made + r->made_count; m++) {
        cli_json_open(j, NULL, '{');
        if (m->name)
            cli_json_text(j, "name", m->name);
        else
            cli_json_number(j, "iso", m->iso);
        if (m->moment)
            put_moment(j, m);
        if (m->written)
            cli_json_text(j, "path", cli_shown_path(m->path));
        put_facts(j, m);
        cli_json_text(j, "status", cw_status_name(m->error.status));
        if (m->error.status != CW_OK)
            cli_json_message(j, "message", m->error.message);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_compressed(cli_json *j, const cw_compressed *c)
{
    cli_json_count(j, "bits", (size_t)c->bits);
    cli_json_number(j, "step_mm", c->step_mm);
    cli_json_number(j, "error_mm", c->error_mm);
    cli_json_number(j, "normal_degrees", c->normal_degrees);
    cli_json_count(j, "settled_vertices", c->settled);
    cli_json_count(j, "merged_vertices", c->merged);
    cli_json_count(j, "flat_triangles", c->flat);
    cli_json_count(j, "dropped_triangles", c->dropped);
    if (c->fragments)
        cli_json_count(j, "fragments", c->fragments);
    cli_json_bool(j, "decoded_checked", true);
}

static void put_dropped(cli_json *j, unsigned dropped)
{
    bool any = false;
    for (size_t i = 0; i < cli_kept_count; i++)
        if (dropped & cli_kept[i].flag) {
            if (!any)
                cli_json_open(j, "dropped", '[');
            any = true;
            cli_json_text(j, NULL, cli_kept[i].name);
        }
    if (any)
        cli_json_close(j, ']');
}

static void put_output(cli_json *j, const cli_made *made)
{
    double bytes;
    if (!made->written)
        return;
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "path", cli_shown_path(made->path));
    cli_json_count(j, "bytes",
                   cli_find_output_size(made->path, &bytes) ? (size_t)bytes
                                                            : (size_t)made->compressed.bytes);
    cli_json_text(j, "compression", cli_compression_name(made->compression));
    if (made->compression)
        put_compressed(j, &made->compressed);
    cli_json_bool(j, "local", made->local);
    if (made->local)
        cli_json_numbers(j, "origin", made->origin, 3);
    put_dropped(j, made->dropped);
    cli_json_close(j, '}');
}

static void put_made(cli_json *j, const cli_report *r)
{
    if (r->several)
        put_several(j, r);
    else if (r->made_count)
        put_facts(j, &r->made[0]);
    cli_json_open(j, "output", '[');
    for (size_t n = 0; n < r->made_count; n++)
        put_output(j, &r->made[n]);
    cli_json_close(j, ']');
}

static void put_warnings(cli_json *j, const cli_report *r)
{
    cli_json_open(j, "warnings", '[');
    if (r->input && !(r->input->whole.known & CW_KNOWN_UNIT))
        cli_json_text(j, NULL, "the input names no unit: taken as mm");
    for (size_t n = 0; n < r->made_count; n++)
        for (size_t w = 0; w < r->made[n].warning_count; w++)
            cli_json_text(j, NULL, r->made[n].warning[w]);
    cli_json_close(j, ']');
}

static void put_report(FILE *out, const cli_report *r, cw_status status, const cw_error *err)
{
    cli_json j = {.out = out};
    cli_json_begin(&j, "cubewright-report-1");
    put_features(&j);
    cli_json_text(&j, "command", r->command);
    if (r->input)
        cli_json_input(&j, "input", r->input);
    if (r->facts)
        r->facts(&j, r->args);
    put_steps(&j, r);
    put_made(&j, r);
    put_warnings(&j, r);
    cli_json_text(&j, "status", cw_status_name(status));
    if (status != CW_OK)
        cli_json_message(&j, "message", err->message);
    cli_json_int(&j, "exit", cw_status_exit_code(status));
    cli_json_close(&j, '}');
}

cw_status cli_report_save(const char *path, const char *text, size_t size, cw_error *err)
{
    if (strcmp(path, "-") == 0)
        return fwrite(text, 1, size, stdout) == size && fflush(stdout) == 0
                   ? CW_OK
                   : cli_fail_standard(err);
    return cwi_outfile_save(path, text, size, err);
}

cw_status cli_report_make(const char *path, void (*put)(FILE *out, const void *what),
                          const void *what, cw_error *err)
{
    char *text;
    size_t size;
    if (!path)
        return CW_OK;
    FILE *out = cwi_text_open(&text, &size);
    if (out)
        put(out, what);
    cw_status st = cwi_text_close(out, &text) ? cli_report_save(path, text, size, err)
                                              : cwi_fail_memory(err);
    free(text);
    return st;
}

/* Writes the report of a run that ended with this status, and returns the one to end with. */
static cw_status write_report(const cli_report *report, cw_status status, cw_error *err)
{
    char *text;
    size_t size;
    cw_error why = {0};
    if (!report->path)
        return status;
    FILE *out = cwi_text_open(&text, &size);
    if (out)
        put_report(out, report, status, err);
    cw_status st = cwi_text_close(out, &text) ? cli_report_save(report->path, text, size, &why)
                                              : cwi_fail_memory(&why);
    free(text);
    if (status != CW_OK)
        return status;
    if (st != CW_OK)
        *err = why;
    return st;
}

cw_status cli_run_reported(const cli_run *run, cli_report *report, cw_error *err)
{
    cli_console_start(run->common, (cli_progress_mode)run->progress);
    cli_console_reserve_stdout(run->json);
    cw_status st = cli_report_reserve(report, run->meshes ? run->meshes : 1, err);
    if (st == CW_OK)
        st = run->body(run->state, err);
    st = write_report(report, st, err);
    free(report->made);
    free(report->steps);
    return st;
}
