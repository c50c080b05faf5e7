/* Reads legacy VTK image data and grids: rectilinear, curvilinear and unstructured ("VTK File
 * Formats", the simple legacy formats, version 1.0 to 5.1). */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/irregular_grid.h"
#include "formats/volume/named_arrays.h"
#include "formats/vtk/vtk.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_grid.h"

#include <string.h>
#include <strings.h>

static const char magic[] = "# vtk DataFile Version ";

typedef enum dataset {
    EVEN = 1,
    RECTILINEAR = 2,
    CURVILINEAR = 4,
    UNSTRUCTURED = 8,
    IRREGULAR = CURVILINEAR | UNSTRUCTURED
} dataset;

static const struct {
    const char *name;
    dataset kind;
} datasets[] = {{"STRUCTURED_POINTS", EVEN},
                {"RECTILINEAR_GRID", RECTILINEAR},
                {"STRUCTURED_GRID", CURVILINEAR},
                {"UNSTRUCTURED_GRID", UNSTRUCTURED}};
enum { DATASET_COUNT = sizeof datasets / sizeof *datasets };

typedef enum grid_field {
    G_DIMENSIONS,
    G_ORIGIN,
    G_SPACING,
    G_POINTS,
    G_CELLS,
    G_CELL_TYPES,
    G_COORDINATES,
    GRID_FIELD_COUNT = G_COORDINATES + 3
} grid_field;

static const char *const grid_names[GRID_FIELD_COUNT] = {
    [G_DIMENSIONS] = "dimensions",
    [G_ORIGIN] = "origin",
    [G_SPACING] = "spacing|aspect_ratio",
    [G_POINTS] = "points",
    [G_CELLS] = "cells",
    [G_CELL_TYPES] = "cell_types",
    [G_COORDINATES] = "x_coordinates",
    [G_COORDINATES + 1] = "y_coordinates",
    [G_COORDINATES + 2] = "z_coordinates",
};

/* The kinds of dataset that have each field. */
static const unsigned grid_kinds[GRID_FIELD_COUNT] = {
    [G_DIMENSIONS] = EVEN | RECTILINEAR | CURVILINEAR,
    [G_ORIGIN] = EVEN,
    [G_SPACING] = EVEN,
    [G_POINTS] = IRREGULAR,
    [G_CELLS] = UNSTRUCTURED,
    [G_CELL_TYPES] = UNSTRUCTURED,
    [G_COORDINATES] = RECTILINEAR,
    [G_COORDINATES + 1] = RECTILINEAR,
    [G_COORDINATES + 2] = RECTILINEAR,
};

/* The description of the grid read so far. */
typedef struct grid {
    dataset kind;
    const char *name; /* of the kind */
    size_t dim[3];
    double origin[3], spacing[3];
    bool seen[GRID_FIELD_COUNT];
} grid;

bool cwi_vtk_sniff(const unsigned char *head, size_t size)
{
    return size >= sizeof magic - 1 && memcmp(head, magic, sizeof magic - 1) == 0;
}

/* --- the first lines --------------------------------------------------------------------- */

static cw_status read_magic(cwi_vtk *v, cw_error *err)
{
    bool more;
    cw_status st = cwi_vtk_line(v, &more, err);
    if (st != CW_OK)
        return st;
    if (strncmp(v->line, magic, sizeof magic - 1) != 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the first line is not '%s1.0' or the like", magic);
    const char *version = v->line + sizeof magic - 1;
    if (*version < '1' || *version > '5' || version[1] != '.')
        return cwi_fail(err, CW_ERR_FORMAT, "the version is '%.20s'; 1.0 to 5.1 are read",
                        version);
    v->version = *version - '0';
    return cwi_vtk_line(v, &more, err); /* a title, possibly empty */
}

static cw_status read_form(cwi_vtk *v, cw_error *err)
{
    bool more;
    cw_status st = cwi_vtk_full_line(v, &more, err);
    if (st != CW_OK)
        return st;
    v->binary = strcasecmp(v->line, "binary") == 0;
    if (v->binary || strcasecmp(v->line, "ascii") == 0)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT, "line %zu is '%.40s'; it must be ASCII or BINARY",
                    v->number, v->line);
}

cw_status cwi_vtk_start(cwi_vtk *v, cw_error *err)
{
    cw_status st = read_magic(v, err);
    return st == CW_OK ? read_form(v, err) : st;
}

static bool is_keyword(const cwi_vtk *v, const char *names)
{
    return cwi_field_find(&names, 1, v->line, strcspn(v->line, " \t")) == 0;
}

