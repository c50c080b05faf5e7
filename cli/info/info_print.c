/* Prints the facts of a volume, and the series of a folder. */
#include "cli/info/info_facts.h"

#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "cli/framework/run_config.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Arrays of one name, at points and at cells, cannot be told apart: the second has no range. */
bool cli_info_is_reached(const cli_info_facts *f, size_t n)
{
    for (size_t i = 0; i < f->array_count; i++)
        if (i != n && strcmp(f->arrays[i].name, f->arrays[n].name) == 0 &&
            f->arrays[n].of_cells && !f->arrays[i].of_cells)
            return false;
    return f->arrays[n].is_read;
}

static bool has_ranges(const cli_info_facts *f, size_t n)
{
    return cli_info_is_reached(f, n) && !isnan(f->ranges[n * CLI_INFO_COMPONENTS][0]);
}

/* "left 0.00, posterior -1.00, ..." : the world direction that each index axis mostly
 * runs to. */
static const char *axis_letters(const cw_volume *v)
{
    static char text[8];
    for (int c = 0; c < 3; c++) {
        int largest = 0;
        for (int r = 1; r < 3; r++)
            if (fabs(v->affine[r][c]) > fabs(v->affine[largest][c]))
                largest = r;
        text[c] = v->affine[largest][c] >= 0 ? "LPS"[largest] : "RAI"[largest];
    }
    return text;
}

static void print_steps(const cw_volume *v)
{
    if (v->step_seconds > 0)
        printf("  steps    %zu, %.6g s apart\n", v->steps, v->step_seconds);
    else
        printf("  steps    %zu, no times named\n", v->steps);
}

/* Of a rectilinear grid: the steps that the line above gives the mean of. */
static void print_spacing(const cli_volume *volume)
{
    double range[3][2];
    if (!cwi_is_rectilinear(&volume->whole))
        return;
    for (int a = 0; a < 3; a++)
        cli_spacing_range(volume, a, range[a]);
    printf("  spacing  x %.6g to %.6g, y %.6g to %.6g, z %.6g to %.6g mm\n", range[0][0],
           range[0][1], range[1][0], range[1][1], range[2][0], range[2][1]);
}

static const char *frame_of(const cw_volume *v)
{
    return v->known & CW_KNOWN_FRAME ? "LPS" : "not named, taken as LPS";
}

static void print_frame(const cli_volume *volume)
{
    const cw_volume *v = &volume->whole;
    const double *s = volume->spacing;
    const double last[3] = {(double)(v->dim[0] - 1), (double)(v->dim[1] - 1),
                            (double)(v->dim[2] - 1)};
    double from[3], to[3];
    cw_volume_to_world(v, (const double[3]){0, 0, 0}, from);
    cw_volume_to_world(v, last, to);
    print_spacing(volume);
    printf("  size     %.6g x %.6g x %.6g mm\n", last[0] * s[0], last[1] * s[1],
           last[2] * s[2]);
    printf("  frame    %s, axes run to %s; first voxel (%.6g, %.6g, %.6g), last (%.6g, %.6g, "
           "%.6g)\n",
           frame_of(v), axis_letters(v), from[0], from[1], from[2], to[0], to[1], to[2]);
}

/* Of an irregular grid, which has no axes. */
static void print_box(const cli_volume *volume)
{
    const double *low = volume->grid.low, *high = volume->grid.high;
    printf("  size     %.6g x %.6g x %.6g mm\n", high[0] - low[0], high[1] - low[1],
           high[2] - low[2]);
    printf("  cells    edges of %.6g mm on average\n", volume->spacing[0]);
    printf("  frame    %s; box from (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g)\n",
           frame_of(&volume->whole), low[0], low[1], low[2], high[0], high[1], high[2]);
}

static void print_arrays(const cli_info_facts *f)
{
    for (size_t n = 0; n < f->array_count; n++) {
        const cw_array *a = &f->arrays[n];
        printf("  array    '%s', %zu x %s%s%s", a->name, a->components,
               *a->type ? a->type : "of a type that is not read",
               a->of_cells ? ", of cells" : "",
               !a->is_read     ? ", not read"
               : a->is_default ? ", taken unless --array names another"
                               : "");
        for (size_t c = 0; c < a->components && has_ranges(f, n); c++) {
            const double *r = f->ranges[n * CLI_INFO_COMPONENTS + c];
            printf("%s %.6g to %.6g", c ? "," : ":", r[0], r[1]);
        }
        puts("");
    }
}

