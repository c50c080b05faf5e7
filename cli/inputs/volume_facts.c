/* Describes a volume that was read: notes, its grid in words and in JSON, and whether its
 * values are Hounsfield units. */
#include "cli/inputs/volume_input.h"

#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/standard_streams.h"
#include "core/volume/volume.h"

#include <math.h>
#include <sha2.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Says what the reader decided, and keeps it for reports. Irregular grids are known only once
 * they are read, and tell then what their header told, too. */
void cli_take_note(void *user, const char *text)
{
    char note[CLI_MESSAGE];
    cli_volume *volume = user;
    text = cli_name_options(text, note);
    for (size_t n = 0; n < volume->note_count; n++)
        if (strcmp(volume->notes[n], text) == 0)
            return;
    if (!volume->is_quiet)
        cli_say("%s: %s", volume->path, text);
    if (volume->note_count < CLI_MAX_NOTES)
        snprintf(volume->notes[volume->note_count++], sizeof *volume->notes, "%s", text);
}

void cli_note_volume(cli_volume *volume, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    cli_take_note(volume, text);
}

const char *cli_shown_path(const char *path)
{
    const char *slash = strrchr(path, '/');
    return path[0] == '/' && slash ? slash + 1 : path;
}

static const char *shape_name(int shape, size_t count)
{
    static const char *const names[CW_SHAPE_COUNT][2] = {
        [CW_TETRAHEDRON] = {"tetrahedra", "tetrahedron"},
        [CW_PYRAMID] = {"pyramids", "pyramid"},
        [CW_WEDGE] = {"wedges", "wedge"},
        [CW_HEXAHEDRON] = {"hexahedra", "hexahedron"}};
    return names[shape][count == 1];
}

/* Returns true for formats that can state the directions of axes. */
static bool can_state_frame(const char *format)
{
    static const char *const formats[] = {"nrrd", "nifti", "metaimage", "dicom"};
    for (size_t n = 0; n < sizeof formats / sizeof *formats; n++)
        if (strcmp(format, formats[n]) == 0)
            return true;
    return false;
}

/* Says the unit, and what the file might have stated and does not. */
static const char *unit_of(const cli_volume *volume)
{
    const unsigned known = volume->whole.known;
    const bool lacks_frame = !(known & CW_KNOWN_FRAME) && can_state_frame(volume->format);
    if (known & CW_KNOWN_UNIT)
        return lacks_frame ? "mm (no frame given: taken as LPS)" : "mm";
    return lacks_frame ? "(no unit and no frame given: taken as mm in LPS)"
                       : "(no unit given: taken as mm)";
}

static const char *describe_grid(const cli_volume *volume)
{
    static char text[256];
    const cw_volume *v = &volume->whole;
    int n = snprintf(text, sizeof text, "%s, %zu samples %s", volume->format, v->dim[0],
                     cw_type_name(v->type));
    if (v->components > 1)
        n += snprintf(text + n, sizeof text - (size_t)n, ", %zu components", v->components);
    for (int s = 0; s < CW_SHAPE_COUNT; s++)
        if (volume->grid.cells[s])
            n += snprintf(text + n, sizeof text - (size_t)n, ", %zu %s", volume->grid.cells[s],
                          shape_name(s, volume->grid.cells[s]));
    snprintf(text + n, sizeof text - (size_t)n, " %s", unit_of(volume));
    return text;
}

const char *cli_describe(const cli_volume *volume)
{
    static char text[256];
    const cw_volume *v = &volume->whole;
    const double *s = volume->spacing;
    if (v->cells)
        return describe_grid(volume);
    int n = snprintf(text, sizeof text, "%s, %zu x %zu x %zu %s", volume->format, v->dim[0],
                     v->dim[1], v->dim[2], cw_type_name(v->type));
    if (v->components > 1)
        n += snprintf(text + n, sizeof text - (size_t)n, ", %zu components", v->components);
    if (v->steps > 1)
        n += snprintf(text + n, sizeof text - (size_t)n, ", %zu time steps", v->steps);
    snprintf(text + n, sizeof text - (size_t)n, ", %s%.6g x %.6g x %.6g %s",
             cwi_is_rectilinear(v) ? "rectilinear, on average " : "", s[0], s[1], s[2],
             unit_of(volume));
    return text;
}

void cli_spacing_range(const cli_volume *volume, int axis, double mm[2])
{
    const cw_volume *v = &volume->whole;
    const double *at = v->coordinates[axis], (*m)[4] = v->affine;
    const double scale = hypot(hypot(m[0][axis], m[1][axis]), m[2][axis]);
    mm[0] = v->dim[axis] > 1 ? INFINITY : volume->spacing[axis];
    mm[1] = v->dim[axis] > 1 ? 0 : volume->spacing[axis];
    for (size_t i = 1; i < v->dim[axis]; i++) {
        mm[0] = fmin(mm[0], scale * (at[i] - at[i - 1]));
        mm[1] = fmax(mm[1], scale * (at[i] - at[i - 1]));
    }
}

