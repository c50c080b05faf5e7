// Order of the frames of a file: slices, and the moments, echoes or views of each.
#ifndef FORMATS_DCMTK_DICOM_INCREMENTS_HPP
#define FORMATS_DCMTK_DICOM_INCREMENTS_HPP

#include "formats/dcmtk/dicom_values.hpp"

namespace cw
{

// Places and ranks the frames behind the facts by the vectors that FrameIncrementPointer names (PS3.3 C.7.6.6,
// C.8.4.8 for nuclear medicine, C.8.8.3.2 for dose). Vectors that count views or moments of a film, or that are
// not known, make facts->no_volume.
void order_by_vectors(DcmItem *data, cwi_dicom_facts *facts);

// Ranks the frames by those of their DimensionIndexValues that count no places (PS3.3 C.7.6.17).
// each  the items of PerFrameFunctionalGroupsSequence
void order_by_dimensions(DcmItem *data, const std::vector<DcmItem *> &each,
                         cwi_dicom_facts *facts);

// Sets facts->no_volume for projections and photographs, by class and ImageType.
void tell_projections(DcmItem *data, cwi_dicom_facts *facts);

} // namespace cw

#endif
