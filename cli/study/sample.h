/* Some of the triangles of a mesh. */
#ifndef CLI_STUDY_SAMPLE_H
#define CLI_STUDY_SAMPLE_H

#include <cubewright/mesh.h>

typedef struct cli_sample {
    size_t one_of;      /* so many triangles one was taken; 1: all, and nothing is held */
    cw_mesh mesh;       /* positions and triangles */
    uint32_t *vertices; /* of the mesh, those of the sample */
} cli_sample;

/* Takes about so many triangles at most, fewer where they are larger than the face of a voxel,
 * at random but always the same ones. CW_ERR_NO_MEMORY */
cw_status cli_take_sample(const cw_mesh *mesh, size_t most, double voxel_mm, cli_sample *sample,
                          cw_error *err);
void cli_free_sample(cli_sample *sample);

/* What to measure. */
const cw_mesh *cli_sampled(const cli_sample *sample, const cw_mesh *mesh);

/* Values of the sample's vertices for all vertices of the mesh: the others have that of one
 * near by. */
void cli_spread_sample(const cli_sample *sample, const float *sampled, const cw_mesh *mesh,
                       float *values);

#endif
