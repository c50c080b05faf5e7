/* The driver of PLOT3D: its names and its reader. */
#include "formats/plot3d/plot3d_format.h"

const cwi_format_driver cwi_format_plot3d = {
    .name = "plot3d",
    .extensions = ".q",
    .about = "PLOT3D solution, with its grid in another file",
    .volume = {.read_file = cwi_plot3d_read, .needs_points = true},
};
