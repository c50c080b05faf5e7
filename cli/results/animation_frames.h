/* The surfaces of all steps, kept until they become one animation. */
#ifndef CLI_RESULTS_ANIMATION_FRAMES_H
#define CLI_RESULTS_ANIMATION_FRAMES_H

#include "cli/inputs/time_series.h"

/* A zeroed one is empty. */
typedef struct cli_frames {
    struct cli_frame {
        cw_mesh mesh;
        char name[32];
    } * frames;
    cw_part *parts; /* one a frame, in order, some without triangles */
    size_t count, capacity;
    size_t empty;
    size_t bytes; /* that they take */
} cli_frames;

/* Allocates memory for `count` frames. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_frames_reserve(cli_frames *frames, size_t count, cw_error *err);
void cli_frames_free(cli_frames *frames);

/* Takes over a mesh, empty or not, as the surface of a moment: shown from its own time on or,
 * with steps_a_second, from that of its place in the row. */
void cli_frames_add(cli_frames *frames, cw_mesh *mesh, const cli_moment *moment,
                    double steps_a_second);

#endif
