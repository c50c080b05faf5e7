/* A volume as an octree from voxels up, which hierarchical splatting draws [Laur1991]. */
#ifndef VIEWER_PROXY_VALUE_OCTREE_H
#define VIEWER_PROXY_VALUE_OCTREE_H

#include "viewer/scene/cell_lattice.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Values of the voxels in a node: their mean, weighted by mass, the lowest and the highest; and
 * the mass (in cells; 0: nothing in the node has a value). */
typedef struct cwi_pyramid_node {
    float mean, low, high, mass;
} cwi_pyramid_node;

/* Node (i, j, k) of level n has the voxels from 2^(n + 1) (i, j, k) on, 2^(n + 1) along each
 * axis or as many as there are. The last level has one node. */
typedef struct cwi_pyramid {
    size_t level_count;
    struct {
        size_t dim[3];
        cwi_pyramid_node *nodes; /* x fastest */
    } levels[32];
} cwi_pyramid;

/* Makes the octree of a resolved, evenly spaced volume; about 2.3 bytes a voxel.
 * CW_ERR_NO_MEMORY. has_gaps: whether some samples have no value, see cwi_lattice_mass() */
CW_NODISCARD cw_status cwi_pyramid_make(const cw_volume *volume, bool has_gaps, int threads,
                                        const cw_progress *progress, cwi_pyramid *pyramid,
                                        cw_error *err);
void cwi_pyramid_free(cwi_pyramid *pyramid);

const cwi_pyramid_node *cwi_pyramid_node_at(const cwi_pyramid *pyramid, size_t level,
                                            const size_t node[3]);

/* Settings by which values are seen: a transfer function's table, and its visible part; sheets
 * are across an axis. */
typedef struct cwi_pyramid_view {
    const cwi_frame *frame;
    const cwi_table *table;
    const cwi_visible *visible;
    int axis;
} cwi_pyramid_view;

/* Look of a node, in coordinates of the table, clamped to it where it is constant. */
typedef struct cwi_pyramid_look {
    float mean, error; /* error: the largest difference of a voxel from the mean */
    bool shows_any;    /* some value within its range is visible */
    bool shows_mean;
} cwi_pyramid_look;

cwi_pyramid_look cwi_pyramid_look_at(const cwi_pyramid_view *view,
                                     const cwi_pyramid_node *node);

enum { CWI_PYRAMID_STEPS = 4096 };

/* Counts the splats drawn with a largest error of n / CWI_PYRAMID_STEPS, for all n. A node is
 * one splat in each of its sheets; with 0 every visible voxel is one. Clipping and the edges of
 * the picture are ignored. counts: CWI_PYRAMID_STEPS + 1 */
void cwi_pyramid_counts(const cwi_pyramid *pyramid, const cwi_pyramid_view *view,
                        size_t *counts);

/* Finds the least of those errors with which at most `budget` splats are drawn; 1 if none is
 * large enough. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_pyramid_fit(const cwi_pyramid *pyramid, const cwi_pyramid_view *view,
                                       size_t budget, double *error, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
