/* A block of cells as coherent projection [Wilhelms1991] draws it on the CPU: cells, and nodes
 * of similar cells, from front to back, each over the samples of a tile that it covers. */
#ifndef VIEWER_PROJECTION_CELL_BLOCK_H
#define VIEWER_PROJECTION_CELL_BLOCK_H

#include "viewer/projection/linear_cell.h"
#include "viewer/scene/block_ranges.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    CWI_TILE_EDGE = 32, /* samples; a row of a tile is one word of bits */
    CWI_BLOCK_SIDE = CWI_RANGE_EDGE + 1,
    CWI_BLOCK_CORNERS = CWI_BLOCK_SIDE * CWI_BLOCK_SIDE * CWI_BLOCK_SIDE,
    CWI_BLOCK_WIDE = CWI_BLOCK_SIDE + 2, /* with the samples around it */
    CWI_BLOCK_CELLS = CWI_RANGE_EDGE * CWI_RANGE_EDGE * CWI_RANGE_EDGE
};

/* A piece of the picture under way. Bit x of live[y]: sample (x, y) still takes light. */
typedef struct cwi_tile {
    const cwi_cell_model *model;
    size_t x, y; /* of its upper left sample in the picture */
    int width, height;
    double pixel_from_index[3][4]; /* homogeneous; from the tile's upper left corner */
    double near_depth;             /* the least third coordinate that is drawn */
    double eye[3];                 /* in index space */
    float tolerance;               /* half the range of a node drawn whole; below 0: none is */
    float min_light;               /* rays end below this */
    bool has_gaps;                 /* some voxels have no value */
    uint32_t live[CWI_TILE_EDGE];
    cwi_cell_ray rays[CWI_TILE_EDGE * CWI_TILE_EDGE];
    cwi_lanes halfway[CWI_TILE_EDGE * CWI_TILE_EDGE][CW_MAX_LIGHTS];
} cwi_tile;

/* A rectangle of samples of a tile, the ends included; empty if high < low. */
typedef struct cwi_tile_box {
    int low[2], high[2];
} cwi_tile_box;

/* Finds the samples that a box of index space may cover. */
cwi_tile_box cwi_tile_project(const cwi_tile *tile, const double low[3], const double high[3]);

/* Returns true if some sample of a rectangle still takes light. */
bool cwi_tile_is_live(const cwi_tile *tile, const cwi_tile_box *box);

/* Draws the cells of a block, from the cell `first` on. linear: where opacity is linear over
 * polygons, else NULL */
void cwi_block_draw(cwi_tile *tile, cwi_linear_cell *linear, const size_t first[3]);

#ifdef __cplusplus
}
#endif

#endif
