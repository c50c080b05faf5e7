/* The state of a boolean: what the steps of mesh_boolean.c hand on. */
#ifndef SIMPLIFY_BOOLEAN_BOOLEAN_STATE_H
#define SIMPLIFY_BOOLEAN_BOOLEAN_STATE_H

#include "simplify/boolean/complex.h"

#include <cubewright/boolean.h>

/* Triangles on the grid, with what they came from. */
typedef struct cwi_grid_solids {
    cwi_soup soup;
    double scale;      /* grid units of 1 mm, a power of two */
    uint32_t *inputs;  /* of each triangle */
    uint32_t *sources; /* of each triangle: its number among those of all meshes */
    size_t input_count;
    bool *
        moved; /* of each triangle: a corner moved since the last arrangement; NULL: all are new */
    size_t flat_count; /* triangles without area, behind the others */
    size_t dropped, turned, open_mesh;
    double moved_mm;
} cwi_grid_solids;

/* Triangles of a result, with one vertex for each sheet of surface at a point. */
typedef struct cwi_sheets {
    size_t vertex_count, triangle_count;
    uint32_t *points;    /* of each vertex: a point of the arrangement */
    uint32_t *triangles; /* triangle_count x 3, vertices */
    uint32_t *sources;   /* of each triangle */
    size_t contact_edges, contact_vertices;
} cwi_sheets;

/* Puts the meshes on a grid, with one number for each place.
 * Returns  CW_ERR_CHECK: a mesh is open; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_solids_gather(const cw_mesh *const *meshes, size_t count,
                                         cwi_grid_solids *out, cw_error *err);

/* Puts triangles of a former result on a grid.
 * positions  x, y, z of each vertex, mm
 * first_new  points from this number on are no vertices of the former solids: they moved */
CW_NODISCARD cw_status cwi_solids_again(const float *positions, const cwi_sheets *sheets,
                                        size_t first_new, double scale, cwi_grid_solids *out,
                                        cw_error *err);

/* Moves vertices of triangles that meet onto others within a radius, in grid units, and inserts them into edges and
 * facets that are so close; *moved_mm grows to the largest movement. Vertices of other triangles stay.
 * edges_meet  edges that pass each other so closely get a vertex in common */
CW_NODISCARD cw_status cwi_solids_snap(cwi_grid_solids *solids, const cwi_meetings *meetings,
                                       const cwi_seams *seams, double radius, bool edges_meet,
                                       double *moved_mm, cw_error *err);

/* Puts triangles without area behind the others, and drops those that name a vertex twice. Edges that only a
 * flat triangle joins lie on one another, so that nothing is open without it; it counts again when vertices move. */
CW_NODISCARD cw_status cwi_solids_set_flat_aside(cwi_grid_solids *solids, cw_error *err);
void cwi_solids_free(cwi_grid_solids *solids);

/* Gives cells that are thinner than `thickness`, in grid units, to what most of their surface borders on: of those
 * that a triangle bounds that moved. *moved_mm grows to the largest thickness. */
CW_NODISCARD cw_status cwi_absorb_thin_cells(const cwi_grid_solids *solids,
                                             const cwi_triangle_parts *parts,
                                             const cwi_facets *facets,
                                             const cwi_space_cells *cells, double thickness,
                                             uint8_t *kept, double *moved_mm, cw_error *err);

/* Finds inputs that are empty, turned, or have shells inside out, and the regions that are lost by that.
 * kept    of each cell; CWI_NEGATIVE is taken out of it
 * inputs  of each mesh: its flags; may be NULL
 * facts   negative_regions and negative_mm3 are set */
CW_NODISCARD cw_status cwi_find_input_facts(
    const cw_mesh *const *meshes, const cwi_grid_solids *solids,
    const cwi_triangle_parts *parts, const cwi_facets *facets, const cwi_space_cells *cells,
    uint8_t *kept, uint8_t *inputs, cw_boolean_facts *facts, cw_error *err);

/* Computes six times the signed volume between three points of an arrangement and an origin, in grid units. */
double cwi_cone_volume(const cwi_grid_solids *solids, const cwi_triangle_parts *parts,
                       const uint32_t corners[3], const double origin[3]);

/* Collects the facets between cells inside of a result and others, and sews them into manifold sheets.
 * kept  of each cell; `bit` says which result */
CW_NODISCARD cw_status cwi_sew_sheets(const cwi_grid_solids *solids, const cwi_facets *facets,
                                      const cwi_space_cells *cells, const uint8_t *kept,
                                      uint8_t bit, cwi_sheets *out, cw_error *err);
void cwi_sheets_free(cwi_sheets *sheets);

/* Gives a result, which has vertices and triangles, the attributes of the meshes. */
CW_NODISCARD cw_status cwi_carry_attributes(const cw_mesh *const *meshes, size_t count,
                                            const cwi_sheets *sheets, cw_mesh *out,
                                            cw_error *err);

#endif
