/* Reads the images of OME-Zarr: axes, units, levels, and the roles of dimensions. */
#include "formats/zarr/zarr_image.h"

#include "core/base/status.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { MAX_COMPONENTS = 16 };

/* Returns the first image in several sizes of a node, or NULL. */
static const json_t *find_multiscale(const cwi_zarr_node *node)
{
    return json_array_get(json_object_get(node->ome, "multiscales"), 0);
}

size_t cwi_zarr_level_count(const cwi_zarr_node *node)
{
    return json_array_size(json_object_get(find_multiscale(node), "datasets"));
}

static const json_t *find_level(const cwi_zarr_node *node, size_t level)
{
    return json_array_get(json_object_get(find_multiscale(node), "datasets"), level);
}

cw_status cwi_zarr_level_path(const cwi_zarr_node *node, size_t level,
                              char path[CWI_ZARR_KEY_BYTES], cw_error *err)
{
    const json_t *dataset = find_level(node, level);
    const char *text = cwi_zarr_text(dataset, "path");
    cw_status st = CW_OK;
    char subject[48];
    if (cwi_zarr_level_count(node) > CWI_ZARR_LEVELS)
        st = cwi_fail(err, CW_ERR_LIMIT, "%zu levels; at most %d are read",
                      cwi_zarr_level_count(node), CWI_ZARR_LEVELS);
    if (st == CW_OK && !text)
        st = cwi_zarr_fail(err, dataset, "path", "the path of an array");
    if (st == CW_OK)
        st = cwi_zarr_join(node->path, text, path, err);
    snprintf(subject, sizeof subject, "datasets[%zu]", level);
    return st == CW_OK ? CW_OK
                       : cwi_zarr_fail_in(err, cwi_fail_in(err, st, subject), node, true);
}

/* --- axes ----------------------------------------------------------------------------------- */

/* The units of OME-Zarr: length in millimetres, time in seconds. */
static const struct {
    const char *name;
    double value;
} lengths[] =
    {{"angstrom", 1e-7},   {"picometer", 1e-9}, {"nanometer", 1e-6}, {"micrometer", 1e-3},
     {"micron", 1e-3},     {"microns", 1e-3},   {"millimeter", 1},   {"centimeter", 10},
     {"decimeter", 100},   {"meter", 1000},     {"decameter", 1e4},  {"hectometer", 1e5},
     {"kilometer", 1e6},   {"inch", 25.4},      {"foot", 304.8},     {"yard", 914.4},
     {"mile", 1609344},    {"nm", 1e-6},        {"um", 1e-3},        {"\xc2\xb5m", 1e-3},
     {"\xce\xbcm", 1e-3},  {"mm", 1},           {"cm", 10},          {"m", 1000},
     {"femtometer", 1e-12}},
  times[] = {{"nanosecond", 1e-9}, {"microsecond", 1e-6}, {"millisecond", 1e-3}, {"second", 1},
             {"minute", 60},       {"hour", 3600},        {"day", 86400},        {"s", 1},
             {"ms", 1e-3}};

void cwi_zarr_read_unit(const char *text, cwi_zarr_axis *axis)
{
    axis->unit = 1;
    for (size_t n = 0; text && axis->role <= CWI_AXIS_Z && n < sizeof lengths / sizeof *lengths;
         n++)
        if (strcmp(text, lengths[n].name) == 0) {
            axis->unit = lengths[n].value;
            axis->has_unit = true;
        }
    for (size_t n = 0; text && axis->role == CWI_AXIS_STEP && n < sizeof times / sizeof *times;
         n++)
        if (strcmp(text, times[n].name) == 0) {
            axis->unit = times[n].value;
            axis->has_unit = true;
        }
}

bool cwi_zarr_name_role(const char *name, cwi_role *role)
{
    static const struct {
        const char *name;
        cwi_role role;
    } names[] = {{"x", CWI_AXIS_X},
                 {"y", CWI_AXIS_Y},
                 {"z", CWI_AXIS_Z},
                 {"c", CWI_AXIS_COMPONENT},
                 {"channel", CWI_AXIS_COMPONENT},
                 {"t", CWI_AXIS_STEP},
                 {"time", CWI_AXIS_STEP}};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (strcasecmp(name, names[n].name) == 0) {
            *role = names[n].role;
            return true;
        }
    return false;
}

/* Returns the role of an axis by its type where its name does not tell. Axes of space with other
 * names get theirs later. */
static cwi_role find_typed_role(const char *name, const char *type)
{
    cwi_role role = CWI_ROLE_COUNT;
    if (type && strcmp(type, "channel") == 0)
        return CWI_AXIS_COMPONENT;
    if (type && strcmp(type, "time") == 0)
        return CWI_AXIS_STEP;
    cwi_zarr_name_role(name, &role);
    return role;
}

