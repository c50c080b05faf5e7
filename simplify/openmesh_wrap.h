/* OpenMesh behind plain C: the functions of the module "openmesh". They simplify a block: some
 * triangles of a mesh, all of it perhaps, in a box of their own. */
#ifndef SIMPLIFY_OPENMESH_WRAP_H
#define SIMPLIFY_OPENMESH_WRAP_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Symmetric matrix, vector and number of a quadric about its vertex's own position:
 * error(d) = d A d + 2 b d + c, where d is the way from there. */
typedef struct cwi_quadric {
    float a[6]; /* xx, xy, xz, yy, yz, zz */
    float b[3];
    float c;
} cwi_quadric;

/* Of two about one place, the sum. */
static inline void cwi_quadric_add(cwi_quadric *q, const cwi_quadric *other)
{
    for (int k = 0; k < 6; k++)
        q->a[k] += other->a[k];
    for (int k = 0; k < 3; k++)
        q->b[k] += other->b[k];
    q->c += other->c;
}

/* Around points that are given so much care nothing is changed. */
enum { CWI_MOST_CARE = 4 };

/* What a surface was before it was simplified: each of its points belongs to the list of a
 * triangle that it lies near, and must stay within a distance of the surface. */
typedef struct cwi_original {
    const float *points;     /* vertices x 3 */
    const uint32_t *corners; /* of its triangles, x 3 */
    const uint32_t *first;   /* vertices + 1: the triangles around a vertex are */
    const uint32_t *around;  /* around[first[v]] .. around[first[v + 1] - 1] */
    uint32_t *next;          /* vertices: the next point in a list; UINT32_MAX ends it */
    const uint8_t *care;     /* vertices: how often the distance is halved around them */
} cwi_original;

typedef struct cwi_block {
    size_t vertices, triangles;
    size_t own;            /* triangles; those behind them are in the way, and stay */
    float *points;         /* vertices x 3 */
    uint32_t *corners;     /* triangles x 3 */
    uint32_t *names;       /* vertices: a vertex of the input that it came from */
    uint8_t *held;         /* vertices: must stay, with all edges to them */
    uint8_t *seam;         /* vertices: were held in another block, where borders between two
                              of them were not counted. NULL: none */
    cwi_quadric *quadrics; /* vertices; NULL: from the triangles */
    uint32_t *lists;       /* own: first point of a list; NULL without an original */
    float low[3], high[3]; /* vertices are moved to low <= x < high only */
} cwi_block;

typedef struct cwi_block_desc {
    double error; /* the distance to keep; 0: none */
    bool allow_crossings, keep_border;
} cwi_block_desc;

typedef struct cwi_decimater cwi_decimater;

typedef struct cwi_openmesh_functions {
    /* Nothing is borrowed but the original. Free with close. */
    cw_status (*open)(const cwi_block *block, const cwi_block_desc *desc,
                      const cwi_original *original, cwi_decimater **out, cw_error *err);
    /* Collapses edges in order of their cost, while it is at most `cost`, and there are more
     * than `least` triangles. */
    cw_status (*run)(cwi_decimater *decimater, float cost, size_t least, cw_error *err);
    /* Triangles of the block's own that are left. */
    size_t (*triangles)(const cwi_decimater *decimater);
    /* The cost of the next collapse to try; infinite when there is none. */
    float (*next)(const cwi_decimater *decimater);
    /* Vertices of the block that are no single fan, or at an edge of more than two. */
    size_t (*cut)(const cwi_decimater *decimater);
    /* What is left, in arrays from cwi_alloc_array(): own triangles only. */
    cw_status (*take)(const cwi_decimater *decimater, cwi_block *out, cw_error *err);
    void (*close)(cwi_decimater *decimater);
} cwi_openmesh_functions;

extern CW_API const cwi_openmesh_functions cwi_module_openmesh;

#ifdef __cplusplus
}
#endif

#endif
