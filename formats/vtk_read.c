/* Legacy VTK image data: "VTK File Formats", the simple legacy formats, version 1.0 to 5.1. */
#include "core/memory.h"
#include "core/status.h"
#include "formats/readers.h"
#include "formats/vtk.h"

#include <string.h>
#include <strings.h>

static const char magic[] = "# vtk DataFile Version ";

typedef enum grid_field { G_DIMENSIONS, G_ORIGIN, G_SPACING, GRID_FIELD_COUNT } grid_field;
static const char *const grid_names[GRID_FIELD_COUNT] = {
    [G_DIMENSIONS] = "dimensions", [G_ORIGIN] = "origin", [G_SPACING] = "spacing|aspect_ratio"};

/* The grid of points, as far as the file has told of it. */
typedef struct grid {
    size_t dim[3];
    double origin[3], spacing[3];
    bool seen[GRID_FIELD_COUNT];
    bool has_cells, has_points;
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
        return cw_fail(err, CW_ERR_FORMAT, "the first line is not '%s1.0' or the like", magic);
    const char *version = v->line + sizeof magic - 1;
    if (*version < '1' || *version > '5' || version[1] != '.')
        return cw_fail(err, CW_ERR_FORMAT, "the version is '%.20s'; 1.0 to 5.1 are read",
                       version);
    return cwi_vtk_line(v, &more, err); /* a title, or none */
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
    return cw_fail(err, CW_ERR_FORMAT, "line %zu is '%.40s'; it must be ASCII or BINARY",
                   v->number, v->line);
}

static bool is_keyword(const cwi_vtk *v, const char *names)
{
    return cwi_field_find(&names, 1, v->line, strcspn(v->line, " \t")) == 0;
}

/* A FIELD may stand in front. */
static cw_status read_dataset(cwi_vtk *v, cw_error *err)
{
    bool more = true, known = true;
    cw_status st = CW_OK;
    while (st == CW_OK && known) {
        st = cwi_vtk_full_line(v, &more, err);
        if (st == CW_OK && !more)
            return cw_fail(err, CW_ERR_FORMAT, "'DATASET' is missing");
        if (st == CW_OK && is_keyword(v, "dataset"))
            break;
        if (st == CW_OK)
            st = cwi_vtk_section(v, &known, err);
    }
    if (st != CW_OK || strcasecmp(cwi_vtk_value(v), "structured_points") == 0)
        return st;
    return cw_fail(err, CW_ERR_FORMAT,
                   "line %zu is '%.60s'; only DATASET STRUCTURED_POINTS is a volume", v->number,
                   v->line);
}

/* --- the grid ---------------------------------------------------------------------------- */

static cw_status read_grid_field(const cwi_vtk *v, int field, grid *g, cw_error *err)
{
    static const char by[] = "STRUCTURED_POINTS";
    const char *value = cwi_vtk_value(v);
    g->seen[field] = true;
    if (field == G_DIMENSIONS)
        return cwi_field_sizes("DIMENSIONS", value, 3, by, g->dim, err);
    if (field == G_ORIGIN)
        return cwi_field_doubles("ORIGIN", value, 3, by, g->origin, err);
    return cwi_field_doubles("SPACING", value, 3, by, g->spacing, err);
}

static cw_status start_points(const cwi_vtk *v, const grid *g, cw_error *err)
{
    size_t wanted;
    if (!g->seen[G_DIMENSIONS])
        return cw_fail(err, CW_ERR_FORMAT, "'DIMENSIONS' is missing in front of POINT_DATA");
    if (!cwi_size_mul(g->dim[0], g->dim[1], &wanted) ||
        !cwi_size_mul(wanted, g->dim[2], &wanted))
        return cw_fail(err, CW_ERR_LIMIT,
                       "'DIMENSIONS' asks for more voxels than an address space holds");
    if (v->count == wanted)
        return CW_OK;
    return cw_fail(err, CW_ERR_FORMAT, "'POINT_DATA' is %zu; 'DIMENSIONS' asks for %zu",
                   v->count, wanted);
}