/* Reads the kind of dataset; a FIELD may precede it. */
static cw_status read_dataset(cwi_vtk *v, grid *g, cw_error *err)
{
    bool more = true, known = true;
    cw_status st = CW_OK;
    while (st == CW_OK && known) {
        st = cwi_vtk_full_line(v, &more, err);
        if (st == CW_OK && !more)
            return cwi_fail(err, CW_ERR_FORMAT, "'DATASET' is missing");
        if (st == CW_OK && is_keyword(v, "dataset"))
            break;
        if (st == CW_OK)
            st = cwi_vtk_section(v, &known, err);
    }
    for (int i = 0; i < DATASET_COUNT && st == CW_OK; i++)
        if (strcasecmp(cwi_vtk_value(v), datasets[i].name) == 0) {
            g->kind = datasets[i].kind;
            g->name = datasets[i].name;
            return CW_OK;
        }
    if (st != CW_OK)
        return st;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "line %zu is '%.60s'; only DATASET STRUCTURED_POINTS, RECTILINEAR_GRID, "
                    "STRUCTURED_GRID or UNSTRUCTURED_GRID is a volume",
                    v->number, v->line);
}

/* --- the grid ---------------------------------------------------------------------------- */

/* Finds the field of the line v->line; -1: such a grid has no such field. */
static int find_field(const cwi_vtk *v, const grid *g)
{
    const int field =
        cwi_field_find(grid_names, GRID_FIELD_COUNT, v->line, strcspn(v->line, " \t"));
    return field >= 0 && grid_kinds[field] & g->kind ? field : -1;
}

static cw_status read_grid_field(cwi_vtk *v, int field, grid *g, cw_error *err)
{
    const char *by = g->name;
    const char *value = cwi_vtk_value(v);
    g->seen[field] = true;
    if (field >= G_COORDINATES)
        return cwi_vtk_coordinates(v, field - G_COORDINATES, err);
    if (field == G_POINTS)
        return cwi_vtk_points(v, err);
    if (field == G_CELLS)
        return cwi_vtk_cell_corners(v, err);
    if (field == G_CELL_TYPES)
        return cwi_vtk_cell_types(v, err);
    if (field == G_DIMENSIONS)
        return cwi_field_sizes("DIMENSIONS", value, 3, by, g->dim, err);
    if (field == G_ORIGIN)
        return cwi_field_doubles("ORIGIN", value, 3, by, g->origin, err);
    return cwi_field_doubles("SPACING", value, 3, by, g->spacing, err);
}

/* Checks a count. A plane of points, or a line, also counts as having cells. */
static cw_status check_count(const cwi_vtk *v, const char *field, const grid *g, cw_error *err)
{
    const size_t cells = v->best == &v->cells;
    size_t expected = 1;
    if (g->kind == UNSTRUCTURED) {
        expected = cells ? v->grid.count : v->grid.points.count;
        return v->count == expected
                   ? CW_OK
                   : cwi_fail(err, CW_ERR_FORMAT, "'%s' is %zu; '%s' asks for %zu", field,
                              v->count, cells ? "CELLS" : "POINTS", expected);
    }
    if (!g->seen[G_DIMENSIONS])
        return cwi_fail(err, CW_ERR_FORMAT, "'DIMENSIONS' is missing in front of %s", field);
    for (int a = 0; a < 3; a++)
        if (!cwi_size_mul(expected, g->dim[a] > 1 ? g->dim[a] - cells : 1, &expected))
            return cwi_fail(err, CW_ERR_LIMIT,
                            "'DIMENSIONS' asks for more voxels than an address space holds");
    if (v->count == expected)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT, "'%s' is %zu; 'DIMENSIONS' asks for %zu", field,
                    v->count, expected);
}

/* Reads "POINT_DATA n" or "CELL_DATA n": the places of the arrays that follow. */
static cw_status start_data(cwi_vtk *v, const grid *g, cw_error *err)
{
    const bool points = is_keyword(v, "point_data");
    const char *field = points ? "POINT_DATA" : "CELL_DATA";
    int64_t count = 0;
    cw_status st = cwi_field_integer(field, cwi_vtk_value(v), 0, INT64_MAX, &count, err);
    v->best = points ? &v->points : &v->cells;
    v->count = (size_t)count;
    return st == CW_OK ? check_count(v, field, g, err) : st;
}

