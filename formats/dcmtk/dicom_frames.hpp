// Frames of a file: where they lie, what sets them apart, and how their pixels are scaled.
#ifndef FORMATS_DCMTK_DICOM_FRAMES_HPP
#define FORMATS_DCMTK_DICOM_FRAMES_HPP

#include "formats/dcmtk/dicom_values.hpp"

namespace cw
{

// Fills the frames behind the facts, facts->frame_count of them.
void take_frames(DcmItem *data, cwi_dicom_facts *facts);

} // namespace cw

#endif
