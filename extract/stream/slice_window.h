/* The slices of a volume that are in memory: their voxels, bits and numbers. The window moves
 * upward; numbers are those in the whole surface.
 *
 * Layers count as in extract/dense/bit_planes.h, padding first: layer p holds voxel slice p - 1.
 * In the window's grid, layer p of the volume has number p - first. */
#ifndef EXTRACT_STREAM_SLICE_WINDOW_H
#define EXTRACT_STREAM_SLICE_WINDOW_H

#include <cubewright/stream.h>

#include "extract/dense/border_loops.h"
#include "extract/dense/dense_plan.h"

typedef struct cwi_slice_window {
    const cw_slice_source *source;
    cw_extract_desc desc;
    cw_volume whole;            /* the volume, resolved; its data are those of the window */
    cwi_plan plan;              /* engine, grid and rows of the window */
    size_t below, above;        /* layers below and above a layer that its vertices need */
    size_t first, count;        /* voxel slices in memory */
    size_t capacity;            /* ... at most */
    size_t counted;             /* layers below this one have numbers */
    size_t vertices, triangles; /* of these layers, from the first that was counted on */
    size_t first_vertex,
        first_triangle; /* the numbers that count as 0: those of layer `start` */
    size_t start;       /* the first layer that is written */
    bool in, out;       /* samples were found inside, and outside */
    /* Around voxels without a value an open surface ends at live cells, of which some are dropped
     * sweep by sweep: see cwi_drop_pinched_layer(). Each sweep follows the one before by a layer. */
    size_t sweeps;  /* 0: no cells are dropped */
    size_t swept;   /* layers below this one had their first sweep */
    bool unsettled; /* the last sweep dropped cells: there would have to be more of them */
    unsigned char *slices;
} cwi_slice_window;

/* Sweeps that drop cells, the last of which has to find none. Where one voxel in 14 has no value, at
 * random, noise takes 6 sweeps for 48^3 voxels and 8 for 256^3. */
enum { CWI_SWEEPS = 12 };

/* Returns the bytes of a window with `layers` layers between two slabs' ends. */
size_t cwi_slice_window_bytes(const cw_volume *whole, const cw_extract_desc *desc,
                              size_t sweeps, size_t layers);

/* Allocates a window for slabs of up to `layers` layers. Free it with cwi_slice_window_free(), also
 * after an error. Its volume, without data, and its sweeps are set; the rest is zero. */
CW_NODISCARD cw_status cwi_slice_window_init(cwi_slice_window *w, const cwi_engine *engine,
                                             const cw_slice_source *source,
                                             const cw_extract_desc *desc, size_t layers,
                                             cw_error *err);
void cwi_slice_window_free(cwi_slice_window *w);

/* Reads slices until it is known on which sides samples are, or to the end of the volume (`all`).
 * cwi_slice_window_start() has to follow. */
CW_NODISCARD cw_status cwi_slice_window_scan(cwi_slice_window *w, bool all, cw_error *err);

/* Begins a pass with a layer: numbers count from there. */
void cwi_slice_window_start(cwi_slice_window *w, size_t layer);

/* Moves the window so that layers begin to end - 1 can be written: reads, classifies and counts
 * what is new. Windows follow each other: begin is the last end. */
CW_NODISCARD cw_status cwi_slice_window_move(cwi_slice_window *w, size_t begin, size_t end,
                                             cw_error *err);

/* Moves the window through layers below the first that is written, whose cells the sweeps reach. */
CW_NODISCARD cw_status cwi_slice_window_pass(cwi_slice_window *w, size_t begin, size_t end,
                                             cw_error *err);

/* Adds the slices that came into memory to a count of the border's curves. It follows each move of a
 * pass that begins at layer 0. */
void cwi_slice_window_add_border(const cwi_slice_window *w, cwi_border_loops *loops);

/* Returns the first row of a layer. */
static inline const cwi_row *cwi_slice_window_layer(const cwi_slice_window *w, size_t layer)
{
    return w->plan.rows + (layer - w->first) * w->plan.grid.rows_y;
}

#endif
