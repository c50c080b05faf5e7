/* Reads VTK's XML image data (.vti) and rectilinear grids (.vtr), and lists of them. The elements are read as a
 * stream. The text of arrays only passes through. Reading stops where appended data start,
 * which need not be XML. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/vtk/vti.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_grid.h"
#include "formats/vtk/vtk_sides.h"

#include <string.h>

enum { MAX_ELEMENTS = 100000 };

/* Recognises the first element VTKFile, of image data or of another kind, which is then
 * refused. */
bool cwi_vti_sniff(const unsigned char *head, size_t size)
{
    return cwi_vtk_xml_sniff(head, size, "");
}

/* --- elements ---------------------------------------------------------------------------- */

typedef struct parsing {
    cwi_vti_file *file;
    cwi_vtk_array *open; /* the next tag ends its text; NULL: no wanted array */
} parsing;

/* Returns the piece at hand; before the first one what all have in common. */
static cwi_vti *current(void *user)
{
    cwi_vti_file *f = ((parsing *)user)->file;
    return f->count ? &f->pieces[f->count - 1] : &f->common;
}

static cw_status start_file(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const kinds[5][2] = {
        {"ImageData", "a volume"},
        {"RectilinearGrid", "a volume"},
        {"PImageData", "a volume in files"},
        {"PRectilinearGrid", "a volume in files"},
        {"ImageData, RectilinearGrid (vti), StructuredGrid or UnstructuredGrid (vtu), or a list of "
         "one kind",
         "a volume"}};
    cwi_vti_file *f = ((parsing *)user)->file;
    const char *type = cwi_attribute(a, "type");
    int kind = 0;
    (void)x;
    while (kind < 4 && !(type && strcmp(type, kinds[kind][0]) == 0))
        kind++;
    f->common.rectilinear = kind == 1 || kind == 3;
    f->is_list = kind == 2 || kind == 3;
    return cwi_vtk_xml_file(&f->common.file, a, kinds[kind], err);
}

static cw_status start_image(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_vti_file *f = ((parsing *)user)->file;
    (void)x;
    f->has_extent = cwi_vti_extent(a, "WholeExtent", f->extent, NULL) == CW_OK;
    return cwi_vti_image(&f->common, a, err);
}

static cw_status start_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return cwi_vti_piece(((parsing *)user)->file, a, err);
}

/* Keeps the file of a piece; its own extent is in there. */
static cw_status start_list_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return cwi_vtk_sides_name(&((parsing *)user)->file->sources, "Piece", "Source", a, err);
}

static cw_status start_points(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)err;
    cwi_vti_data_start(&current(user)->points, false, a);
    return CW_OK;
}

static cw_status start_cells(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)err;
    cwi_vti_data_start(&current(user)->cells, true, a);
    return CW_OK;
}

static void open_text(parsing *p, cwi_xml *x, cwi_vtk_array *array)
{
    p->open = array;
    array->start = cwi_xml_tag_end(x);
}

static cw_status start_data_array(parsing *p, cwi_vti_data *data, cwi_xml *x, cwi_attributes a,
                                  cw_error *err)
{
    bool kept;
    cw_status st = cwi_vti_data_array(&p->file->choice, data, a, &kept, err);
    if (kept)
        open_text(p, x, &data->best.data);
    return st;
}

static cw_status start_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return start_data_array(user, &current(user)->points, x, a, err);
}

static cw_status start_cell_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return start_data_array(user, &current(user)->cells, x, a, err);
}

static cw_status start_coordinates(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    size_t n;
    cw_status st = cwi_vti_coordinates(current(user), a, &n, err);
    if (st == CW_OK)
        open_text(user, x, &current(user)->coordinates[n]);
    return st;
}

static cw_status start_appended(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_vtk_xml *file = &((parsing *)user)->file->common.file;
    file->appended = cwi_xml_tag_end(x);
    cwi_xml_stop(x);
    return cwi_vtk_xml_appended(file, a, err);
}

static cw_status end_text(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)err;
    if (p->open)
        p->open->end = cwi_xml_tag_start(x);
    p->open = NULL;
    return CW_OK;
}

