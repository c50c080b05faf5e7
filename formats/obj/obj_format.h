/* The driver of OBJ, and what it calls. */
#ifndef FORMATS_OBJ_OBJ_FORMAT_H
#define FORMATS_OBJ_OBJ_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_obj;

cwi_mesh_reader cwi_obj_read;
cwi_mesh_writer cwi_obj_write;

#endif
