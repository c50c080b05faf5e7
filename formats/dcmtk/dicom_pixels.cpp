// Decodes the pixels of a frame by DCMTK, behind plain C: the second half of the module
// "dicom".
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/dcmtk/dicom_lookup.hpp"

#include <algorithm>
#include <cstring>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>

using namespace cw;

namespace
{

// Moves the stored bits to the bottom, and extends the sign. The bits above them, such as old
// overlays, are no part of a pixel.
template <typename Unsigned, typename Signed>
void mend_bits(const PixelLayout &l, void *pixels, size_t count)
{
    const unsigned all = 8 * sizeof(Unsigned), up = all - 1 - l.high, down = all - l.stored;
    Unsigned *p = static_cast<Unsigned *>(pixels);
    if (up == 0 && down == 0)
        return;
    for (size_t i = 0; i < count; i++) {
        const Unsigned top = Unsigned(p[i] << up);
        p[i] = l.is_signed ? Unsigned(Signed(top) >> down) : Unsigned(top >> down);
    }
}

void mend(const PixelLayout &l, void *pixels)
{
    if (l.type == CW_U8 || l.type == CW_I8)
        mend_bits<uint8_t, int8_t>(l, pixels, l.count());
    else if (l.type == CW_U16 || l.type == CW_I16)
        mend_bits<uint16_t, int16_t>(l, pixels, l.count());
    else if (l.type == CW_U32 || l.type == CW_I32)
        mend_bits<uint32_t, int32_t>(l, pixels, l.count());
}

void interleave(const PixelLayout &l, std::vector<unsigned char> &pixels)
{
    const size_t size = cw_type_size(l.type), plane = size_t(l.columns) * l.rows;
    const std::vector<unsigned char> planes(pixels);
    for (size_t i = 0; i < plane; i++)
        for (size_t c = 0; c < l.samples; c++)
            std::memcpy(&pixels[(i * l.samples + c) * size], &planes[(c * plane + i) * size],
                        size);
}

cw_status fail_frame(uint32_t frame, const char *why, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "the pixels of frame %u cannot be read: %s", frame + 1,
                    why);
}

cw_status fail_short(uint32_t frame, cw_error *err)
{
    return fail_frame(frame, "'PixelData' ends before it", err);
}

// Unpacks pixels of one bit each, from a given bit on.
void spread_bits(DicomFile &d, const Uint8 *bytes, uint64_t first)
{
    const size_t count = d.layout.count();
    d.pixels.resize(count);
    for (size_t i = 0; i < count; i++)
        d.pixels[i] = bytes[(first + i) / 8] >> ((first + i) % 8) & 1;
}

// Reads pixels of one bit each. Frames follow each other without a gap, even within a byte.
cw_status read_bits(DicomFile &d, uint32_t frame, cw_error *err)
{
    const size_t count = d.layout.count();
    const Uint8 *bytes = nullptr;
    unsigned long size = 0;
    DcmElement *element = nullptr;
    if (d.data()->findAndGetElement(DCM_PixelData, element).bad())
        return fail_short(frame, err);
    Uint8 *mine = nullptr;
    Uint16 *words = nullptr;
    if (element->getUint8Array(mine).good() && mine)
        bytes = mine;
    else if (element->getUint16Array(words).good() && words)
        bytes = reinterpret_cast<const Uint8 *>(words); // little-endian words are the bytes
    size = element->getLengthField();
    const uint64_t first = uint64_t(frame) * count;
    if (!bytes || (first + count + 7) / 8 > size)
        return fail_short(frame, err);
    spread_bits(d, bytes, first);
    return CW_OK;
}

DcmPixelData *pixel_data(DicomFile &d)
{
    DcmElement *element = nullptr;
    d.data()->findAndGetElement(DCM_PixelData, element);
    return dynamic_cast<DcmPixelData *>(element);
}

// Adds a fragment of compressed pixels; returns false where none has that number.
bool add_fragment(DcmPixelSequence *fragments, unsigned long number,
                  std::vector<unsigned char> &bytes)
{
    DcmPixelItem *item = nullptr;
    Uint8 *data = nullptr;
    if (fragments->getItem(item, number).bad() || item->getUint8Array(data).bad() || !data)
        return false;
    bytes.insert(bytes.end(), data, data + item->getLength());
    return true;
}

