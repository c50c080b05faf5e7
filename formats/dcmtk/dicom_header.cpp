// Reads the facts of a file by DCMTK, behind plain C: the first half of the module "dicom".
#include "core/base/guard.hpp"
#include "formats/dcmtk/dicom_file.hpp"
#include "formats/dcmtk/dicom_frames.hpp"
#include "formats/dcmtk/dicom_lookup.hpp"
#include "formats/dcmtk/dicom_mosaic.hpp"

#include <dcmtk/dcmdata/dccodec.h>
#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <dcmtk/oflog/oflog.h>

#include <cmath>
#include <cstdio>
#include <cstring>

using namespace cw;

namespace
{

// Returns the number of frames; 0 where it is stated, but is no whole number above 0.
uint32_t frames_of(DcmItem *data)
{
    double value;
    if (text_of(data, DCM_NumberOfFrames).empty())
        return 1;
    return number_of(data, DCM_NumberOfFrames, 0, &value) && value >= 1 &&
                   value <= UINT32_MAX && value == std::floor(value)
               ? uint32_t(value)
               : 0;
}

// Finds the kind of object. DCMTK 3.6.7 does not know the class of label maps.
cwi_dicom_kind kind_of(DcmItem *data)
{
    static const char label_map[] = "1.2.840.10008.5.1.4.1.1.66.7";
    const OFString what = text_of(data, DCM_SOPClassUID);
    const bool labels = text_of(data, DCM_SegmentationType) == "LABELMAP";
    if (what == label_map || (what == UID_SegmentationStorage && labels))
        return CWI_DICOM_LABELMAP;
    if (what == UID_SegmentationStorage && text_of(data, DCM_SegmentationType) == "FRACTIONAL")
        return CWI_DICOM_FRACTIONS;
    return what == UID_SegmentationStorage ? CWI_DICOM_SEGMENTATION : CWI_DICOM_IMAGE;
}

// --- the pixels' layout
// ------------------------------------------------------------------------

bool layout_type(PixelLayout &l, const char **why)
{
    static const cw_type types[2][3] = {{CW_U8, CW_U16, CW_U32}, {CW_I8, CW_I16, CW_I32}};
    const bool whole =
        l.allocated == 1 || l.allocated == 8 || l.allocated == 16 || l.allocated == 32;
    *why = !whole ? "BitsAllocated is none of 1, 8, 16, 32"
           : l.stored < 1 || l.stored > l.allocated || l.high + 1 < l.stored ||
                   l.high >= l.allocated
               ? "BitsStored and HighBit do not fit BitsAllocated"
               : nullptr;
    if (*why)
        return false;
    l.type = types[l.is_signed][l.allocated == 32 ? 2 : l.allocated == 16 ? 1 : 0];
    return true;
}

// Checks the colour model. Plain colours are read as stored; decoders of JPEG convert theirs to RGB.
const char *check_colour(DcmItem *data, uint32_t samples, bool makes_rgb)
{
    const OFString model = text_of(data, DCM_PhotometricInterpretation);
    if (samples == 1 && model != "PALETTE COLOR")
        return nullptr;
    if (samples == 3 && (model == "RGB" || (makes_rgb && model.substr(0, 3) == "YBR")))
        return nullptr;
    return samples == 1 ? "its pixels are colours of a palette"
                        : "its colours are not stored as RGB";
}

// Checks the pixels of labels. A palette gives display colours: its indices are the numbers of
// segments.
const char *check_labels(const PixelLayout &l)
{
    return l.samples != 1 || l.is_signed || (l.type != CW_U8 && l.type != CW_U16)
               ? "it is a label map, and its pixels are not one number of 8 or 16 bits"
               : nullptr;
}

struct Stored {
    DcmElement *element = nullptr;
    const char *why_not = nullptr;
};

Stored find_pixels(DcmItem *data, PixelLayout &l, cwi_dicom_kind kind, bool makes_rgb)
{
    Stored s;
    l.columns = count_of(data, DCM_Columns, 0);
    l.rows = count_of(data, DCM_Rows, 0);
    l.samples = count_of(data, DCM_SamplesPerPixel, 1);
    l.frames = frames_of(data);
    l.allocated = count_of(data, DCM_BitsAllocated, 0);
    l.stored = count_of(data, DCM_BitsStored, l.allocated);
    l.high = count_of(data, DCM_HighBit, l.stored - 1);
    l.is_signed = count_of(data, DCM_PixelRepresentation, 0) == 1;
    l.by_plane = count_of(data, DCM_PlanarConfiguration, 0) == 1;
    if (data->findAndGetElement(DCM_FloatPixelData, s.element).good())
        l.type = CW_F32;
    else if (data->findAndGetElement(DCM_DoubleFloatPixelData, s.element).good())
        l.type = CW_F64;
    else if (data->findAndGetElement(DCM_PixelData, s.element).good() &&
             layout_type(l, &s.why_not))
        s.why_not = kind == CWI_DICOM_LABELMAP ? check_labels(l)
                                               : check_colour(data, l.samples, makes_rgb);
    return s;
}

bool is_real(const PixelLayout &l)
{
    return l.type == CW_F32 || l.type == CW_F64;
}

// Returns the padding value as stored, without a sign: it is one of the pixel values.
double padding_of(DcmItem *data, const DcmTagKey &tag, const PixelLayout &l, double otherwise)
{
    double value;
    if (!number_of(data, tag, 0, &value))
        return otherwise;
    const double range = std::ldexp(1, int(l.stored));
    return l.is_signed && value >= range / 2 ? value - range : value;
}

void take_padding(DcmItem *data, const PixelLayout &l, cwi_dicom_facts *f)
{
    double value;
    f->has_padding = !is_real(l) && number_of(data, DCM_PixelPaddingValue, 0, &value);
    if (!f->has_padding)
        return;
    const double a = padding_of(data, DCM_PixelPaddingValue, l, 0);
    const double b = padding_of(data, DCM_PixelPaddingRangeLimit, l, a);
    f->padding[0] = a < b ? a : b;
    f->padding[1] = a < b ? b : a;
}
// --- the file
// ----------------------------------------------------------------------------------

// Returns the transfer syntax that the file states for its pixels.
OFString syntax_of(DicomFile &d)
{
    const OFString text = text_of(d.file->getMetaInfo(), DCM_TransferSyntaxUID);
    return text.substr(0, text.find_first_not_of("0123456789."));
}

// Refuses, by name, syntaxes that DCMTK does not know, or knows but does not decode.
void check_syntax(DicomFile &d, cwi_dicom_facts *f)
{
    static const struct {
        const char *uid, *name;
    } unknown[] = {{"1.2.840.10008.1.2.4.110", "JPEG XL lossless"},
                   {"1.2.840.10008.1.2.4.111", "JPEG XL recompressed"},
                   {"1.2.840.10008.1.2.4.112", "JPEG XL"},
                   {"1.2.840.10008.1.2.4.201", "HTJ2K lossless"},
                   {"1.2.840.10008.1.2.4.202", "HTJ2K lossless RPCL"},
                   {"1.2.840.10008.1.2.4.203", "HTJ2K"},
                   {"1.2.840.10008.1.2.8.1", "frames deflated one by one"}};
    const OFString uid = syntax_of(d);
    const DcmXfer syntax(uid.c_str());
    const E_TransferSyntax known = syntax.getXfer();
    if (uid.empty()) // a file without a meta header states nothing
        return;
    if (known != EXS_Unknown &&
        (!is_compressed_syntax(syntax) || known == EXS_JPEG2000LosslessOnly ||
         known == EXS_JPEG2000 ||
         DcmCodecList::canChangeCoding(known, EXS_LittleEndianExplicit)))
        return;
    const char *name = known == EXS_Unknown ? "unknown" : syntax.getXferName();
    for (const auto &row : unknown)
        if (uid == row.uid)
            name = row.name;
    std::snprintf(f->refusal, sizeof f->refusal,
                  "its transfer syntax %.64s (%.60s) is not read", uid.c_str(), name);
}

cw_status open_dicom(DicomFile &d, int fd, uint64_t size, cw_error *err)
{
    d.close_file();
    d.fd = fd;
    d.stream.reset(new FileStream(Source{fd, int64_t(size), 0, nullptr}));
    d.file.reset(new DcmFileFormat);
    d.file->transferInit();
    const OFCondition read = d.file->read(*d.stream, EXS_Unknown, EGL_noChange, 1 << 16);
    d.file->transferEnd();
    if (read.bad())
        return cwi_fail(err, CW_ERR_FORMAT, "its elements are damaged or cut off: %s",
                        read.text());
    return CW_OK;
}

bool is_compressed(DicomFile &d)
{
    return is_compressed_syntax(DcmXfer(d.data()->getOriginalXfer()));
}

const char *why_unreadable(DicomFile &d)
{
    const E_TransferSyntax syntax = d.data()->getOriginalXfer();
    const bool mpeg = syntax >= EXS_MPEG2MainProfileAtMainLevel && is_compressed(d) &&
                      std::strstr(DcmXfer(syntax).getXferName(), "MPEG");
    if (mpeg)
        return "its frames are a film (MPEG)";
    if (is_compressed(d) && d.layout.allocated == 1 && syntax != EXS_RLELossless &&
        syntax != EXS_JPEG2000 && syntax != EXS_JPEG2000LosslessOnly)
        return "its pixels of one bit are compressed by something other than run lengths";
    if (DcmXfer(syntax).isBigEndian() && d.layout.allocated == 32)
        return "its numbers of 32 bits are big-endian";
    return nullptr;
}

const char *check_sizes(const PixelLayout &l)
{
    const size_t row = size_t(l.columns) * l.samples * cw_type_size(l.type);
    return l.columns < 1 || l.rows < 1  ? "Rows or Columns is missing or 0"
           : l.samples < 1              ? "SamplesPerPixel is 0"
           : row > CWI_PLANES_SHARED    ? "a row of pixels takes more than 64 MiB"
           : l.frames < 1               ? "NumberOfFrames is no whole number above 0"
           : l.count() > INT32_MAX / 16 ? "a frame holds more than 2^27 numbers"
                                        : nullptr;
}

void take_code(DcmItem *item, cwi_dicom_code *code)
{
    if (!item)
        return;
    copy_text(code->scheme, text_of(item, DCM_CodingSchemeDesignator));
    copy_text(code->value, text_of(item, DCM_CodeValue));
    copy_text(code->meaning, text_of(item, DCM_CodeMeaning));
}

void take_segment(DcmItem *item, cwi_dicom_segment *s)
{
    double lab[3];
    *s = cwi_dicom_segment();
    s->number = count_of(item, DCM_SegmentNumber, 0);
    copy_text(s->label, text_of(item, DCM_SegmentLabel));
    if (numbers_of(item, DCM_RecommendedDisplayCIELabValue, 3, lab)) {
        s->has_color = 1;
        for (int n = 0; n < 3; n++)
            s->lab[n] = uint16_t(std::fmin(std::fmax(lab[n], 0), 65535));
    }
    take_code(first_item(item, DCM_SegmentedPropertyCategoryCodeSequence), &s->category);
    take_code(first_item(item, DCM_SegmentedPropertyTypeCodeSequence), &s->type);
}

// Takes the segments of a segmentation, as many as there is room for.
void take_segments(DcmDataset *data, cwi_dicom_facts *f, size_t capacity)
{
    DcmSequenceOfItems *sequence = nullptr;
    cwi_dicom_frame *frames = reinterpret_cast<cwi_dicom_frame *>(f + 1);
    cwi_dicom_segment *segments =
        reinterpret_cast<cwi_dicom_segment *>(frames + f->frame_count);
    const size_t max =
        (capacity - sizeof *f - f->frame_count * sizeof *frames) / sizeof *segments;
    if (f->kind == CWI_DICOM_IMAGE)
        return;
    f->never_overlaps = text_of(data, DcmTagKey(0x0062, 0x0013)) == "NO"; // SegmentsOverlap
    if (data->findAndGetSequence(DCM_SegmentSequence, sequence).bad())
        return;
    while (f->segment_count < sequence->card() && f->segment_count < max) {
        take_segment(sequence->getItem(f->segment_count), segments + f->segment_count);
        f->segment_count++;
    }
}

// Scales the fractions of a segment to 0 to 1.
void scale_fractions(DcmDataset *data, cwi_dicom_facts *f)
{
    const uint32_t max = count_of(data, DCM_MaximumFractionalValue, 0);
    cwi_dicom_frame *frames = reinterpret_cast<cwi_dicom_frame *>(f + 1);
    if (f->kind != CWI_DICOM_FRACTIONS)
        return;
    if (max == 0)
        refuse(f, "it is a segmentation by fractions without 'MaximumFractionalValue'");
    for (uint32_t n = 0; n < f->frame_count && max > 0; n++) {
        frames[n].slope = 1.0 / max;
        frames[n].intercept = 0;
    }
}

cw_status take_facts(DicomFile &d, cwi_dicom_facts *f, size_t capacity, cw_error *err)
{
    DcmDataset *data = d.data();
    d.layout = PixelLayout();
    *f = cwi_dicom_facts();
    const cwi_dicom_kind kind = kind_of(data);
    const Stored s = find_pixels(
        data, d.layout, kind, is_compressed(d) && data->getOriginalXfer() != EXS_RLELossless);
    d.tables.clear();
    d.type = d.layout.type;
    if (!s.element && !(d.layout.columns > 0 && d.layout.rows > 0))
        return CW_OK; // no image: ignored
    const char *unreadable = why_unreadable(d);
    if (unreadable)
        refuse(f, unreadable);
    else
        check_syntax(d, f);
    const PixelLayout &l = d.layout;
    f->kind = kind;
    copy_text(f->series, text_of(data, DCM_SeriesInstanceUID));
    copy_text(f->instance, text_of(data, DCM_SOPInstanceUID));
    copy_text(f->modality, text_of(data, DCM_Modality));
    f->number = integer_of(data, DCM_SeriesNumber);
    f->instance_number = integer_of(data, DCM_InstanceNumber);
    f->columns = l.columns;
    f->rows = l.rows;
    f->samples = l.samples;
    f->type = f->stored_type = l.type;
    f->value_bits = is_real(l) ? unsigned(8 * cw_type_size(l.type)) : l.stored;
    f->pixel_bytes = is_compressed(d) || !s.element ? 0 : s.element->getLengthField();
    f->deflated = d.data()->getOriginalXfer() == EXS_DeflatedLittleEndianExplicit;
    refuse(f, s.element ? s.why_not : "it has Rows and Columns, and no pixels");
    refuse(f, check_sizes(l));
    if (l.frames > (capacity - sizeof *f) / sizeof(cwi_dicom_frame))
        return cwi_fail(err, CW_ERR_LIMIT, "'NumberOfFrames' is %u; at most %zu are read",
                        l.frames, (capacity - sizeof *f) / sizeof(cwi_dicom_frame));
    f->frame_count = l.frames;
    take_padding(data, l, f);
    take_frames(data, f);
    take_segments(data, f, capacity);
    scale_fractions(data, f);
    take_lookups(d, f);
    unfold_mosaic(d, f);
    return CW_OK;
}

// Takes the series of a file that is damaged behind that; it is refused as damaged.
cw_status take_series(DicomFile &d, cwi_dicom_facts *f, cw_status st, cw_error *err)
{
    *f = cwi_dicom_facts();
    f->kind = CWI_DICOM_IMAGE;
    DcmElement *series = nullptr;
    // A damaged file may state any length, and DCMTK allocates it; a UID has at most 64 bytes.
    if (d.data()->findAndGetElement(DCM_SeriesInstanceUID, series).good() &&
        series->getLengthField() <= 64)
        copy_text(f->series, text_of(d.data(), DCM_SeriesInstanceUID));
    if (st != CW_ERR_FORMAT || !f->series[0])
        return st;
    copy_text(f->refusal, err ? err->message : "its elements are damaged or cut off");
    return CW_OK;
}

cw_status copy_rows(DicomFile &d, const cwi_plane_request *q, void *shared, cw_error *err)
{
    const PixelLayout &l = d.layout;
    const Mosaic &m = d.mosaic;
    const bool unfolded = m.count > 1;
    const uint32_t rows = l.rows / m.across, frame = unfolded ? 0 : q->plane;
    if (!d.file || (unfolded ? q->plane >= m.count : q->plane >= l.frames) ||
        q->first_row > rows || q->row_count > rows - q->first_row)
        return cwi_fail(err, CW_ERR_FORMAT, "frame %u has no rows %u to %u", q->plane,
                        q->first_row, q->first_row + q->row_count);
    cw_status st = frame == d.decoded ? CW_OK : decode_frame(d, frame, err);
    if (st != CW_OK)
        return st;
    const size_t all = size_t(l.columns) * l.samples * cw_type_size(d.type);
    const size_t row = all / m.across, tile = unfolded ? q->plane : 0;
    const unsigned char *from =
        d.pixels.data() + tile % m.across * row + (tile / m.across * rows + q->first_row) * all;
    for (uint32_t n = 0; n < q->row_count; n++)
        std::memcpy(static_cast<char *>(shared) + n * row, from + n * all, row);
    return CW_OK;
}

cw_status work(void *state, int fd, const void *request, void *shared, cw_error *err)
{
    DicomFile &d = *static_cast<DicomFile *>(state);
    cwi_plane_request q;
    std::memcpy(&q, request, sizeof q);
    return guard(err, "DCMTK", [&] {
        if (q.op == CWI_PLANE_PIXELS)
            return copy_rows(d, &q, shared, err);
        cwi_dicom_facts *f = static_cast<cwi_dicom_facts *>(shared);
        cw_status st = open_dicom(d, fd, q.file_bytes, err);
        return st == CW_OK ? take_facts(d, f, CWI_PLANES_SHARED, err)
                           : take_series(d, f, st, err);
    });
}

// DCMTK's initialisation, once per process. It reads its dictionary from a file, and would log
// the data that it reads.
struct Library {
    Library()
    {
        OFLog::configure(OFLogger::OFF_LOG_LEVEL);
        DcmRLEDecoderRegistration::registerCodecs();
        DJDecoderRegistration::registerCodecs();
        DJLSDecoderRegistration::registerCodecs();
        dcmDataDict.rdlock();
        dcmDataDict.rdunlock();
    }
    ~Library()
    {
        DJLSDecoderRegistration::cleanup();
        DJDecoderRegistration::cleanup();
        DcmRLEDecoderRegistration::cleanup();
    }
};

cw_status prepare(cw_error *err)
{
    return guard(err, "DCMTK", [&] {
        static const Library library;
        return CW_OK;
    });
}

void *state_new()
{
    return new (std::nothrow) DicomFile;
}

void state_free(void *state)
{
    delete static_cast<DicomFile *>(state);
}

} // namespace

const cwi_plane_functions cwi_module_dicom = {state_new, state_free, prepare, work};
