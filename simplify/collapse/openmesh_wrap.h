/* OpenMesh behind plain C: the functions of the module "openmesh". They simplify a block: some
 * triangles of a mesh, all of it perhaps, in a box of their own. */
#ifndef SIMPLIFY_COLLAPSE_OPENMESH_WRAP_H
#define SIMPLIFY_COLLAPSE_OPENMESH_WRAP_H

#include "core/mesh/surface_walk.h"

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Symmetric matrix, vector and number of a quadric about its vertex's own position:
 * error(d) = d A d + 2 b d + c, where d is the displacement from there. */
typedef struct cwi_quadric {
    float a[6]; /* xx, xy, xz, yy, yz, zz */
    float b[3];
    float c;
} cwi_quadric;

/* Adds a quadric about the same position. */
static inline void cwi_quadric_add(cwi_quadric *q, const cwi_quadric *other)
{
    for (int k = 0; k < 6; k++)
        q->a[k] += other->a[k];
    for (int k = 0; k < 3; k++)
        q->b[k] += other->b[k];
    q->c += other->c;
}

/* An attribute about a vertex's own position: at d it is d slope + value. */
typedef struct cwi_attribute_gradient {
    float slope[3], value;
} cwi_attribute_gradient;

enum { CWI_MAX_ATTRIBUTES = 10, CWI_TEXTURE_ATTRIBUTES = 2 };

/* Replaces the means of `count` gradients over an area by those over two areas, about the same
 * position. Adds their squared differences times area to the quadric. */
static inline void cwi_attribute_gradients_join(cwi_quadric *q, float *area,
                                                cwi_attribute_gradient *mean, float other_area,
                                                const cwi_attribute_gradient *other,
                                                size_t count)
{
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    if (!(other_area > 0))
        return;
    const float fraction = other_area / (*area + other_area), weight = fraction * *area;
    for (size_t n = 0; n < count; n++) {
        const float value = other[n].value - mean[n].value;
        float slope[3];
        for (int k = 0; k < 3; k++)
            slope[k] = other[n].slope[k] - mean[n].slope[k];
        for (int k = 0; k < 6; k++)
            q->a[k] += weight * slope[row[k]] * slope[column[k]];
        for (int k = 0; k < 3; k++)
            q->b[k] += weight * slope[k] * value;
        q->c += weight * value * value;
        for (int k = 0; k < 3; k++)
            mean[n].slope[k] += fraction * slope[k];
        mean[n].value += fraction * value;
    }
    *area += other_area;
}

/* Around points of this tighten level nothing is changed. */
enum { CWI_MAX_TIGHTEN_LEVEL = 4 };

/* Surface before it was simplified, which the result must stay near: each of its points belongs
 * to the list of a triangle that it is near to. */
typedef struct cwi_original {
    size_t vertices;
    cwi_fans fans;
    const uint32_t
        *across;    /* 2 for each of fans.around: the triangle's other corners in order */
    uint32_t *next; /* vertices: the next point in a list; UINT32_MAX ends it */
    const uint8_t *tighten_level; /* vertices: how often the distance is halved around them */
    const uint8_t *folded;        /* vertices: triangles around them face opposite ways */
    const float *allowed;    /* vertices: the distance there; NULL: the block's everywhere */
    const float *normals;    /* vertices x 3: 0 where the next does not matter; or NULL */
    float min_normal_cosine; /* cosine: how far they are from the mean of those joined */
} cwi_original;

typedef struct cwi_mesh_block {
    size_t vertices, triangles;
    size_t interior_count; /* triangles; those behind them are in the way, and stay */
    float *points;         /* vertices x 3 */
    uint32_t *corners;     /* triangles x 3 */
    uint32_t *global_ids;  /* vertices: they keep them; of those that are joined, the same */
    uint8_t *locked;       /* vertices: must stay, with all edges to them. NULL: none */
    uint8_t *seam;         /* vertices: were held before, when borders between two of them were
                              not counted. NULL: none */
    uint8_t *open;         /* vertices: edges at them are to be tried; the others were tried
                              before. NULL: all are */
    cwi_quadric *quadrics; /* vertices; NULL: from the triangles */
    size_t
        attributes; /* that count; 0: the next three are NULL. Texture coordinates come last */
    float *values;  /* vertices x attributes, but for texture coordinates; NULL where there are
                              gradients */
    float *areas;   /* vertices: of the triangles whose mean the gradients are */
    cwi_attribute_gradient *gradients; /* vertices x attributes; NULL: from the triangles */
    float *texture;      /* own triangles x 3 x 2: texture coordinates of corners; NULL: none */
    float texture_scale; /* the length that the side of the texture has on the surface */
    bool holds_seams;    /* seams of the texture stay as they are */
    uint32_t *nearest_points; /* own: first point of a list; NULL without an original */
    size_t
        nonmanifold_count; /* vertices that were no single fan, or at an edge of more than two */
    float low[3], high[3];    /* vertices are moved to low <= x < high only */
    float along[3], from, to; /* and to from <= along . x <= to */
} cwi_mesh_block;

typedef struct cwi_block_desc {
    double error; /* the distance to keep; 0: none */
    bool allow_crossings, keep_border;
    const cw_progress *progress; /* asked from any thread; borrowed until the end */
} cwi_block_desc;

typedef struct cwi_decimater cwi_decimater;

typedef struct cwi_openmesh_functions {
    /* Nothing is borrowed but the original. Free with close. */
    cw_status (*open)(const cwi_mesh_block *block, const cwi_block_desc *desc,
                      const cwi_original *original, cwi_decimater **out, cw_error *err);
    /* Collapses edges in order of their cost, while it is at most `cost`, and there are more
     * than `min_triangles` triangles. */
    cw_status (*run)(cwi_decimater *decimater, float cost, size_t min_triangles, cw_error *err);
    /* Triangles of the block's own that are left. */
    size_t (*triangles)(const cwi_decimater *decimater);
    /* The cost of the next collapse to try; infinite when there is none. */
    float (*next)(const cwi_decimater *decimater);
    /* Takes the remaining triangles, own ones only, in arrays from cwi_alloc_array(). */
    cw_status (*take)(const cwi_decimater *decimater, cwi_mesh_block *out, cw_error *err);
    void (*close)(cwi_decimater *decimater);
} cwi_openmesh_functions;

extern CW_API const cwi_openmesh_functions cwi_module_openmesh;

#ifdef __cplusplus
}
#endif

#endif
