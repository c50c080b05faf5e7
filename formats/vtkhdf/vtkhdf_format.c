/* The driver of VTKHDF: its names and its readers. */
#include "formats/vtkhdf/vtkhdf_format.h"

const cwi_format_driver cwi_format_vtkhdf = {
    .name = "vtkhdf",
    .extensions = ".vtkhdf .hdf",
    .about = "VTK image data, unstructured grid or surface in HDF5",
    .feature = "hdf5",
    .volume = {.sniff = cwi_vtkhdf_sniff, .read_grid = cwi_vtkhdf_read_volume},
    .mesh = {.sniff = cwi_vtkhdf_mesh_sniff, .read = cwi_vtkhdf_read_mesh},
};
