/* The drivers of VTK, and what they call. */
#ifndef FORMATS_VTK_VTK_FORMATS_H
#define FORMATS_VTK_VTK_FORMATS_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_vtk, cwi_format_vtu, cwi_format_vti, cwi_format_vtp,
    cwi_format_vtm;

cwi_volume_sniffer cwi_vtk_sniff, cwi_vtu_sniff, cwi_vti_sniff, cwi_vtm_sniff;
cwi_header_parser cwi_vtk_parse, cwi_vti_parse;
cwi_grid_reader cwi_vtk_read_grid, cwi_vtu_read, cwi_vti_read_pieces, cwi_vtm_read_volume;
cwi_mesh_sniffer cwi_vtp_sniff, cwi_vtk_poly_sniff, cwi_vtm_mesh_sniff;
cwi_mesh_reader cwi_vtp_read, cwi_vtk_poly_read, cwi_vtm_read_mesh;
cwi_mesh_writer cwi_vtp_write;

/* Reads files that a list names as the pieces of one irregular grid. */
CW_NODISCARD cw_status cwi_vtu_read_sides(const cwi_input *list, const cwi_names *files,
                                          const cw_read_desc *desc, cw_volume *volume,
                                          cw_error *err);

/* Writes VTP with indices of 64 bits; cwi_vtp_write() calls it for meshes that need them. */
cwi_mesh_writer cwi_vtp_write_wide;

#endif
