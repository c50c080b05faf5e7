/* Makes a scene from the options: transfer function, colours, clip planes, lights, material,
 * steps and mesh. */
#include "cli/render/scene_options.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pictures for keeps: the library's own is 1. */
static const double STEP_VOX = 0.5;

static cw_status fail_color(const char *option, const char *text, cw_error *err)
{
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "--%s '%s': expected a colour such as #ffeedd, #fed, white, black or grey",
                    option, text);
}

/* Two colours by comma, or one for both. */
static bool parse_background(const char *text, uint8_t background[2][4])
{
    char top[16];
    const char *comma = strchr(text, ',');
    const size_t length = comma ? (size_t)(comma - text) : strlen(text);
    if (length >= sizeof top)
        return false;
    memcpy(top, text, length);
    top[length] = '\0';
    return cli_parse_color(top, background[0]) &&
           cli_parse_color(comma ? comma + 1 : top, background[1]);
}

cw_status cli_background(const cli_scene *args, uint8_t background[2][4], cw_error *err)
{
    static const uint8_t dark[2][4] = {{8, 10, 14, 255}, {24, 28, 36, 255}},
                         none[2][4] = {{255, 255, 255, 0}, {255, 255, 255, 0}};
    const char *text = args->background;
    memcpy(background, dark, sizeof dark);
    if (text && strcmp(text, "none") == 0)
        memcpy(background, none, sizeof none);
    else if (text && !parse_background(text, background))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--background '%s': expected a colour such as #ffeedd, two by comma "
                        "(top, bottom), or none",
                        text);
    return CW_OK;
}

/* Returns true for fields: floats whose file names neither unit nor frame, as those of
 * simulations. They have no natural colours. */
static bool is_field(const cw_volume *v, const cw_statistics *s)
{
    return s->quantum == 0 && !(v->known & (CW_KNOWN_UNIT | CW_KNOWN_FRAME));
}

static const char *default_preset(const cw_volume *v, const cw_statistics *s, cw_mode mode)
{
    switch (mode) {
    case CW_MODE_MIP:
    case CW_MODE_LOCAL_MIP:
        return "mip";
    case CW_MODE_AVERAGE:
    case CW_MODE_MINIP:
        return "xray";
    case CW_MODE_SLICES:
        return "window";
    default:
        return v->known & CW_KNOWN_LEVEL_SET ? "level-set"
               : is_field(v, s)              ? "viridis"
                                             : "auto";
    }
}

static bool ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text), m = strlen(end);
    return n >= m && strcmp(text + n - m, end) == 0;
}

/* Air is -1000 in Hounsfield units: without anything below -200 there is none, or it is stored
 * with an offset. */
static void warn_of_units(const char *preset, const cw_statistics *s, const cli_scene *args)
{
    if (strncmp(preset, "ct-", 3) != 0 || args->shift.given || s->min < -200)
        return;
    cli_say("warning: --tf %s is in Hounsfield units, of which air is -1000; these values are "
            "%g to %g%s",
            preset, s->min, s->max,
            s->max > 1500 ? ": if air is at 0, --shift 1024 corrects it" : "");
}

/* Nothing to be seen is rarely what was meant. */
static void warn_of_nothing(const cw_transfer *t, const cw_statistics *s)
{
    double color[3], opacity, max = 0;
    for (size_t b = 0; b < s->bin_count; b++) {
        cw_transfer_at(t, s->min + s->bin_width * ((double)b + 0.5), color, &opacity);
        max = s->bins[b] ? fmax(max, opacity) : max;
    }
    if (max < 1e-3)
        cli_say("warning: the transfer function makes all values from %g to %g invisible",
                s->min, s->max);
}

/* Reads factors of the gradient: pairs G:F by comma. */
static cw_status change_gradients(const char *text, cw_transfer *t, cw_error *err)
{
    char item[CWI_ITEM_BYTES], separator = 0;
    const char *rest = text;
    t->gradient_count = 0;
    do {
        double gradient, factor;
        const char *at = item;
        if (!cwi_next_item(&rest, &separator, item) || !cwi_parse_double(&at, &gradient) ||
            *at++ != ':' || !cwi_parse_double(&at, &factor) || *at ||
            t->gradient_count == CW_TRANSFER_POINTS)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--gradient-opacity '%s': expected G:F,..., such as 0:0.1,1:1",
                            text);
        t->gradients[t->gradient_count++] = (cw_opacity_point){gradient, (float)factor};
    } while (separator);
    return CW_OK;
}

