/* The runs of wanted bytes among the voxels in a file, for a region or a preview. */
#ifndef FORMATS_VOLUME_REGION_RUNS_H
#define FORMATS_VOLUME_REGION_RUNS_H

#include "formats/volume/voxel_source.h"

/* The runs of a box. The voxels of a file are nested axes, and a box of them is a series of
 * runs. A run is a block of contiguous bytes; it repeats at a fixed distance along each slower
 * axis. */
typedef struct cwi_runs {
    uint64_t next;  /* the first wanted byte that was not taken; at the end: end */
    uint64_t end;   /* end of the last wanted byte */
    uint64_t bytes; /* of a run */
    uint64_t left;  /* of the current run; 0: there are no more */
    size_t axis_count;
    struct {
        uint64_t stride;
        size_t count, at;
    } axes[CWI_ROLE_COUNT];
} cwi_runs;

/* Plans the runs of a box in the source, or of all its voxels (NULL), relative to the first
 * voxel of its first file; along x, y and z only every n-th. */
void cwi_runs_plan(cwi_runs *runs, const cwi_source *src, const cw_box *box,
                   const size_t every[3]);

/* Advances by bytes that were taken, at most those left of the run. */
void cwi_runs_take(cwi_runs *runs, uint64_t bytes);

#endif