static cw_status read_line(cwi_vtk *v, grid *g, cw_error *err)
{
    const int field = find_field(v, g);
    bool known;
    if (field >= 0)
        return read_grid_field(v, field, g, err);
    if (is_keyword(v, "point_data|cell_data"))
        return start_data(v, g, err);
    cw_status st = cwi_vtk_section(v, &known, err);
    if (st == CW_OK && !known)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu, '%.40s', starts nothing that is known",
                        v->number, v->line);
    return st;
}

/* Walks through the file until no better array can come, or to its end. Behind the best array
 * only the list of all arrays matters, so errors there are ignored. */
static cw_status read_lines(cwi_vtk *v, grid *g, cw_error *err)
{
    const bool listing = v->in->arrays && !v->to_end;
    bool more = true;
    cw_status st = CW_OK;
    cw_error why = {0};
    v->to_end = v->to_end || listing;
    while (st == CW_OK && !cwi_vtk_is_settled(v)) {
        st = cwi_vtk_full_line(v, &more, &why);
        if (!more)
            break;
        if (st == CW_OK)
            st = read_line(v, g, &why);
    }
    if (st == CW_OK || (listing && v->points.rank >= CWI_VTK_SCALARS))
        return CW_OK;
    return cwi_fail(err, st, "%s", why.message);
}

/* Chooses the array that is the volume: at points, unless only cells have a good one. */
static const cwi_legacy_array *choose_array(const cwi_vtk *v)
{
    const bool is_of_points = v->points.rank > CWI_VTK_WIDE ||
                              (v->points.rank == CWI_VTK_WIDE && v->cells.rank <= CWI_VTK_WIDE);
    return is_of_points ? &v->points : &v->cells;
}

static cw_status check_found(const cwi_vtk *v, cw_error *err)
{
    if (choose_array(v)->rank != CWI_VTK_NONE)
        return CW_OK;
    if (!v->best)
        return cwi_fail(err, CW_ERR_FORMAT, "'POINT_DATA' is missing, and 'CELL_DATA' too");
    if (v->expected)
        return cwi_fail(err, CW_ERR_ARGUMENT, "there is no array '%.100s' that is read%s%s",
                        v->expected, *v->others ? "; there are " : "", v->others);
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'POINT_DATA' and 'CELL_DATA' hold no array that is read%s%s",
                    *v->others ? "; there are " : "", v->others);
}

/* --- to a source ------------------------------------------------------------------------- */

static cw_status describe_grid(const cwi_vtk *v, const grid *g, cwi_source *src, cw_error *err)
{
    const cwi_legacy_array *array = choose_array(v);
    size_t dim[3] = {g->dim[0], g->dim[1], g->dim[2]};
    cw_status st =
        array == &v->cells ? cwi_vtk_grid_to_cells(src, array->name, dim, err) : CW_OK;
    const cwi_axis axes[] = {{CWI_AXIS_COMPONENT, array->components},
                             {CWI_AXIS_X, dim[0]},
                             {CWI_AXIS_Y, dim[1]},
                             {CWI_AXIS_Z, dim[2]}};
    src->shape.type = array->type;
    src->stored = array->stored;
    src->shape.slope = 1;
    src->has_arrays = true;
    src->encoding = v->binary ? CWI_RAW : CWI_ASCII;
    src->big_endian = true;
    src->offset = array->offset;
    return st == CW_OK ? cwi_source_set_axes(src, axes, sizeof axes / sizeof *axes, err) : st;
}

static cw_status set_coordinates(const cwi_vtk *v, const grid *g, cwi_source *src,
                                 cw_error *err)
{
    static const char *const fields[] = {"X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"};
    cwi_source rows[3];
    for (int a = 0; a < 3; a++) {
        const cwi_vtk_row *row = &v->coordinates[a];
        if (row->count != g->dim[a])
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' lists %zu numbers; 'DIMENSIONS' says %zu",
                            fields[a], row->count, g->dim[a]);
        cw_status st = cwi_vtk_grid_row(&rows[a], fields[a], row->type, row->count, err);
        if (st != CW_OK)
            return st;
        rows[a].encoding = src->encoding;
        rows[a].big_endian = true;
        rows[a].offset = row->offset;
    }
    return cwi_vtk_grid_place(rows, v->in, choose_array(v) == &v->cells, &src->shape, err);
}

/* Sets the frame. Flat data may have no thickness. Cells are half a step further. */
static void set_frame(const cwi_vtk *v, const grid *g, cw_volume *shape)
{
    for (int a = 0; a < 3; a++) {
        const double step = g->dim[a] == 1 && g->spacing[a] == 0 ? 1 : g->spacing[a];
        shape->affine[a][a] = step;
        shape->affine[a][3] = g->origin[a] + (choose_array(v) == &v->cells ? 0.5 * step : 0);
    }
}