static void json_coordinates(cli_json *j, const cli_volume *volume)
{
    const cw_volume *v = &volume->whole;
    double range[2];
    cli_json_open(j, "coordinates", '[');
    for (int a = 0; a < 3; a++) {
        const double *at = v->coordinates[a];
        cli_json_numbers(j, NULL, (double[2]){at[0], at[v->dim[a] - 1]}, 2);
    }
    cli_json_close(j, ']');
    cli_json_open(j, "spacing_ranges", '[');
    for (int a = 0; a < 3; a++) {
        cli_spacing_range(volume, a, range);
        cli_json_numbers(j, NULL, range, 2);
    }
    cli_json_close(j, ']');
}

static void json_sparse(cli_json *j, const cw_volume *v)
{
    cli_json_open(j, "sparse", '{');
    cli_json_count(j, "leaves", v->sparse->leaf_count);
    cli_json_count(j, "tiles", v->sparse->tile_count);
    cli_json_number(j, "background", v->sparse->background);
    cli_json_bool(j, "level_set", v->known & CW_KNOWN_LEVEL_SET);
    cli_json_close(j, '}');
}

static void json_grid(cli_json *j, const cli_grid *grid, double spacing)
{
    cli_json_open(j, "cells", '{');
    for (int s = 0; s < CW_SHAPE_COUNT; s++)
        cli_json_count(j, shape_name(s, 0), grid->cells[s]);
    cli_json_close(j, '}');
    if (!grid->has_box)
        return;
    cli_json_open(j, "box", '[');
    cli_json_numbers(j, NULL, grid->low, 3);
    cli_json_numbers(j, NULL, grid->high, 3);
    cli_json_close(j, ']');
    cli_json_number(j, "mean_edge", spacing);
}

void cli_json_notes(cli_json *j, const cli_volume *volume)
{
    cli_json_open(j, "notes", '[');
    for (size_t n = 0; n < volume->note_count; n++)
        cli_json_text(j, NULL, volume->notes[n]);
    cli_json_close(j, ']');
}

void cli_json_input(cli_json *j, const char *key, const cli_volume *volume)
{
    const cw_volume *v = &volume->whole;
    const double dims[3] = {(double)v->dim[0], (double)v->dim[1], (double)v->dim[2]};
    char sum[SHA256_DIGEST_STRING_LENGTH];
    cli_json_open(j, key, '{');
    cli_json_text(j, "path", cli_shown_path(volume->path));
    cli_json_text(j, "kind", volume->format);
    cli_json_numbers(j, "dims", dims, 3);
    cli_json_text(j, "type", cw_type_name(v->type));
    cli_json_count(j, "components", v->components);
    cli_json_count(j, "steps", v->steps);
    if (v->cells)
        json_grid(j, &volume->grid, volume->spacing[0]);
    else
        cli_json_numbers(j, "spacing", volume->spacing, 3);
    cli_json_bool(j, "rectilinear", cwi_is_rectilinear(v));
    if (v->sparse)
        json_sparse(j, v);
    if (cwi_is_rectilinear(v))
        json_coordinates(j, volume);
    cli_json_text(j, "unit", v->known & CW_KNOWN_UNIT ? "mm" : "unknown");
    cli_json_text(j, "frame", v->known & CW_KNOWN_FRAME ? "LPS" : "unknown");
    cli_json_open(j, "affine", '[');
    for (int r = 0; r < 3; r++)
        cli_json_numbers(j, NULL, v->affine[r], 4);
    cli_json_close(j, ']');
    cli_json_notes(j, volume);
    if (SHA256File(cli_bytes_path(volume->path), sum))
        cli_json_text(j, "sha256", sum);
    cli_json_close(j, '}');
}

void cli_describe_labels(const cli_volume *volume, const cw_labels *labels,
                         char text[CLI_LABELS_TEXT])
{
    const cw_volume *v = &volume->voxels;
    const size_t zeros = labels->count && labels->value[0] == 0, count = labels->count - zeros;
    int n = snprintf(text, CLI_LABELS_TEXT, "%s label map (%s%zu label%s",
                     v->known & CW_KNOWN_LABELS ? "is a" : "looks like a",
                     labels->more ? "more than " : "", count, count == 1 ? "" : "s");
    const cw_label_ids *ids = &volume->ids;
    if (ids->count > 1) {
        const cw_label first = cw_label_ids_label(ids, 1),
                       last = cw_label_ids_label(ids, (uint32_t)ids->count - 1);
        char low[CW_LABEL_NUMBER], high[CW_LABEL_NUMBER];
        n += snprintf(text + n, CLI_LABELS_TEXT - (size_t)n, ", %s to %s",
                      cw_label_number(&first, low), cw_label_number(&last, high));
    } else if (count && !labels->more)
        n += snprintf(text + n, CLI_LABELS_TEXT - (size_t)n, ", %.10g to %.10g",
                      labels->value[zeros], labels->value[labels->count - 1]);
    snprintf(text + n, CLI_LABELS_TEXT - (size_t)n, "%s)",
             v->components > 1 ? " in component 0" : "");
}

void cli_free_volume(cli_volume *volume)
{
    cw_label_table_free(&volume->labels);
    cw_label_ids_free(&volume->ids);
    cw_volume_free(&volume->whole);
    cw_volume_free(&volume->voxels);
    cw_volume_free(&volume->magnitude);
    cw_volume_free(&volume->prepared);
}
