/* Convex pieces of the picture that a box of index space covers: the geometry of coherent
 * projection [Wilhelms1991]. In a piece every ray enters by one face and leaves by another, so
 * that both depths (in perspective their reciprocals) are linear over it. */
#ifndef VIEWER_PROXY_PROJECTED_CELLS_H
#define VIEWER_PROXY_PROJECTED_CELLS_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_PIECE_VERTICES = 128, CWI_PIECE_INDICES = 320 };

typedef struct cwi_piece_vertex {
    double at[2];       /* eye space x and y; in perspective divided by the depth */
    double front, back; /* depths where the ray enters and leaves */
} cwi_piece_vertex;

/* Pieces as fans of triangles; pieces share the vertices they have in common. */
typedef struct cwi_pieces {
    size_t polygon_count, vertex_count, index_count;
    cwi_piece_vertex vertices[CWI_PIECE_VERTICES];
    uint8_t indices[CWI_PIECE_INDICES];
} cwi_pieces;

/* Makes the pieces of the box from low to high, at most 7 in general; the part nearer than the
 * frame's near plane is cut off. Every pair of a front and a back face has a piece where they
 * overlap, which may be empty: so no cases of views have to be distinguished. */
void cwi_pieces_make(const cwi_frame *frame, const double low[3], const double high[3],
                     cwi_pieces *pieces);

#ifdef __cplusplus
}
#endif

#endif