/* --- irregular grids --------------------------------------------------------------------- */

static cw_status describe_array(const void *file, size_t piece, cwi_grid_role role,
                                size_t count, cwi_source *src, bool *wide, cw_error *err)
{
    const cwi_vtk *v = file;
    const cwi_legacy_array *array = choose_array(v);
    const cwi_vtk_row values = {.type = array->type, .count = count, .offset = array->offset};
    cw_status st;
    (void)piece;
    switch (role) {
    case CWI_GRID_POINTS:
        return cwi_vtk_describe(v, &v->grid.points, "POINTS", 3, count, src, wide, err);
    case CWI_GRID_TYPES:
        return cwi_vtk_describe(v, &v->grid.types, "CELL_TYPES", 1, count, src, wide, err);
    case CWI_GRID_ENDS:
        return cwi_vtk_describe(v, &v->grid.ends, "OFFSETS", 1, count, src, wide, err);
    case CWI_GRID_CORNERS:
        return cwi_vtk_describe(v, &v->grid.corners, v->grid.listed ? "CELLS" : "CONNECTIVITY",
                                1, count, src, wide, err);
    case CWI_GRID_POINT_MARKS:
    case CWI_GRID_CELL_MARKS:
        return cwi_vtk_describe(v, &v->grid.marks[role == CWI_GRID_CELL_MARKS], "vtkGhostType",
                                1, count, src, wide, err);
    default:
        st =
            cwi_vtk_describe(v, &values, array->name, array->components, count, src, wide, err);
        src->stored = array->stored;
        return st;
    }
}

static cw_status set_piece(const cwi_vtk *v, const grid *g, cwi_grid_piece *piece,
                           cw_error *err)
{
    *piece = (cwi_grid_piece){.points = v->grid.points.count,
                              .cells = v->grid.count,
                              .listed = v->grid.listed,
                              .has_point_marks = v->grid.marks[0].offset,
                              .has_cell_marks = v->grid.marks[1].offset};
    if (g->kind == UNSTRUCTURED)
        return CW_OK;
    for (int a = 0; a < 3; a++)
        piece->along[a] = g->dim[a];
    return cwi_grid_along(piece, "DIMENSIONS", err);
}

static cw_status read_start(cwi_vtk *v, grid *g, cw_error *err)
{
    cw_status st = cwi_vtk_start(v, err);
    return st == CW_OK ? read_dataset(v, g, err) : st;
}

cw_status cwi_vtk_read_grid(const cwi_input *in, const cw_read_desc *desc, bool *is_grid,
                            cw_volume *volume, cw_error *err)
{
    cwi_vtk v = {.in = in, .expected = in->array, .to_end = true};
    grid g = {0};
    cwi_grid_piece piece;
    cw_status st = read_start(&v, &g, err);
    *is_grid = g.kind & IRREGULAR;
    if (st != CW_OK || !*is_grid)
        return st;
    st = read_lines(&v, &g, err);
    if (st == CW_OK)
        st = check_found(&v, err);
    if (st == CW_OK)
        st = set_piece(&v, &g, &piece, err);
    if (st != CW_OK)
        return st;
    const cwi_legacy_array *array = choose_array(&v);
    cwi_array_list_choose(in->arrays, array->name, array == &v.cells);
    const cwi_irregular all = {.pieces = &piece,
                               .piece_count = 1,
                               .point_field = "POINTS",
                               .array = array->name,
                               .type = array->type,
                               .components = array->components,
                               .of_cells = array == &v.cells,
                               .describe = describe_array,
                               .file = &v};
    return cwi_irregular_read(&all, in, desc, volume, err);
}

/* --- other grids ------------------------------------------------------------------------- */

cw_status cwi_vtk_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    cwi_vtk v = {.in = in, .expected = in->array};
    grid g = {.spacing = {1, 1, 1}};
    src->size_field = "DIMENSIONS";
    src->frame_field = "SPACING, ORIGIN";
    cw_status st = read_start(&v, &g, err);
    if (st == CW_OK)
        st = read_lines(&v, &g, err);
    if (st == CW_OK)
        st = check_found(&v, err);
    if (st == CW_OK)
        st = describe_grid(&v, &g, src, err);
    if (st == CW_OK)
        cwi_array_list_choose(in->arrays, choose_array(&v)->name, choose_array(&v) == &v.cells);
    if (st == CW_OK && g.kind == RECTILINEAR)
        return set_coordinates(&v, &g, src, err);
    set_frame(&v, &g, &src->shape);
    return st;
}