cw_status cli_change_transfer(const cli_scene *args, cw_transfer *t, cw_error *err)
{
    const double factor = args->opacity.given ? args->opacity.value : 1;
    if (!(factor >= 0))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--opacity %g: a factor of 0 or more was expected", factor);
    for (size_t n = 0; n < t->color_count; n++)
        t->colors[n].value += args->shift.value;
    for (size_t n = 0; n < t->opacity_count; n++) {
        t->opacities[n].value += args->shift.value;
        t->opacities[n].opacity = (float)fmin(factor * (double)t->opacities[n].opacity, 1);
    }
    for (size_t n = 0; n < t->index_count; n++)
        t->indices[n].value += args->shift.value;
    if (args->surface_width.given)
        t->surface_mm = args->surface_width.value;
    if (args->surface_width.given && !(t->surface_mm > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--surface-width %g: a length was expected",
                        t->surface_mm);
    if (args->surface_width.given && t->index_count == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--surface-width is for transfer functions with materials, such as "
                        "--tf ct-materials");
    if (args->gradient_opacity) {
        cw_status st = change_gradients(args->gradient_opacity, t, err);
        if (st != CW_OK)
            return st;
    }
    return cw_transfer_check(t, err);
}

/* A file, a preset, or JSON itself. */
static cw_status find_transfer(const char *name, const cw_statistics *statistics,
                               const cli_scene *args, cw_transfer *transfer, cw_error *err)
{
    if (ends_with(name, ".json") && *name != '{')
        return cw_transfer_read(name, transfer, err);
    cw_status st = *name == '{' ? cw_transfer_parse(name, transfer, err)
                                : cw_transfer_preset(name, statistics, transfer, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--tf");
    if (*name != '{')
        warn_of_units(name, statistics, args);
    return st;
}

double cli_class_level(const cw_statistics *s)
{
    double level;
    return cw_statistics_otsu(s, 1, &level) ? level : 0.5 * (s->min + s->max);
}

cw_status cli_fit_transfer(const cli_scene *args, const cw_volume *volume, cw_mode mode,
                           const cw_statistics *statistics, cw_transfer *transfer,
                           cw_error *err)
{
    const cw_mode drawn =
        mode == CW_MODE_REFERENCE && args->reference_of ? args->reference_of : mode;
    const char *name =
        args->transfer ? args->transfer : default_preset(volume, statistics, drawn);
    cw_status st = find_transfer(name, statistics, args, transfer, err);
    if (st == CW_OK)
        st = cli_change_transfer(args, transfer, err);
    if (st == CW_OK)
        warn_of_nothing(transfer, statistics);
    return st;
}

cw_status cli_make_transfer(const cli_scene *args, const cw_volume *volume, cw_mode mode,
                            int threads, cw_transfer *transfer, cw_error *err)
{
    cw_statistics statistics;
    cw_status st = cw_volume_statistics(volume, CLI_TRANSFER_BINS, threads, &statistics, err);
    if (st == CW_OK)
        st = cli_fit_transfer(args, volume, mode, &statistics, transfer, err);
    cw_statistics_free(&statistics);
    return st;
}

/* Numbers by comma or 'x', up to a semicolon or the end; how many, or -1. Text moves behind
 * them. */
static int parse_tuple(const char **text, double *numbers, int max)
{
    char item[CWI_ITEM_BYTES], separator = 0;
    int count = 0;
    do {
        const char *at = item;
        if (count == max || !cwi_next_item(text, &separator, item) ||
            !cwi_parse_double(&at, &numbers[count]) || *at || !isfinite(numbers[count]))
            return -1;
        count++;
    } while (separator);
    *text += **text == ';';
    return count;
}

static cw_status parse_planes(const char *option, const char *text, size_t max, cw_clip *out,
                              size_t *count, cw_error *err)
{
    for (const char *at = text; at && *at;) {
        double p[4];
        if (parse_tuple(&at, p, 4) != 4 || (p[0] == 0 && p[1] == 0 && p[2] == 0))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--%s '%s': expected planes nx,ny,nz,d parted by ';': all points p "
                            "with n . p = d, in mm",
                            option, text);
        if (*count == max)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--%s: %zu planes at most, with those of a --clip-box", option,
                            max);
        const double length = cwi_length(p);
        out[(*count)++] =
            (cw_clip){{p[0] / length, p[1] / length, p[2] / length}, p[3] / length};
    }
    return CW_OK;
}

