/* The files that a VTK file lists as its pieces or blocks, opened one at a time. */
#ifndef FORMATS_VTK_VTK_SIDES_H
#define FORMATS_VTK_VTK_SIDES_H

#include "formats/text/xml.h"

/* The files of a list. Set the first two; zeroed but for them, none is open. */
typedef struct cwi_vtk_sides {
    const cwi_input *list;  /* borrowed: the file that lists them */
    const cwi_names *names; /* borrowed */
    cwi_input now;          /* the open one; its path is its name in the list */
    size_t opened;          /* number of the open one, from 1; 0: none */
} cwi_vtk_sides;

/* Adds the name that an attribute of an element states. tag: name of the element, for messages. */
CW_NODISCARD cw_status cwi_vtk_sides_name(cwi_names *names, const char *tag, const char *name,
                                          cwi_attributes a, cw_error *err);

/* Checks that all files are there, and that none is listed twice or is the list itself.
 * bytes  set to the bytes of all together
 * Returns as cwi_input_open_side(), with the file's name; CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_vtk_sides_check(cwi_vtk_sides *s, uint64_t *bytes, cw_error *err);

/* Opens a file, unless it is the open one, and closes the one before.
 * in  set to s->now, which has the arrays and choices of the list
 * Returns as cwi_vtk_sides_check() */
CW_NODISCARD cw_status cwi_vtk_sides_open(cwi_vtk_sides *s, size_t n, const cwi_input **in,
                                          cw_error *err);
void cwi_vtk_sides_close(cwi_vtk_sides *s);

#endif
