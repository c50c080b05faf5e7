/* Legacy VTK files: lines of text with the numbers of arrays between them. */
#ifndef FORMATS_VTK_VTK_H
#define FORMATS_VTK_VTK_H

#include "formats/text/text_header.h"
#include "formats/volume/voxel_source.h"

enum { CWI_VTK_LINE_BYTES = 1024 };

/* The preference of an array as the volume: first the requested array, then attributes called
 * SCALARS, then other arrays of one value, then arrays of several values. Integers of 64 bits, which are
 * mostly the numbers of points or cells, come last. */
typedef enum cwi_vtk_rank {
    CWI_VTK_NONE,
    CWI_VTK_WIDE,
    CWI_VTK_SEVERAL,
    CWI_VTK_ONE,
    CWI_VTK_SCALARS,
    CWI_VTK_REQUESTED
} cwi_vtk_rank;

typedef struct cwi_legacy_array {
    char name[CWI_WORD_BYTES];
    cw_type type;
    cwi_stored stored;
    size_t components;
    uint64_t offset; /* of its numbers in the file */
    cwi_vtk_rank rank;
} cwi_legacy_array;

/* The numbers of the grid itself: coordinates along an axis, corners of cells. */
typedef struct cwi_vtk_row {
    cw_type type;
    bool wide; /* whole numbers of 64 bits: type is that of their halves */
    size_t count;
    uint64_t offset; /* of its numbers in the file; 0: missing */
} cwi_vtk_row;

/* The arrays of an irregular grid. */
typedef struct cwi_vtk_cells {
    cwi_vtk_row points; /* three numbers each; count is that of points */
    cwi_vtk_row corners, ends, types;
    cwi_vtk_row marks[2]; /* vtkGhostType of points, of cells */
    size_t count;         /* of cells */
    size_t listed; /* length of the list where each cell's count precedes its corners, up to
                      version 4; else 0 */
} cwi_vtk_cells;

/* A walk through the file from line to line. */
typedef struct cwi_vtk {
    const cwi_input *in;
    uint64_t offset; /* of the next line */
    size_t number;   /* number of lines returned so far; numbers of arrays do not count */
    bool binary;
    int version; /* the major version */
    char line[CWI_VTK_LINE_BYTES];

    const char *expected;           /* the name of the requested array; NULL: none */
    cwi_legacy_array points, cells; /* the best of each so far */
    cwi_legacy_array *best;         /* the best for the current kind of data; NULL: neither */
    size_t count;                   /* ... and the number of them */
    cwi_vtk_row coordinates[3];
    cwi_vtk_cells grid;
    bool to_end;      /* marks may follow the best array */
    char others[400]; /* names and types of arrays that are not read, for messages */
} cwi_vtk;

/* Reads the lines before the first section: magic, title, and whether it is binary. */
CW_NODISCARD cw_status cwi_vtk_start(cwi_vtk *v, cw_error *err);

/* Reads the next line into v->line, without its end and trailing blanks, or the next line that
 * is not empty. *more is false behind the last. */
CW_NODISCARD cw_status cwi_vtk_line(cwi_vtk *v, bool *more, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_full_line(cwi_vtk *v, bool *more, cw_error *err);

/* Returns the text behind the first word of v->line. */
const char *cwi_vtk_value(const cwi_vtk *v);

/* Returns true if no array can be better than the one found. */
static inline bool cwi_vtk_is_settled(const cwi_vtk *v)
{
    return !v->to_end && v->points.rank >= CWI_VTK_SCALARS;
}

/* Reads the coordinates whose line is v->line, such as "X_COORDINATES count type". */
CW_NODISCARD cw_status cwi_vtk_coordinates(cwi_vtk *v, int axis, cw_error *err);

/* Reads the section whose line is v->line: "POINTS count type", "CELLS ...", "CELL_TYPES
 * count". */
CW_NODISCARD cw_status cwi_vtk_points(cwi_vtk *v, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_cell_corners(cwi_vtk *v, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_cell_types(cwi_vtk *v, cw_error *err);

/* Describes the first numbers of a row, or all of them, for cwi_tuples_load(). */
CW_NODISCARD cw_status cwi_vtk_describe(const cwi_vtk *v, const cwi_vtk_row *row,
                                        const char *field, size_t components, size_t count,
                                        cwi_source *src, bool *wide, cw_error *err);

/* Skips the numbers of a row, and stores their place and type in it. skipped: count of leading
 * numbers that do not belong to it. */
CW_NODISCARD cw_status cwi_vtk_row_pass(cwi_vtk *v, const char *field, const char *type_name,
                                        size_t skipped, size_t count, cwi_vtk_row *row,
                                        cw_error *err);

/* Reports that a line ends too early. */
CW_NODISCARD cw_status cwi_vtk_fail_cut_short(const cwi_vtk *v, cw_error *err);

/* Reads the section whose line is v->line, if it is one of arrays. They are skipped, and the
 * best of them is kept. *known is false when the line is something else. */
CW_NODISCARD cw_status cwi_vtk_section(cwi_vtk *v, bool *known, cw_error *err);

#endif
