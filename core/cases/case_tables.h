/* Tables of the 256 cube cases, the resolutions of their ambiguous faces, and the cases of
 * other cells. generate_tables.c makes them. Triangles name edges of the cell, three a
 * triangle, counter-clockwise seen from outside the solid. */
#ifndef CORE_CASES_CASE_TABLES_H
#define CORE_CASES_CASE_TABLES_H

#include <cubewright/volume.h>

enum {
    CWI_CASE_MAX_TRIANGLES = 5,
    CWI_CASE_MAX_LOOPS = 4,
    CWI_CASE_CONFIGS = 656, /* over all cases, 2 ^ (number of ambiguous faces) */
    CWI_CONFIGS = 802,      /* these first, then those of the other shapes */
};

/* Tables for one rule for every face: inside corners are kept apart. The number of triangles of
 * each case, and their corners. */
extern const uint8_t cwi_case_count[256];
extern const uint8_t cwi_case_triangles[256][3 * CWI_CASE_MAX_TRIANGLES];

/* Cases whose surface their signs alone do not settle: they have ambiguous faces, or two
 * corners that a tunnel may join. Bit f of the first table: face f is ambiguous. */
extern const uint8_t cwi_case_ambiguous_faces[256];
extern const bool cwi_case_is_ambiguous[256];

/* The number of each case's first configuration. Within a case, configurations count the
 * ambiguous faces' bits, lowest face first. A bit is set where the inside corners of the face
 * are joined. */
extern const uint16_t cwi_case_first_config[256];

/* A case with its faces resolved. Loops are directed polygons of crossed edges on the cube's
 * surface; they part it into patches. */
typedef struct cwi_config {
    uint8_t loop_count;
    uint8_t loop_length[CWI_CASE_MAX_LOOPS];
    uint8_t loop_edges[12];               /* all loops, one after another */
    bool cone[CWI_CASE_MAX_LOOPS];        /* the loop needs a vertex inside the cube */
    uint8_t triangles[3 * 10];            /* of the loops that do not, one after another */
    uint8_t patch[8];                     /* of each corner: the lowest corner of its patch */
    uint8_t triangle_count, vertex_count; /* of all loops' discs, cones among them */
} cwi_config;

extern const cwi_config cwi_configs[CWI_CONFIGS];

/* A shape of cells: how corners, edges and faces belong together, and where its configurations
 * are. A hexahedron's corners, edges and faces are numbered as in cube_numbering.h, others'
 * corners as in VTK. */
typedef struct cwi_shape {
    uint8_t corner_count, edge_count, face_count;
    uint8_t edges[12][2];      /* corners, the lower first */
    uint8_t edge_faces[12][2]; /* on both sides of it */
    uint8_t face_size[6];
    uint8_t faces[6][4];      /* corners, counter-clockwise seen from outside */
    uint8_t face_edges[6][4]; /* from corner n to n + 1 */
    uint8_t ambiguous_faces[256];
    uint16_t first_config[256];
} cwi_shape;

extern const cwi_shape cwi_shapes[CW_SHAPE_COUNT];

#endif
