/* Colours of triangles while a mesh is read, and the colour of a mesh that has one everywhere. */
#ifndef FORMATS_MESH_FACE_COLORS_H
#define FORMATS_MESH_FACE_COLORS_H

#include "formats/mesh/mesh_reader.h"

/* Colours of the triangles read so far, sRGB and opacity. Zero it, except for `in`. */
typedef struct cwi_face_colors {
    cwi_mesh_input *in; /* borrowed */
    uint8_t *colors;    /* count x 4; NULL: none of these has a colour */
    size_t count, capacity;
} cwi_face_colors;

/* Gives all triangles behind the last coloured one, and before `end`, a colour. NULL means that they have
 * none: they are white if another triangle has one.
 * Returns as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_color_faces(cwi_face_colors *f, size_t end, const uint8_t color[4],
                                       cw_error *err);

/* Moves the colours into a finished mesh: as its attribute CW_FACE_COLORS.
 * spread   as colours of its vertices instead, if it has none and no vertex gets two
 * Returns CW_ERR_NO_MEMORY, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_color_mesh(cwi_face_colors *f, bool spread, cw_mesh *mesh,
                                      cw_error *err);

void cwi_face_colors_free(cwi_face_colors *f);

#endif
