/* Reads VTK's XML unstructured grids (.vtu) and curvilinear ones (.vts), and lists of such files
 * (.pvtu, .pvts). The elements are read as a stream, like those of .vti; then the arrays, by the
 * common reader of irregular grids. */
#define _GNU_SOURCE /* memmem */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/irregular_grid.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/vti.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_sides.h"

#include <stdio.h>
#include <string.h>

enum { MAX_ELEMENTS = 100000 };

/* The content of a Piece. */
typedef struct piece {
    cwi_vtk_xml file;                          /* of the file that holds it */
    size_t side;                               /* number of that file in a list */
    cwi_vtk_array arrays[CWI_GRID_ROLE_COUNT]; /* all but the values */
    bool has[CWI_GRID_ROLE_COUNT];
    cwi_vti_data points, cells;
} piece;

typedef struct parsing {
    cwi_vtk_xml file; /* the one that is parsed */
    const cwi_input *in;
    bool curvilinear;
    bool is_list, is_side; /* the parsed file lists others; is one of a list */
    bool has_kind;         /* a file before has stated whether they are curvilinear */
    cwi_names names;       /* of the files in the list */
    cwi_vtk_sides *sides;  /* those files; NULL: there is no list */
    uint64_t side_bytes;
    cwi_vti_choice choice;
    cwi_grid_piece *grid;
    piece *pieces; /* count of them */
    size_t count, capacity;
    cwi_vtk_array *open; /* the next tag ends its text; NULL: no wanted array */
    bool of_cells;
} parsing;

static const char *point_field(const parsing *p)
{
    return p->curvilinear ? "Extent" : "NumberOfPoints";
}

static const char *cell_field(const parsing *p)
{
    return p->curvilinear ? "Extent" : "NumberOfCells";
}

/* Recognises the first element VTKFile and its kind of grid. */
bool cwi_vtu_sniff(const unsigned char *head, size_t size)
{
    static const char tag[] = "<VTKFile";
    static const char *const kinds[] = {
        "\"UnstructuredGrid", "\"PUnstructuredGrid", "'UnstructuredGrid", "'PUnstructuredGrid",
        "\"StructuredGrid",   "\"PStructuredGrid",   "'StructuredGrid",   "'PStructuredGrid"};
    const char *text = memmem(head, size, tag, sizeof tag - 1);
    const char *end =
        text ? memchr(text, '>', size - (size_t)(text - (const char *)head)) : NULL;
    for (size_t k = 0; end && k < sizeof kinds / sizeof *kinds; k++)
        if (memmem(text, (size_t)(end - text), kinds[k], strlen(kinds[k])))
            return true;
    return false;
}

/* --- elements ---------------------------------------------------------------------------- */

static cw_status start_file(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const kinds[4][2] = {
        {"UnstructuredGrid", "of cells that need no order"},
        {"StructuredGrid", "of cells in rows"},
        {"PUnstructuredGrid", "a list of grids"},
        {"PStructuredGrid", "a list of grids"},
    };
    parsing *p = user;
    const char *type = cwi_attribute(a, "type");
    int kind = p->curvilinear;
    (void)x;
    for (int k = 0; k < (p->is_side ? 2 : 4) && type && !p->has_kind; k++)
        if (strcmp(type, kinds[k][0]) == 0)
            kind = k;
    p->curvilinear = kind % 2;
    p->has_kind = true;
    p->is_list = kind >= 2;
    return cwi_vtk_xml_file(&p->file, a, kinds[kind], err);
}

static cw_status start_grid(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)user, (void)x;
    return cwi_vti_check_times(a, err);
}

static cw_status start_list_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return cwi_vtk_sides_name(&((parsing *)user)->names, "Piece", "Source", a, err);
}

static cw_status grow_pieces(parsing *p, cw_error *err)
{
    const size_t capacity = p->capacity ? 2 * p->capacity : 1;
    if (p->count < p->capacity)
        return CW_OK;
    piece *pieces = cwi_realloc_array(p->pieces, capacity, sizeof *pieces);
    p->pieces = pieces ? pieces : p->pieces;
    cwi_grid_piece *grid = cwi_realloc_array(p->grid, capacity, sizeof *grid);
    p->grid = grid ? grid : p->grid;
    if (!pieces || !grid)
        return cwi_fail_memory(err);
    p->capacity = capacity;
    return CW_OK;
}

static cw_status set_extent(cwi_grid_piece *g, cwi_attributes a, cw_error *err)
{
    int64_t extent[6];
    cw_status st = cwi_vti_extent(a, "Extent", extent, err);
    for (int i = 0; i < 3 && st == CW_OK; i++) {
        g->along[i] = (size_t)(extent[2 * i + 1] - extent[2 * i] + 1);
        g->low[i] = extent[2 * i];
    }
    return st == CW_OK ? cwi_grid_along(g, "Extent", err) : st;
}

