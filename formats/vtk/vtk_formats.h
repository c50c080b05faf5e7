/* The drivers of VTK, and what they call. */
#ifndef FORMATS_VTK_VTK_FORMATS_H
#define FORMATS_VTK_VTK_FORMATS_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_vtk, cwi_format_vtu, cwi_format_vti, cwi_format_vtp;

cwi_volume_sniffer cwi_vtk_sniff, cwi_vtu_sniff, cwi_vti_sniff;
cwi_header_parser cwi_vtk_parse, cwi_vti_parse;
cwi_grid_reader cwi_vtk_read_grid, cwi_vtu_read, cwi_vti_read_pieces;
cwi_mesh_sniffer cwi_vtp_sniff, cwi_vtk_poly_sniff;
cwi_mesh_reader cwi_vtp_read, cwi_vtk_poly_read;
cwi_mesh_writer cwi_vtp_write;

/* Writes VTP with indices of 64 bits; cwi_vtp_write() calls it for meshes that need them. */
cwi_mesh_writer cwi_vtp_write_wide;

#endif