/* "POINT_DATA n" or "CELL_DATA n": what the arrays behind it are for. */
static cw_status start_data(cwi_vtk *v, grid *g, cw_error *err)
{
    int64_t count = 0;
    v->at_points = is_keyword(v, "point_data");
    cw_status st = cwi_field_integer(v->at_points ? "POINT_DATA" : "CELL_DATA",
                                     cwi_vtk_value(v), 0, INT64_MAX, &count, err);
    v->count = (size_t)count;
    g->has_points |= v->at_points;
    g->has_cells |= !v->at_points;
    return st == CW_OK && v->at_points ? start_points(v, g, err) : st;
}

static cw_status read_line(cwi_vtk *v, grid *g, cw_error *err)
{
    const int field =
        cwi_field_find(grid_names, GRID_FIELD_COUNT, v->line, strcspn(v->line, " \t"));
    bool known;
    if (field >= 0)
        return read_grid_field(v, field, g, err);
    if (is_keyword(v, "point_data|cell_data"))
        return start_data(v, g, err);
    cw_status st = cwi_vtk_section(v, &known, err);
    if (st == CW_OK && !known)
        return cw_fail(err, CW_ERR_FORMAT, "line %zu, '%.40s', starts nothing that is known",
                       v->number, v->line);
    return st;
}

/* Walks the file until SCALARS are found, or to its end. */
static cw_status read_lines(cwi_vtk *v, grid *g, cw_error *err)
{
    bool more = true;
    cw_status st = CW_OK;
    while (st == CW_OK && v->best.rank < CWI_VTK_SCALARS) {
        st = cwi_vtk_full_line(v, &more, err);
        if (!more)
            break;
        if (st == CW_OK)
            st = read_line(v, g, err);
    }
    return st;
}

static cw_status check_found(const cwi_vtk *v, const grid *g, cw_error *err)
{
    if (v->best.rank != CWI_VTK_NONE)
        return CW_OK;
    if (g->has_cells && !g->has_points)
        return cw_fail(
            err, CW_ERR_FORMAT,
            "the file has CELL_DATA and no POINT_DATA; only values at points are read");
    if (!g->has_points)
        return cw_fail(err, CW_ERR_FORMAT, "'POINT_DATA' is missing");
    return cw_fail(err, CW_ERR_FORMAT, "'POINT_DATA' holds no array that is read%s%s",
                   *v->others ? "; there are " : "", v->others);
}

/* --- to a source ------------------------------------------------------------------------- */

static cw_status describe(const cwi_vtk *v, const grid *g, cwi_source *src, cw_error *err)
{
    const cwi_axis axes[] = {{CWI_AXIS_COMPONENT, v->best.components},
                             {CWI_AXIS_X, g->dim[0]},
                             {CWI_AXIS_Y, g->dim[1]},
                             {CWI_AXIS_Z, g->dim[2]}};
    cw_volume *shape = &src->shape;
    shape->type = v->best.type;
    shape->slope = 1;
    src->encoding = v->binary ? CWI_RAW : CWI_ASCII;
    src->big_endian = true;
    src->offset = v->best.offset;
    for (int a = 0; a < 3; a++) { /* flat data may have no thickness */
        shape->affine[a][a] = g->dim[a] == 1 && g->spacing[a] == 0 ? 1 : g->spacing[a];
        shape->affine[a][3] = g->origin[a];
    }
    return cwi_source_set_axes(src, axes, sizeof axes / sizeof *axes, err);
}

cw_status cwi_vtk_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    cwi_vtk v = {.in = in};
    grid g = {.spacing = {1, 1, 1}};
    src->size_field = "DIMENSIONS";
    src->frame_field = "SPACING, ORIGIN";
    cw_status st = read_magic(&v, err);
    if (st == CW_OK)
        st = read_form(&v, err);
    if (st == CW_OK)
        st = read_dataset(&v, err);
    if (st == CW_OK)
        st = read_lines(&v, &g, err);
    if (st == CW_OK)
        st = check_found(&v, &g, err);
    if (st == CW_OK)
        st = describe(&v, &g, src, err);
    return st;
}
