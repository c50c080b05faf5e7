/* The inner loops of extraction, compiled once for any machine and again for better instruction
 * sets. All engines give the same bytes. */
#ifndef EXTRACT_DENSE_ISA_DISPATCH_H
#define EXTRACT_DENSE_ISA_DISPATCH_H

#include "core/cases/case_tables.h"
#include "core/cases/cube_numbering.h"
#include "extract/dense/minmax_octree.h"

#include <cubewright/mesh.h>

/* Triangles of a case, in the order in which they are written, three edges each; padded so that
 * 16 can be read at once. */
typedef struct cwi_case_emission {
    _Alignas(32) uint8_t edge[16];
    uint8_t crossed[CWI_EDGE_ROWS]; /* 1 where the edge in the row is */
    uint8_t edges;                  /* how many; 0: signs alone do not settle the surface */
} cwi_case_emission;

/* Triangles written for cells: those of each case, and those of each configuration of a case
 * that has no vertices inside the cell. */
typedef struct cwi_emission {
    cwi_case_emission of_case[256];
    uint8_t config_edge[CWI_CASE_CONFIGS][32];
    uint8_t config_edges[CWI_CASE_CONFIGS]; /* how many; 0: there are vertices inside */
    bool flip; /* triangles are turned round, as the affine mirrors */
} cwi_emission;

/* Destination of vertices: arrays, and the maps from index space. */
typedef struct cwi_vertex_sink {
    float *positions, *normals; /* normals may be NULL */
    size_t first;               /* number of the vertex at the start of the arrays */
    double affine[3][3];        /* index to world directions */
    bool diagonal;              /* only the diagonal is not 0 */
    double centre[3];           /* index, or coordinate, that stands at the mesh's origin */
    const cw_volume *grid;      /* that these coordinates are of */
    double cofactor[3][3];      /* index gradient to outward world direction */
    float cap[3][2][3];         /* normals of caps across an axis, low and high side */
    bool missing;               /* some normal is zero as the gradient vanished */
} cwi_vertex_sink;

/* A part of a surface to write: vertices and triangles of some rows in some layers. */
typedef struct cwi_row_span {
    size_t begin, end;     /* layers of vertices, from begin to end - 1 */
    size_t cells;          /* layers of triangles, from begin to cells - 1 */
    size_t row, row_end;   /* rows of each layer, from row to row_end - 1 */
    size_t plan;           /* number of ambiguous cells of layer `begin` before the first row */
    size_t first_triangle; /* number of the triangle at the start of the array */
} cwi_row_span;

struct cwi_engine {
    const char *name;
    bool (*usable)(void);
    /* Writes the inside bits of the wanted samples in brick layer b: eight layers of padded
     * samples, or as many as are left. Where values are sought, it also writes which samples
     * have values. Unless leaves is NULL, it writes the ranges of the layer's bricks. Reports
     * whether samples with values are on each side. */
    void (*classify_layer)(const cwi_bit_grid *grid, size_t b, cwi_range *leaves, bool *in,
                           bool *out);
    /* Writes the inside bits of `rows` rows of layer k, from row j on, all of them wanted.
     * Reports `in` and `out` as classify_layer does. */
    void (*classify_rows)(const cwi_bit_grid *grid, size_t j, size_t k, size_t rows, bool *in,
                          bool *out);
    /* Finds the ranges of some of a tree's leaves again, and those of the leaves in the same words.
     * leaves: all of the tree's, level 0 */
    void (*measure_leaves)(const cwi_bit_grid *grid, const cwi_leaf_box *box,
                           cwi_range *leaves);
    /* Sets `in` if some of `count` packed voxels, a multiple of 64, are inside, and `out` if
     * some are not. Clears neither. */
    void (*find_sides)(const cwi_bit_grid *grid, const void *voxels, size_t count, bool *in,
                       bool *out);
    /* Stores a layer's counts, not yet first numbers, in its rows. */
    void (*count_layer)(const cwi_bit_grid *grid, size_t k, cwi_row *rows);
    /* Writes the vertices and triangles of a span to their places. */
    void (*write_span)(const cwi_bit_grid *grid, const cwi_row_span *span, const cwi_row *rows,
                       const cwi_emission *emission, cwi_vertex_sink *sink,
                       uint32_t *triangles);
};

/* Returns the n-th engine this machine can use, the plain one first; NULL when there are
 * fewer. */
const cwi_engine *cwi_engine_at(size_t n);
const cwi_engine *cwi_engine_best(void);

/* In files that are compiled for each engine, CWI_ENGINE is its name, and CWI_WIDE is whether
 * it may shuffle, count and compress bytes and bits in words of 512 bits. */
#ifdef CWI_ENGINE
#if defined __AVX512VBMI2__ && defined __AVX512VBMI__ && defined __GFNI__ &&                   \
    defined __AVX512VPOPCNTDQ__
#define CWI_WIDE 1
#else
#define CWI_WIDE 0
#endif
#define CWI_PASTE(a, b)    a##_##b
#define CWI_EXPAND(a, b)   CWI_PASTE(a, b)
#define CWI_OF_ENGINE(a)   CWI_EXPAND(a, CWI_ENGINE)
#define cwi_classify_layer CWI_OF_ENGINE(cwi_classify_layer)
#define cwi_classify_rows  CWI_OF_ENGINE(cwi_classify_rows)
#define cwi_measure_leaves CWI_OF_ENGINE(cwi_measure_leaves)
#define cwi_find_sides     CWI_OF_ENGINE(cwi_find_sides)
#define cwi_count_layer    CWI_OF_ENGINE(cwi_count_layer)
#define cwi_write_span     CWI_OF_ENGINE(cwi_write_span)
#define cwi_place_vertices CWI_OF_ENGINE(cwi_place_vertices)

void cwi_classify_layer(const cwi_bit_grid *grid, size_t b, cwi_range *leaves, bool *in,
                        bool *out);
void cwi_classify_rows(const cwi_bit_grid *grid, size_t j, size_t k, size_t rows, bool *in,
                       bool *out);
void cwi_measure_leaves(const cwi_bit_grid *grid, const cwi_leaf_box *box, cwi_range *leaves);
void cwi_find_sides(const cwi_bit_grid *grid, const void *voxels, size_t count, bool *in,
                    bool *out);
void cwi_count_layer(const cwi_bit_grid *grid, size_t k, cwi_row *rows);
void cwi_write_span(const cwi_bit_grid *grid, const cwi_row_span *span, const cwi_row *rows,
                    const cwi_emission *emission, cwi_vertex_sink *sink, uint32_t *triangles);
void cwi_place_vertices(const cwi_bit_grid *grid, const cwi_row_span *span, const cwi_row *rows,
                        cwi_vertex_sink *sink);
#endif

#endif