cw_status cwi_zarr_check_roles(const cwi_zarr_frame *frame, const cwi_zarr_array *array,
                               cw_error *err)
{
    unsigned taken = 0;
    for (size_t d = 0; d < frame->rank; d++) {
        const cwi_zarr_axis *axis = &frame->axes[d];
        if (axis->role == CWI_ROLE_COUNT && array->shape[d] > 1)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'axes' names '%s' with %zu entries; x, y, z, c or t was expected",
                            axis->name, array->shape[d]);
        if (axis->role != CWI_ROLE_COUNT && taken & 1U << axis->role)
            return cwi_fail(err, CW_ERR_FORMAT, "'axes' names '%s' beside another of its kind",
                            axis->name);
        taken |= axis->role != CWI_ROLE_COUNT ? 1U << axis->role : 0;
    }
    return CW_OK;
}

/* Returns the list of axes: of version 0.4 and 0.5, else of the first coordinate system of
 * later ones. */
static const json_t *find_axes(const json_t *multiscale)
{
    const json_t *systems = json_object_get(multiscale, "coordinateSystems");
    const json_t *axes = json_object_get(multiscale, "axes");
    return axes ? axes : json_object_get(json_array_get(systems, 0), "axes");
}

static cw_status read_axes(const json_t *list, const cwi_zarr_array *array,
                           cwi_zarr_frame *frame, cw_error *err)
{
    if (json_array_size(list) != array->rank)
        return cwi_fail(err, CW_ERR_FORMAT, "'axes' lists %zu; the array has %zu dimensions",
                        json_array_size(list), array->rank);
    for (size_t d = 0; d < array->rank; d++) {
        const json_t *item = json_array_get(list, d);
        const char *name = cwi_zarr_text(item, "name");
        cwi_zarr_axis *axis = &frame->axes[d];
        if (!name && !(name = json_string_value(item))) /* a text in version 0.3 */
            return cwi_fail(err, CW_ERR_FORMAT, "'axes[%zu]' has no name", d);
        snprintf(axis->name, sizeof axis->name, "%s", name);
        axis->role = find_typed_role(name, cwi_zarr_text(item, "type"));
        cwi_zarr_read_unit(cwi_zarr_text(item, "unit"), axis);
    }
    return cwi_zarr_check_roles(frame, array, err);
}

/* --- frames --------------------------------------------------------------------------------- */

void cwi_zarr_start_frame(const cwi_zarr_array *array, cwi_zarr_frame *frame)
{
    *frame = (cwi_zarr_frame){.rank = array->rank};
    for (size_t d = 0; d < array->rank; d++) {
        frame->matrix[d][d] = 1;
        frame->axes[d].unit = 1;
        frame->axes[d].role = CWI_ROLE_COUNT;
    }
}

/* Gives roles by place: the last is x. A fourth one from the end is components, unless there are
 * too many for a voxel: then it is steps, as is a fifth. */
static void place_roles(const cwi_zarr_array *array, cwi_zarr_frame *frame)
{
    static const char *const names[] = {"x", "y", "z", "c", "t"};
    for (size_t n = 0; n < array->rank; n++) {
        const size_t d = array->rank - 1 - n;
        cwi_role role = n < CWI_ROLE_COUNT ? (cwi_role)n : CWI_ROLE_COUNT;
        if (n == 3 && array->rank == 4 && array->shape[d] > MAX_COMPONENTS)
            role = CWI_AXIS_STEP;
        frame->axes[d].role = role;
        snprintf(frame->axes[d].name, sizeof frame->axes[d].name, "%s",
                 role < CWI_ROLE_COUNT ? names[role] : "?");
    }
}

void cwi_zarr_plain_frame(const cwi_zarr_array *array, cwi_zarr_frame *frame)
{
    bool known = array->has_names;
    cwi_zarr_start_frame(array, frame);
    for (size_t d = 0; known && d < array->rank; d++) {
        snprintf(frame->axes[d].name, sizeof frame->axes[d].name, "%s", array->names[d]);
        known =
            cwi_zarr_name_role(array->names[d], &frame->axes[d].role) || array->shape[d] == 1;
    }
    if (!known || cwi_zarr_check_roles(frame, array, NULL) != CW_OK)
        place_roles(array, frame);
}

cw_status cwi_zarr_level_frame(const cwi_zarr_node *node, size_t level,
                               const cwi_zarr_node *level_node, const cwi_zarr_array *array,
                               cwi_zarr_frame *frame, cw_error *err)
{
    (void)level_node; /* the image tells all */
    const json_t *multiscale = find_multiscale(node), *axes = find_axes(multiscale);
    const json_t *dataset = find_level(node, level);
    cw_status st = CW_OK;
    char subject[48];
    cwi_zarr_start_frame(array, frame);
    if (axes)
        st = read_axes(axes, array, frame, err);
    else
        cwi_zarr_plain_frame(array, frame);
    if (st == CW_OK && (st = cwi_zarr_transform(dataset, frame, err)) != CW_OK) {
        snprintf(subject, sizeof subject, "datasets[%zu]", level);
        cwi_fail_in(err, st, subject);
    }
    /* From 0.6 on those of the whole lead to further coordinate systems. */
    if (st == CW_OK && !json_object_get(multiscale, "coordinateSystems"))
        st = cwi_zarr_transform(multiscale, frame, err);
    return st == CW_OK ? CW_OK : cwi_zarr_fail_in(err, st, node, true);
}
