// Reads where the frames of a file lie, what sets them apart, and how their pixels are scaled.
#include "formats/dcmtk/dicom_frames.hpp"

#include "formats/dcmtk/dicom_increments.hpp"

#include <cmath>

using namespace cw;

namespace
{

void take_keys(DcmItem *item, cwi_dicom_frame *f)
{
    static const struct {
        int key;
        DcmTagKey tag;
    } rows[] = {{CWI_DICOM_TEMPORAL, DCM_TemporalPositionIdentifier},
                {CWI_DICOM_TEMPORAL, DCM_TemporalPositionIndex},
                {CWI_DICOM_REFERENCE, DCM_FrameReferenceTime},
                {CWI_DICOM_TRIGGER, DCM_TriggerTime},
                {CWI_DICOM_TRIGGER, DCM_NominalCardiacTriggerDelayTime},
                {CWI_DICOM_PHASE, DCM_NominalPercentageOfCardiacPhase},
                {CWI_DICOM_PHASE, DCM_NominalPercentageOfRespiratoryPhase},
                {CWI_DICOM_ECHO, DCM_EchoTime},
                {CWI_DICOM_ECHO, DCM_EffectiveEchoTime},
                {CWI_DICOM_B_VALUE, DCM_DiffusionBValue},
                {CWI_DICOM_ACQUISITION, DCM_AcquisitionNumber}};
    double value;
    for (const auto &row : rows)
        if (number_of(item, row.tag, 0, &value))
            f->keys[row.key] = value;
}

// Reads geometry and scaling, where an item has them.
void take_plane(DcmItem *item, cwi_dicom_frame *f)
{
    double spacing[2], value;
    if (numbers_of(item, DCM_ImagePositionPatient, 3, f->position))
        f->has |= CWI_DICOM_POSITION;
    if (numbers_of(item, DCM_ImageOrientationPatient, 6, &f->axes[0][0]))
        f->has |= CWI_DICOM_ORIENTATION;
    if (numbers_of(item, DCM_ImagePositionVolume, 3, f->position))
        f->has |= CWI_DICOM_POSITION | CWI_DICOM_OWN_FRAME;
    if (numbers_of(item, DCM_ImageOrientationVolume, 6, &f->axes[0][0]))
        f->has |= CWI_DICOM_ORIENTATION | CWI_DICOM_OWN_FRAME;
    if (numbers_of(item, DCM_PixelSpacing, 2, spacing)) {
        f->spacing[0] = spacing[1]; // "row spacing" comes first: the spacing between rows
        f->spacing[1] = spacing[0];
        f->has |= CWI_DICOM_SPACING;
    }
    if ((number_of(item, DCM_SpacingBetweenSlices, 0, &value) && value != 0) ||
        (!(f->has & CWI_DICOM_BETWEEN) && number_of(item, DCM_SliceThickness, 0, &value))) {
        f->between = value;
        f->has |= CWI_DICOM_BETWEEN;
    }
    if (number_of(item, DCM_RescaleSlope, 0, &value))
        f->slope = value;
    if (number_of(item, DCM_RescaleIntercept, 0, &value)) {
        const OFString type = text_of(item, DCM_RescaleType);
        f->intercept = value;
        if (type.empty() || type == "HU")
            f->has |= CWI_DICOM_RESCALED;
    }
}

cwi_dicom_frame plain_frame(DcmItem *data)
{
    cwi_dicom_frame f = {};
    f.slope = 1;
    for (double &key : f.keys)
        key = NAN;
    take_plane(first_item(data, DCM_DetectorInformationSequence), &f); // nuclear medicine
    take_plane(data, &f);
    take_keys(data, &f);
    double scaling;
    if (number_of(data, DCM_DoseGridScaling, 0, &scaling))
        f.slope = scaling;
    return f;
}

// Reads the functional groups of a multi-frame object: those of all frames, then those of one.
void take_groups(DcmItem *groups, cwi_dicom_frame *f)
{
    static const DcmTagKey planes[] = {
        DCM_PixelMeasuresSequence,       DCM_PlaneOrientationSequence,
        DCM_PlanePositionSequence,       DCM_PlaneOrientationVolumeSequence,
        DCM_PlanePositionVolumeSequence, DCM_PixelValueTransformationSequence};
    static const DcmTagKey keys[] = {
        DCM_FrameContentSequence, DCM_MREchoSequence, DCM_MRDiffusionSequence,
        DCM_CardiacSynchronizationSequence, DCM_RespiratorySynchronizationSequence};
    for (const DcmTagKey &tag : planes)
        take_plane(first_item(groups, tag), f);
    for (const DcmTagKey &tag : keys)
        take_keys(first_item(groups, tag), f);
    DcmItem *content = first_item(groups, DCM_FrameContentSequence);
    if (content)
        copy_text(f->stack, text_of(content, DCM_StackID));
    DcmItem *segment = first_item(groups, DCM_SegmentIdentificationSequence);
    if (segment)
        f->segment = count_of(segment, DCM_ReferencedSegmentNumber, 0);
}

} // namespace

void cw::take_frames(DcmItem *data, cwi_dicom_facts *facts)
{
    cwi_dicom_frame *frames = reinterpret_cast<cwi_dicom_frame *>(facts + 1);
    const std::vector<DcmItem *> each = items_of(data, DCM_PerFrameFunctionalGroupsSequence);
    cwi_dicom_frame common = plain_frame(data);
    take_groups(first_item(data, DCM_SharedFunctionalGroupsSequence), &common);
    for (uint32_t n = 0; n < facts->frame_count; n++) {
        frames[n] = common;
        if (n < each.size())
            take_groups(each[n], frames + n);
    }
    if (!each.empty())
        order_by_dimensions(data, each, facts);
    else if (facts->frame_count > 1)
        order_by_vectors(data, facts);
    tell_projections(data, facts);
}
