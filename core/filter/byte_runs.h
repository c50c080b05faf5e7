/* Connected components of voxels that have a byte, by runs along x. */
#ifndef CORE_FILTER_BYTE_RUNS_H
#define CORE_FILTER_BYTE_RUNS_H

#include <cubewright/core.h>

#include <stdint.h>

/* Voxels in a row that follow each other. */
typedef struct cwi_byte_run {
    uint32_t first, end;
} cwi_byte_run;

/* Runs, row by row, and the component of each: the lowest of its runs. Voxels are connected through
 * their faces. */
typedef struct cwi_byte_runs {
    size_t dim[3], count;
    size_t *rows; /* dim[1] x dim[2] + 1: first run of each row */
    cwi_byte_run *runs;
    uint32_t *component; /* count */
} cwi_byte_runs;

/* Finds the runs of voxels whose byte is `value`. Free with cwi_byte_runs_free().
 * Returns CW_ERR_NO_MEMORY; CW_ERR_LIMIT for more than 2^32 - 1 runs */
CW_NODISCARD cw_status cwi_byte_runs_init(const uint8_t *bytes, uint8_t value,
                                          const size_t dim[3], cwi_byte_runs *out,
                                          cw_error *err);
void cwi_byte_runs_free(cwi_byte_runs *runs);

/* Sums the voxels of each component into the numbers of its lowest run; `voxels` has one a run. */
void cwi_byte_runs_measure(const cwi_byte_runs *runs, size_t *voxels);

#endif
