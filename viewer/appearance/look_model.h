/* Surfaces made ready to be drawn: one list of vertices and triangles for all parts. */
#ifndef VIEWER_APPEARANCE_LOOK_MODEL_H
#define VIEWER_APPEARANCE_LOOK_MODEL_H

#include "viewer/appearance/look_texture.h"
#include <cubewright/appearance.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_look_part {
    size_t first_triangle;
    bool is_flat; /* without normals */
    cwi_look_texture normal_map, color_map, occlusion_map;
} cwi_look_part;

typedef struct cwi_look_model {
    double origin[3]; /* of positions, in the world */
    float (*positions)[3];
    float (*normals)[3];     /* NULL: all parts are flat */
    float (*colors)[3];      /* linear; NULL: all parts are white */
    float (*face_colors)[3]; /* of triangles, linear; NULL: none */
    float (*uv)[2];          /* NULL: no maps */
    float (*tangents)[4];    /* NULL: no normal maps */
    uint32_t (*triangles)[3];
    cwi_look_part *parts;
    size_t vertex_count, triangle_count, part_count;
    bool has_maps;
} cwi_look_model;

/* Checks surfaces and joins them.
 * Returns  as cw_appearance_measure(); free the model in any case */
CW_NODISCARD cw_status cwi_look_model_make(const cw_surface_look *surface, size_t count,
                                           cwi_look_model *model, cw_error *err);
void cwi_look_model_free(cwi_look_model *model);

/* Finds the middle of the box of all triangles, in the world, and the distance of the farthest vertex from
 * there. Returns false for a model without triangles, or without extent. */
bool cwi_look_model_extent(const cwi_look_model *model, double center[3], double *radius_mm);

/* Finds the part of a triangle. */
const cwi_look_part *cwi_look_part_of(const cwi_look_model *model, size_t triangle);

#ifdef __cplusplus
}
#endif

#endif
