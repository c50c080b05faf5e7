// Frames of a file: where they lie, what sets them apart, and how their pixels are scaled.
#ifndef FORMATS_DICOM_DICOM_FRAMES_HPP
#define FORMATS_DICOM_DICOM_FRAMES_HPP

#include "formats/dicom/dicom_values.hpp"

namespace cw
{

// Fills the frames behind the facts, facts->frame_count of them.
void take_frames(DcmItem *data, cwi_dicom_facts *facts);

} // namespace cw

#endif
