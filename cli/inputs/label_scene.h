/* The labels of a label map as pictures show them: names, colours, opacities and surfaces. */
#ifndef CLI_INPUTS_LABEL_SCENE_H
#define CLI_INPUTS_LABEL_SCENE_H

#include "cli/inputs/label_choice.h"

#include <cubewright/mesh.h>

/* Options that say which labels are shown, and how; each may be NULL. */
typedef struct cli_label_look {
    const char *labels, *names, *opacity;
    cli_length smooth;
} cli_label_look;

/* Labels of one step. A zeroed scene has no labels. Free with cli_free_label_scene(). */
typedef struct cli_label_scene {
    bool has_names;
    cli_label_names names;
    cli_label_choice choice;
    double max_move;      /* of smoothing, in voxels; 0: off */
    cw_label_table shown; /* the chosen labels that occur, complete, with their opacities. Those
                             that are hidden are in slices alone */
    size_t *voxels;       /* of each of those */
} cli_label_scene;

/* Finds the labels of a volume's step that are shown. Names are those of the first step. Says
 * which of the chosen labels do not occur.
 * look     with labels
 * Returns  as cli_find_label_names(), cli_choose_labels(), cw_label_counts(); CW_ERR_ARGUMENT for
 *          opacities and a limit of smoothing that are not understood; CW_ERR_EMPTY: no voxel has one of the labels;
 *          CW_ERR_UNSUPPORTED: sparse and irregular grids */
CW_NODISCARD cw_status cli_find_shown_labels(const cli_label_look *look, const cli_input *input,
                                             size_t step, cli_volume *volume,
                                             cli_label_scene *scene, cw_error *err);
void cli_free_label_scene(cli_label_scene *scene);

/* Returns the number of labels that are not clear, and in 3D not hidden. */
size_t cli_count_visible(const cli_label_scene *scene, bool in_3d);

/* Makes a mesh of the surfaces of the labels that cli_find_shown_labels() found, as
 * cw_label_colored_mesh(). Says how many are hidden.
 * Returns  as cw_extract_labels(); CW_ERR_EMPTY: all are clear or hidden */
CW_NODISCARD cw_status cli_make_label_mesh(const cli_input *input, size_t step,
                                           const cli_volume *volume,
                                           const cli_label_scene *scene, cw_mesh *mesh,
                                           cw_error *err);

/* Selects the components of a volume that hold labels: all, or the one that was chosen. */
void cli_label_layers(const cli_volume *volume, const cli_input *input, size_t *first,
                      size_t *end);

/* Finds the label of the voxel nearest to a point of the world: of components that overlap, the
 * last. Returns false for the background, and beyond the volume. */
bool cli_find_label_at(const cli_volume *volume, const cli_input *input, size_t step,
                       const double world[3], uint32_t *layer, uint32_t *value);

/* Finds if a volume is drawn as labels when nobody asked for a way to draw it: the file says so,
 * or its values look like labels. `what` gets a line about it, "": it is not. */
CW_NODISCARD cw_status cli_looks_like_labels(const cli_volume *volume,
                                             char what[CLI_LABELS_TEXT], cw_error *err);

#endif