static cw_status set_counts(cwi_grid_piece *g, cwi_attributes a, cw_error *err)
{
    int64_t points = 0, cells = 0;
    cw_status st = cwi_vtk_xml_integer(a, "NumberOfPoints", 0, INT64_MAX / 4, &points, err);
    if (st == CW_OK)
        st = cwi_vtk_xml_integer(a, "NumberOfCells", 0, INT64_MAX / 4, &cells, err);
    g->points = (size_t)points;
    g->cells = (size_t)cells;
    return st;
}

static cw_status start_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    cw_status st = grow_pieces(p, err);
    (void)x;
    if (st != CW_OK)
        return st;
    cwi_grid_piece *g = &p->grid[p->count];
    *g = (cwi_grid_piece){0};
    p->pieces[p->count++] = (piece){0};
    return p->curvilinear ? set_extent(g, a, err) : set_counts(g, a, err);
}

static piece *at_hand(parsing *p)
{
    return &p->pieces[p->count - 1];
}

static cw_status start_point_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)err;
    cwi_vti_data_start(&at_hand(user)->points, false, a);
    return CW_OK;
}

static cw_status start_cell_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)err;
    cwi_vti_data_start(&at_hand(user)->cells, true, a);
    return CW_OK;
}

static void open_text(parsing *p, cwi_xml *x, cwi_vtk_array *array)
{
    p->open = array;
    array->start = array->end = cwi_xml_tag_end(x);
}

/* Keeps an array that the grid needs. */
static cw_status keep_array(parsing *p, cwi_xml *x, cwi_attributes a, cwi_grid_role role,
                            size_t components, cw_error *err)
{
    piece *to = at_hand(p);
    cwi_vtk_array array;
    cw_status st = cwi_vtk_xml_array(&array, a, err);
    const bool real = array.type == CW_F32 || array.type == CW_F64;
    if (st == CW_OK && (!array.is_known || array.components != components ||
                        (real && role != CWI_GRID_POINTS)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' has %zu numbers of type '%s'; %zu %s expected",
                        array.name, array.components, array.type_name, components,
                        role == CWI_GRID_POINTS ? "were" : "whole one was");
    if (st != CW_OK || to->has[role])
        return st;
    to->has[role] = true;
    to->arrays[role] = array;
    open_text(p, x, &to->arrays[role]);
    return CW_OK;
}

static bool is_named(cwi_attributes a, const char *name)
{
    const char *array = cwi_attribute(a, "Name");
    return array && strcmp(array, name) == 0;
}

/* Handles an array that may be the values, or the marks of hidden points or cells. */
static cw_status start_data_array(parsing *p, cwi_xml *x, cwi_attributes a, cwi_vti_data *data,
                                  cwi_grid_role marks, cw_error *err)
{
    bool kept;
    const bool levels = is_named(a, "vtkGhostLevels"); /* before VTK 7 */
    if (levels && data->of_cells && !at_hand(p)->has[marks])
        p->grid[p->count - 1].marks_are_levels = true;
    if (is_named(a, "vtkGhostType") || (levels && data->of_cells))
        return keep_array(p, x, a, marks, 1, err);
    cw_status st = cwi_vti_data_array(&p->choice, data, a, &kept, err);
    if (kept)
        open_text(p, x, &data->best.data);
    return st;
}

static cw_status start_point_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return start_data_array(user, x, a, &at_hand(user)->points, CWI_GRID_POINT_MARKS, err);
}

static cw_status start_cell_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return start_data_array(user, x, a, &at_hand(user)->cells, CWI_GRID_CELL_MARKS, err);
}

static cw_status start_points(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return keep_array(user, x, a, CWI_GRID_POINTS, 3, err);
}

static cw_status start_cells(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const struct {
        const char *name;
        cwi_grid_role role;
    } rows[] = {{"connectivity", CWI_GRID_CORNERS},
                {"offsets", CWI_GRID_ENDS},
                {"types", CWI_GRID_TYPES}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (is_named(a, rows[i].name))
            return keep_array(user, x, a, rows[i].role, 1, err);
    return CW_OK;
}

static cw_status start_appended(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    p->file.appended = cwi_xml_tag_end(x);
    cwi_xml_stop(x);
    return cwi_vtk_xml_appended(&p->file, a, err);
}

static cw_status end_text(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)err;
    if (p->open && cwi_xml_tag_start(x) > p->open->start)
        p->open->end = cwi_xml_tag_start(x);
    p->open = NULL;
    return CW_OK;
}

