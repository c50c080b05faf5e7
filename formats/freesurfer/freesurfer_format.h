/* The driver of FreeSurfer's surfaces, and what it calls. */
#ifndef FORMATS_FREESURFER_FREESURFER_FORMAT_H
#define FORMATS_FREESURFER_FREESURFER_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_freesurfer;

cwi_mesh_sniffer cwi_freesurfer_sniff;
cwi_mesh_reader cwi_freesurfer_read;
cwi_mesh_writer cwi_freesurfer_write;

#endif
