/* Reads points and cells of a legacy VTK file's irregular grid. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/grid_arrays.h"
#include "formats/vtk/vtk.h"

#include <strings.h>

/* Reads the next word of a line as a count. */
static cw_status next_count(const cwi_vtk *v, const char *field, const char **text, size_t *out,
                            cw_error *err)
{
    char word[CWI_WORD_BYTES];
    int64_t count = 0;
    if (!cwi_next_text_word(text, word))
        return cwi_vtk_fail_cut_short(v, err);
    cw_status st = cwi_field_integer(field, word, 0, INT64_MAX / 8, &count, err);
    *out = (size_t)count;
    return st;
}

cw_status cwi_vtk_points(cwi_vtk *v, cw_error *err)
{
    char type[CWI_WORD_BYTES];
    const char *text = cwi_vtk_value(v);
    size_t count = 0;
    cw_status st = next_count(v, "POINTS", &text, &count, err);
    if (st == CW_OK && !cwi_next_text_word(&text, type))
        st = cwi_vtk_fail_cut_short(v, err);
    if (st == CW_OK)
        st = cwi_vtk_row_pass(v, "POINTS", type, 0, 3 * count, &v->grid.points, err);
    v->grid.points.count = count;
    return st;
}

/* Reads a line "OFFSETS type" or "CONNECTIVITY type", and its numbers. */
static cw_status read_named(cwi_vtk *v, const char *name, size_t skipped, size_t count,
                            cwi_vtk_row *row, cw_error *err)
{
    char word[CWI_WORD_BYTES], type[CWI_WORD_BYTES];
    bool more;
    cw_status st = cwi_vtk_full_line(v, &more, err);
    const char *text = v->line;
    if (st != CW_OK)
        return st;
    if (!cwi_next_text_word(&text, word) || !cwi_next_text_word(&text, type) ||
        strcasecmp(word, name) != 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu is '%.40s'; %s and a type were expected, behind CELLS",
                        v->number, v->line, name);
    return cwi_vtk_row_pass(v, name, type, skipped, count, row, err);
}

/* Reads the corners of cells: "CELLS cells numbers", then for each cell the count of its
 * corners and these. From version 5 on it is "CELLS ends corners", with the ends from 0, in a
 * list each. */
cw_status cwi_vtk_cell_corners(cwi_vtk *v, cw_error *err)
{
    cwi_vtk_cells *g = &v->grid;
    const char *text = cwi_vtk_value(v);
    size_t count = 0, numbers = 0;
    cw_status st = next_count(v, "CELLS", &text, &count, err);
    if (st == CW_OK)
        st = next_count(v, "CELLS", &text, &numbers, err);
    if (st != CW_OK)
        return st;
    if (v->version < 5) {
        g->count = count;
        g->listed = numbers;
        return cwi_vtk_row_pass(v, "CELLS", "int", 0, numbers, &g->corners, err);
    }
    g->count = count ? count - 1 : 0;
    if (g->count)
        st = read_named(v, "OFFSETS", 1, g->count, &g->ends, err);
    return st == CW_OK && g->count ? read_named(v, "CONNECTIVITY", 0, numbers, &g->corners, err)
                                   : st;
}

cw_status cwi_vtk_cell_types(cwi_vtk *v, cw_error *err)
{
    const char *text = cwi_vtk_value(v);
    size_t count = 0;
    cw_status st = next_count(v, "CELL_TYPES", &text, &count, err);
    return st == CW_OK ? cwi_vtk_row_pass(v, "CELL_TYPES", "int", 0, count, &v->grid.types, err)
                       : st;
}

cw_status cwi_vtk_describe(const cwi_vtk *v, const cwi_vtk_row *row, const char *field,
                           size_t components, size_t count, cwi_source *src, bool *wide,
                           cw_error *err)
{
    *wide = row->wide;
    if (!row->offset)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' is missing", field);
    if (count > row->count)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' lists %zu; the grid asks for %zu", field,
                        row->count, count);
    cw_status st =
        cwi_tuples_describe(src, field, row->type, row->wide, components, count, err);
    src->encoding = v->binary ? CWI_RAW : CWI_ASCII;
    src->big_endian = true;
    src->offset = row->offset;
    return st;
}
