/* Irregular grids: from cells of any shape to the surface. The parts, in the order in which
 * they are used; cell_surface.c is the recipe.
 *
 * The surface is made of elements: cells with corners on both sides and, where it is capped,
 * also those wholly inside. A face of an element is numbered 6 times the element + the shape's
 * face. */
#ifndef EXTRACT_IRREGULAR_CELL_SURFACE_H
#define EXTRACT_IRREGULAR_CELL_SURFACE_H

#include "core/cases/case_tables.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"
#include "extract/dense/bit_planes.h"

#define CWI_NO_FACE UINT32_MAX

enum { CWI_CELL_CHUNK = 4096, CWI_CELL_FACES = 6 };

/* A third side, beside those of bit_planes.h: that of samples without value. */
enum { CWI_ABSENT = 4 };

typedef struct cwi_element {
    uint32_t corners[8]; /* samples, as cwi_shape numbers them */
    uint8_t shape;
    uint8_t inside;          /* bit a corner: its case */
    uint16_t crossed;        /* bit an edge */
    bool flip;               /* the shape's outward is inward here */
    uint32_t plan;           /* of its surface, as cwi_cell_plan_pack() has it */
    uint32_t first_crossing; /* of its crossed edges, in cwi_cells.crossings */
    uint32_t first_vertex;   /* of those on edges that no element before it has */
    uint32_t first_inner;    /* vertex inside it */
    size_t first_triangle;
} cwi_element;

/* A face that no other element has, where the surface ends or is capped. */
typedef struct cwi_border_face {
    uint32_t face;
    uint32_t corners[4]; /* vertices of a cap at its inside corners, by position in the face */
    uint32_t middles[4]; /* on the side of a cap from a position to the next; seldom */
    uint32_t centres[2]; /* inside its polygons; seldom */
    size_t first_triangle; /* of the caps' */
} cwi_border_face;

typedef struct cwi_cells {
    cw_volume volume; /* resolved: one component, one step */
    const cw_extract_desc *desc;
    cwi_level level;
    double centre[3];              /* middle of the points' box: the origin of positions */
    double reach;                  /* the longest side of that box */
    double largest;                /* finite number among the samples, without its sign */
    uint8_t *sides;                /* of the samples */
    size_t chunks, *chunk_corners; /* where the corners of each chunk of cells begin */
    cwi_element *elements;
    size_t count;
    uint32_t *across;    /* count x CWI_CELL_FACES: the face on the other side; CWI_NO_FACE:
                            none, or none that matters */
    uint32_t *crossings; /* of elements' crossed edges: sets, then the vertices there */
    size_t crossing_count;
    cwi_border_face *border;
    size_t border_count;
    size_t edge_vertices, inner_vertices, cap_vertices; /* are numbered in this order */
    size_t cap_triangle, cap_triangles; /* the first one, and how many there are */
    size_t pairing_bytes;               /* held for a while */
    cw_extract_counts counts;
} cwi_cells;

/* Extracts the surface of an irregular grid as cw_extract() does. Without a mesh it is only
 * counted; counts may be NULL. */
CW_NODISCARD cw_status cwi_cells_extract(const cw_volume *volume, const cw_extract_desc *desc,
                                         cw_mesh *mesh, cw_extract_counts *counts,
                                         cw_error *err);

/* --- active_elements.c ---------------------------------------------------------------------- */

/* Checks the grid, and compares its samples with the isovalue. */
CW_NODISCARD cw_status cwi_cells_init(cwi_cells *g, const cw_volume *volume,
                                      const cw_extract_desc *desc, cw_error *err);
void cwi_cells_free(cwi_cells *g);

/* Finds the elements. */
CW_NODISCARD cw_status cwi_cells_gather(cwi_cells *g, cw_error *err);

/* --- degenerate_cells.c -------------------------------------------------------------------- */

/* Turns an element with repeated corners into one that all later steps can process. Returns
 * false where none encloses the same volume. */
bool cwi_element_collapse(cwi_element *e);

/* --- face_pairing.c ----------------------------------------------------------------------- */

/* Finds the positions in a face whose corner is not the next one's sample: 3 or 4 of them,
 * fewer in cells that have to be collapsed. The edge from each leads to the next one. */
int cwi_face_ring(const cwi_element *e, int face, uint8_t ring[4]);

/* Returns the position, in a face of an element, at which the edge between two samples
 * starts. */
int cwi_edge_position(const cwi_element *e, int face, uint32_t s, uint32_t t);

/* Returns true if the surface, or a cap, runs through a face. */
bool cwi_face_matters(const cwi_cells *g, const cwi_element *e, int face);

/* A face's samples in an order that does not depend on the cell: from the least toward the
 * lesser of its neighbours. UINT32_MAX ends those of a triangle. */
