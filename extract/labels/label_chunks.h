/* Chunks of layers of a label map, which threads go through one by one. */
#ifndef EXTRACT_LABELS_LABEL_CHUNKS_H
#define EXTRACT_LABELS_LABEL_CHUNKS_H

#include "core/volume/key_counts.h"
#include "extract/labels/label_cubes.h"
#include "extract/labels/label_layers.h"
#include "extract/labels/label_net.h"
#include "extract/labels/label_window.h"

#include <cubewright/labels.h>

#include <pthread.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_LABEL_CHUNK = 16 }; /* layers of cubes */

/* A chunk's share of the result. */
typedef struct cwi_label_chunk {
    cwi_key_counts pairs;  /* triangles of each; in the second pass, where the next goes */
    cwi_key_counts voxels; /* of each label */
    size_t vertices;       /* in the second pass, the number of the first */
} cwi_label_chunk;

/* An extraction: two passes over all chunks, then smoothing. */
typedef struct cwi_label_job {
    cwi_label_layers layers;
    cwi_label_window *window; /* of slices that are read; NULL: all voxels are in memory */
    cwi_label_rules rules;
    double corners[CWI_TETS][3]; /* vertices of tetrahedra, from the cube's middle */
    bool is_mirrored;
    cwi_label_net net;
    float *originals; /* places before smoothing; NULL without smoothing */
    float *places;    /* those after it, counted in voxels; at first spare */
    cw_label_surfaces *out;
    cw_label_prediction *prediction; /* filled in by the first pass; then nothing is made */
    cwi_label_chunk *chunks;
    size_t first_chunk; /* of those whose slices are in memory */
    bool is_writing;    /* the second pass */
    bool is_starved;
    pthread_mutex_t bad_lock; /* for the next two */
    bool is_bad;
    size_t bad[3]; /* the first voxel whose value is no label */
} cwi_label_job;

/* Goes through chunk n of a job, the context, counted from its first_chunk: the first pass counts,
 * the second one writes. */
void cwi_label_chunk_work(void *context, size_t n);

#ifdef __cplusplus
}
#endif

#endif
