// Modality LUTs: tables that turn stored pixels into values, in place of slope and intercept.
#ifndef FORMATS_DCMTK_DICOM_LOOKUP_HPP
#define FORMATS_DCMTK_DICOM_LOOKUP_HPP

#include "formats/dcmtk/dicom_file.hpp"

namespace cw
{

// Finds the table of each frame, and checks its descriptor (PS3.3 C.11.1). With a table, values are returned in
// place of pixels: the facts tell their type, and padding becomes -1. Frames without one keep their pixels.
void take_lookups(DicomFile &file, cwi_dicom_facts *facts);

// Turns the decoded pixels of a frame into values, where the file has tables.
cw_status apply_lookup(DicomFile &file, uint32_t frame, cw_error *err);

} // namespace cw

#endif