/* Two planes across each axis, of the world or of the file's voxels. */
/* Returns the place of a (fractional) index on the axis of a rectilinear grid; else itself. */
static double place_of(const cw_volume *v, int axis, double index)
{
    if (!cwi_is_rectilinear(v))
        return index;
    if (v->dim[axis] == 1)
        return v->coordinates[axis][0] + index;
    const double low = floor(fmin(fmax(index, 0), (double)v->dim[axis] - 2));
    return cwi_grid_coordinate(v, axis, (ptrdiff_t)low, index - low);
}

static cw_status add_clip_box(const cli_ranges *box, const cw_volume *whole, cw_scene *s,
                              cw_error *err)
{
    double at_zero[3] = {0}, at[3] = {0}, zero[3] = {0};
    cw_volume plain = {0}; /* without coordinates, to find directions */
    cw_status st = CW_OK;
    if (!box->world && (!whole || whole->cells))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--clip-box of %s is in mm, such as -30mm:30mm,0mm:50mm,0mm:9mm",
                        whole ? "an irregular grid" : "a mesh");
    if (!box->world) {
        plain = *whole;
        memset(plain.coordinates, 0, sizeof plain.coordinates);
        st = cw_volume_to_index(&plain, zero, at_zero, err);
    }
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        cw_clip *low = &s->clips[s->clip_count++], *high = &s->clips[s->clip_count++];
        for (int w = 0; w < 3 && st == CW_OK; w++) {
            double unit[3] = {0};
            unit[w] = 1;
            if (!box->world)
                st = cw_volume_to_index(&plain, unit, at, err);
            low->normal[w] = box->world ? w == a : at[a] - at_zero[a];
            high->normal[w] = -low->normal[w];
        }
        const double ends[2] = {box->world ? box->low[a] : place_of(whole, a, box->low[a]),
                                box->world ? box->high[a] : place_of(whole, a, box->high[a])};
        low->distance_mm = ends[0] - at_zero[a];
        high->distance_mm = -(ends[1] - at_zero[a]);
    }
    return st;
}

static cw_status add_clips(const cli_scene *args, const cli_subject *subject, cw_scene *s,
                           cw_error *err)
{
    cw_status st = CW_OK;
    if (args->clip_box.given)
        st = add_clip_box(&args->clip_box, subject->whole, s, err);
    if (st == CW_OK)
        st = parse_planes("clip", args->clips, CW_MAX_CLIPS, s->clips, &s->clip_count, err);
    s->cut_away = args->cut_away;
    return st;
}

static cw_status add_lights(const char *text, cw_scene *s, cw_error *err)
{
    for (const char *at = text; at && *at;) {
        double p[6] = {0, 0, 0, 1, 1, 1};
        const int count = parse_tuple(&at, p, 6);
        if ((count != 3 && count != 6) || (p[0] == 0 && p[1] == 0 && p[2] == 0))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--light '%s': expected x,y,z or x,y,z,r,g,b parted by ';'", text);
        if (s->light_count == CW_MAX_LIGHTS)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--light: %d at most", CW_MAX_LIGHTS);
        cw_light *light = &s->lights[s->light_count++];
        for (int c = 0; c < 3; c++) {
            light->direction[c] = p[c];
            light->color[c] = (float)p[3 + c];
            if (!(p[3 + c] >= 0))
                return cwi_fail(err, CW_ERR_ARGUMENT, "--light '%s': a colour is 0 or more",
                                text);
        }
    }
    return CW_OK;
}

static cw_status take_share(const char *name, const cli_number *n, double max, float *out,
                            cw_error *err)
{
    if (n->given && !(n->value >= 0 && n->value <= max))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--%s %g: 0 to %g was expected", name, n->value,
                        max);
    if (n->given)
        *out = (float)n->value;
    return CW_OK;
}

