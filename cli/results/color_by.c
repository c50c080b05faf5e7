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

/* Parts NAME:mag and NAME:2 from a file or array of that name. */
static void part_name(const char *by, char *name, size_t size, cli_component *component)
{
    const char *colon = strrchr(by, ':');
    size_t number = 0;
    snprintf(name, size, "%s", by);
    if (!colon || access(by, F_OK) == 0)
        return;
    const bool is_magnitude = strcmp(colon + 1, "mag") == 0;
    if (!is_magnitude && !cli_parse_count(colon + 1, 1000, &number))
        return;
    *component = (cli_component){.given = true, .magnitude = is_magnitude, .number = number};
    if ((size_t)(colon - by) < size)
        name[colon - by] = '\0';
}

/* Reads a file of that name, or else that array of the input. */
static cw_status read_colors(cli_coloring *c, const char *path, const cli_input *input,
                             size_t step, cw_error *err)
{
    static char name[4096]; /* the volume keeps it */
    cli_input settings = {.threads = input->threads,
                          .memory = input->memory,
                          .max_voxels = input->max_voxels,
                          .no_sandbox = input->no_sandbox,
                          .timeout_s = input->timeout_s,
                          .allow_external = input->allow_external};
    cli_component component = {0};
    part_name(c->args->by, name, sizeof name, &component);
    const bool is_file = access(name, F_OK) == 0;
    if (!is_file) {
        settings = *input;
        settings.array = name;
        settings.crop.given = settings.resample.given = settings.denoise.given = false;
        settings.preview = settings.may_stream = settings.remove_table = false;
        settings.coarsen = 0;
        settings.step = step;
        settings.step_chosen = true;
    }
    settings.component = component;
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

void cli_tell_coloring(cli_coloring *c, const cw_pipeline_facts *f)
{
    c->has_range = true;
    c->low = f->color_low;
    c->high = f->color_high;
    cli_say("%s: values %.6g to %.6g; colours from %.6g to %.6g by %s", c->args->by,
            f->color.low, f->color.high, c->low, c->high,
            cw_colormap_name((cw_colormap)c->args->map));
    if (f->color.missing)
        cli_say("%s: %s vertices are outside of it, and get the lowest value", c->args->by,
                cli_count(f->color.missing));
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
