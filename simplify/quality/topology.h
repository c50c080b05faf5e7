/* The topology of a mesh, without the shapes of its triangles. */
#ifndef SIMPLIFY_QUALITY_TOPOLOGY_H
#define SIMPLIFY_QUALITY_TOPOLOGY_H

#include <cubewright/quality.h>

/* Measures as cw_quality_measure() does, besides what cwi_measure_shapes() sets: areas, volume, angles,
 * lengths, and triangles without area. */
CW_NODISCARD cw_status cwi_measure_topology(const cw_mesh *mesh, const cw_quality_desc *desc,
                                            cw_quality *out, cw_error *err);

#endif
