/* Legacy VTK: lines of text with the numbers of arrays between them. */
#ifndef FORMATS_VTK_H
#define FORMATS_VTK_H

#include "formats/header.h"
#include "formats/source.h"

enum { CWI_VTK_LINE_BYTES = 1024 };

/* How well an array will do as the volume: the one that was asked for goes before attributes
 * called SCALARS, those before other arrays of one value, and those before arrays of several.
 */
typedef enum cwi_vtk_rank {
    CWI_VTK_NONE,
    CWI_VTK_SEVERAL,
    CWI_VTK_ONE,
    CWI_VTK_SCALARS,
    CWI_VTK_ASKED_FOR
} cwi_vtk_rank;

typedef struct cwi_vtk_array {
    char name[CWI_WORD_BYTES];
    cw_type type;
    size_t components;
    uint64_t offset; /* of its numbers in the file */
    cwi_vtk_rank rank;
} cwi_vtk_array;

/* Coordinates along an axis of a rectilinear grid. */
typedef struct cwi_vtk_row {
    cw_type type;
    size_t count;
    uint64_t offset; /* of its numbers in the file */
} cwi_vtk_row;

/* A walk through the file from line to line. */
typedef struct cwi_vtk {
    const cwi_input *in;
    uint64_t offset; /* of the next line */
    size_t number;   /* of lines given so far; numbers of arrays do not count */
    bool binary;
    char line[CWI_VTK_LINE_BYTES];

    const char *wanted;          /* the name of the array that was asked for; NULL: none */
    cwi_vtk_array points, cells; /* the best of each so far */
    cwi_vtk_array *best;         /* of what the arrays now read are for; NULL: neither */
    size_t count;                /* ... and the number of them */
    cwi_vtk_row coordinates[3];
    char others[400]; /* names and types of arrays that are not read, for messages */
} cwi_vtk;

/* Reads the next line into v->line, without its end and trailing blanks, or the next that is
 * not empty. *more is false behind the last. */
cw_status cwi_vtk_line(cwi_vtk *v, bool *more, cw_error *err);
cw_status cwi_vtk_full_line(cwi_vtk *v, bool *more, cw_error *err);

/* The text behind the first word of v->line. */
const char *cwi_vtk_value(const cwi_vtk *v);

/* Whether no array can be better than what was found. */
static inline bool cwi_vtk_is_settled(const cwi_vtk *v)
{
    return v->points.rank >= CWI_VTK_SCALARS;
}

/* Reads the coordinates that v->line starts: "X_COORDINATES count type", say. */
cw_status cwi_vtk_coordinates(cwi_vtk *v, int axis, cw_error *err);

/* Reads the section that v->line starts, if it is one of arrays; they are passed over, and the
 * best of them kept. False when the line is something else. */
cw_status cwi_vtk_section(cwi_vtk *v, bool *known, cw_error *err);

#endif
