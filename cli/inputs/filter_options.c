/* Parses and prints how volumes are filtered: other distances between voxels, and less noise; and
 * how surfaces are smoothed and cut. */
#include "cli/inputs/filter_options.h"

#include "cli/framework/quantity.h"
#include "core/base/text.h"

#include <cubewright/filter.h>
#include <cubewright/labels.h>
#include <cubewright/smooth.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Parses a kernel of values, or one of labels. */
static bool parse_kernel(const char *text, cli_resample *out)
{
    for (int k = 0; k < CW_KERNEL_COUNT && !out->has_kernel; k++) {
        out->has_kernel = strcmp(text, cw_kernel_name((cw_kernel)k)) == 0;
        out->kernel = out->has_kernel ? k : out->kernel;
    }
    for (int k = 0; k < CW_LABEL_KERNEL_COUNT && !out->has_kernel; k++) {
        out->has_kernel = out->of_labels =
            strcmp(text, cw_label_kernel_name((cw_label_kernel)k)) == 0;
        out->label_kernel = out->of_labels ? k : out->label_kernel;
    }
    return out->has_kernel;
}

static bool parse_resample(const cli_option *o, const char *text, void *field)
{
    cli_resample *out = field;
    (void)o;
    char lengths[128];
    cli_lengths mm;
    const char *colon = strchr(text, ':');
    const size_t size = colon ? (size_t)(colon - text) : strlen(text);
    *out = (cli_resample){.given = size < sizeof lengths};
    if (!out->given)
        return false;
    memcpy(lengths, text, size);
    lengths[size] = '\0';
    out->iso = strcmp(lengths, "iso") == 0;
    out->given = out->iso || cli_parse_lengths(lengths, &mm);
    for (int a = 0; a < 3 && out->given && !out->iso; a++)
        out->mm[a] = mm.mm[a];
    return out->given = out->given && (!colon || parse_kernel(colon + 1, out));
}

enum { DEFAULT_STEPS = 10, MOST_STEPS = 100, MOST_RADIUS = 3 };

/* Each field of a filter follows the one before after a colon. */
enum { FIELDS = 3, FIELD_BYTES = 64 };

static int split_fields(const char *text, char fields[FIELDS][FIELD_BYTES])
{
    for (int n = 0; n < FIELDS; n++) {
        const size_t length = strcspn(text, ":");
        if (length == 0 || length >= FIELD_BYTES)
            return 0;
        memcpy(fields[n], text, length);
        fields[n][length] = '\0';
        if (text[length] == '\0')
            return n + 1;
        text += length + 1;
    }
    return 0;
}

static bool parse_width(const char *text, cli_length *out)
{
    return cli_parse_length(text, CLI_IN_MM | CLI_IN_VOXELS, out);
}

static bool parse_value(const char *text, double *out)
{
    return cwi_parse_double(&text, out) && *text == '\0' && isfinite(*out) && *out > 0;
}

static bool parse_denoise(const cli_option *o, const char *text, void *field)
{
    cli_denoise *out = field;
    (void)o;
    char f[FIELDS][FIELD_BYTES];
    const int count = split_fields(text, f);
    *out = (cli_denoise){0};
    if (count == 2 && strcmp(f[0], "gauss") == 0) {
        out->filter = CLI_GAUSS;
        return out->given = parse_width(f[1], &out->width);
    }
    if (count == 2 && strcmp(f[0], "median") == 0) {
        out->filter = CLI_MEDIAN;
        return out->given = cli_parse_count(f[1], 1000, &out->count) && out->count >= 1 &&
                            out->count <= MOST_RADIUS;
    }
    if (count >= 2 && strcmp(f[0], "bilateral") == 0) {
        out->filter = CLI_BILATERAL;
        return out->given = parse_width(f[1], &out->width) &&
                            (count < 3 || parse_value(f[2], &out->value));
    }
    if (count >= 1 && strcmp(f[0], "aniso") == 0) {
        out->filter = CLI_ANISO;
        out->count = DEFAULT_STEPS;
        return out->given = (count < 2 || (cli_parse_count(f[1], 1000, &out->count) &&
                                           out->count >= 1 && out->count <= MOST_STEPS)) &&
                            (count < 3 || parse_value(f[2], &out->value));
    }
    out->filter = CLI_NLM;
    return out->given = count >= 1 && count <= 2 && strcmp(f[0], "nlm") == 0 &&
                        (count < 2 || parse_value(f[1], &out->value));
}