/* The elements. Both kinds of grid have the same in their pieces, except for cells. */
enum {
    GRID,
    PIECE,
    POINT_DATA,
    POINT_ARRAY,
    CELL_DATA,
    CELL_ARRAY,
    POINTS,
    POINTS_ARRAY,
    GRID_ROWS
};
enum {
    FILE_ROW,
    CURVILINEAR,
    UNSTRUCTURED = CURVILINEAR + GRID_ROWS,
    CELLS = UNSTRUCTURED + GRID_ROWS,
    CELLS_ARRAY,
    LIST,
    LIST_PIECE,
    CURVILINEAR_LIST,
    CURVILINEAR_LIST_PIECE,
    APPENDED,
    ELEMENT_COUNT
};

#define GRID_ELEMENTS(at, name)                                                                \
    [at + GRID] = {name, FILE_ROW, start_grid, NULL},                                          \
          [at + PIECE] = {"Piece", at + GRID, start_piece, NULL},                              \
          [at + POINT_DATA] = {"PointData", at + PIECE, start_point_data, NULL},               \
          [at + POINT_ARRAY] = {"DataArray", at + POINT_DATA, start_point_array, NULL},        \
          [at + CELL_DATA] = {"CellData", at + PIECE, start_cell_data, NULL},                  \
          [at + CELL_ARRAY] = {"DataArray", at + CELL_DATA, start_cell_array, NULL},           \
          [at + POINTS] = {"Points", at + PIECE, NULL, NULL},                                  \
          [at + POINTS_ARRAY] = {"DataArray", at + POINTS, start_points, NULL}

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [FILE_ROW] = {"VTKFile", CWI_XML_ROOT, start_file, NULL},
    GRID_ELEMENTS(CURVILINEAR, "StructuredGrid"),
    GRID_ELEMENTS(UNSTRUCTURED, "UnstructuredGrid"),
    [CELLS] = {"Cells", UNSTRUCTURED + PIECE, NULL, NULL},
    [CELLS_ARRAY] = {"DataArray", CELLS, start_cells, NULL},
    [LIST] = {"PUnstructuredGrid", FILE_ROW, NULL, NULL},
    [LIST_PIECE] = {"Piece", LIST, start_list_piece, NULL},
    [CURVILINEAR_LIST] = {"PStructuredGrid", FILE_ROW, NULL, NULL},
    [CURVILINEAR_LIST_PIECE] = {"Piece", CURVILINEAR_LIST, start_list_piece, NULL},
    [APPENDED] = {"AppendedData", FILE_ROW, start_appended, NULL},
};

static const cwi_xml_rules rules = {.elements = elements,
                                    .element_count = ELEMENT_COUNT,
                                    .max_elements = MAX_ELEMENTS,
                                    .tag = end_text};

/* --- to a grid --------------------------------------------------------------------------- */

/* Returns the array of a piece that is the volume: at points, unless only cells have one. */
static const cwi_vti_array *values_of(const parsing *p, size_t n)
{
    return p->of_cells ? &p->pieces[n].cells.best : &p->pieces[n].points.best;
}

/* Drops empty pieces, which a parallel run may write; they need not have arrays. */
static void drop_empty(parsing *p)
{
    size_t left = 0;
    for (size_t n = 0; n < p->count; n++)
        if (p->grid[n].points && p->grid[n].cells) {
            p->pieces[left] = p->pieces[n];
            p->grid[left++] = p->grid[n];
        }
    p->count = p->count && left == 0 ? 1 : left; /* one for messages */
}

/* Chooses the array; all pieces must have the one that the first piece chooses. */
static cw_status choose_array(parsing *p, cw_error *err)
{
    if (p->count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the grid has no Piece");
    p->of_cells = !cwi_vti_is_of_points(&p->pieces[0].points, &p->pieces[0].cells);
    const cwi_vti_array *first = values_of(p, 0);
    if (first->rank == CWI_VTI_NONE)
        return cwi_vti_fail_choice(&p->choice, err);
    for (size_t n = 1; n < p->count; n++) {
        const cwi_vtk_array *other = &values_of(p, n)->data;
        if (strcmp(other->name, first->data.name) != 0 || other->type != first->data.type ||
            other->components != first->data.components)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "piece %zu has the array '%s' (%zu %s) where the first has '%s' "
                            "(%zu %s)",
                            n, other->name, other->components, other->type_name,
                            first->data.name, first->data.components, first->data.type_name);
    }
    return CW_OK;
}

static cw_status describe_array(const void *file, size_t n, cwi_grid_role role, size_t count,
                                cwi_source *src, bool *wide, cw_error *err)
{
    const parsing *p = file;
    const piece *from = &p->pieces[n];
    const bool values = role == CWI_GRID_VALUES;
    const bool of_points =
        role == CWI_GRID_POINTS || role == CWI_GRID_POINT_MARKS || (values && !p->of_cells);
    const cwi_input *in = p->sides ? &p->sides->now : p->in;
    const cwi_vtk_array *array = values            ? &values_of(p, n)->data
                                 : from->has[role] ? &from->arrays[role]
                                                   : NULL;
    const char *field = role == CWI_GRID_CORNERS ? "offsets"
                        : of_points              ? point_field(p)
                                                 : cell_field(p);
    *wide = false;
    return values ? cwi_vtk_xml_values(&from->file, array, field, count, in, src, err)
                  : cwi_vtk_xml_tuples(&from->file, array, field, count, in, src, wide, err);
}

