/* The drivers of VTK's formats (legacy, vtu, vti, vtm, vtp): their names, readers and writers. */
#include "formats/vtk/vtk_formats.h"

const cwi_format_driver cwi_format_vtk = {
    .name = "vtk",
    .extensions = ".vtk",
    .about = "legacy VTK image data, grid of any kind, or surface",
    .volume = {.sniff = cwi_vtk_sniff, .parse = cwi_vtk_parse, .read_grid = cwi_vtk_read_grid},
    .mesh = {.sniff = cwi_vtk_poly_sniff, .read = cwi_vtk_poly_read},
};

const cwi_format_driver cwi_format_vtu = {
    .name = "vtu",
    .extensions = ".vtu .vts .pvtu .pvts",
    .about = "VTK unstructured or curvilinear grid as XML, also in pieces",
    .volume = {.sniff = cwi_vtu_sniff, .read_grid = cwi_vtu_read},
};

const cwi_format_driver cwi_format_vti = {
    .name = "vti",
    .extensions = ".vti .vtr .pvti .pvtr",
    .about = "VTK image data or rectilinear grid as XML, also in pieces",
    .volume = {.sniff = cwi_vti_sniff,
               .parse = cwi_vti_parse,
               .read_grid = cwi_vti_read_pieces},
};

const cwi_format_driver cwi_format_vtm = {
    .name = "vtm",
    .extensions = ".vtm .vtmb .vtpc",
    .about = "VTK list of blocks: surfaces as parts, or a volume",
    .volume = {.sniff = cwi_vtm_sniff, .read_grid = cwi_vtm_read_volume},
    .mesh = {.sniff = cwi_vtm_mesh_sniff, .read = cwi_vtm_read_mesh},
};

const cwi_format_driver cwi_format_vtp = {
    .name = "vtp",
    .extensions = ".vtp .pvtp",
    .about = "VTK surface as XML, also in pieces, LPS millimetres",
    .lost = "affine; places beyond single precision, unless local",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS | CW_KEEPS_OPACITY |
             CW_KEEPS_SCALARS | CW_KEEPS_LABELS | CW_KEEPS_FACE_COLORS,
    .mesh = {.sniff = cwi_vtp_sniff, .read = cwi_vtp_read},
    .write = {.extensions = ".vtp", .write = cwi_vtp_write, .spools = true, .sides = true},
};