const char *cli_resample_text(const cli_resample *r)
{
    static char text[128];
    const char *kernel = r->of_labels ? cw_label_kernel_name((cw_label_kernel)r->label_kernel)
                                      : cw_kernel_name((cw_kernel)r->kernel);
    if (r->iso)
        snprintf(text, sizeof text, "iso:%s", kernel);
    else
        snprintf(text, sizeof text, "%sx%sx%smm:%s", cli_number_text(r->mm[0]),
                 cli_number_text(r->mm[1]), cli_number_text(r->mm[2]), kernel);
    return text;
}

const char *cli_denoise_text(const cli_denoise *d)
{
    static char text[128];
    const char *value = d->value > 0 ? cli_number_text(d->value) : "",
               *colon = d->value > 0 ? ":" : "", *width = cli_length_text(&d->width);
    switch (d->filter) {
    case CLI_GAUSS:
        snprintf(text, sizeof text, "gauss:%s", width);
        break;
    case CLI_MEDIAN:
        snprintf(text, sizeof text, "median:%zu", d->count);
        break;
    case CLI_BILATERAL:
        snprintf(text, sizeof text, "bilateral:%s%s%s", width, colon, value);
        break;
    case CLI_ANISO:
        snprintf(text, sizeof text, "aniso:%zu%s%s", d->count, colon, value);
        break;
    case CLI_NLM:
        snprintf(text, sizeof text, "nlm%s%s", colon, value);
        break;
    }
    return text;
}

static bool parse_smoothing(const cli_option *o, const char *text, void *field)
{
    cli_smoothing *out = field;
    *out = (cli_smoothing){0};
    for (int m = 0; m < CW_SMOOTH_METHOD_COUNT && !out->given; m++) {
        const char *name = cw_smooth_method_name((cw_smooth_method)m);
        const char *rest = text + strlen(name);
        out->given = strncmp(text, name, strlen(name)) == 0 && (*rest == '\0' || *rest == ':');
        out->method = m;
        if (!out->given || *rest == '\0')
            continue;
        out->given = m == CW_SMOOTH_FAIR
                         ? cli_parse_length(rest + 1, o->kind->units, &out->width)
                         : cli_parse_count(rest + 1, 1000, &out->iterations) &&
                               out->iterations >= 1 &&
                               out->iterations <= CW_SMOOTH_MAX_ITERATIONS;
    }
    return out->given;
}

const char *cli_smoothing_text(const cli_smoothing *s)
{
    static char text[64];
    const char *method = cw_smooth_method_name((cw_smooth_method)s->method);
    if (s->iterations)
        snprintf(text, sizeof text, "%s:%zu", method, s->iterations);
    else if (s->width.given)
        snprintf(text, sizeof text, "%s:%s", method, cli_length_text(&s->width));
    else
        snprintf(text, sizeof text, "%s", method);
    return text;
}

/* Parses three numbers with commas between. */
static bool parse_triple(const char **text, double out[3])
{
    for (int a = 0; a < 3; a++) {
        if (a > 0 && *(*text)++ != ',')
            return false;
        if (!cwi_parse_double(text, &out[a]) || !isfinite(out[a]))
            return false;
    }
    return true;
}

/* Parses an offset along an axis: in mm, or percent of the box. */
static bool parse_offset(const char *text, double *offset, bool *is_percent)
{
    cli_length length;
    if (!cli_parse_length(text, CLI_IN_MM | CLI_IN_PERCENT | CLI_SIGNED, &length))
        return false;
    *offset = length.value;
    *is_percent = length.unit == CLI_PERCENT;
    return true;
}

