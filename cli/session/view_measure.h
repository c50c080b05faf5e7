/* Measurements of the window: distances, angles and areas between points of the world. */
#ifndef CLI_SESSION_VIEW_MEASURE_H
#define CLI_SESSION_VIEW_MEASURE_H

#include "cli/session/view.h"

/* "distance", "angle", "area"; of any other kind "off". */
const char *view_measure_name(view_measure_kind kind);

/* Returns the points of a measurement. */
const double (*view_measure_points(const view *v, const view_measure *m))[3];

/* Writes the value with its unit: "12.3 mm", and what makes an area doubtful. */
void view_measure_value(const view *v, const view_measure *m, char *text, size_t size);

/* Adds a measurement.
 * Returns CW_ERR_ARGUMENT  points that have no such value; CW_ERR_LIMIT  too many;
 *         CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status view_add_measure(view *v, view_measure_kind kind,
                                        const double (*points)[3], size_t count, cw_error *err);

/* Writes all measurements as commands, or as lines for people. */
void view_put_measures(const view *v, FILE *out, const char *end);
void view_print_measures(const view *v, FILE *out);

/* Measuring by the mouse and by keys, while a tool is chosen. */
void view_choose_tool(view *v, view_measure_kind kind); /* again the same: none */
CW_NODISCARD cw_status view_add_tool_point(view *v, const double point[3], cw_error *err);
CW_NODISCARD cw_status view_end_tool(view *v, cw_error *err); /* closes an area */
/* Takes Enter and Escape while something is measured; false: they mean what they usually do. */
bool view_measure_key(view *v, const char *key);
/* Writes what the next click does; "" without a tool. */
void view_tool_hint(const view *v, char *text, size_t size);

/* Draws the measurements on the picture of a part, for keeps. */
CW_NODISCARD cw_status view_mark_measures(const view *v, int part, const cw_scene *scene,
                                          double text_px, cw_image *image, cw_error *err);

/* Draws the measurements over a part of the window. */
void view_show_measures(view *v, int part, const cwi_ui_input *in);

#endif
