/* Replaces dicom_jpeg2000.c in builds without OpenJPEG. */
#include "core/base/status.h"
#include "formats/dcmtk/dicom.h"

cw_status cwi_dicom_jpeg2000(const void *data, size_t size, const cwi_dicom_image *image,
                             void *pixels, cw_error *err)
{
    (void)data, (void)size, (void)image, (void)pixels;
    return cwi_fail(
        err, CW_ERR_UNSUPPORTED,
        "its pixels are compressed by JPEG 2000, which needs a build with the Debian "
        "package libopenjp2-7-dev");
}
