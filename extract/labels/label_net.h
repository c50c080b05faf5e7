/* The vertices and polygons of a label map, and which are beside which. */
#ifndef EXTRACT_LABELS_LABEL_NET_H
#define EXTRACT_LABELS_LABEL_NET_H

#include "core/base/memory.h"

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Flags of a vertex's kind. */
enum {
    CWI_NET_FIXED = 0x40, /* in a cube with more than one vertex: smoothing lets it stay */
    CWI_NET_BACK = 0x80   /* where it was before smoothing: it stayed, or was put back */
};

/* Capacity for the corners of a polygon: 6 at most. */
enum { CWI_POLYGON_CORNERS = 8 };

/* A polygon is named by its first triangle. */
typedef struct cwi_label_net {
    uint32_t (*neighbours)[6]; /* of vertices, in the cubes below and above along each axis: x-,
                                  y-, z-, x+, y+, z+; UINT32_MAX: none */
    uint8_t *kinds;    /* of vertices. Bit n: three labels or more meet on the way to neighbour
                          n; and flags. 0: the vertex is in one patch */
    uint8_t *polygons; /* of triangles: at a polygon's first, the edge of tetrahedra around
                          which it lies, as in cwi_label_rules; 0 at others */
    uint32_t *firsts;  /* vertex_count + 1: where a vertex's part of `around` begins */
    uint32_t *around;  /* the polygons with a vertex, rising */
} cwi_label_net;

/* Returns the triangle behind a polygon's last. */
static inline size_t cwi_polygon_end(const cwi_label_net *net, const cw_mesh *mesh,
                                     size_t polygon)
{
    size_t t = polygon + 1;
    while (t < mesh->triangle_count && !net->polygons[t])
        t++;
    return t;
}

/* Lists a polygon's corners, in one of the two orders around it. Returns their number. */
int cwi_polygon_corners(const cwi_label_net *net, const cw_mesh *mesh, size_t polygon,
                        uint32_t corners[CWI_POLYGON_CORNERS]);

/* Trims memory in sweeps by patches, at every 1024th element: their vertices are on pages far from each
 * other. */
static inline void cwi_label_trim(size_t n)
{
    if (n % (1 << 10) == 0)
        cwi_memory_trim();
}

/* Makes `firsts` and `around`. Returns false when memory is out. */
CW_NODISCARD bool cwi_label_net_finish(cwi_label_net *net, const cw_mesh *mesh);

void cwi_label_net_free(cwi_label_net *net);

#ifdef __cplusplus
}
#endif

#endif
