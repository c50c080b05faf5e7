/* The loops of open edges of a surface that comes in parts. */
#ifndef SIMPLIFY_QUALITY_OPEN_LOOPS_H
#define SIMPLIFY_QUALITY_OPEN_LOOPS_H

#include <cubewright/core.h>

/* One end of an open edge, and the fan of triangles around the vertex at this end. */
typedef struct cwi_open_end {
    uint32_t low, high; /* the vertices of the edge */
    uint32_t fan;
} cwi_open_end;

/* Ends whose edge has not shown its other end yet. A zeroed struct is valid and empty. */
typedef struct cwi_border {
    cwi_open_end *ends;
    size_t count, capacity;
    uint32_t fans; /* the ends name fans below this number */
    size_t loops;  /* so far: fans that were appended, less those that were joined */
} cwi_border;

/* Appends an end as it is: its fan is below `fans`, which the caller counts. False when memory is
 * out. */
bool cwi_border_push(cwi_border *border, cwi_open_end end);

/* Appends the ends of another border, whose fans are new to this one. False when memory is out. */
bool cwi_border_append(cwi_border *border, const cwi_border *more);

/* Joins the fans at both ends of each edge, and drops these ends. False when memory is out. */
bool cwi_border_join(cwi_border *border);

void cwi_border_free(cwi_border *border);

#endif