static cw_status add_depth_cue(const cli_scene *args, cw_scene *s, cw_error *err)
{
    const cli_numbers *range = &args->cue_range;
    cw_status st = take_share("depth-cue", &args->depth_cue, 1, &s->depth_cue, err);
    if (st != CW_OK)
        return st;
    if (range->count && (range->count != 2 || !(range->value[0] < range->value[1])))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--depth-cue-range takes two rising numbers");
    if (args->cue_form == CW_CUE_EXPONENTIAL && args->depth_cue.value >= 1)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--depth-cue %g: less than 1 was expected with --depth-cue-form "
                        "exponential",
                        args->depth_cue.value);
    for (size_t n = 0; n < 2; n++)
        s->cue_range[n] = range->count ? range->value[n] : (double)n;
    s->cue_form = (cw_cue_form)args->cue_form;
    return CW_OK;
}

/* Nothing said is left to the library: meshes may have a light of their own. */
static cw_status add_material(const cli_scene *args, cw_scene *s, cw_error *err)
{
    const bool given = args->ambient.given || args->diffuse.given || args->specular.given ||
                       args->shininess.given;
    cw_material *m = &s->material;
    s->one_sided = args->lambert;
    if (given)
        *m = (cw_material){0.25f, 0.75f, 0.2f, 32};
    cw_status st = take_share("ambient", &args->ambient, 1, &m->ambient, err);
    if (st == CW_OK)
        st = take_share("diffuse", &args->diffuse, 1, &m->diffuse, err);
    if (st == CW_OK)
        st = take_share("specular", &args->specular, 1, &m->specular, err);
    if (st == CW_OK)
        st = take_share("shininess", &args->shininess, 1000, &m->shininess, err);
    if (st == CW_OK)
        st = add_depth_cue(args, s, err);
    if (st == CW_OK && given && m->ambient + m->diffuse + m->specular == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--ambient, --diffuse and --specular are all 0: nothing is lit");
    return st == CW_OK ? add_lights(args->lights, s, err) : st;
}

static bool has_shading(cw_mode mode)
{
    return mode == CW_MODE_COMPOSITE || (mode >= CW_MODE_PROJECTION && mode != CW_MODE_SLICES);
}

/* As many slices as were asked for, between the nearest and the farthest corner. */
static cw_status space_slices(const cli_scene *args, const cw_volume *v, cw_scene *s,
                              cw_error *err)
{
    double axes[3][3], low = INFINITY, high = -INFINITY, spacing[3];
    if (args->slices == 0)
        return CW_OK;
    if (args->step.given)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--slices or --step-length, not both");
    cw_status st = cw_camera_axes(&s->camera, axes[0], axes[1], axes[2], err);
    for (int n = 0; n < 8 && st == CW_OK; n++) {
        double index[3], p[3], depth = 0;
        for (int a = 0; a < 3; a++)
            index[a] = n >> a & 1 ? (double)v->dim[a] - 1 : 0;
        cw_volume_to_world(v, index, p);
        for (int a = 0; a < 3; a++)
            depth += p[a] * axes[2][a];
        low = fmin(low, depth);
        high = fmax(high, depth);
    }
    cw_volume_spacing(v, spacing);
    s->sampling.step_vox = fmax(high - low, 1e-3) / (double)args->slices /
                           fmin(fmin(spacing[0], spacing[1]), spacing[2]);
    return st;
}

static cw_status add_steps(const cli_scene *args, const cw_volume *v, double level, cw_scene *s,
                           cw_error *err)
{
    if (args->step.given && !(args->step.value >= 1e-3 && args->step.value <= 1e3))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--step-length %g: 0.001 to 1000 was expected",
                        args->step.value);
    if (args->tree_error.given && !(args->tree_error.value >= 0 && args->tree_error.value <= 1))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--tree-error %g: 0 to 1 was expected",
                        args->tree_error.value);
    if (args->splat_width.given &&
        !(args->splat_width.value >= 0.2 && args->splat_width.value <= 4))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--splat-width %g: 0.2 to 4 was expected",
                        args->splat_width.value);
    if (args->colors_first && args->direction_filter)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--direction-filter does nothing with --colors-first, which interpolates "
            "lit colours");
    if (args->stop_opacity.given && !(args->stop_opacity.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--stop-opacity %g: above 0 was expected",
                        args->stop_opacity.value);
    if (args->gradient_smoothing.given &&
        !(args->gradient_smoothing.value >= 0 && args->gradient_smoothing.value <= 16))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--gradient-smoothing %g: 0 to 16 was expected",
                        args->gradient_smoothing.value);
    s->gradient_sigma = args->gradient_smoothing.value;
    s->shadow =
        cli_setting_fits("shadow", s->mode, false) ? (cw_shadow)args->shadow : CW_SHADOW_NONE;
    s->sampling.step_vox = args->step.given ? args->step.value : STEP_VOX;
    s->sampling.stop_opacity = s->mode == CW_MODE_VBUFFER ? 0.99999f : 0.9999f;
    s->sampling.cell_steps = args->cell_steps;
    s->sampling.no_preintegration = !args->preintegration;
    s->sampling.jitter = args->jitter;
    s->sampling.exact_filter = args->exact_filter;
    s->sampling.no_skipping = !args->skipping;
    s->intensity.threshold = args->threshold.given ? args->threshold.value : level;
    s->intensity.minip_inside = args->minip_inside;
    s->sampling.texture_edge = args->texture_edge;
    s->texture.target = (cw_target)args->target;
    s->texture.colors_first = args->colors_first;
    s->texture.normals = args->normals ? args->normals : 1024;
    s->texture.direction_filter = (cw_direction_filter)args->direction_filter;
    s->texture.material_table = args->material_table;
    s->texture.mark_boundary = args->boundary;
    s->vbuffer.pixel_area = args->pixel_area;
    s->projection.linear_opacity = args->linear_opacity;
    s->splat.tree_error = s->projection.tree_error = args->tree_error.value;
    s->splat.budget = args->splat_budget;
    s->splat.kernel = (cw_splat_kernel)args->splat_kernel;
    s->splat.width = args->splat_width.value; /* 0: the kernel's own */
    cw_status st =
        take_share("stop-opacity", &args->stop_opacity, 1, &s->sampling.stop_opacity, err);
    return st == CW_OK ? space_slices(args, v, s, err) : st;
}

