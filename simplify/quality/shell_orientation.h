/* Which closed shells face the wrong way? */
#ifndef SIMPLIFY_QUALITY_SHELL_ORIENTATION_H
#define SIMPLIFY_QUALITY_SHELL_ORIENTATION_H

#include "simplify/quality/welded_mesh.h"

/* The components of a mesh; arrays of vertex_count. A component is known by its root. */
typedef struct cwi_shells {
    uint32_t *part;      /* union-find: vertices that share triangles; afterwards each root */
    const uint8_t *used; /* not 0: in a triangle */
    uint8_t *unbounded;  /* why the edges to higher vertices bound no volume: CWI_OPEN,
                            CWI_UNORIENTED or both; used up */
} cwi_shells;

/* Counts cavities, inside_out, nested and open_inward, and marks the triangles of the last
 * three. False when memory is out, or when the progress has cancelled. */
bool cwi_measure_shells(const cwi_welded *welded, const cwi_shells *shells,
                        const cw_quality_desc *desc, cw_quality *q);

#endif