// Collects the fragments of a frame. Each frame has one fragment, or the only frame has all.
// The first fragment is a table of offsets.
cw_status read_fragments(DicomFile &d, uint32_t frame, std::vector<unsigned char> &bytes,
                         cw_error *err)
{
    const PixelLayout &l = d.layout;
    DcmPixelSequence *fragments = nullptr;
    DcmPixelData *data = pixel_data(d);
    if (!data ||
        data->getEncapsulatedRepresentation(d.data()->getOriginalXfer(), nullptr, fragments)
            .bad())
        return fail_short(frame, err);
    const unsigned long count = fragments->card();
    const bool whole = l.frames == 1;
    if (count < 2 || (!whole && count != l.frames + 1ul))
        return fail_frame(frame, "compressed frames must have one fragment each", err);
    for (unsigned long n = whole ? 1 : frame + 1ul; n < (whole ? count : frame + 2ul); n++)
        if (!add_fragment(fragments, n, bytes))
            return fail_short(frame, err);
    return CW_OK;
}

// Decodes runs of bytes (PackBits): n < 128 is followed by n + 1 bytes, n > 128 repeats one 257
// - n times. Returns the number of bytes, at most room.
size_t unpack_runs(const unsigned char *from, size_t size, unsigned char *to, size_t capacity)
{
    size_t at = 0, filled = 0;
    while (at + 1 < size && filled < capacity) {
        const unsigned n = from[at++];
        const bool repeats = n > 128;
        const size_t expected = n == 128 ? 0 : repeats ? 257 - n : n + 1;
        const size_t count = std::min(expected, capacity - filled);
        if (!repeats && count > size - at)
            return filled;
        if (repeats)
            std::memset(to + filled, from[at], count);
        else
            std::memcpy(to + filled, from + at, count);
        filled += count;
        at += repeats ? 1 : expected;
    }
    return filled;
}

// Finds the segments of a frame of runs (PS3.5 G.5): its head counts them, and states where each starts. Returns
// false where their number is not the expected one, or one lies outside of the frame.
bool find_segments(const std::vector<unsigned char> &bytes, size_t count,
                   std::vector<size_t> &starts)
{
    enum { HEAD = 64 };
    if (bytes.size() < HEAD || count > HEAD / 4 - 1)
        return false;
    for (size_t n = 0; n <= count; n++) {
        const unsigned char *b = &bytes[4 * n];
        const size_t number =
            b[0] | size_t(b[1]) << 8 | size_t(b[2]) << 16 | size_t(b[3]) << 24;
        const size_t least = starts.empty() ? size_t(HEAD) : starts.back();
        if (n == 0 ? number != count : number < least || number > bytes.size())
            return false;
        if (n > 0)
            starts.push_back(number);
    }
    starts.push_back(bytes.size());
    return true;
}

// Decodes runs. Each byte of a sample has a segment of its own, the highest first; pixels of one bit have one
// segment, eight to a byte. DCMTK returns memory that it did not fill where runs end early.
cw_status read_runs(DicomFile &d, uint32_t frame, cw_error *err)
{
    const PixelLayout &l = d.layout;
    const size_t bytes = l.allocated / 8, segments = bytes ? bytes * l.samples : 1;
    const size_t count = l.count() / l.samples;
    std::vector<unsigned char> runs, plane(bytes ? count : (count + 7) / 8);
    std::vector<size_t> starts;
    cw_status st = read_fragments(d, frame, runs, err);
    if (st != CW_OK)
        return st;
    if (!find_segments(runs, segments, starts))
        return fail_frame(frame,
                          "its head of run lengths does not count and place its segments", err);
    d.pixels.resize(l.count() * cw_type_size(l.type));
    for (size_t s = 0; s < segments; s++) {
        if (unpack_runs(runs.data() + starts[s], starts[s + 1] - starts[s], plane.data(),
                        plane.size()) < plane.size())
            return fail_frame(frame, "its run lengths end early", err);
        if (!bytes)
            spread_bits(d, plane.data(), 0);
        const size_t at = bytes ? s / bytes * bytes + bytes - 1 - s % bytes : 0;
        for (size_t i = 0; bytes && i < count; i++)
            d.pixels[i * segments + at] = plane[i];
    }
    return CW_OK;
}

