/* Writes the JSON report of render: scene, cameras, transfer function, settings and
 * pictures. */
#include "cli/render/render_report.h"

#include "cli/framework/run_config.h"
#include "cli/results/run_report.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <stdlib.h>

static void put_camera(cli_json *j, const cw_camera *c)
{
    cli_json_open(j, "camera", '{');
    cli_json_numbers(j, "eye", c->eye, 3);
    cli_json_numbers(j, "target", c->target, 3);
    cli_json_numbers(j, "up", c->up, 3);
    cli_json_number(j, c->fov_deg > 0 ? "fov_deg" : "height_mm",
                    c->fov_deg > 0 ? c->fov_deg : c->height_mm);
    cli_json_close(j, '}');
}

/* Writes what a transfer function has for gradients, if it has something. */
static void put_gradients(cli_json *j, const cw_transfer *t)
{
    if (t->gradient_count > 0) {
        cli_json_open(j, "gradients", '[');
        for (size_t n = 0; n < t->gradient_count; n++)
            cli_json_numbers(
                j, NULL, (double[2]){t->gradients[n].value, (double)t->gradients[n].opacity},
                2);
        cli_json_close(j, ']');
    }
    if (t->index_count > 0) {
        cli_json_open(j, "indices", '[');
        for (size_t n = 0; n < t->index_count; n++)
            cli_json_numbers(j, NULL,
                             (double[2]){t->indices[n].value, (double)t->indices[n].index}, 2);
        cli_json_close(j, ']');
    }
    if (t->surface_mm > 0)
        cli_json_number(j, "surface_mm", t->surface_mm);
}

static void put_transfer(cli_json *j, const cw_transfer *t)
{
    cli_json_open(j, "transfer", '{');
    if (t->unit_mm > 0)
        cli_json_number(j, "unit_mm", t->unit_mm);
    cli_json_open(j, "colors", '[');
    for (size_t n = 0; n < t->color_count; n++) {
        const cw_color_point *p = &t->colors[n];
        cli_json_numbers(j, NULL,
                         (double[4]){p->value, (double)p->color[0], (double)p->color[1],
                                     (double)p->color[2]},
                         4);
    }
    cli_json_close(j, ']');
    cli_json_open(j, "opacities", '[');
    for (size_t n = 0; n < t->opacity_count; n++)
        cli_json_numbers(
            j, NULL, (double[2]){t->opacities[n].value, (double)t->opacities[n].opacity}, 2);
    cli_json_close(j, ']');
    put_gradients(j, t);
    cli_json_close(j, '}');
}

static void put_planes(cli_json *j, const char *key, const cw_clip *planes, size_t count)
{
    cli_json_open(j, key, '[');
    for (size_t n = 0; n < count; n++)
        cli_json_numbers(j, NULL,
                         (double[4]){planes[n].normal[0], planes[n].normal[1],
                                     planes[n].normal[2], planes[n].distance_mm},
                         4);
    cli_json_close(j, ']');
}

/* Writes the settings that the library was given; 0 stands for its default. */
static void put_settings(cli_json *j, const cw_scene *s)
{
    static const char *const targets[CW_TARGET_COUNT] = {"32f", "16", "16f", "8"};
    static const char *const kernels[CW_SPLAT_COUNT] = {"gaussian", "polygon", "tent",
                                                        "b-spline"};
    static const char *const forms[CW_CUE_COUNT] = {"linear", "exponential"};
    static const char *const shadows[CW_SHADOW_COUNT] = {"none", "light", "ambient"};
    const cw_material *m = &s->material;
    cli_json_open(j, "settings", '{');
    cli_json_count(j, "width", s->width);
    cli_json_count(j, "height", s->height);
    cli_json_int(j, "samples", s->samples);
    cli_json_bool(j, "lit", s->lit);
    cli_json_text(j, "lambert", s->one_sided ? "one-sided" : "two-sided");
    cli_json_numbers(j, "material",
                     (double[4]){(double)m->ambient, (double)m->diffuse, (double)m->specular,
                                 (double)m->shininess},
                     4);
    cli_json_number(j, "depth_cue", (double)s->depth_cue);
    cli_json_numbers(j, "depth_cue_range", s->cue_range, 2);
    cli_json_text(j, "depth_cue_form", forms[s->cue_form]);
    cli_json_text(j, "shadow", shadows[s->shadow]);
    cli_json_number(j, "gradient_smoothing", s->gradient_sigma);
    cli_json_number(j, "step_length", s->sampling.step_vox);
    cli_json_bool(j, "cell_steps", s->sampling.cell_steps);
    cli_json_bool(j, "preintegration", !s->sampling.no_preintegration);
    cli_json_bool(j, "jitter", s->sampling.jitter);
    cli_json_bool(j, "exact_filter", s->sampling.exact_filter);
    cli_json_bool(j, "skipping", !s->sampling.no_skipping);
    cli_json_number(j, "stop_opacity", (double)s->sampling.stop_opacity);
    cli_json_number(j, "threshold", s->intensity.threshold);
    cli_json_bool(j, "minip_inside", s->intensity.minip_inside);
    cli_json_text(j, "target", targets[s->texture.target]);
    cli_json_bool(j, "colors_first", s->texture.colors_first);
    cli_json_count(j, "normals", s->texture.normals);
    cli_json_text(j, "direction_filter", s->texture.direction_filter ? "nearest" : "linear");
    cli_json_bool(j, "material_table", s->texture.material_table);
    cli_json_bool(j, "boundary", s->texture.mark_boundary);
    cli_json_bool(j, "pixel_area", s->vbuffer.pixel_area);
    cli_json_bool(j, "linear_opacity", s->projection.linear_opacity);
    cli_json_number(j, "tree_error", s->splat.tree_error);
    cli_json_text(j, "splat_kernel", kernels[s->splat.kernel]);
    cli_json_number(j, "splat_width", s->splat.width);
    put_planes(j, "clips", s->clips, s->clip_count);
    cli_json_bool(j, "cut_away", s->cut_away);
    put_planes(j, "planes", s->slices, s->slice_count);
    cli_json_close(j, '}');
}

