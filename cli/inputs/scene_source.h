/* Source of a scene: a volume, a mesh, or a series of volumes, opened a step at a time. */
#ifndef CLI_INPUTS_SCENE_SOURCE_H
#define CLI_INPUTS_SCENE_SOURCE_H

#include "cli/inputs/time_series.h"

#include <cubewright/mesh.h>
#include <cubewright/render.h>

/* Zeroed, there is nothing. Free with cli_close_source(). */
typedef struct cli_source {
    cli_series series;
    bool is_mesh; /* the input is a mesh */
    bool is_level_set;
    bool is_uneven;    /* it is a rectilinear or irregular grid */
    bool is_label_map; /* the file says that its values are labels */
    bool of_labels;    /* labels are drawn: all components are read, unless one was chosen */
    cli_volume volume; /* of the step at hand */
    cw_volume dense;   /* of a sparse one */
    cw_mesh mesh;      /* the input's; else whatever is put here */
} cli_source;

bool cli_is_folder(const char *path);

/* Finds the steps, and out of the headers whether it is a volume or a mesh; a mesh is read.
 * A file that cannot be read as a volume is taken for a mesh, if it may be one: its reader's
 * words are then the better ones, unless the file's name speaks for a volume. */
CW_NODISCARD cw_status cli_open_source(cli_source *source, const cli_common *common,
                                       const cli_input *input, const cli_steps *steps,
                                       bool may_be_mesh, cw_error *err);
void cli_close_source(cli_source *source);

/* Reads the volume of a step, unless it is there. */
CW_NODISCARD cw_status cli_read_step(cli_source *source, const cli_input *input, size_t step,
                                     cw_error *err);

/* Computes the statistics of the values of a series: of the step that was read if it is the
 * only one, else of up to 16 steps, evenly spread from the first to the last. Of other files
 * than the one at hand large ones are sampled, row by row. Afterwards that step is read, if the
 * steps are in one file.
 * Returns CW_ERR_NO_MEMORY; as cli_read_step() */
CW_NODISCARD cw_status cli_find_statistics(cli_source *source, const cli_input *input,
                                           size_t step, size_t bins, cw_statistics *out,
                                           cw_error *err);

/* Makes a sparse volume dense so that it can be drawn, and prints a note. */
CW_NODISCARD cw_status cli_need_drawable(cli_source *source, const cli_input *input,
                                         cw_error *err);

/* Returns the default mode for the kind of grid of the volume. */
cw_mode cli_default_mode(const cli_source *source);

/* Returns the volume that is drawn: of a sparse one, the dense copy. */
const cw_volume *cli_drawn(const cli_source *source);

/* Around what is seen: the volume that is drawn (NULL: none), a mesh (NULL: none). false:
 * nothing is. */
bool cli_find_box(const cw_volume *volume, const cw_mesh *mesh, double box[2][3]);

#endif