static cw_status add_mesh(const cli_scene *args, cw_scene *s, cw_error *err)
{
    uint8_t rgba[4];
    const cli_numbers *range = &args->tint_range;
    if (args->color && !cli_parse_color(args->color, rgba))
        return fail_color("color", args->color, err);
    for (int c = 0; c < 4 && args->color; c++)
        s->mesh_look.color[c] = (float)rgba[c] / 255;
    if (range->count && (range->count != 2 || !(range->value[0] < range->value[1])))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--tint-range takes two rising numbers");
    s->mesh_look.tint = (cw_tint)args->tint;
    s->mesh_look.tint_low = range->count ? range->value[0] : 0;
    s->mesh_look.tint_high = range->count ? range->value[1] : 0;
    s->mesh_look.wireframe = args->wireframe;
    s->mesh_look.cap = args->cap;
    return CW_OK;
}

/* Sets the background colours, which depth cues and slices blend with. */
static cw_status add_background(const cli_scene *args, cw_scene *s, cw_error *err)
{
    uint8_t background[2][4];
    cw_status st = cli_background(args, background, err);
    for (int n = 0; n < 2; n++)
        for (int c = 0; c < 3; c++)
            s->background[n][c] = (float)background[n][c] / 255;
    return st;
}

cw_status cli_make_scene(const cli_scene *args, const cli_subject *subject, cw_mode mode,
                         const cw_transfer *transfer, cw_scene *scene, cw_error *err)
{
    cw_scene *s = scene;
    s->mode = mode;
    s->reference_of = mode == CW_MODE_REFERENCE ? args->reference_of : (cw_mode)0;
    s->volume = mode == CW_MODE_MESH ? NULL : subject->volume;
    s->mesh = args->hide == CLI_HIDE_MESH ? NULL : subject->mesh;
    s->transfer = mode == CW_MODE_MESH ? NULL : transfer;
    s->threads = subject->threads;
    s->lit = args->lit && has_shading(mode);
    cw_status st = add_background(args, s, err);
    if (st == CW_OK)
        st = add_clips(args, subject, s, err);
    if (st == CW_OK)
        st = add_material(args, s, err);
    if (st == CW_OK && s->volume)
        st = add_steps(args, s->volume, subject->level, s, err);
    if (st == CW_OK)
        st = parse_planes("planes", args->planes, CW_MAX_SLICES, s->slices, &s->slice_count,
                          err);
    return st == CW_OK ? add_mesh(args, s, err) : st;
}
