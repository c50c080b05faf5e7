// Orders the frames of a file by the vectors that count them: slices, offsets, moments, views.
#include "formats/dcmtk/dicom_increments.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <numeric>

using namespace cw;

namespace
{

enum class Counts { SLICES, OFFSETS, STEPS, VIEWS, FILM };

struct Vector {
    DcmTagKey tag;
    const char *name;
    Counts counts;
    const char *views; // the word for several of them
};

const Vector vectors[] = {
    {DCM_EnergyWindowVector, "EnergyWindowVector", Counts::STEPS, nullptr},
    {DCM_DetectorVector, "DetectorVector", Counts::VIEWS, "detectors"},
    {DCM_PhaseVector, "PhaseVector", Counts::STEPS, nullptr},
    {DCM_RotationVector, "RotationVector", Counts::VIEWS, "rotations"},
    {DCM_RRIntervalVector, "RRIntervalVector", Counts::STEPS, nullptr},
    {DCM_TimeSlotVector, "TimeSlotVector", Counts::STEPS, nullptr},
    {DCM_SliceVector, "SliceVector", Counts::SLICES, nullptr},
    {DCM_AngularViewVector, "AngularViewVector", Counts::VIEWS, "angular views"},
    {DCM_TimeSliceVector, "TimeSliceVector", Counts::STEPS, nullptr},
    {DCM_GridFrameOffsetVector, "GridFrameOffsetVector", Counts::OFFSETS, nullptr},
    {DCM_FrameTime, "FrameTime", Counts::FILM, nullptr},
    {DCM_FrameTimeVector, "FrameTimeVector", Counts::FILM, nullptr}};

// The order of frames, as far as it is known.
struct Order {
    cwi_dicom_facts *facts;
    cwi_dicom_frame *frames;
    std::vector<double> ranks; // of the steps; empty: there is one
    bool is_placed;            // each frame's place is known
};

// Keeps the first reason why the frames make no volume.
CW_PRINTF(2, 3) void tell(Order &o, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (!o.facts->no_volume[0])
        std::vsnprintf(o.facts->no_volume, sizeof o.facts->no_volume, format, arguments);
    va_end(arguments);
}

size_t count_different(std::vector<double> list)
{
    std::sort(list.begin(), list.end());
    return size_t(std::unique(list.begin(), list.end()) - list.begin());
}

// Ranks frames by their ranks until now, then by another number.
void refine_ranks(Order &o, const char *name, const std::vector<double> &list)
{
    if (count_different(list) < 2)
        return;
    std::vector<double> &ranks = o.ranks;
    ranks.resize(list.size());
    std::vector<size_t> order(list.size());
    std::iota(order.begin(), order.end(), size_t(0));
    const auto less = [&](size_t a, size_t b) {
        return ranks[a] != ranks[b] ? ranks[a] < ranks[b] : list[a] < list[b];
    };
    std::sort(order.begin(), order.end(), less);
    std::vector<double> refined(list.size());
    for (size_t n = 1; n < order.size(); n++)
        refined[order[n]] = refined[order[n - 1]] + less(order[n - 1], order[n]);
    ranks.swap(refined);
    char *names = o.facts->order;
    const size_t used = std::strlen(names);
    std::snprintf(names + used, sizeof o.facts->order - used, "%s%s", used ? ", " : "", name);
}

void keep_ranks(Order &o)
{
    for (size_t n = 0; n < o.ranks.size(); n++)
        o.frames[n].keys[CWI_DICOM_INCREMENT] = o.ranks[n];
}

std::vector<double> count_up(size_t count)
{
    std::vector<double> list(count);
    std::iota(list.begin(), list.end(), 1.0);
    return list;
}

// Numbers the slices from the one of the lowest number on, whose place is stated.
void number_slices(Order &o, const std::vector<double> &list)
{
    o.is_placed = true;
    const double first = *std::min_element(list.begin(), list.end());
    for (uint32_t n = 0; n < o.facts->frame_count; n++) {
        cwi_dicom_frame &f = o.frames[n];
        f.slice = int32_t(std::fmin(list[n] - first, INT32_MAX));
        f.has |= CWI_DICOM_NUMBERED;
        if (!(f.has & CWI_DICOM_BETWEEN))
            f.between = 0;
    }
}

// Places frames at offsets along the normal, or at their z in the patient where the first offset
// is that of the stated place.
void place_frames(Order &o, const std::vector<double> &list)
{
    o.is_placed = true;
    const cwi_dicom_frame first = o.frames[0];
    const double(&a)[2][3] = first.axes;
    double normal[3];
    for (int c = 0; c < 3; c++) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        normal[c] = a[0][d] * a[1][e] - a[0][e] * a[1][d];
    }
    const double z = first.position[2];
    const bool absolute = list[0] != 0 && std::fabs(list[0] - z) < 1e-3 &&
                          std::fabs(std::fabs(normal[2]) - 1) < 1e-3;
    if (list[0] != 0 && !absolute)
        tell(o,
             "GridFrameOffsetVector begins with %.9g, where 0 or, for transverse frames, the z "
             "of ImagePositionPatient was expected",
             list[0]);
    for (uint32_t n = 0; n < o.facts->frame_count; n++)
        for (int c = 0; c < 3; c++)
            o.frames[n].position[c] +=
                absolute ? (c == 2) * (list[n] - z) : list[n] * normal[c];
}

