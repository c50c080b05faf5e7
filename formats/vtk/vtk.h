/* Legacy VTK: lines of text with the numbers of arrays between them. */
#ifndef FORMATS_VTK_VTK_H
#define FORMATS_VTK_VTK_H

#include "formats/text/text_header.h"
#include "formats/volume/voxel_source.h"

enum { CWI_VTK_LINE_BYTES = 1024 };

/* How well an array will do as the volume: the one that was asked for goes before attributes
 * called SCALARS, those before other arrays of one value, and those before arrays
 * of several. */
typedef enum cwi_vtk_rank {
    CWI_VTK_NONE,
    CWI_VTK_SEVERAL,
    CWI_VTK_ONE,
    CWI_VTK_SCALARS,
    CWI_VTK_ASKED_FOR
} cwi_vtk_rank;

typedef struct cwi_legacy_array {
    char name[CWI_WORD_BYTES];
    cw_type type;
    size_t components;
    uint64_t offset; /* of its numbers in the file */
    cwi_vtk_rank rank;
} cwi_legacy_array;

/* Numbers that the grid itself needs: coordinates along an axis, corners of cells. */
typedef struct cwi_vtk_row {
    cw_type type;
    bool wide; /* whole numbers of 64 bits: type is that of their halves */
    size_t count;
    uint64_t offset; /* of its numbers in the file; 0: it has none such */
} cwi_vtk_row;

/* What an irregular grid is made of. */
typedef struct cwi_vtk_cells {
    cwi_vtk_row points; /* three numbers each; count is that of points */
    cwi_vtk_row corners, ends, types;
    cwi_vtk_row marks[2]; /* vtkGhostType of points, of cells */
    size_t count;         /* of cells */
    size_t listed; /* numbers among which cells have their count in front, up to version 4; else
                      0 */
} cwi_vtk_cells;

/* A walk through the file from line to line. */
typedef struct cwi_vtk {
    const cwi_input *in;
    uint64_t offset; /* of the next line */
    size_t number;   /* of lines given so far; numbers of arrays do not count */
    bool binary;
    int version; /* the first number of it */
    char line[CWI_VTK_LINE_BYTES];

    const char *wanted;             /* the name of the array that was asked for; NULL: none */
    cwi_legacy_array points, cells; /* the best of each so far */
    cwi_legacy_array *best;         /* of what the arrays now read are for; NULL: neither */
    size_t count;                   /* ... and the number of them */
    cwi_vtk_row coordinates[3];
    cwi_vtk_cells grid;
    bool to_end;      /* marks may stand behind the best array */
    char others[400]; /* names and types of arrays that are not read, for messages */
} cwi_vtk;

/* Reads the next line into v->line, without its end and trailing blanks, or the next that is
 * not empty. *more is false behind the last. */
CW_NODISCARD cw_status cwi_vtk_line(cwi_vtk *v, bool *more, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_full_line(cwi_vtk *v, bool *more, cw_error *err);

/* The text behind the first word of v->line. */
const char *cwi_vtk_value(const cwi_vtk *v);

/* Whether no array can be better than what was found. */
static inline bool cwi_vtk_is_settled(const cwi_vtk *v)
{
    return !v->to_end && v->points.rank >= CWI_VTK_SCALARS;
}

/* Reads the coordinates that v->line starts: "X_COORDINATES count type", say. */
CW_NODISCARD cw_status cwi_vtk_coordinates(cwi_vtk *v, int axis, cw_error *err);

/* Reads what v->line starts: "POINTS count type", "CELLS ...", "CELL_TYPES count". */
CW_NODISCARD cw_status cwi_vtk_points(cwi_vtk *v, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_cell_corners(cwi_vtk *v, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_cell_types(cwi_vtk *v, cw_error *err);

/* Describes the first numbers of a row, or all of them, for cwi_tuples_load(). */
CW_NODISCARD cw_status cwi_vtk_describe(const cwi_vtk *v, const cwi_vtk_row *row,
                                        const char *field, size_t components, size_t count,
                                        cwi_source *src, bool *wide, cw_error *err);

/* Passes over the numbers at hand, and sets in the row where and what they are. skipped: so
 * many in front are none of its. */
CW_NODISCARD cw_status cwi_vtk_row_pass(cwi_vtk *v, const char *field, const char *type_name,
                                        size_t skipped, size_t count, cwi_vtk_row *row,
                                        cw_error *err);

/* Says that a line ends too early. */
CW_NODISCARD cw_status cwi_vtk_fail_cut_short(const cwi_vtk *v, cw_error *err);

/* Reads the section that v->line starts, if it is one of arrays; they are passed over, and the
 * best of them kept. False when the line is something else. */
CW_NODISCARD cw_status cwi_vtk_section(cwi_vtk *v, bool *known, cw_error *err);

#endif
