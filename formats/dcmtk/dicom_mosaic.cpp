// Finds the slices of a mosaic, which Siemens scanners show side by side in one image.
#include "formats/dcmtk/dicom_mosaic.hpp"

#include "formats/dcmtk/dicom_csa.h"

#include <cmath>

using namespace cw;

namespace
{

// Returns true for a mosaic: Siemens scanners show the slices of one moment side by side.
bool is_mosaic(DcmItem *data, const PixelLayout &l)
{
    for (unsigned long n = 0; n < 16; n++)
        if (text_of(data, DCM_ImageType, n) == "MOSAIC")
            return l.frames == 1;
    return false;
}

// Finds the element of a private group that a name has reserved; NULL where there is none.
const Uint8 *private_bytes(DcmItem *data, Uint16 group, const char *name, Uint16 number,
                           size_t *size)
{
    for (unsigned block = 0x10; block < 0x100; block++) {
        DcmElement *element = nullptr;
        Uint8 *bytes = nullptr;
        if (text_of(data, DcmTagKey(group, Uint16(block))) != name ||
            data->findAndGetElement(DcmTagKey(group, Uint16(block << 8 | number)), element)
                .bad() ||
            element->getUint8Array(bytes).bad() || !bytes)
            continue;
        *size = element->getLength();
        return bytes;
    }
    return nullptr;
}

// Reads the number and the direction of the slices; returns the error, or NULL.
const char *read_mosaic(DcmItem *data, const PixelLayout &l, Mosaic &m)
{
    size_t size = 0;
    double count = 0;
    const Uint8 *csa = private_bytes(data, 0x0029, "SIEMENS CSA HEADER", 0x10, &size);
    if (!csa)
        return "it is a mosaic of slices, and has no CSA header (0029,1010) that says where "
               "they lie";
    if (!cwi_csa_numbers(csa, size, "NumberOfImagesInMosaic", 1, &count) ||
        !cwi_csa_numbers(csa, size, "SliceNormalVector", 3, m.normal))
        return "it is a mosaic of slices, and its CSA header (0029,1010) is damaged or has no "
               "NumberOfImagesInMosaic or SliceNormalVector";
    if (!(count >= 1 && count <= 4096) || count != std::floor(count))
        return "NumberOfImagesInMosaic of its CSA header is not from 1 to 4096";
    m.count = uint32_t(count);
    m.across = uint32_t(std::ceil(std::sqrt(count)));
    if (l.columns % m.across || l.rows % m.across)
        return "it is a mosaic of slices, and Rows and Columns are no multiples of a slice's";
    return nullptr;
}

// Computes the place of the first slice. The stated place is that of a slice as large as the
// mosaic, around the same middle.
const char *place_slices(const Mosaic &m, cwi_dicom_facts *f)
{
    cwi_dicom_frame *frames = reinterpret_cast<cwi_dicom_frame *>(f + 1), first = frames[0];
    const unsigned needed =
        CWI_DICOM_POSITION | CWI_DICOM_ORIENTATION | CWI_DICOM_SPACING | CWI_DICOM_BETWEEN;
    const double(&a)[2][3] = first.axes;
    double along = 0;
    first.between = std::fabs(first.between);
    if ((first.has & needed) != needed || !(first.between > 0))
        return "it is a mosaic of slices without one of ImagePositionPatient, "
               "ImageOrientationPatient, PixelSpacing and SpacingBetweenSlices";
    for (int c = 0; c < 3; c++) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        along += m.normal[c] * (a[0][d] * a[1][e] - a[0][e] * a[1][d]);
        first.position[c] +=
            (m.across - 1) / 2.0 *
            (a[0][c] * first.spacing[0] * f->columns + a[1][c] * first.spacing[1] * f->rows);
    }
    if (!(std::fabs(std::fabs(along) - 1) < 1e-2))
        return "SliceNormalVector of its CSA header is not normal to ImageOrientationPatient";
    for (uint32_t n = 0; n < f->frame_count; n++) {
        frames[n] = first;
        for (int c = 0; c < 3; c++)
            frames[n].position[c] += n * first.between * m.normal[c];
    }
    return nullptr;
}

} // namespace

void cw::unfold_mosaic(DicomFile &d, cwi_dicom_facts *f)
{
    d.mosaic = Mosaic();
    if (!is_mosaic(d.data(), d.layout))
        return;
    const char *why = read_mosaic(d.data(), d.layout, d.mosaic);
    if (!why) {
        f->columns /= d.mosaic.across;
        f->rows /= d.mosaic.across;
        f->frame_count = d.mosaic.count;
        why = place_slices(d.mosaic, f);
    }
    refuse(f, why);
}