typedef enum element {
    E_FILE,
    E_IMAGE,
    E_IMAGE_PIECE,
    E_IMAGE_POINTS,
    E_IMAGE_CELLS,
    E_LIST,
    E_LIST_PIECE,
    E_GRID_LIST,
    E_GRID_LIST_PIECE,
    E_GRID,
    E_GRID_PIECE,
    E_GRID_POINTS,
    E_GRID_CELLS,
    E_COORDINATES,
    E_COORDINATE_ARRAY,
    E_IMAGE_ARRAY,
    E_IMAGE_CELL_ARRAY,
    E_GRID_ARRAY,
    E_GRID_CELL_ARRAY,
    E_APPENDED,
    ELEMENT_COUNT
} element;

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_FILE] = {"VTKFile", CWI_XML_ROOT, start_file, NULL},
    [E_IMAGE] = {"ImageData", E_FILE, start_image, NULL},
    [E_IMAGE_PIECE] = {"Piece", E_IMAGE, start_piece, NULL},
    [E_IMAGE_POINTS] = {"PointData", E_IMAGE_PIECE, start_points, NULL},
    [E_IMAGE_CELLS] = {"CellData", E_IMAGE_PIECE, start_cells, NULL},
    [E_LIST] = {"PImageData", E_FILE, start_image, NULL},
    [E_LIST_PIECE] = {"Piece", E_LIST, start_list_piece, NULL},
    [E_GRID_LIST] = {"PRectilinearGrid", E_FILE, start_image, NULL},
    [E_GRID_LIST_PIECE] = {"Piece", E_GRID_LIST, start_list_piece, NULL},
    [E_GRID] = {"RectilinearGrid", E_FILE, start_image, NULL},
    [E_GRID_PIECE] = {"Piece", E_GRID, start_piece, NULL},
    [E_GRID_POINTS] = {"PointData", E_GRID_PIECE, start_points, NULL},
    [E_GRID_CELLS] = {"CellData", E_GRID_PIECE, start_cells, NULL},
    [E_COORDINATES] = {"Coordinates", E_GRID_PIECE, NULL, NULL},
    [E_COORDINATE_ARRAY] = {"DataArray", E_COORDINATES, start_coordinates, NULL},
    [E_IMAGE_ARRAY] = {"DataArray", E_IMAGE_POINTS, start_array, NULL},
    [E_IMAGE_CELL_ARRAY] = {"DataArray", E_IMAGE_CELLS, start_cell_array, NULL},
    [E_GRID_ARRAY] = {"DataArray", E_GRID_POINTS, start_array, NULL},
    [E_GRID_CELL_ARRAY] = {"DataArray", E_GRID_CELLS, start_cell_array, NULL},
    [E_APPENDED] = {"AppendedData", E_FILE, start_appended, NULL},
};

static const cwi_xml_rules rules = {.elements = elements,
                                    .element_count = ELEMENT_COUNT,
                                    .max_elements = MAX_ELEMENTS,
                                    .tag = end_text};

/* --- several pieces ----------------------------------------------------------------------- */

/* Stops at the first piece. */
static cw_status look_at_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_xml_stop(x);
    return cwi_vti_piece(((parsing *)user)->file, a, err);
}

static cw_status look_at_list(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_xml_stop(x);
    return start_image(user, x, a, err);
}

bool cwi_vti_may_have_pieces(const cwi_input *in)
{
    static const cwi_xml_element first[] = {
        {"VTKFile", CWI_XML_ROOT, start_file, NULL}, {"ImageData", 0, start_image, NULL},
        {"Piece", 1, look_at_piece, NULL},           {"PImageData", 0, look_at_list, NULL},
        {"PRectilinearGrid", 0, look_at_list, NULL}, {"RectilinearGrid", 0, start_image, NULL},
        {"Piece", 5, look_at_piece, NULL},
    };
    static const cwi_xml_rules looking = {
        .elements = first, .element_count = 7, .max_elements = 100};
    cwi_vti_file file = {0};
    parsing p = {.file = &file};
    const bool is_read = cwi_xml_read_file(&looking, &p, in, NULL) == CW_OK;
    const bool may =
        is_read &&
        (file.is_list || (file.count && file.has_extent &&
                          memcmp(file.pieces->extent, file.extent, sizeof file.extent) != 0));
    cwi_vti_close(&file);
    return may;
}

/* --- the array ---------------------------------------------------------------------------- */

/* Chooses the array that is the volume: at points, unless only cells have a good one. */
static const cwi_vti_array *choose_array(const cwi_vti *v)
{
    return cwi_vti_is_of_points(&v->points, &v->cells) ? &v->points.best : &v->cells.best;
}

static bool is_of_cells(const cwi_vti *v)
{
    return choose_array(v) == &v->cells.best;
}

static cw_status check_found(const cwi_vti *v, const cwi_vti_choice *choice, cw_error *err)
{
    if (v->rectilinear && v->coordinate_arrays != 3)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "Coordinates has %zu arrays; one for x, y and z each was expected",
                        v->coordinate_arrays);
    return choose_array(v)->rank != CWI_VTI_NONE ? CW_OK : cwi_vti_fail_choice(choice, err);
}

/* --- coordinates -------------------------------------------------------------------------- */

static size_t points_along(const cwi_vti *v, int axis)
{
    return (size_t)(v->extent[2 * axis + 1] - v->extent[2 * axis] + 1);
}