static void put_comparison(cli_json *j, const cw_comparison *c)
{
    cli_json_open(j, "comparison", '{');
    cli_json_count(j, "pixels", c->pixels);
    cli_json_number(j, "rmse", c->rmse);
    cli_json_number(j, "max", c->max);
    cli_json_number(j, "bias", c->bias);
    cli_json_number(j, "delta_e_mean", c->delta_e_mean);
    cli_json_number(j, "delta_e_p99", c->delta_e_p99);
    cli_json_number(j, "delta_e_max", c->delta_e_max);
    cli_json_number(j, "ssim", c->ssim);
    cli_json_close(j, '}');
}

static void put_shots(cli_json *j, const cli_render_report *r)
{
    cli_json_open(j, "pictures", '[');
    for (size_t n = 0; n < r->shot_count; n++) {
        const cli_shot *shot = &r->shots[n];
        if (!shot->written)
            continue;
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "path", cli_shown_path(shot->path));
        cli_json_count(j, "step", shot->step);
        cli_json_number(j, "turn_deg", shot->turn_deg);
        put_camera(j, &shot->camera);
        cli_json_number(j, "seconds", shot->seconds);
        if (shot->compared)
            put_comparison(j, &shot->measured);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_labels(cli_json *j, const cli_label_scene *s)
{
    cli_json_open(j, "labels", '[');
    for (size_t n = 0; n < s->shown.count; n++) {
        const cw_label *l = &s->shown.labels[n];
        char hex[16];
        snprintf(hex, sizeof hex, "#%02X%02X%02X", l->color[0], l->color[1], l->color[2]);
        cli_json_open(j, NULL, '{');
        cli_json_count(j, "label", l->value);
        if (l->layer > 0)
            cli_json_count(j, "layer", l->layer);
        cli_json_text(j, "name", l->name);
        cli_json_text(j, "color", hex);
        cli_json_number(j, "opacity", l->hidden ? 0 : l->color[3] / 255.0);
        cli_json_count(j, "voxels", s->voxels[n]);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_report(FILE *out, const cli_render_report *r, cw_status status,
                       const cw_error *err)
{
    cli_json j = {.out = out};
    cli_json_begin(&j, "cubewright-render-1");
    if (r->volume)
        cli_json_input(&j, "input", r->volume);
    cli_json_text(&j, "mode", cw_mode_name(r->mode));
    cli_json_text(&j, "source", cw_mode_source(r->mode));
    cli_json_text(&j, "backend", r->backend);
    if (r->labels->shown.count)
        put_labels(&j, r->labels);
    if (r->triangles)
        cli_json_count(&j, "triangles", r->triangles);
    if (r->scene)
        put_settings(&j, r->scene);
    if (r->scene && r->scene->transfer)
        put_transfer(&j, r->transfer);
    put_shots(&j, r);
    cli_json_number(&j, "seconds", r->seconds);
    cli_json_text(&j, "status", cw_status_name(status));
    if (status != CW_OK)
        cli_json_message(&j, "message", err->message);
    cli_json_int(&j, "exit", cw_status_exit_code(status));
    cli_json_close(&j, '}');
}

cw_status cli_render_report_write(const char *path, const cli_render_report *report,
                                  cw_status status, cw_error *err)
{
    char *text;
    size_t size;
    cw_error why = {0};
    if (!path)
        return status;
    FILE *out = cwi_text_open(&text, &size);
    if (out)
        put_report(out, report, status, err);
    cw_status st = cwi_text_close(out, &text) ? cli_report_save(path, text, size, &why)
                                              : cwi_fail_memory(&why);
    free(text);
    if (status != CW_OK)
        return status;
    if (st != CW_OK)
        *err = why;
    return st;
}