// Takes one vector; `named` tells if FrameIncrementPointer names it.
void take_vector(Order &o, DcmItem *data, const Vector &v, bool named, bool alone)
{
    const uint32_t frames = o.facts->frame_count;
    if (v.counts == Counts::FILM) {
        if (named)
            tell(o, "they are moments of a film (%s)", v.name);
        return;
    }
    std::vector<double> list = list_of(data, v.tag);
    if (list.empty() && alone && v.counts == Counts::SLICES)
        list = count_up(frames);
    if (list.size() != frames) {
        if (named)
            tell(o, "FrameIncrementPointer names %s, which lists %zu numbers for %u frames",
                 v.name, list.size(), frames);
        return;
    }
    if (v.counts == Counts::STEPS)
        refine_ranks(o, v.name, list);
    else if (v.counts == Counts::SLICES)
        number_slices(o, list);
    else if (v.counts == Counts::OFFSETS)
        place_frames(o, list);
    else if (count_different(list) > 1)
        tell(o, "they are views of %zu %s (%s)", count_different(list), v.views, v.name);
}

bool is_listed(const std::vector<DcmTagKey> &tags, const DcmTagKey &tag)
{
    return std::find(tags.begin(), tags.end(), tag) != tags.end();
}

// Dimensions that count places, or segments: they are read from the frames' own attributes.
bool counts_places(const DcmTagKey &tag)
{
    static const DcmTagKey places[] = {DCM_StackID,
                                       DCM_InStackPositionNumber,
                                       DCM_ImagePositionPatient,
                                       DCM_ImagePositionVolume,
                                       DCM_ImageOrientationPatient,
                                       DCM_ImageOrientationVolume,
                                       DCM_PlanePositionSequence,
                                       DCM_PlanePositionVolumeSequence,
                                       DCM_ReferencedSegmentNumber,
                                       DCM_SegmentNumber};
    return std::find(std::begin(places), std::end(places), tag) != std::end(places);
}

} // namespace

void cw::order_by_vectors(DcmItem *data, cwi_dicom_facts *facts)
{
    Order o = {facts, reinterpret_cast<cwi_dicom_frame *>(facts + 1), {}, false};
    const OFString what = text_of(data, DCM_SOPClassUID);
    const std::vector<DcmTagKey> named = tags_of(data, DCM_FrameIncrementPointer);
    if (what == UID_UltrasoundMultiframeImageStorage ||
        what == UID_RETIRED_UltrasoundMultiframeImageStorage)
        tell(o, "they are moments of a film of ultrasound");
    for (const DcmTagKey &tag : named) {
        const Vector *v = std::find_if(std::begin(vectors), std::end(vectors),
                                       [&](const Vector &row) { return row.tag == tag; });
        if (v == std::end(vectors))
            tell(o, "FrameIncrementPointer names (%04x,%04x), an order that is not read",
                 unsigned(tag.getGroup()), unsigned(tag.getElement()));
        else
            take_vector(o, data, *v, true, named.size() == 1);
    }
    for (const Vector &v : vectors)
        if (!is_listed(named, v.tag))
            take_vector(o, data, v, false, false);
    if (named.empty() && !o.is_placed &&
        text_of(data, DCM_ImageType, 2).substr(0, 6) == "RECON ")
        number_slices(o, count_up(facts->frame_count));
    keep_ranks(o);
    const bool at_one_place = count_different(o.ranks) == facts->frame_count;
    for (uint32_t n = 1; !o.is_placed && !at_one_place && n < facts->frame_count; n++)
        o.frames[n].has &= ~unsigned(CWI_DICOM_POSITION); // only the first one's is stated
}

void cw::order_by_dimensions(DcmItem *data, const std::vector<DcmItem *> &each,
                             cwi_dicom_facts *facts)
{
    Order o = {facts, reinterpret_cast<cwi_dicom_frame *>(facts + 1), {}, true};
    const std::vector<DcmItem *> dimensions = items_of(data, DCM_DimensionIndexSequence);
    std::vector<std::vector<double>> values(facts->frame_count);
    for (uint32_t n = 0; n < facts->frame_count; n++) {
        DcmItem *content =
            n < each.size() ? first_item(each[n], DCM_FrameContentSequence) : nullptr;
        values[n] = list_of(content, DCM_DimensionIndexValues);
        if (values[n].size() != dimensions.size())
            return;
    }
    for (size_t d = 0; d < dimensions.size(); d++) {
        const std::vector<DcmTagKey> tags = tags_of(dimensions[d], DCM_DimensionIndexPointer);
        std::vector<double> list(facts->frame_count);
        if (tags.size() != 1 || counts_places(tags[0]))
            continue;
        for (uint32_t n = 0; n < facts->frame_count; n++)
            list[n] = values[n][d];
        refine_ranks(o, DcmTag(tags[0]).getTagName(), list);
    }
    keep_ranks(o);
}
