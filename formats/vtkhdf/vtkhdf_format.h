/* The driver of VTKHDF, and what it calls. */
#ifndef FORMATS_VTKHDF_VTKHDF_FORMAT_H
#define FORMATS_VTKHDF_VTKHDF_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_vtkhdf;

cwi_volume_sniffer cwi_vtkhdf_sniff;
cwi_mesh_sniffer cwi_vtkhdf_mesh_sniff;
cwi_grid_reader cwi_vtkhdf_read_volume;
cwi_mesh_reader cwi_vtkhdf_read_mesh;

/* Returns true for an HDF5 file without the word VTKHDF in its first and last bytes, where the names of
 * its groups are. */
bool cwi_vtkhdf_is_other(const cwi_input *in, const unsigned char *head, size_t size);

#endif