static cw_status open_side(const void *file, size_t n, const cwi_input **in, cw_error *err)
{
    const parsing *p = file;
    return cwi_vtk_sides_open(p->sides, p->pieces[n].side, in, err);
}

static cw_status read_grid(parsing *p, const cw_read_desc *desc, cw_volume *volume,
                           cw_error *err)
{
    for (size_t n = 0; n < p->count; n++) {
        p->grid[n].has_point_marks = p->pieces[n].has[CWI_GRID_POINT_MARKS];
        p->grid[n].has_cell_marks = p->pieces[n].has[CWI_GRID_CELL_MARKS];
    }
    const cwi_vtk_array *values = &values_of(p, 0)->data;
    const cwi_irregular grid = {.pieces = p->grid,
                                .piece_count = p->count,
                                .point_field = point_field(p),
                                .array = values->name,
                                .type = values->type,
                                .components = values->components,
                                .of_cells = p->of_cells,
                                .describe = describe_array,
                                .file = p,
                                .open = p->sides ? open_side : NULL,
                                .file_bytes = p->side_bytes};
    return cwi_irregular_read(&grid, p->in, desc, volume, err);
}

/* Reads the elements of one file; side: its number in a list. */
static cw_status parse_file(parsing *p, const cwi_input *in, size_t side, cw_error *err)
{
    const size_t first = p->count;
    p->file = (cwi_vtk_xml){0};
    cw_status st = cwi_xml_read_file(&rules, p, in, err);
    if (st == CW_OK)
        st = cwi_vtk_xml_find_appended(in, &p->file, err);
    for (size_t n = first; n < p->count; n++) {
        p->pieces[n].file = p->file; /* the place of appended data comes last */
        p->pieces[n].side = side;
    }
    return st;
}

static cw_status parse_sides(parsing *p, cw_error *err)
{
    cw_status st = cwi_vtk_sides_check(p->sides, &p->side_bytes, err);
    p->is_side = true;
    for (size_t n = 0; n < p->sides->names->count && st == CW_OK; n++) {
        const cwi_input *side;
        st = cwi_vtk_sides_open(p->sides, n, &side, err);
        if (st == CW_OK) {
            st = parse_file(p, side, n, err);
            st = st == CW_OK ? st : cwi_fail_in(err, st, side->path);
        }
    }
    return st;
}

/* Reads the grid of all parsed pieces. */
static cw_status read_pieces(parsing *p, const cw_read_desc *desc, cw_volume *volume,
                             cw_error *err)
{
    drop_empty(p);
    cw_status st = choose_array(p, err);
    if (st != CW_OK)
        return st;
    cwi_array_list_choose(p->in->arrays, values_of(p, 0)->data.name, p->of_cells);
    st = read_grid(p, desc, volume, err);
    if (st == CW_OK && p->sides && p->sides->names->count > 1)
        cwi_note(desc, "%zu files are joined", p->sides->names->count);
    return st;
}

static void free_pieces(parsing *p)
{
    cwi_names_free(&p->names);
    cwi_free(p->pieces);
    cwi_free(p->grid);
}

cw_status cwi_vtu_read_sides(const cwi_input *list, const cwi_names *files,
                             const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    cwi_vtk_sides sides = {.list = list, .names = files};
    parsing p = {
        .in = list, .sides = &sides, .choice = {.expected = list->array, .list = list->arrays}};
    cw_status st = parse_sides(&p, err);
    if (st == CW_OK)
        st = read_pieces(&p, desc, volume, err);
    cwi_vtk_sides_close(&sides);
    free_pieces(&p);
    return st;
}

cw_status cwi_vtu_read(const cwi_input *in, const cw_read_desc *desc, bool *is_grid,
                       cw_volume *volume, cw_error *err)
{
    parsing p = {.in = in, .choice = {.expected = in->array, .list = in->arrays}};
    cwi_vtk_sides sides = {.list = in, .names = &p.names};
    *is_grid = true;
    cw_status st = parse_file(&p, in, 0, err);
    if (st == CW_OK && p.is_list) {
        p.sides = &sides;
        st = parse_sides(&p, err);
    }
    if (st == CW_OK)
        st = read_pieces(&p, desc, volume, err);
    cwi_vtk_sides_close(&sides);
    free_pieces(&p);
    return st;
}