static void json_arrays(cli_json *j, const cli_info_facts *f)
{
    if (!f->array_count)
        return;
    cli_json_open(j, "arrays", '[');
    for (size_t n = 0; n < f->array_count; n++) {
        const cw_array *a = &f->arrays[n];
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "name", a->name);
        cli_json_text(j, "type", a->type);
        cli_json_count(j, "components", a->components);
        cli_json_text(j, "of", a->of_cells ? "cells" : "points");
        cli_json_bool(j, "read", a->is_read);
        cli_json_bool(j, "default", a->is_default);
        if (has_ranges(f, n)) {
            cli_json_open(j, "ranges", '[');
            for (size_t c = 0; c < a->components; c++)
                cli_json_numbers(j, NULL, f->ranges[n * CLI_INFO_COMPONENTS + c], 2);
            cli_json_close(j, ']');
        }
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void print_geometry(const cli_info_facts *f)
{
    const cw_volume *v = &f->volume.whole;
    printf("%s\n  %s\n", f->volume.path, cli_describe(&f->volume));
    if (v->cells)
        print_box(&f->volume);
    else
        print_frame(&f->volume);
    if (v->steps > 1)
        print_steps(v);
    if (v->slope != 1 || v->intercept != 0)
        printf("  scaling  value = %.10g * voxel + %.10g\n", v->slope, v->intercept);
    if (f->series.images)
        printf("  series   %s %s, %zu images, tilt %.3g degrees\n", f->series.label,
               f->series.modality, f->series.images, f->series.tilt_degrees);
    print_arrays(f);
    cli_print_scales(&f->scales);
    for (size_t n = 0; n < f->volume.note_count; n++)
        if (!f->array_count ||
            !strstr(f->volume.notes[n], "; --array takes")) /* listed above */
            printf("  note     %s\n", f->volume.notes[n]);
}

static bool is_sampled(const cli_info_facts *f)
{
    return cli_is_preview(&f->volume);
}

static void print_values(const cli_info_facts *f, size_t chosen)
{
    const cw_statistics *r = &f->range;
    const cw_label_ids *ids = &f->volume.ids;
    if (ids->count > 1) {
        const cw_label first = cw_label_ids_label(ids, 1),
                       last = cw_label_ids_label(ids, (uint32_t)ids->count - 1);
        char low[CW_LABEL_NUMBER], high[CW_LABEL_NUMBER];
        printf("  values   numbers of labels, %s to %s", cw_label_number(&first, low),
               cw_label_number(&last, high));
    } else {
        printf("  values   %.10g to %.10g", r->min, r->max);
    }
    if (f->volume.whole.steps > 1)
        printf(" in step %zu", chosen);
    if (r->not_finite)
        printf(", %s not finite", cli_count(r->not_finite));
    if (r->nodata)
        printf(", %s no-data", cli_count(r->nodata));
    if (is_sampled(f))
        printf(" in one row of %zu, one slice of %zu (--deep reads all)", f->volume.coarsen[1],
               f->volume.coarsen[2]);
    puts("");
    for (size_t b = 0; b < r->bin_count; b++)
        printf("  %12.6g  %s\n", r->min + (double)b * r->bin_width,
               cli_count((size_t)r->bins[b]));
}

static void print_levels(const cli_info_facts *f, bool predicted)
{
    for (int n = 0; n < f->level_count; n++) {
        const cli_info_level *l = &f->levels[n];
        printf("  level    %-7s--iso %.6g", l->name, l->value);
        if (predicted)
            printf("  %s triangles, STL %s", cli_count(l->triangles),
                   cli_bytes((double)cli_stl_bytes(l->triangles)));
        puts("");
    }
}

static void json_series(cli_json *j, const cw_series *s)
{
    cli_json_text(j, "label", s->label);
    cli_json_text(j, "modality", s->modality);
    cli_json_count(j, "images", s->images);
    if (s->status == CW_OK)
        cli_json_number(j, "tilt_degrees", s->tilt_degrees);
}

/* Tells the range of values that are numbers of labels. */
static void json_ids(cli_json *j, const cw_label_ids *ids)
{
    const uint32_t ends[2] = {0, (uint32_t)ids->count - 1};
    cli_json_open(j, "range", '[');
    for (int n = 0; n < 2; n++) {
        const cw_label label = cw_label_ids_label(ids, ends[n]);
        cli_json_label(j, NULL, &label);
    }
    cli_json_close(j, ']');
}

void cli_json_info(const cli_info_facts *f, bool predicted)
{
    const cw_statistics *r = &f->range;
    cli_json j = {.out = stdout};
    cli_json_begin(&j, "cubewright-info-1");
    cli_json_input(&j, "input", &f->volume);
    if (f->series.images) {
        cli_json_open(&j, "series", '{');
        json_series(&j, &f->series);
        cli_json_close(&j, '}');
    }
    json_arrays(&j, f);
    cli_json_scales(&j, &f->scales);
    cli_json_label_facts(&j, &f->labels);
    cli_json_within(&j, &f->within);
    if (f->volume.ids.count)
        json_ids(&j, &f->volume.ids);
    else
        cli_json_numbers(&j, "range", (const double[2]){r->min, r->max}, 2);
    if (is_sampled(f))
        cli_json_numbers(
            &j, "sampled",
            (const double[3]){1, (double)f->volume.coarsen[1], (double)f->volume.coarsen[2]},
            3);
    cli_json_count(&j, "finite", r->finite);
    cli_json_count(&j, "not_finite", r->not_finite);
    cli_json_count(&j, "nodata", r->nodata);
    if (r->bin_count) {
        cli_json_number(&j, "bin_width", r->bin_width);
        cli_json_open(&j, "histogram", '[');
        for (size_t b = 0; b < r->bin_count; b++)
            cli_json_count(&j, NULL, (size_t)r->bins[b]);
        cli_json_close(&j, ']');
    }
    cli_json_open(&j, "levels", '[');
    for (int n = 0; n < f->level_count; n++) {
        cli_json_open(&j, NULL, '{');
        cli_json_text(&j, "name", f->levels[n].name);
        cli_json_number(&j, "iso", f->levels[n].value);
        if (predicted)
            cli_json_count(&j, "triangles", f->levels[n].triangles);
        cli_json_close(&j, '}');
    }
    cli_json_close(&j, ']');
    cli_json_predictions(&j, &f->predictions);
    cli_json_label_prediction(&j, &f->label_prediction);
    cli_json_close(&j, '}');
}

void cli_print_info(const cli_info_facts *f, size_t step, bool predicted)
{
    print_geometry(f);
    print_values(f, step);
    cli_print_label_facts(&f->labels, is_sampled(f));
    cli_print_within(&f->within);
    print_levels(f, predicted);
    cli_print_predictions(&f->predictions);
    cli_print_label_prediction(&f->label_prediction);
}

/* --- series ------------------------------------------------------------------------------- */

static const char *shape_of(const cw_series *s)
{
    static char text[128];
    double spacing[3];
    const size_t *dim = s->shape.dim;
    int n = snprintf(text, sizeof text, "%zu x %zu x %zu %s", dim[0], dim[1], dim[2],
                     cw_type_name(s->shape.type));
    if (s->status != CW_OK)
        return text;
    cw_volume_spacing(&s->shape, spacing);
    if (s->shape.steps > 1)
        n += snprintf(text + n, sizeof text - (size_t)n, ", %zu steps", s->shape.steps);
    snprintf(text + n, sizeof text - (size_t)n, ", %.6g x %.6g x %.6g %s, tilt %.3g",
             spacing[0], spacing[1], spacing[2],
             s->shape.known & CW_KNOWN_UNIT ? "mm" : "(no unit)", s->tilt_degrees);
    return text;
}

void cli_print_series(const cli_volume *notes, const cw_series *series, size_t count)
{
    printf("%s\n", notes->path);
    for (size_t n = 0; n < count; n++) {
        const cw_series *s = &series[n];
        printf("  series %-6s %-4s %4zu images  %s%s%s\n", s->label, s->modality, s->images,
               shape_of(s), s->finding[0] ? "\n    " : "",
               cli_name_options(s->finding, (char[CLI_MESSAGE]){0}));
    }
    for (size_t n = 0; n < notes->note_count; n++)
        printf("  note   %s\n", notes->notes[n]);
}

static void json_shape(cli_json *j, const cw_series *s)
{
    const double dims[3] = {(double)s->shape.dim[0], (double)s->shape.dim[1],
                            (double)s->shape.dim[2]};
    double spacing[3];
    cli_json_numbers(j, "dims", dims, 3);
    cli_json_text(j, "type", cw_type_name(s->shape.type));
    if (s->status == CW_OK) {
        cw_volume_spacing(&s->shape, spacing);
        cli_json_numbers(j, "spacing", spacing, 3);
        cli_json_count(j, "steps", s->shape.steps);
    }
    cli_json_text(j, "status", cw_status_name(s->status));
    cli_json_message(j, "finding", s->finding);
}

void cli_json_all_series(const cli_volume *notes, const cw_series *series, size_t count)
{
    cli_json j = {.out = stdout};
    cli_json_begin(&j, "cubewright-series-1");
    cli_json_text(&j, "path", cli_shown_path(notes->path));
    cli_json_open(&j, "series", '[');
    for (size_t n = 0; n < count; n++) {
        cli_json_open(&j, NULL, '{');
        json_series(&j, &series[n]);
        json_shape(&j, &series[n]);
        cli_json_close(&j, '}');
    }
    cli_json_close(&j, ']');
    cli_json_notes(&j, notes);
    cli_json_close(&j, '}');
}
