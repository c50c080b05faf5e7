/* Types that the files of snapping share: a mesh while it is snapped, and one sample's
 * cluster. */
#ifndef EXTRACT_SNAP_SNAP_CLUSTER_H
#define EXTRACT_SNAP_SNAP_CLUSTER_H

#include "core/cases/cell_topology.h"
#include "extract/dense/bit_planes.h"

#include <cubewright/mesh.h>

enum {
    CWI_MEMBERS = 6, /* edges at a sample */
    CWI_FAN = 8 * CWI_CELL_MAX_TRIANGLES,
    CWI_NEARBY = 64 * CWI_CELL_MAX_TRIANGLES,
    CWI_LINK = 64, /* bits in a word; a dozen is usual */
};

/* Data of a vertex that the mesh does not have. */
typedef struct cwi_vertex_index {
    double x[3];          /* its position as stored, in padded index */
    uint64_t near_sample; /* 1 + the sample it is close to; 0: none */
} cwi_vertex_index;

/* The cells, of 64 in a row, that have triangles, and the number of such cells before them. */
typedef struct cwi_cell_word {
    uint64_t has;
    uint32_t cells_before;
} cwi_cell_word;

typedef struct cwi_snapping {
    const cwi_bit_grid *grid;
    const cwi_row *rows;
    cw_mesh *mesh;
    double snap_distance;
    double inverse[3][3], centre[3]; /* positions to padded index */
    double edge;                     /* of voxels that are cubes; else 0 */
    double shrink;             /* along any line, a voxel's length is no less in the world */
    cwi_vertex_index *indices; /* of vertices */
    uint32_t *merged_into;     /* of each vertex: the vertex it was merged into */
    float *cells_before;       /* positions */
    cwi_cell_word *cells;      /* rows x words */
    uint32_t *
        triangle_ends; /* from a row's first triangle on: where its cells' triangles end, counted
                       from there, cell by cell that has any */
} cwi_snapping;

/* Crossings close to a sample, and the triangles around them. */
typedef struct cwi_cluster {
    size_t at[3]; /* padded sample */
    uint64_t sample;
    int count, fan_count, link_count;
    uint32_t member[CWI_MEMBERS];
    size_t fan[CWI_FAN];     /* its triangles, in order */
    uint32_t link[CWI_LINK]; /* vertices around the star, in order */
    size_t owner[CWI_LINK];  /* the star's triangle at the rim's side from here to the next */
} cwi_cluster;

/* Returns the vertex after the n-th of the rim. */
static inline int cwi_link_next(const cwi_cluster *c, int n)
{
    return n + 1 < c->link_count ? n + 1 : 0;
}

uint64_t cwi_sample_number(const cwi_bit_grid *grid, size_t i, size_t j, size_t k);
void cwi_sample_index(const cwi_bit_grid *grid, uint64_t sample, size_t at[3]);

/* Convert positions in the mesh to padded index, and back. */
void cwi_to_index(const cwi_snapping *s, const float position[3], double x[3]);
void cwi_to_position(const cwi_snapping *s, const double x[3], float position[3]);

static inline const float *cwi_mesh_position(const cwi_snapping *s, uint32_t v)
{
    return s->mesh->positions + 3 * (size_t)v;
}

/* Returns true for a triangle between vertices that were merged into one. */
static inline bool cwi_is_gone(const uint32_t *t)
{
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/* Returns the place of a vertex, in padded index. */
static inline const double *cwi_index(const cwi_snapping *s, uint32_t v)
{
    return s->indices[v].x;
}

/* Finds the triangles of the cells up to `reach` (1 or 2) from a sample: CWI_FAN or CWI_NEARBY
 * at most. */
int cwi_find_triangles(const cwi_snapping *s, const size_t at[3], size_t reach, size_t *out);

bool cwi_is_member(const cwi_cluster *c, uint32_t v);

/* Finds the vertices close to v's sample that sides of triangles join to it; if there are any
 * beside v, finds their star. */
void cwi_cluster_find(const cwi_snapping *s, uint32_t v, cwi_cluster *c);

/* Finds the rim; returns false unless the star is a disc with all members inside. */
bool cwi_cluster_is_disc(const cwi_snapping *s, cwi_cluster *c);

/* Finds where all members may go: the padded index, and the position to be stored. */
bool cwi_cluster_position(const cwi_snapping *s, const cwi_cluster *c, double x[3],
                          float position[3]);

/* Returns true if the cone from x over the rim crosses neither itself nor the triangles around
 * the star. */
bool cwi_fan_is_clear(const cwi_snapping *s, const cwi_cluster *c, const double x[3]);

#endif
