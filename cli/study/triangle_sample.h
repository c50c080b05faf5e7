/* Some of the triangles of a mesh. */
#ifndef CLI_STUDY_TRIANGLE_SAMPLE_H
#define CLI_STUDY_TRIANGLE_SAMPLE_H

#include <cubewright/mesh.h>

typedef struct cli_sample {
    size_t one_of; /* one of n triangles was taken; 1: all, and mesh is empty */
    cw_mesh mesh;  /* positions and triangles */
} cli_sample;

/* Takes about `most` triangles, and fewer where they are larger than the face of a voxel.
 * The choice is random, but always the same. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_take_sample(const cw_mesh *mesh, size_t max_count, double voxel_mm,
                                       cli_sample *sample, cw_error *err);
void cli_free_sample(cli_sample *sample);

/* Returns the mesh to measure: the sample, or the whole mesh. */
const cw_mesh *cli_sampled(const cli_sample *sample, const cw_mesh *mesh);

#endif
