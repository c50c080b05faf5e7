/* Some of the triangles of a mesh. */
#ifndef CLI_REPORT_TRIANGLE_SAMPLE_H
#define CLI_REPORT_TRIANGLE_SAMPLE_H

#include <cubewright/mesh.h>

typedef struct cli_sample {
    size_t one_of; /* so many triangles one was taken; 1: all, and nothing is held */
    cw_mesh mesh;  /* positions and triangles */
} cli_sample;

/* Takes about so many triangles at most, fewer where they are larger than the face of a voxel,
 * at random but always the same ones. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_take_sample(const cw_mesh *mesh, size_t most, double voxel_mm,
                                       cli_sample *sample, cw_error *err);
void cli_free_sample(cli_sample *sample);

/* What to measure. */
const cw_mesh *cli_sampled(const cli_sample *sample, const cw_mesh *mesh);

#endif
