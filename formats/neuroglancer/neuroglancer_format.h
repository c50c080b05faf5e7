/* The driver of Neuroglancer's meshes, and what it calls. */
#ifndef FORMATS_NEUROGLANCER_NEUROGLANCER_FORMAT_H
#define FORMATS_NEUROGLANCER_NEUROGLANCER_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_neuroglancer;

cwi_mesh_writer cwi_neuroglancer_write;

#endif
