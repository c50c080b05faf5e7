/* The driver of PLOT3D, and what it calls. */
#ifndef FORMATS_PLOT3D_PLOT3D_FORMAT_H
#define FORMATS_PLOT3D_PLOT3D_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_plot3d;

/* Reads one file and the one that desc->points names. */
cwi_volume_reader cwi_plot3d_read;

#endif
