/* Which bytes of the voxels in a file are wanted, when they are not all. */
#ifndef FORMATS_VOLUME_REGION_RUNS_H
#define FORMATS_VOLUME_REGION_RUNS_H

#include "formats/volume/voxel_source.h"

/* The voxels of a file are a nest of axes, and a box of them is a series of runs: bytes that
 * stand together, and then the same again some way on, along each axis that is slower. */
typedef struct cwi_runs {
    uint64_t next;  /* the first byte that is wanted and not taken; behind the last: end */
    uint64_t end;   /* behind the last byte that is wanted */
    uint64_t bytes; /* of a run */
    uint64_t left;  /* of the run under way; 0: there are no more */
    size_t axis_count;
    struct {
        uint64_t stride;
        size_t count, at;
    } axes[CWI_ROLE_COUNT];
} cwi_runs;

/* The runs of a box that lies in the source, or of all its voxels (NULL), counted from the
 * first voxel of its first file; of x, y and z every n-th alone. */
void cwi_runs_plan(cwi_runs *runs, const cwi_source *src, const cw_box *box,
                   const size_t every[3]);

/* Goes on behind bytes that were taken, at most those left of the run. */
void cwi_runs_take(cwi_runs *runs, uint64_t bytes);

#endif
