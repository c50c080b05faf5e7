/* Normals of vertices, from gradients of the field and from triangles. */
#ifndef EXTRACT_COMMON_FIELD_NORMALS_H
#define EXTRACT_COMMON_FIELD_NORMALS_H

#include "core/volume/surface_frame.h"

#include <cubewright/extract.h>

/* Adds the normal of a triangle, as long as twice its area in units of 1 / scale. */
void cwi_add_facet_normal(const float *const corner[3], double scale, float normal[3]);

/* Gives a sum of normals length 1; a sum of zero becomes +z. */
void cwi_finish_normal(float normal[3]);

/* Replaces normals that are zero by those of the triangles around their vertex, weighted by
 * area. */
CW_NODISCARD cw_status cwi_repair_normals(cw_mesh *mesh, double scale, cw_error *err);

/* Normals in the making, from the field around the vertices of a mesh. The field is that of a
 * volume, of which some slices may be in memory. */
typedef struct cwi_shading {
    cw_volume volume; /* resolved. Its data begin with slice `first` */
    size_t first;
    cw_mesh *mesh;        /* unchanged until the end */
    float *normals;       /* vertex_count x 3 */
    double inverse[3][3]; /* world to index, of differences */
    double outward[3][3];
} cwi_shading;

/* Sets the field: a resolved volume. invert: low numbers are inside. Mesh and normals are left to
 * the caller. */
void cwi_shading_set_field(cwi_shading *shading, const cw_volume *volume, bool invert);

/* Begins with the normals that the mesh has; free with cwi_shading_free(), also after an error.
 * Errors as cw_extract_normals(). */
CW_NODISCARD cw_status cwi_shading_init(cwi_shading *shading, const cw_volume *volume,
                                        const cw_normals_desc *desc, cw_mesh *mesh,
                                        cw_error *err);
void cwi_shading_free(cwi_shading *shading);

/* Finds the lower slice of the cell around a vertex. The vertex needs that slice, the one before
 * and the two after. Returns false outside the volume. */
bool cwi_shading_slice(const cwi_shading *shading, size_t vertex, size_t *slice);

/* Returns how many slices beyond the next one a vertex's place may be away from its cell, as its
 * position is rounded: 0 unless slices of a rectilinear grid are very close. */
size_t cwi_shading_drift(const cw_volume *volume);

/* Sets the normal of a vertex, whose slices are in memory. */
void cwi_shade_vertex(const cwi_shading *shading, size_t vertex);

/* Makes the normals that the field does not give, and hands all to the mesh. */
CW_NODISCARD cw_status cwi_shading_finish(cwi_shading *shading, cw_error *err);

#endif