cw_status read_jpeg2000(DicomFile &d, uint32_t frame, cw_error *err)
{
    const PixelLayout &l = d.layout;
    std::vector<unsigned char> bytes;
    cw_status st = read_fragments(d, frame, bytes, err);
    if (st != CW_OK)
        return st;
    const cwi_dicom_image image = {l.columns, l.rows, l.samples, l.type};
    d.pixels.resize(l.count() * cw_type_size(l.type));
    return cwi_dicom_jpeg2000(bytes.data(), bytes.size(), &image, d.pixels.data(), err);
}

// Reads floats, which are no "pixel data" to DCMTK.
cw_status read_reals(DicomFile &d, uint32_t frame, cw_error *err)
{
    const PixelLayout &l = d.layout;
    const size_t bytes = l.count() * cw_type_size(l.type);
    const DcmTagKey &tag = l.type == CW_F32 ? DCM_FloatPixelData : DCM_DoubleFloatPixelData;
    DcmElement *element = nullptr;
    d.pixels.resize(bytes);
    if (d.data()->findAndGetElement(tag, element).bad() ||
        (uint64_t(frame) + 1) * bytes > element->getLengthField())
        return fail_short(frame, err);
    const OFCondition read = element->getPartialValue(d.pixels.data(), Uint32(frame * bytes),
                                                      Uint32(bytes), nullptr, gLocalByteOrder);
    return read.good() ? CW_OK : fail_frame(frame, read.text(), err);
}

// Asks for the bytes of a frame. DCMTK 3.6.9 has to be told whether they are compressed.
template <typename Pixels>
auto find_frame_size(Pixels &pixels, DcmItem *item, bool compressed, Uint32 &bytes)
    -> decltype(pixels.getUncompressedFrameSize(item, bytes, OFBool(!compressed)))
{
    return pixels.getUncompressedFrameSize(item, bytes, OFBool(!compressed));
}

template <typename Pixels, typename... None>
auto find_frame_size(Pixels &pixels, DcmItem *item, bool, Uint32 &bytes, None...)
    -> decltype(pixels.getUncompressedFrameSize(item, bytes))
{
    return pixels.getUncompressedFrameSize(item, bytes);
}

cw_status read_integers(DicomFile &d, uint32_t frame, bool compressed, cw_error *err)
{
    const PixelLayout &l = d.layout;
    DcmPixelData *data = pixel_data(d);
    OFString colours;
    Uint32 fragment = 0, bytes = 0;
    if (!data)
        return fail_short(frame, err);
    OFCondition done = find_frame_size(*data, d.data(), compressed, bytes);
    const size_t expected = l.count() * cw_type_size(l.type);
    if (done.good() && bytes != expected)
        return fail_frame(frame, "its size is not what rows, columns and bits make", err);
    d.pixels.assign(expected + expected % 2, 0);
    if (done.good())
        done = data->getUncompressedFrame(d.data(), frame, fragment, d.pixels.data(),
                                          Uint32(d.pixels.size()), colours);
    return done.good() ? CW_OK : fail_frame(frame, done.text(), err);
}

bool is_jpeg2000(E_TransferSyntax syntax)
{
    return syntax == EXS_JPEG2000LosslessOnly || syntax == EXS_JPEG2000;
}

} // namespace

cw_status cw::decode_frame(DicomFile &d, uint32_t frame, cw_error *err)
{
    const PixelLayout &l = d.layout;
    const bool real = l.type == CW_F32 || l.type == CW_F64;
    const E_TransferSyntax syntax = d.data()->getOriginalXfer();
    const bool compressed = is_compressed_syntax(DcmXfer(syntax));
    d.decoded = -1;
    cw_status st = real                              ? read_reals(d, frame, err)
                   : l.allocated == 1 && !compressed ? read_bits(d, frame, err)
                   : is_jpeg2000(syntax)             ? read_jpeg2000(d, frame, err)
                   : syntax == EXS_RLELossless       ? read_runs(d, frame, err)
                                                     : read_integers(d, frame, compressed, err);
    if (st != CW_OK)
        return st;
    if (l.samples > 1 && l.by_plane && !compressed)
        interleave(l, d.pixels);
    if (l.allocated > 1)
        mend(l, d.pixels.data());
    st = apply_lookup(d, frame, err);
    d.decoded = st == CW_OK ? int64_t(frame) : -1;
    return st;
}
