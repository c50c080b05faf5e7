/* Moves of a label map's vertices along the normals of its patches, and how they change volumes. */
#ifndef EXTRACT_LABELS_LABEL_MOVES_H
#define EXTRACT_LABELS_LABEL_MOVES_H

#include "extract/labels/label_net.h"

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The sum of the triangles' area vectors around a vertex in one patch. */
typedef struct cwi_label_direction {
    float normal[3], area;
    uint32_t patch;
} cwi_label_direction;

/* Facts of a patch. Normals are twice as long as areas throughout. */
typedef struct cwi_patch_facts {
    double volume;     /* between it and the volume's middle, inside of its labels[0]; signed */
    double area;       /* of its triangles */
    double effect;     /* by how much its volume changes with its pressures: of all vertices, */
    double extent;     /* held against their area; */
    double held;       /* and the part of vertices that their bounds hold */
    double difference; /* of pressures across it, by which to move its vertices; 0: they stay */
    bool is_changed;   /* since it was measured */
} cwi_patch_facts;

/* Set the first block and zero the rest. */
typedef struct cwi_label_moves {
    cwi_label_net *net;                /* finished */
    const cw_label_surfaces *surfaces; /* whose mesh may be elsewhere */
    const float *originals;            /* places before smoothing, counted in voxels */
    float *places;                     /* those now */
    const size_t *dim;                 /* of the volume */
    float bound;                       /* how far a vertex may be from its first place */

    double side;   /* on which triangles have their normals in the grid: -1 if the world is a
                    mirror image of it */
    bool is_first; /* measurement, which finds directions too */
    cwi_patch_facts *patches;
    cwi_label_direction *directions; /* of vertices in one patch */
    size_t curve_count;
    uint32_t *curve;      /* vertices on curves */
    size_t *curve_firsts; /* where a vertex's part of `curve_shares` begins */
    cwi_label_direction
        *curve_shares; /* in each of its patches; the first has the area of all */
    uint8_t *held;     /* of vertices: bit n if the bound holds it along axis n */
    uint32_t *few;     /* vertices of the patches that move; NULL: all vertices */
    size_t few_count;  /* of them */
    uint8_t *moved;    /* of vertices: 1 is added to those that move; or NULL */
} cwi_label_moves;

/* Makes the arrays. Returns false when memory is out; free them either way. */
CW_NODISCARD bool cwi_label_moves_init(cwi_label_moves *m);
void cwi_label_moves_free(cwi_label_moves *m);

/* Measures the volumes and areas of the patches that are changed.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_label_moves_measure(cwi_label_moves *m, const cw_labels_desc *desc,
                                               cw_error *err);

/* Moves the vertices of patches by their differences of pressures.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_label_moves_apply(cwi_label_moves *m, const cw_labels_desc *desc,
                                             cw_error *err);

/* Tells that a vertex is elsewhere: its patches are changed. */
void cwi_label_moves_mark(cwi_label_moves *m, size_t vertex);

#ifdef __cplusplus
}
#endif

#endif
