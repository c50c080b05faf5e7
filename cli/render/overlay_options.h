/* Options for marks on a picture of render, and for slices beside it. */
#ifndef CLI_RENDER_OVERLAY_OPTIONS_H
#define CLI_RENDER_OVERLAY_OPTIONS_H

#include "cli/render/slice_labels.h"

#include <cubewright/overlay.h>

typedef struct cli_marks {
    bool axes, scale_bar, letters, color_bar, histogram, legend, isolines;
    const char *caption;
    int layout;
    double text_px;                /* height of capitals; 0: by the picture's height */
    double isovalue;               /* of isolines */
    const cw_value_slices *values; /* whose colours are shown as a bar, or NULL */
} cli_marks;

enum { CLI_LAYOUT_SINGLE, CLI_LAYOUT_QUAD };

/* Draws what was asked for on the picture of a scene.
 * labels   of the legend, or NULL
 * Returns CW_ERR_ARGUMENT for what needs a volume, without one; as cw_overlay_draw() */
CW_NODISCARD cw_status cli_mark(const cli_marks *marks, const cli_label_scene *labels,
                                const cw_scene *scene, cw_image *image, cw_error *err);

/* Whether there is something to draw. */
bool cli_has_marks(const cli_marks *marks);

/* A sheet of four: axial, coronal and sagittal slices through the middle, as radiologists see
 * them, and the picture of the scene, lower right. A quarter each.
 * scene     of the whole sheet's size
 * shown     its picture, of half that size on a side
 * labels    that are drawn over the slices
 * renderer  NULL at first; made when needed */
CW_NODISCARD cw_status cli_mark_quad(const cw_scene *scene, const cw_image *shown,
                                     const cli_slice_labels *labels, cw_backend backend,
                                     cw_renderer **renderer, cw_image *sheet, cw_error *err);

#endif
