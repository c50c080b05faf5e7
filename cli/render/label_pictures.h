/* Labels of label maps in the pictures of render: whether they are drawn, and their surfaces. */
#ifndef CLI_RENDER_LABEL_PICTURES_H
#define CLI_RENDER_LABEL_PICTURES_H

#include "cli/render/render_run.h"

/* Checks the options of labels before the input is read. CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_check_label_look(const render_args *args, cw_error *err);

/* Decides whether labels are drawn, and in which mode: where --labels asks for them, and where
 * nothing asks for another way to draw a volume that is a label map, which is then read, and
 * said. */
CW_NODISCARD cw_status cli_decide_labels(cli_pictures *p, cw_error *err);

/* Finds the labels of a step, which has been read, and makes their surfaces for the mode mesh. */
CW_NODISCARD cw_status cli_open_labels(cli_pictures *p, size_t step, cw_error *err);

/* Returns true if labels are drawn that only OpenGL can: translucent ones. */
bool cli_labels_need_gl(const cli_label_scene *labels);

#endif