static cw_status describe_coordinates(const cwi_vti *v, const cwi_input *in, cwi_source rows[3],
                                      cw_error *err)
{
    cw_status st = CW_OK;
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        const cwi_vtk_array *array = &v->coordinates[a];
        st = cwi_vtk_grid_row(&rows[a], "Extent", array->type, points_along(v, a), err);
        if (st == CW_OK)
            st = cwi_vtk_xml_place(&v->file, array, in, &rows[a], err);
    }
    return st;
}

cw_status cwi_vti_coordinates_load(const cwi_vti *v, const cwi_input *in, cw_volume numbers[3],
                                   cw_error *err)
{
    cwi_source rows[3];
    cw_status st = describe_coordinates(v, in, rows, err);
    return st == CW_OK ? cwi_vtk_grid_load(rows, in, numbers, err) : st;
}

static cw_status set_coordinates(const cwi_vti *v, const cwi_input *in, cw_volume *shape,
                                 cw_error *err)
{
    cwi_source rows[3];
    cw_status st = describe_coordinates(v, in, rows, err);
    return st == CW_OK ? cwi_vtk_grid_place(rows, in, is_of_cells(v), shape, err) : st;
}

/* --- to a source ------------------------------------------------------------------------- */

static cw_status set_sizes(const cwi_vti *v, cwi_source *src, cw_error *err)
{
    const cwi_vtk_array *array = &choose_array(v)->data;
    size_t dim[3] = {points_along(v, 0), points_along(v, 1), points_along(v, 2)};
    cw_status st = is_of_cells(v) ? cwi_vtk_grid_to_cells(src, array->name, dim, err) : CW_OK;
    const cwi_axis axes[] = {{CWI_AXIS_COMPONENT, array->components},
                             {CWI_AXIS_X, dim[0]},
                             {CWI_AXIS_Y, dim[1]},
                             {CWI_AXIS_Z, dim[2]}};
    src->shape.type = array->type;
    src->stored = array->stored;
    src->shape.slope = 1;
    src->has_arrays = true;
    return st == CW_OK ? cwi_source_set_axes(src, axes, 4, err) : st;
}

/* Sets the frame: World = Origin + Direction (Spacing * index). The index counts from that of
 * the extent. Cells are half a step further. */
static void set_frame(const cwi_vti *v, cw_volume *shape)
{
    for (int r = 0; r < 3; r++)
        shape->affine[r][3] = v->origin[r];
    for (int c = 0; c < 3; c++) {
        const double spacing = shape->dim[c] == 1 && v->spacing[c] == 0 ? 1 : v->spacing[c];
        for (int r = 0; r < 3; r++) {
            shape->affine[r][c] = v->direction[3 * r + c] * spacing;
            shape->affine[r][3] +=
                shape->affine[r][c] * ((double)v->extent[2 * c] + (is_of_cells(v) ? 0.5 : 0));
        }
    }
}

cw_status cwi_vti_open(const cwi_input *in, cwi_vti_file *file, cw_error *err)
{
    parsing p = {.file = file};
    cw_status st = cwi_xml_read_file(&rules, &p, in, err);
    if (st == CW_OK)
        st = cwi_vtk_xml_find_appended(in, &file->common.file, err);
    for (size_t n = 0; n < file->count; n++)
        file->pieces[n].file = file->common.file; /* the place of appended data comes last */
    return st;
}

void cwi_vti_close(cwi_vti_file *file)
{
    cwi_free(file->pieces);
    cwi_names_free(&file->sources);
    *file = (cwi_vti_file){0};
}

cw_status cwi_vti_describe(const cwi_vti *v, const cwi_vti_choice *choice, const cwi_input *in,
                           cwi_source *src, cw_error *err)
{
    src->size_field = "Extent";
    src->frame_field = "Direction, Spacing, Origin";
    cw_status st = check_found(v, choice, err);
    if (st == CW_OK)
        st = set_sizes(v, src, err);
    if (st != CW_OK)
        return st;
    if (v->rectilinear)
        st = set_coordinates(v, in, &src->shape, err);
    else
        set_frame(v, &src->shape);
    return st == CW_OK ? cwi_vtk_xml_place(&v->file, &choose_array(v)->data, in, src, err) : st;
}

const cwi_vti_array *cwi_vti_chosen(const cwi_vti *v, bool *of_cells)
{
    *of_cells = is_of_cells(v);
    return choose_array(v);
}

cw_status cwi_vti_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    cwi_vti_file file = {.choice = {.expected = in->array, .list = in->arrays}};
    bool of_cells;
    cw_status st = cwi_vti_open(in, &file, err);
    const cwi_vti *v = file.count ? &file.pieces[0] : &file.common;
    if (st == CW_OK)
        st = cwi_vti_describe(v, &file.choice, in, src, err);
    if (st == CW_OK)
        cwi_array_list_choose(in->arrays, cwi_vti_chosen(v, &of_cells)->data.name,
                              is_of_cells(v));
    cwi_vti_close(&file);
    return st;
}