typedef struct cwi_face_key {
    uint32_t samples[4];
    bool reversed; /* against the order of the cell's face */
} cwi_face_key;

cwi_face_key cwi_face_key_of(const cwi_element *e, int face);

/* Finds the faces that two elements share, and turns elements so that neighbours agree on the
 * outward direction. */
CW_NODISCARD cw_status cwi_cells_pair_faces(cwi_cells *g, cw_error *err);
CW_NODISCARD cw_status cwi_cells_orient(cwi_cells *g, cw_error *err);

/* --- boundary_faces.c ---------------------------------------------------------------------- */

/* Lists the border's faces, numbers the vertices of caps, after all others, and their
 * triangles, and counts border loops. */
CW_NODISCARD cw_status cwi_cells_find_border(cwi_cells *g, cw_error *err);

/* --- caps.c ------------------------------------------------------------------------ */

void cwi_cells_write_caps(const cwi_cells *g, cw_mesh *mesh);

/* Moves vertices of the border that coincide a little apart, each into its cells. */
CW_NODISCARD cw_status cwi_cells_part(const cwi_cells *g, cw_mesh *mesh, cw_error *err);

/* --- least_squares_gradients.c --------------------------------------------------------------------- */

/* Gradients of the stored numbers at the corners of crossed elements, in the world, all by the
 * same factor; zero where there is none. */
typedef struct cwi_gradients {
    uint32_t *rows; /* of the samples; UINT32_MAX: none */
    double (*at)[3];
} cwi_gradients;

CW_NODISCARD cw_status cwi_cells_gradients(const cwi_cells *g, cwi_gradients *out,
                                           cw_error *err);
void cwi_gradients_free(cwi_gradients *gradients);

/* ----------------------------------------------------------------------------------------- */

static inline const cwi_shape *cwi_shape_of(const cwi_element *e)
{
    return &cwi_shapes[e->shape];
}

static inline double cwi_stored_at(const cwi_cells *g, uint32_t sample)
{
    return cwi_voxel_at(g->volume.type, cwi_voxel_address(&g->volume, sample, 0, 0));
}

/* Returns the place at which cw_cells lists a shape's corner: a hexahedron's around its base
 * and above it, while a cube's are x fastest. */
static inline int cwi_listed_corner(uint8_t shape, int corner)
{
    return shape == CW_HEXAHEDRON ? corner ^ (corner >> 1 & 1) : corner;
}

/* Returns the edge of a face of an element between two samples. */
static inline int cwi_edge_of(const cwi_element *e, int face, uint32_t s, uint32_t t)
{
    return cwi_shape_of(e)->face_edges[face][cwi_edge_position(e, face, s, t)];
}

/* Returns the number of chunks in which elements are processed. */
static inline size_t cwi_chunks_of(const cwi_cells *g)
{
    return (g->count + CWI_CELL_CHUNK - 1) / CWI_CELL_CHUNK;
}

static inline void cwi_chunk_of(const cwi_cells *g, size_t chunk, size_t *begin, size_t *end)
{
    *begin = chunk * CWI_CELL_CHUNK;
    *end = *begin + CWI_CELL_CHUNK < g->count ? *begin + CWI_CELL_CHUNK : g->count;
}

/* Returns a sample's value as the decisions see it: minus the isovalue, positive inside. */
static inline double cwi_value_of(const cwi_cells *g, uint32_t sample)
{
    const double stored = cwi_stored_at(g, sample);
    return g->level.invert ? g->level.at - stored : stored - g->level.at;
}

/* Computes the place of a sample in the world, from the mesh's origin. */
static inline void cwi_place_of(const cwi_cells *g, uint32_t sample, double p[3])
{
    const double *x = g->volume.cells->points + 3 * (size_t)sample;
    for (int r = 0; r < 3; r++) {
        const double *a = g->volume.affine[r];
        p[r] = a[0] * (x[0] - g->centre[0]) + a[1] * (x[1] - g->centre[1]) +
               a[2] * (x[2] - g->centre[2]);
    }
}

/* Returns the place of a crossed edge of an element in cwi_cells.crossings. */
static inline size_t cwi_crossing_slot(const cwi_element *e, int edge)
{
    const unsigned before = e->crossed & ((1u << edge) - 1);
    return e->first_crossing + (size_t)__builtin_popcount(before);
}

static inline bool cwi_corner_inside(const cwi_element *e, int corner)
{
    return e->inside >> corner & 1;
}

/* Returns true if an ambiguous face of an element joins its inside corners; the same from the
 * other side. */
bool cwi_cells_join(const cwi_cells *g, const cwi_element *e, int face);

#endif