static bool parse_plane(const cli_option *o, const char *text, void *field)
{
    cli_plane *out = field;
    (void)o;
    *out = (cli_plane){.given = false};
    if (strlen(text) >= sizeof out->text)
        return false;
    snprintf(out->text, sizeof out->text, "%s", text);
    const bool is_below = *text == '-' && text[1] >= 'x';
    const char *at = text + is_below;
    if (*at >= 'x' && *at <= 'z') {
        const int axis = *at - 'x';
        out->normal[axis] = is_below ? -1 : 1;
        out->given = at[1] == '=' && parse_offset(at + 2, &out->point[axis], &out->is_percent);
        return out->given;
    }
    out->given = parse_triple(&text, out->point) && *text++ == ':' &&
                 parse_triple(&text, out->normal) && *text == '\0' &&
                 (out->normal[0] != 0 || out->normal[1] != 0 || out->normal[2] != 0);
    return out->given;
}

const char *cli_plane_text(const cli_plane *plane)
{
    return plane->text;
}

/* --- the kinds ---------------------------------------------------------------------------- */

/* Defines print_NAME(), which prints what cli_NAME_text() returns. */
#define PRINTER(name)                                                                          \
    static void print_##name(const cli_option *o, const void *field, char *text, size_t size)  \
    {                                                                                          \
        const cli_##name *value = field;                                                       \
        (void)o;                                                                               \
        if (value->given)                                                                      \
            snprintf(text, size, "%s", cli_##name##_text(value));                              \
    }
PRINTER(denoise)
PRINTER(smoothing)
PRINTER(plane)

/* The kernel that is taken without one depends on what is sampled: values, or labels. */
static void print_resample(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_resample *r = field;
    (void)o;
    if (!r->given)
        return;
    const char *all = cli_resample_text(r);
    const size_t length = r->has_kernel ? strlen(all) : strcspn(all, ":");
    snprintf(text, size, "%.*s", (int)length, all);
}

/* clang-format off */
const cli_kind cli_kind_resample = {sizeof(cli_resample), parse_resample, print_resample,
    "iso, or a length above 0 with its unit, such as 0.5mm or 1x1x2mm; then a kernel, if not linear: "
    "0.5mm:cubic, iso:lanczos; of labels majority or nearest", CLI_UNITS_MM, CLI_IN_MM};
const cli_kind cli_kind_denoise = {sizeof(cli_denoise), parse_denoise, print_denoise,
    "nlm or nlm:NOISE, aniso or aniso:STEPS (1 to 100) or aniso:STEPS:CONTRAST, gauss:L such as "
    "gauss:0.7vox or gauss:0.5mm, bilateral:L or bilateral:L:VALUES, or median:N (1 to 3 voxels)",
    "L has " CLI_UNITS_MM " or vox; N counts voxels", CLI_IN_MM | CLI_IN_VOXELS};
const cli_kind cli_kind_smoothing = {sizeof(cli_smoothing), parse_smoothing, print_smoothing,
    "taubin or hc, with their iterations from 1 to 1000 such as taubin:10, or fair, with a length such "
    "as fair:4vox or fair:2mm", CLI_UNITS_MM ", % of the box's diagonal, or vox",
    CLI_IN_MM | CLI_IN_PERCENT | CLI_IN_VOXELS};
const cli_kind cli_kind_plane = {sizeof(cli_plane), parse_plane, print_plane,
    "an axis with a place and its unit, such as z=5mm, z=10% of the box, or -z=5mm to keep the other side; or a "
    "point and a normal such as 0,0,5:0,0.1,1",
    "a place on an axis has " CLI_UNITS_MM " or % of the box; a point is in LPS mm", CLI_IN_MM | CLI_IN_PERCENT | CLI_SIGNED};
/* clang-format on */
