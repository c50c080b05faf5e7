#include "formats/format_registry.h"

#include "core/base/features.h"

#include <pthread.h>
#include <string.h>
#include <strings.h>

/* in_this_build is filled in once, at run time: a module may have been left out of
 * a package. */
static const cw_format rows[] = {
    {.name = "nrrd",
     .extensions = ".nrrd .nhdr",
     .about = "NRRD volume, in one file or with its data beside it",
     .reads_volume = true,
     .writes_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "nifti",
     .extensions = ".nii .nii.gz .hdr",
     .about = "NIfTI volume, plain or gzipped",
     .reads_volume = true,
     .writes_volume = true,
     .in_this_build = true,
     .lost = "the frame beyond single precision"},
    {.name = "metaimage",
     .extensions = ".mha .mhd",
     .about = "MetaImage volume",
     .reads_volume = true,
     .writes_volume = true,
     .in_this_build = true,
     .lost = "slope and intercept"},
    {.name = "vtk",
     .extensions = ".vtk",
     .about = "legacy VTK image data or grid of any kind",
     .reads_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "vtu",
     .extensions = ".vtu .vts",
     .about = "VTK unstructured or curvilinear grid as XML",
     .reads_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "vti",
     .extensions = ".vti .vtr",
     .about = "VTK image data or rectilinear grid as XML",
     .reads_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "mrc",
     .extensions = ".mrc .map .ccp4 .rec",
     .about = "MRC2014 or CCP4 map, plain or gzipped",
     .reads_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "inr",
     .extensions = ".inr .inr.gz",
     .about = "INRIMAGE-4 volume, plain or gzipped",
     .reads_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "dicom",
     .extensions = ".dcm .dicom .ima",
     .about = "DICOM series: a folder, or any file of it",
     .reads_volume = true,
     .lost = ""},
    {.name = "tiff",
     .extensions = ".tif .tiff",
     .about = "TIFF stack: pages of one file, or numbered slices",
     .reads_volume = true,
     .lost = ""},
    {.name = "vdb",
     .extensions = ".vdb",
     .about = "OpenVDB level set or fog volume, sparse",
     .reads_volume = true,
     .lost = ""},
    {.name = "plot3d",
     .extensions = ".q",
     .about = "PLOT3D solution, with its grid in another file",
     .reads_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "raw",
     .extensions = ".raw",
     .about = "bytes without a header, laid out as the caller says",
     .reads_volume = true,
     .in_this_build = true,
     .lost = ""},
    {.name = "glb",
     .extensions = ".glb",
     .about = "binary glTF 2.0 scene, metres, +Y up, facing +Z",
     .reads_mesh = true,
     .writes_mesh = true,
     .lost = "scalars, labels",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_PLACES | CW_KEEPS_NORMALS | CW_KEEPS_COLORS |
              CW_KEEPS_PARTS | CW_KEEPS_AFFINE},
    {.name = "gltf",
     .extensions = ".gltf",
     .about = "glTF 2.0 scene as text, metres, +Y up, facing +Z",
     .reads_mesh = true,
     .writes_mesh = true,
     .lost = "scalars, labels",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_PLACES | CW_KEEPS_NORMALS | CW_KEEPS_COLORS |
              CW_KEEPS_PARTS | CW_KEEPS_AFFINE},
    {.name = "stl",
     .extensions = ".stl",
     .about = "STL, binary or text, LPS millimetres",
     .reads_mesh = true,
     .writes_mesh = true,
     .in_this_build = true,
     .lost = "shared vertices, normals, colours, scalars, labels, affine; places beyond single "
             "precision, unless local"},
    {.name = "ply",
     .extensions = ".ply",
     .about = "PLY, binary or text, LPS millimetres",
     .reads_mesh = true,
     .writes_mesh = true,
     .in_this_build = true,
     .lost = "affine; places beyond single precision, unless local",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS | CW_KEEPS_SCALARS |
              CW_KEEPS_LABELS},
    {.name = "obj",
     .extensions = ".obj",
     .about = "Wavefront OBJ, LPS millimetres",
     .reads_mesh = true,
     .writes_mesh = true,
     .in_this_build = true,
     .lost = "colours, scalars, labels, affine",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_PARTS},
    {.name = "off",
     .extensions = ".off",
     .about = "Object File Format as text, LPS millimetres",
     .reads_mesh = true,
     .writes_mesh = true,
     .in_this_build = true,
     .lost = "scalars, labels, affine",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS},
    {.name = "3mf",
     .extensions = ".3mf",
     .about = "3MF for printing: objects with colours, LPS millimetres",
     .reads_mesh = true,
     .writes_mesh = true,
     .in_this_build = true,
     .lost = "normals, scalars, labels, affine",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_PLACES | CW_KEEPS_COLORS | CW_KEEPS_PARTS},
    {.name = "vtp",
     .extensions = ".vtp",
     .about = "VTK surface as XML, LPS millimetres",
     .reads_mesh = true,
     .writes_mesh = true,
     .in_this_build = true,
     .lost = "affine; places beyond single precision, unless local",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS | CW_KEEPS_SCALARS |
              CW_KEEPS_LABELS},
    {.name = "drc",
     .extensions = ".drc",
     .about = "Draco: a compressed mesh, LPS millimetres",
     .reads_mesh = true,
     .writes_mesh = true,
     .lost = "scalars, labels, affine; places between those of the grid",
     .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS},
};

enum { ROW_COUNT = sizeof rows / sizeof *rows };

static cw_format formats[ROW_COUNT];
static pthread_once_t formats_once = PTHREAD_ONCE_INIT;

static void fill_formats(void)
{
    static const struct {
        const char *format, *feature;
    } optional[] = {{"glb", "gltf"},    {"gltf", "gltf"}, {"drc", "draco"},
                    {"dicom", "dicom"}, {"tiff", "tiff"}, {"vdb", "vdb"}};
    memcpy(formats, rows, sizeof rows);
    for (int i = 0; i < ROW_COUNT; i++) {
        formats[i].reason = "";
        for (size_t k = 0; k < sizeof optional / sizeof *optional; k++) {
            if (strcmp(rows[i].name, optional[k].format) != 0)
                continue;
            const cw_feature *feature = cwi_find_feature(optional[k].feature);
            formats[i].in_this_build = feature && feature->available;
            formats[i].reason = feature ? feature->reason : "no such feature";
        }
    }
}

const cw_format *cw_formats(size_t *count)
{
    pthread_once(&formats_once, fill_formats);
    *count = ROW_COUNT;
    return formats;
}
