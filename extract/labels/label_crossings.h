/* Search for triangles of a label map that cross. */
#ifndef EXTRACT_LABELS_LABEL_CROSSINGS_H
#define EXTRACT_LABELS_LABEL_CROSSINGS_H

#include "extract/labels/label_net.h"

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_POLYGON_QUEUED = 1, CWI_POLYGON_SOUND = 2 };

/* Converts a position counted in voxels to a point of the mesh. */
typedef void cwi_label_to_point(const void *context, const double index[3], double point[3]);

/* Polygons, and which of them to look at. Set the first block and zero the rest. */
typedef struct cwi_label_crossings {
    const cw_mesh *mesh;
    const float
        *originals;     /* vertex_count x 3: positions before smoothing, counted in voxels */
    cwi_label_net *net; /* finished */
    cwi_label_to_point *to_point;
    const void *context;

    uint8_t *flags;  /* of polygons, CWI_POLYGON_QUEUED and _SOUND */
    uint32_t *queue; /* first triangles of the polygons to look at */
    size_t queued;
    uint8_t *hits; /* of vertices: 1 if a triangle with it crosses another */
} cwi_label_crossings;

/* Finds polygons that are not proven to cross none, and queues them. Polygons of four corners may be
 * cut along their other diagonal for the proof.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; free with cwi_label_crossings_free() */
CW_NODISCARD cw_status cwi_label_crossings_init(cwi_label_crossings *c,
                                                const cw_labels_desc *desc, cw_error *err);

/* Marks in `hits` the vertices of the triangles that cross those of the queue.
 * Returns  CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_label_crossings_find(cwi_label_crossings *c,
                                                const cw_labels_desc *desc, cw_error *err);

/* Replaces the queue by the polygons around the vertices in `hits`, which have been put back, and
 * clears `hits`. */
void cwi_label_crossings_renew(cwi_label_crossings *c);

void cwi_label_crossings_free(cwi_label_crossings *c);

#ifdef __cplusplus
}
#endif

#endif
