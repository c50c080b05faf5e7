/* Parses the attributes of .vti and .vtr elements, and ranks their arrays. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/vtk/vti.h"

#include <stdio.h>
#include <string.h>

static cw_status parse_numbers(cwi_attributes a, const char *name, size_t count, double *out,
                               cw_error *err)
{
    const char *value = cwi_attribute(a, name);
    return value ? cwi_field_doubles(name, value, count, "ImageData", out, err) : CW_OK;
}

cw_status cwi_vti_check_times(cwi_attributes a, cw_error *err)
{
    const char *times = cwi_attribute(a, "TimeValues");
    if (!times || !strchr(times, ' '))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'TimeValues' is '%.40s'; several time steps in one file are not read",
                    times);
}

cw_status cwi_vti_image(cwi_vti *v, cwi_attributes a, cw_error *err)
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int i = 0; i < 3; i++)
        v->spacing[i] = 1;
    memcpy(v->direction, identity, sizeof identity);
    cw_status st = cwi_vti_check_times(a, err);
    if (st == CW_OK)
        st = parse_numbers(a, "Origin", 3, v->origin, err);
    if (st == CW_OK)
        st = parse_numbers(a, "Spacing", 3, v->spacing, err);
    return st == CW_OK ? parse_numbers(a, "Direction", 9, v->direction, err) : st;
}

cw_status cwi_vti_extent(cwi_attributes a, const char *name, int64_t extent[6], cw_error *err)
{
    const char *text = cwi_attribute(a, name), *s = text ? text : "";
    for (int i = 0; i < 6; i++)
        if (!cwi_parse_int(&s, &extent[i]) || extent[i] > INT32_MAX || extent[i] < INT32_MIN)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' is '%.60s'; six whole numbers were expected", name,
                            text ? text : "");
    for (int i = 0; i < 6; i += 2)
        if (extent[i + 1] < extent[i] || extent[i + 1] - extent[i] >= INT32_MAX)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "'%s' is '%.60s'; it must hold 1 to 2147483647 points along each axis", name,
                text);
    return CW_OK;
}

/* Adds a piece. Arrays are listed of the first one: all have the same. */
cw_status cwi_vti_piece(cwi_vti_file *f, cwi_attributes a, cw_error *err)
{
    cwi_vti *pieces = cwi_grow_array(f->pieces, f->count, &f->capacity, sizeof *pieces);
    if (!pieces)
        return cwi_fail_memory(err);
    f->pieces = pieces;
    if (f->count)
        f->choice.list = NULL;
    cwi_vti *v = &f->pieces[f->count++];
    *v = f->common;
    return cwi_vti_extent(a, "Extent", v->extent, err);
}

void cwi_vti_data_start(cwi_vti_data *data, bool of_cells, cwi_attributes a)
{
    const char *scalars = cwi_attribute(a, "Scalars");
    snprintf(data->scalars, sizeof data->scalars, "%s", scalars ? scalars : "");
    data->of_cells = of_cells;
}

static void note_other(cwi_vti_choice *choice, const cwi_vtk_array *array)
{
    const size_t used = strlen(choice->others), left = sizeof choice->others - used;
    char text[2 * CWI_WORD_BYTES + 40];
    snprintf(text, sizeof text, "'%s' (%zu %s)", array->name, array->components,
             *array->type_name ? array->type_name : "of no type");
    if (!strstr(choice->others, text)) /* other pieces have the same */
        snprintf(choice->others + used, left, "%s%s", used ? ", " : "", text);
}

static cwi_vti_rank rank_of(const cwi_vti_choice *choice, const cwi_vti_data *data,
                            const cwi_vtk_array *array)
{
    if (choice->expected)
        return strcmp(array->name, choice->expected) == 0 ? CWI_VTI_REQUESTED : CWI_VTI_NONE;
    if (*array->name && strcmp(array->name, data->scalars) == 0)
        return CWI_VTI_SCALARS;
    return array->stored            ? CWI_VTI_WIDE
           : array->components == 1 ? CWI_VTI_ONE
                                    : CWI_VTI_SEVERAL;
}

/* Returns true for the array that tells which points or cells are hidden or another piece's. */
static bool are_marks(const cwi_vti_choice *choice, const char *name)
{
    return strncmp(name, "vtkGhost", 8) == 0 &&
           !(choice->expected && strcmp(choice->expected, name) == 0);
}

cw_status cwi_vti_data_array(cwi_vti_choice *choice, cwi_vti_data *data, cwi_attributes a,
                             bool *kept, cw_error *err)
{
    cwi_vti_array array = {0};
    cw_status st = cwi_vtk_xml_array(&array.data, a, err);
    *kept = false;
    if (st != CW_OK || are_marks(choice, array.data.name))
        return st;
    const bool is_read = array.data.is_known && array.data.components <= 16;
    array.rank = is_read ? rank_of(choice, data, &array.data) : CWI_VTI_NONE;
    cwi_array_list_add(choice->list, array.data.name, array.data.type_name,
                       array.data.components, data->of_cells, is_read && *array.data.name);
    if (array.rank == CWI_VTI_NONE)
        note_other(choice, &array.data);
    *kept = array.rank > data->best.rank;
    if (*kept)
        data->best = array;
    return CW_OK;
}

cw_status cwi_vti_fail_choice(const cwi_vti_choice *choice, cw_error *err)
{
    const char *others = choice->others, *there = *others ? "; there are " : "";
    if (choice->expected)
        return cwi_fail(err, CW_ERR_ARGUMENT, "there is no array '%.100s' that is read%s%s",
                        choice->expected, there, others);
    return cwi_fail(err, CW_ERR_FORMAT, "PointData and CellData hold no array that is read%s%s",
                    there, others);
}

cw_status cwi_vti_coordinates(cwi_vti *v, cwi_attributes a, size_t *n, cw_error *err)
{
    *n = v->coordinate_arrays++;
    if (*n > 2)
        return cwi_fail(err, CW_ERR_FORMAT, "Coordinates has more than three arrays");
    cwi_vtk_array *array = &v->coordinates[*n];
    cw_status st = cwi_vtk_xml_array(array, a, err);
    if (st == CW_OK && (!array->is_known || array->stored || array->components != 1))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "coordinates along %c are %zu of type '%s' each; one number of a type of "
            "up to 32 bits, or Float64, was expected",
            "xyz"[*n], array -> components, array -> type_name);
    return st;
}
