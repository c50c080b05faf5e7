/* Reads the volume of colours, and puts its values and colours on a surface. */
#include "cli/results/color_by.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static bool parse_range(const char *text, double *low, double *high)
{
    return cwi_parse_double(&text, low) && *text++ == ':' && cwi_parse_double(&text, high) &&
           *text == '\0' && isfinite(*low) && isfinite(*high) && *low < *high;
}

cw_status cli_check_color(const cli_color_args *args, cw_error *err)
{
    double low, high;
    if (args->range && !parse_range(args->range, &low, &high))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--range '%s': expected two values, the lower one first, such as 0:300",
                        args->range);
    return CW_OK;
}

/* Reads a file of that name, or else that array of the input. */
static cw_status read_colors(cli_coloring *c, const char *path, const cli_input *input,
                             size_t step, cw_error *err)
{
    static cli_array array; /* the volume keeps the name */
    cli_input settings = {.threads = input->threads,
                          .memory = input->memory,
                          .max_voxels = input->max_voxels,
                          .no_sandbox = input->no_sandbox,
                          .timeout_s = input->timeout_s,
                          .allow_external = input->allow_external};
    const char *by = c->args->by, *name = by;
    array = (cli_array){0};
    if (access(by, F_OK) != 0 && cli_parse_array(by, &array))
        name = array.name;
    const bool is_file = access(name, F_OK) == 0;
    if (!is_file) {
        settings = *input;
        settings.crop.given = settings.resample.given = settings.denoise.given = false;
        settings.preview = settings.may_stream = settings.remove_table = false;
        settings.coarsen = 0;
        settings.step = step;
        settings.step_chosen = true;
    }
    settings.array = array;
    if (is_file)
        settings.array.name[0] = '\0';
    cli_free_volume(&c->volume);
    cw_status st = cli_read_volume(is_file ? name : path, &settings, false, &c->volume, err);
    if (st != CW_OK && !is_file) {
        const cw_error why = *err;
        return cwi_fail(err, st, "--color-by %s: no file has this name, and as an array: %s",
                        name, why.message);
    }
    c->is_read = st == CW_OK;
    c->step = step;
    return st;
}

cw_status cli_open_coloring(cli_coloring *c, const char *path, const cli_input *input,
                            size_t step, const cw_volume **volume, cw_error *err)
{
    const bool is_array = access(c->args->by, F_OK) != 0;
    *volume = &c->volume.view;
    return c->is_read && (!is_array || c->step == step)
               ? CW_OK
               : read_colors(c, path, input, step, err);
}

cw_pipeline_color cli_describe_coloring(const cli_coloring *c)
{
    cw_pipeline_color color = {.map = (cw_colormap)c->args->map,
                               .has_range = c->has_range,
                               .low = c->low,
                               .high = c->high};
    if (!c->has_range && c->args->range)
        color.has_range = parse_range(c->args->range, &color.low, &color.high);
    return color;
}

static void tell_range(cli_coloring *c, const cw_sample_facts *f, double low, double high)
{
    c->has_range = true;
    c->low = low;
    c->high = high;
    cli_say("%s: values %.6g to %.6g; colours from %.6g to %.6g by %s", c->args->by, f->low,
            f->high, low, high, cw_colormap_name((cw_colormap)c->args->map));
    if (f->missing)
        cli_say("%s: %s vertices are outside of it, and get the lowest value", c->args->by,
                cli_count(f->missing));
}

void cli_tell_coloring(cli_coloring *c, const cw_pipeline_facts *f)
{
    tell_range(c, &f->color, f->color_low, f->color_high);
}

cw_status cli_color_mesh(cli_coloring *c, cw_mesh *mesh, int threads, cw_error *err)
{
    const cw_sample_desc desc = {.threads = threads};
    const cw_pipeline_color color = cli_describe_coloring(c);
    cw_sample_facts facts;
    cw_status st = cw_mesh_sample(mesh, &c->volume.view, &desc, &facts, err);
    if (st != CW_OK)
        return st;
    const double low = color.has_range ? color.low : facts.low;
    const double high = color.has_range ? color.high : facts.high;
    tell_range(c, &facts, low, high);
    return cw_mesh_color(mesh, color.map, low, high, err);
}

void cli_json_color(cli_json *j, const cli_coloring *c)
{
    if (!c->args || !c->args->by)
        return;
    cli_json_text(j, "color_by", cli_shown_path(c->args->by));
    cli_json_text(j, "colormap", cw_colormap_name((cw_colormap)c->args->map));
    if (c->has_range)
        cli_json_numbers(j, "range", (double[2]){c->low, c->high}, 2);
}

void cli_free_coloring(cli_coloring *c)
{
    cli_free_volume(&c->volume);
    c->is_read = false;
}
