/* Slabs of space between planes that face the viewer; each slice through a 3D texture stands
 * for one. A slab is drawn in the tiles of the picture where it meets something visible. */
#ifndef VIEWER_PROXY_VIEW_SLABS_H
#define VIEWER_PROXY_VIEW_SLABS_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_SLAB_TILES = 64, CWI_SLAB_RECTS = CWI_SLAB_TILES * CWI_SLAB_TILES / 2 };

/* Slab n has the depths from first + n thickness on. Slabs one behind the other that are drawn
 * in the same tiles are a layer. */
typedef struct cwi_slabs {
    double first, thickness; /* units of eye space */
    size_t count;
    size_t per_layer, layer_count;
    size_t tile;                      /* samples along a side */
    uint64_t (*rows)[CWI_SLAB_TILES]; /* of each layer's tiles, lowest first; leftmost: bit 0 */
} cwi_slabs;

/* Samples of the picture from its lower left corner, ends not included. */
typedef struct cwi_slab_rect {
    uint16_t left, bottom, right, top;
} cwi_slab_rect;

/* Makes the slabs of a frame's step through the whole volume in front of the eye; nothing is
 * marked. CW_ERR_LIMIT, CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_slabs_init(const cwi_frame *frame, cwi_slabs *slabs, cw_error *err);
void cwi_slabs_free(cwi_slabs *slabs);

/* Mark where a box of index space may be seen; unmark everything. */
void cwi_slabs_mark(cwi_slabs *slabs, const cwi_frame *frame, const double low[3],
                    const double high[3]);
void cwi_slabs_clear(cwi_slabs *slabs);

/* Covers the marked tiles of a layer by rectangles that do not overlap; returns their
 * number. */
size_t cwi_slabs_rects(const cwi_slabs *slabs, const cwi_frame *frame, size_t layer,
                       cwi_slab_rect rects[CWI_SLAB_RECTS]);

/* Computes the affine 3x4 from eye space to coordinates of a texture that has `count` samples
 * along each axis from `first` on: (s, t, r) = T S R^-1 D^-1 (x, y, z) [Wilson1994]. D and R
 * are the camera's place and turn, S and T the texture's size and place in the volume. */
void cwi_slabs_texture_matrix(const cwi_frame *frame, const size_t first[3],
                              const size_t count[3], double matrix[12]);

#ifdef __cplusplus
}
#endif

#endif
