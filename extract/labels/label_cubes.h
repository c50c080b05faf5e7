/* Cubes between 2 x 2 x 2 voxels of a label map: their tetrahedra, and which of them can be one
 * point. */
#ifndef EXTRACT_LABELS_LABEL_CUBES_H
#define EXTRACT_LABELS_LABEL_CUBES_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_TETS = 6, CWI_EDGES = 8, CWI_RING = 6 };

/* The tetrahedra around an edge of tetrahedra, in the order in which a right-handed screw turns
 * that goes along the edge. */
typedef struct cwi_label_ring {
    int count;
    int8_t cube[CWI_RING][3]; /* the tetrahedron's cube: 0 or -1 along each axis, from the cube
                                 whose corner 0 is the edge's start */
    uint8_t tet[CWI_RING];
} cwi_label_ring;

/* The cubes around an edge, in the order of its ring. */
typedef struct cwi_label_edge_cubes {
    int count;
    int8_t cube[4][3]; /* as in a ring */
} cwi_label_edge_cubes;

/* Facts that follow from the definition of the tetrahedra. Bit a of a corner's number is its
 * place along axis a; sets of corners are bits of a byte. */
typedef struct cwi_label_rules {
    uint8_t tets[CWI_TETS]; /* corners */
    /* True for the corners of a label if neither it nor the rest is in two parts on the cube's
     * surface, nor touches a face of the cube with two corners that are apart. */
    bool is_simple[256];
    cwi_label_ring rings[CWI_EDGES]; /* of the edge from corner 0 to corner n; none of 0 */
    cwi_label_edge_cubes around[CWI_EDGES];
    uint8_t prisms[3]; /* tetrahedra of the second of two prisms along an axis, as bits */
} cwi_label_rules;

static inline int cwi_count_bits(uint32_t bits)
{
    int count = 0;
    for (; bits; bits &= bits - 1)
        count++;
    return count;
}

void cwi_label_rules_make(cwi_label_rules *rules);

/* The vertices of a cube: 0: none, as all corners have one label; CWI_CUBE_SIMPLE: one in its
 * middle; CWI_CUBE_PRISMS and an axis: one for each of two prisms along it; else a bit for each
 * tetrahedron that has one. */
enum { CWI_CUBE_SIMPLE = 0x80, CWI_CUBE_PRISMS = 0x40 };

uint8_t cwi_label_cube(const cwi_label_rules *rules, const uint32_t labels[8]);

/* Returns the number of vertices of a cube. */
static inline size_t cwi_label_cube_vertices(uint8_t cube)
{
    return cube == CWI_CUBE_SIMPLE  ? 1
           : cube & CWI_CUBE_PRISMS ? 2
                                    : (size_t)cwi_count_bits(cube);
}

/* Returns which of a cube's vertices is that of a tetrahedron. */
static inline uint32_t cwi_label_cube_vertex(const cwi_label_rules *rules, uint8_t cube,
                                             int tet)
{
    if (cube == CWI_CUBE_SIMPLE)
        return 0;
    if (cube & CWI_CUBE_PRISMS)
        return rules->prisms[cube & 3] >> tet & 1;
    return (uint32_t)cwi_count_bits(cube & ((1u << tet) - 1));
}

#ifdef __cplusplus
}
#endif

#endif
