/* A surface that comes a slab at a time. */
#ifndef SIMPLIFY_SLAB_SIMPLIFIER_H
#define SIMPLIFY_SLAB_SIMPLIFIER_H

#include "simplify/blocks/block_passes.h"

/* A slab as a block: vertices of its triangles, scaled, with their numbers for names. Held are
 * those in seams to other slabs. */
typedef struct cwi_slab_block {
    cwi_mesh_block block;
    size_t vertices; /* of the block as it was at first */
    uint8_t *seam;   /* vertices: as in cw_slab */
    uint32_t *rank;  /* vertices: which one it is of its seam */
    uint32_t *below; /* seam 1, by rank: its vertex; UINT32_MAX when no triangle has it */
    size_t ranks[3]; /* vertices of seams 1 and 2 */
    double longest;  /* edge */
    bool last;
} cwi_slab_block;

CW_NODISCARD cw_status cwi_slab_block_init(cwi_slab_block *slab, const cw_slab *from,
                                           double scale, cw_error *err);
void cwi_slab_block_free(cwi_slab_block *slab);

/* Keeps an error across slabs: what is simplified is a window, the slab that came last and the
 * upper half of the one before, where the seam between them is no seam any more. The lower half
 * of the slab is for the next window to leave alone. */
typedef struct cwi_slab_window {
    cw_mesh input;       /* what the distance is kept from: as much as is near the window */
    size_t ranks;        /* of the seam above */
    uint32_t *above;     /* by rank: its vertex of the input */
    cwi_mesh_block rest; /* the upper half, or so, of the last slab: held where that ends */
    uint32_t *placed;    /* vertices of the rest: where they are in the result, or UINT32_MAX */
    uint32_t *rank;      /* the same: which one it is of the seam above, or UINT32_MAX */
    float *finished;     /* triangles of the result that reach up to the rest: x 9 */
    size_t finished_count;
    double end;    /* the height that the rest begins at */
    double reach;  /* the longest edge of the input */
    float *points; /* the result */
    uint32_t *corners;
    size_t vertices, triangles, vertex_capacity, triangle_capacity, nonmanifold_count;
} cwi_slab_window;

CW_NODISCARD cw_status cwi_window_take(cwi_slab_window *window, cwi_passes *passes,
                                       cwi_slab_block *slab, cw_error *err);
void cwi_window_free(cwi_slab_window *window);

#endif
