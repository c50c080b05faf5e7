/* The state of a voxelization: meshes in the index space of a grid, sorted into blocks of layers. */
#ifndef EXTRACT_VOXELIZE_VOXELIZE_STATE_H
#define EXTRACT_VOXELIZE_VOXELIZE_STATE_H

#include <cubewright/voxelize.h>

/* Layers of voxels that are filled together: triangles that cross several are prepared once. */
enum { CWI_VOXELIZE_LAYERS = 8 };

/* Sums of a block, by mesh. */
typedef struct cwi_voxelize_counts {
    size_t voxels, overlapped, repeated, negative;
    double covered; /* voxels, by fractions */
} cwi_voxelize_counts;

typedef struct cwi_voxelize {
    const cw_mesh *const *meshes;
    size_t count;
    const cw_voxelize_desc *desc;
    cw_volume *volume;
    size_t *first_vertex, *first_triangle; /* count + 1 */
    double (*points)[3];                   /* fractional indices of all vertices */
    int *turn;             /* of each mesh: 1 where a row leaves it through triangles that run
                              counter-clockwise, seen from high x; -1 where it enters */
    uint32_t *label;       /* of each mesh */
    int64_t lattice;       /* steps of a voxel, to which points are rounded for exact tests */
    size_t blocks, *first; /* blocks + 1: of each block, in `list` */
    uint32_t *list;        /* numbers of triangles, rising in a block; over all meshes */
    cwi_voxelize_counts *counts; /* blocks x count */
    bool no_memory;
} cwi_voxelize;

/* Stores numbers as they come. */
typedef struct cwi_row_events {
    void *items;
    size_t count, capacity;
    bool failed;
} cwi_row_events;

/* Returns where the next element goes, or NULL when memory is out. */
void *cwi_row_events_add(cwi_row_events *events, size_t size);

/* The rows of a block, and the events that triangles leave in them. */
typedef struct cwi_block_rows {
    const cwi_voxelize *v;
    cwi_row_events events; /* the first member of each is the uint32_t number of its row */
    size_t low, high;      /* the first layer, and the one behind the last */
    size_t count;          /* rows */
    size_t *first;         /* count + 1: of each row, in `sorted` */
    void *sorted; /* the events by row; those of a row in the order in which they came */
} cwi_block_rows;

/* Lets each triangle of a block leave its events, and sorts them.
 * size     bytes of an event
 * leave    adds the events of a triangle of a mesh
 * Returns  false when memory is out; free with cwi_block_rows_free() in any case */
bool cwi_block_rows_fill(cwi_block_rows *rows, const cwi_voxelize *v, size_t block, size_t size,
                         void (*leave)(cwi_block_rows *rows, size_t triangle, size_t mesh));
void cwi_block_rows_free(cwi_block_rows *rows);

/* Fill the layers of a block. Work on different blocks may go on at the same time. */
void cwi_voxelize_labels(void *state, size_t block);
void cwi_voxelize_coverage(void *state, size_t block);

/* Finds what is thinner than a voxel, and stores it in the facts of a mesh. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_find_thin_places(const cwi_voxelize *v, size_t mesh,
                                            cw_voxelize_part *part, cw_error *err);

/* Returns the number of the mesh that a triangle belongs to, from that of an earlier triangle. */
static inline size_t cwi_voxelize_mesh(const cwi_voxelize *v, size_t triangle, size_t mesh)
{
    while (triangle >= v->first_triangle[mesh + 1])
        mesh++;
    return mesh;
}

/* Returns the points of a triangle's corners. */
static inline void cwi_voxelize_corners(const cwi_voxelize *v, size_t triangle, size_t mesh,
                                        const double *corners[3])
{
    const uint32_t *c = v->meshes[mesh]->triangles + 3 * (triangle - v->first_triangle[mesh]);
    for (int n = 0; n < 3; n++)
        corners[n] = v->points[v->first_vertex[mesh] + c[n]];
}

#endif
