/* Names files that are not read here, and what converts them. */
#include "formats/foreign_files.h"

#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/bytes/zip_read.h"
#include "formats/npy/npy_format.h"
#include "formats/vtkhdf/vtkhdf_format.h"

#include <string.h>

/* Files by their first bytes, or by extensions; the first row that fits is taken. */
static const struct {
    const char *magic;
    size_t bytes;
    const char *extensions, *about;
} foreign[] = {
    {NULL, 0, ".mnc", "a MINC file, which is not read: 'mnc2nii' of MINC makes NIfTI of it"},
    {NULL, 0, ".ims",
     "an Imaris file, which is not read: Bio-Formats ('bfconvert', Fiji) makes OME-TIFF of it"},
    {NULL, 0, ".czi .nd2 .lif .oib .oif .vsi .lsm",
     "a file of a microscope, which is not read: Bio-Formats ('bfconvert', Fiji) makes OME-TIFF of it"},
    {"\x89HDF\r\n\x1a\n", 8, NULL,
     "an HDF5 file, which is not read: h5py and 'numpy.save' make .npy of one of its arrays"},
    {"CDF\1", 4, ".nc",
     "a NetCDF file, which is not read: of MINC, 'mnc2nii' makes NIfTI of it"},
    {"CDF\2", 4, NULL, "a NetCDF file, which is not read: ParaView saves it as .vti or .vtu"},
    {"# AmiraMesh", 11, ".am",
     "an Amira file, which is not read: Amira and Fiji save it as NRRD or TIFF"},
    {"# Avizo", 7, NULL,
     "an Avizo file, which is not read: Avizo and Fiji save it as NRRD or TIFF"},
    {"mrtrix image", 12, ".mif .mih",
     "an MRtrix file, which is not read: 'mrconvert x.mif x.nii' makes NIfTI of it"},
    {"MATLAB 5.0", 10, ".mat",
     "a MATLAB file, which is not read: 'niftiwrite' makes NIfTI of a variable in it"},
    {"7z\xbc\xaf\x27\x1c", 6, ".7z", "a 7z archive, which is not read: unpack it first"},
    {"Rar!", 4, ".rar", "a rar archive, which is not read: unpack it first"},
    {NULL, 0, ".tar .tgz .tar.gz .tar.xz .tar.bz2",
     "a tar archive, which is not read: unpack it first"},
    {"BLENDER", 7, ".blend",
     "a file of Blender, which is not read: Blender exports glTF, OBJ and STL"},
    {"Kaydara FBX", 11, ".fbx",
     "an FBX file, which is not read: Blender makes glTF or OBJ of it"},
    {NULL, 0, ".dae", "a COLLADA file, which is not read: Blender makes glTF or OBJ of it"},
    {"ISO-10303-21", 12, ".step .stp",
     "a STEP file of solids, which is not read: FreeCAD meshes it as STL"},
    {NULL, 0, ".iges .igs",
     "an IGES file of surfaces, which is not read: FreeCAD meshes it as STL"},
};

const char *cwi_name_foreign(const char *path, const unsigned char *head, size_t size)
{
    for (size_t n = 0; n < sizeof foreign / sizeof *foreign; n++) {
        const bool is_content = foreign[n].bytes && size >= foreign[n].bytes &&
                                memcmp(head, foreign[n].magic, foreign[n].bytes) == 0;
        if (is_content ||
            (foreign[n].extensions && cwi_has_extension(path, foreign[n].extensions)))
            return foreign[n].about;
    }
    return NULL;
}

/* A package of 3MF has a list of the types of its content; a damaged one is left to its reader. */
static bool is_other_zip(const cwi_input *in, const unsigned char *head, size_t size)
{
    cwi_unzip z = {0};
    if (size < 4 || memcmp(head, "PK", 2) != 0 || cwi_has_extension(in->path, ".3mf .npz") ||
        cwi_npz_sniff(head, size < CWI_SNIFF_BYTES ? size : CWI_SNIFF_BYTES) ||
        cwi_unzip_open(&z, in, NULL) != CW_OK)
        return false;
    const bool is_package = cwi_unzip_has(&z, "[Content_Types].xml");
    cwi_unzip_close(&z);
    return !is_package;
}

/* Returns true if a byte order mark is followed by letters of two bytes. */
static bool is_utf16(const unsigned char *head, size_t size)
{
    const bool is_little = size >= 8 && head[0] == 0xff && head[1] == 0xfe;
    const bool is_big = size >= 8 && head[0] == 0xfe && head[1] == 0xff;
    if (!is_little && !is_big)
        return false;
    for (size_t n = 2; n < 8; n += 2)
        if (head[n + is_little] != 0 || head[n + is_big] == 0)
            return false;
    return true;
}

cw_status cwi_refuse_content(const cwi_input *in, const unsigned char *head, size_t size,
                             cw_error *err)
{
    if (is_other_zip(in, head, size))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "this is a zip archive, which is not read: unpack it, and name the file or "
            "folder in it");
    if (cwi_vtkhdf_is_other(in, head, size))
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "this is %s",
                        cwi_name_foreign(in->path, head, size));
    if (is_utf16(head, size))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "this is text in UTF-16; save it in UTF-8, as 'iconv -f utf-16 -t utf-8' "
            "does");
    return CW_OK;
}
