/* Where pictures are taken from: one camera, or those of a turntable. */
#ifndef CLI_RENDER_CAMERA_OPTIONS_H
#define CLI_RENDER_CAMERA_OPTIONS_H

#include "cli/render/scene_options.h"

typedef struct cli_turns {
    size_t count;     /* of pictures around what is seen; 0 and 1: one */
    cli_number orbit; /* degrees from the first to the last; default: all round */
} cli_turns;

/* Box that a camera sees: around what is visible of a volume in modes that blend, around all of
 * it in others, and around a mesh. volume, mesh: NULL for none. false: there is nothing. */
CW_NODISCARD cw_status cli_find_seen_box(const cw_volume *volume, const cw_mesh *mesh,
                                         cw_mode mode, const cw_transfer *transfer, int threads,
                                         double box[2][3], bool *found, cw_error *err);

/* Fails for a camera, an angle or a zoom that is none; files are not looked at. */
CW_NODISCARD cw_status cli_check_camera(const cli_scene *args, const cli_turns *turns,
                                        cw_error *err);

/* The camera of turn n, the same distance from the middle of a box at all of them. box: low and
 * high corner of what is seen, in the world. */
CW_NODISCARD cw_status cli_find_camera(const cli_scene *args, const cli_turns *turns, size_t n,
                                       const double box[2][3], double aspect, cw_camera *camera,
                                       cw_error *err);

/* Returns a title for the camera: its view, angles or file; the view that is chosen for a box
 * where none was requested. */
const char *cli_camera_title(const cli_scene *args, const double box[2][3]);

/* How far turn n has gone, in degrees. */
double cli_turn_angle(const cli_turns *turns, size_t n);

/* Rounds a camera to seven digits, so that its words are short. */
void cli_round_camera(cw_camera *camera);

/* Writes a camera in words, 'eye X,Y,Z to X,Y,Z up X,Y,Z fov DEG', which give it again to the
 * bit. Free it with free(); NULL when there is no memory. */
char *cli_write_camera(const cw_camera *camera);

/* Reads a whole camera: those words, JSON, or a .json file.
 * Returns CW_ERR_ARGUMENT; as cw_camera_read() and cw_camera_parse() */
CW_NODISCARD cw_status cli_read_camera(const char *text, cw_camera *camera, cw_error *err);

#endif
