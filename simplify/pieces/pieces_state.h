/* The state of a solid that is cut to pieces: planes, the cell of each piece, and pegs in the making. */
#ifndef SIMPLIFY_PIECES_PIECES_STATE_H
#define SIMPLIFY_PIECES_PIECES_STATE_H

#include <cubewright/pieces.h>

/* A plane, in coordinates relative to the origin of the mesh. */
typedef struct cwi_cut_plane {
    double point[3];              /* near the middle of the mesh's box */
    double normal[3], u[3], v[3]; /* of length 1; u x v = normal */
} cwi_cut_plane;

/* A solid that is being cut. */
typedef struct cwi_cutter {
    const cw_mesh *mesh;
    cw_pieces *out;
    double low[3], high[3]; /* the box of the mesh's positions */
    double diagonal;
    double tolerance; /* vertices as near as this to a plane are in it */
    cwi_cut_plane *planes;
    size_t plane_count;
    bool *above;     /* of each piece and each plane: the piece is on the side of its normal */
    size_t capacity; /* of pieces */
} cwi_cutter;

/* Computes the coordinates of a point in a plane's frame: along u, v and the normal. */
static inline void cwi_plane_local(const cwi_cut_plane *p, const float x[3], double out[3])
{
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = (double)x[k] - p->point[k];
    for (int k = 0; k < 3; k++) {
        const double *axis = k == 0 ? p->u : k == 1 ? p->v : p->normal;
        out[k] = d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2];
    }
}

/* Returns the numbers of planes of a piece's triangles, from 1; NULL: no plane cut it. */
const uint32_t *cwi_section_numbers(const cw_mesh *mesh);

/* Checks planes and sets them up. Frees nothing on failure.
 * Returns  CW_ERR_ARGUMENT as cw_pieces_cut(); CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_place_planes(cwi_cutter *c, const cw_cut_desc *planes, size_t count,
                                        cw_error *err);

/* Finds neighbouring pieces and the sections between them. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_find_sections(cwi_cutter *c, cw_error *err);

/* Chooses the places of pegs, and their sizes by default.
 * Returns  CW_ERR_CHECK when none has room; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_place_pegs(cwi_cutter *c, cw_error *err);

/* Adds pegs, drills holes, and makes dowels.
 * Returns  as cw_mesh_boolean() */
CW_NODISCARD cw_status cwi_make_pegs(cwi_cutter *c, cw_error *err);

#endif
