// Mosaics: slices side by side in one image.
#ifndef FORMATS_DCMTK_DICOM_MOSAIC_HPP
#define FORMATS_DCMTK_DICOM_MOSAIC_HPP

#include "formats/dcmtk/dicom_file.hpp"

namespace cw
{

// Turns the one frame of a mosaic into a frame for each of its slices; leaves other images alone.
void unfold_mosaic(DicomFile &file, cwi_dicom_facts *facts);

} // namespace cw

#endif
