// Tells images that are no slices: projections, photographs, planar views.
#include "formats/dcmtk/dicom_increments.hpp"

#include <cstring>

using namespace cw;

namespace
{

struct Class {
    const char *uid, *name;
};

// Classes whose images are no slices. Their frames make no volume, wherever they are said to lie.
const Class flat_classes[] = {
    {UID_ComputedRadiographyImageStorage, "radiographs (CR)"},
    {UID_DigitalXRayImageStorageForPresentation, "radiographs (DX)"},
    {UID_DigitalXRayImageStorageForProcessing, "radiographs (DX)"},
    {UID_DigitalMammographyXRayImageStorageForPresentation, "mammograms (MG)"},
    {UID_DigitalMammographyXRayImageStorageForProcessing, "mammograms (MG)"},
    {UID_BreastProjectionXRayImageStorageForPresentation, "projections of a breast"},
    {UID_BreastProjectionXRayImageStorageForProcessing, "projections of a breast"},
    {UID_DigitalIntraOralXRayImageStorageForPresentation, "intraoral radiographs (IO)"},
    {UID_DigitalIntraOralXRayImageStorageForProcessing, "intraoral radiographs (IO)"},
    {UID_XRayAngiographicImageStorage, "angiograms (XA), which are projections"},
    {UID_EnhancedXAImageStorage, "angiograms (XA), which are projections"},
    {UID_RETIRED_XRayAngiographicBiPlaneImageStorage, "angiograms (XA), which are projections"},
    {UID_XRayRadiofluoroscopicImageStorage, "fluoroscopic projections (RF)"},
    {UID_EnhancedXRFImageStorage, "fluoroscopic projections (RF)"},
    {UID_RTImageStorage, "projections of a treatment beam (RT Image)"},
    {UID_VLEndoscopicImageStorage, "endoscopic pictures"},
    {UID_VideoEndoscopicImageStorage, "endoscopic pictures"},
    {UID_VLMicroscopicImageStorage, "pictures of a microscope"},
    {UID_VLSlideCoordinatesMicroscopicImageStorage, "pictures of a microscope"},
    {UID_VideoMicroscopicImageStorage, "pictures of a microscope"},
    {UID_VLWholeSlideMicroscopyImageStorage, "tiles of a slide of tissue"},
    {UID_VLPhotographicImageStorage, "photographs"},
    {UID_VideoPhotographicImageStorage, "photographs"},
    {UID_OphthalmicPhotography8BitImageStorage, "photographs of an eye"},
    {UID_OphthalmicPhotography16BitImageStorage, "photographs of an eye"},
};

// Modalities of images without a class.
const Class flat_modalities[] = {{"CR", "radiographs (CR)"},
                                 {"DX", "radiographs (DX)"},
                                 {"MG", "mammograms (MG)"},
                                 {"IO", "intraoral radiographs (IO)"},
                                 {"PX", "panoramic radiographs (PX)"},
                                 {"RG", "radiographs (RG)"},
                                 {"XA", "angiograms (XA), which are projections"},
                                 {"RF", "fluoroscopic projections (RF)"}};

// Kinds of nuclear medicine that are not reconstructed, by ImageType (PS3.3 C.8.4.9.1.3).
const char *const planar_types[] = {"STATIC",     "DYNAMIC", "GATED",
                                    "WHOLE BODY", "TOMO",    "GATED TOMO"};

template <size_t count> const char *find_name(const Class (&rows)[count], const OFString &key)
{
    for (const Class &row : rows)
        if (key == row.uid)
            return row.name;
    return nullptr;
}

// Tells views of a gamma camera, or projections that were not reconstructed.
void tell_planar(const OFString &type, cwi_dicom_facts *facts)
{
    for (const char *planar : planar_types)
        if (type == planar)
            std::snprintf(
                facts->no_volume, sizeof facts->no_volume,
                "they are %s of a gamma camera (ImageType %s), not reconstructed slices",
                std::strstr(planar, "TOMO") ? "projections" : "planar views", planar);
}

} // namespace

void cw::tell_projections(DcmItem *data, cwi_dicom_facts *facts)
{
    const OFString what = text_of(data, DCM_SOPClassUID),
                   modality = text_of(data, DCM_Modality);
    const OFString type = text_of(data, DCM_ImageType, 2);
    const char *name =
        what.empty() ? find_name(flat_modalities, modality) : find_name(flat_classes, what);
    const bool nuclear = what == UID_NuclearMedicineImageStorage ||
                         what == UID_RETIRED_NuclearMedicineImageStorage ||
                         (what.empty() && modality == "NM");
    if (nuclear)
        tell_planar(type, facts);
    else if (what == UID_CTImageStorage && type == "LOCALIZER")
        name = "localizers (ImageType LOCALIZER), which are projections";
    if (name)
        std::snprintf(facts->no_volume, sizeof facts->no_volume, "they are %s", name);
}
