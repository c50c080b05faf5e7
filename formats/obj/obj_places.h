/* The texture coordinates of OBJ: lines "vt", and corners that name them. */
#ifndef FORMATS_OBJ_OBJ_PLACES_H
#define FORMATS_OBJ_OBJ_PLACES_H

#include "formats/mesh/mesh_reader.h"

/* The places in the texture read so far. Zero it, except for `in`. */
typedef struct cwi_obj_places {
    cwi_mesh_input *in; /* borrowed */
    float *places;      /* count x 2, the second downward */
    size_t count, capacity;
    uint32_t *of_corner; /* of the first `named` corners of triangles: their place */
    size_t named, named_capacity;
    uint32_t first, last; /* places of the current face */
    uint32_t *fans;       /* triangles before polygons are cut by their ears */
    bool is_named;        /* some corner names a place */
    bool is_broken;       /* some corner names a place that is not there */
} cwi_obj_places;

/* Reads the numbers of a line "vt". */
CW_NODISCARD cw_status cwi_obj_read_place(cwi_obj_places *p, cwi_scan *s, cw_error *err);

/* Names the place of the corner that was built last.
 * number   as in the file; 0: none. One that names no place so far is none, too, since shapes do not depend
 *          on it
 * Returns  as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_obj_name_place(cwi_obj_places *p, const cwi_mesh_build *build,
                                          int64_t number, cw_error *err);

/* Remembers polygons before cwi_build_finish(). */
CW_NODISCARD cw_status cwi_obj_keep_fans(cwi_obj_places *p, const cwi_mesh_build *build,
                                         cw_error *err);

/* Gives a finished mesh its texture coordinates, if a corner names a place; those that name none get 0. */
CW_NODISCARD cw_status cwi_obj_keep_places(cwi_obj_places *p, const cwi_mesh_build *build,
                                           cw_mesh *mesh, cw_error *err);

void cwi_obj_places_free(cwi_obj_places *p);

#endif
