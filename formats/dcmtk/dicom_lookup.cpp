// Reads Modality LUTs, and turns pixels into values by them.
#include "formats/dcmtk/dicom_lookup.hpp"

#include "core/base/status.h"
#include "core/volume/volume.h"

#include <algorithm>
#include <cmath>

using namespace cw;

namespace
{

// A table: entry n is the value of pixel first + n. Pixels beyond either end have that end's value.
struct Table {
    uint32_t count = 0, bits = 0;
    int64_t first = 0;
    std::vector<uint16_t> values;
};

// Reads a number of 16 bits, whatever sign its representation has.
bool word_of(DcmItem *item, unsigned at, int64_t *out)
{
    double value;
    if (!number_of(item, DCM_LUTDescriptor, at, &value) || value < -32768 || value > 65535)
        return false;
    *out = int64_t(value) & 0xffff;
    return true;
}

// Reads the descriptor; returns the error, or NULL. The first pixel has the sign of pixels; 0
// entries stand for 65536.
const char *read_descriptor(DcmItem *item, bool is_signed, Table *t)
{
    int64_t count, first, bits;
    DcmElement *data = nullptr;
    if (!word_of(item, 0, &count) || !word_of(item, 1, &first) || !word_of(item, 2, &bits))
        return "LUTDescriptor of its ModalityLUTSequence does not hold three numbers of 16 bits";
    t->count = count ? uint32_t(count) : 65536;
    t->first = is_signed && first >= 32768 ? first - 65536 : first;
    t->bits = uint32_t(bits);
    if (bits < 8 || bits > 16)
        return "LUTDescriptor of its ModalityLUTSequence states entries of fewer than 8 or more than 16 bits";
    if (item->findAndGetElement(DCM_LUTData, data).bad() ||
        data->getLengthField() < (bits == 8 ? t->count : 2 * t->count))
        return "LUTData of its ModalityLUTSequence holds fewer entries than LUTDescriptor states";
    return nullptr;
}

// Reads the entries. Those of 8 bits may be packed two to a word, or have one each.
bool read_entries(DcmItem *item, Table *t)
{
    DcmElement *data = nullptr;
    Uint16 *words = nullptr;
    Uint8 *bytes = nullptr;
    if (item->findAndGetElement(DCM_LUTData, data).bad())
        return false;
    const size_t size = data->getLengthField(), count = t->count;
    t->values.resize(count);
    const bool packed = t->bits == 8 && size < 2 * count;
    if (data->getUint16Array(words).good() && words) {
        for (size_t n = 0; n < count; n++)
            t->values[n] = packed ? Uint16(words[n / 2] >> (n % 2 ? 8 : 0) & 0xff) : words[n];
        return true;
    }
    if (data->getUint8Array(bytes).bad() || !bytes)
        return false;
    for (size_t n = 0; n < count; n++)
        t->values[n] = packed ? bytes[n] : Uint16(bytes[2 * n] | bytes[2 * n + 1] << 8);
    return true;
}

DcmItem *table_of(DcmItem *item)
{
    return first_item(item, DCM_ModalityLUTSequence);
}

// Finds the table of every frame: its own, else that of all.
std::vector<DcmItem *> find_tables(DcmItem *data, uint32_t frames)
{
    DcmItem *shared = first_item(data, DCM_SharedFunctionalGroupsSequence);
    DcmItem *all = table_of(first_item(shared, DCM_PixelValueTransformationSequence));
    const std::vector<DcmItem *> each = items_of(data, DCM_PerFrameFunctionalGroupsSequence);
    std::vector<DcmItem *> tables(frames, all ? all : table_of(data));
    for (size_t n = 0; n < each.size() && n < frames; n++) {
        DcmItem *own = table_of(first_item(each[n], DCM_PixelValueTransformationSequence));
        if (own)
            tables[n] = own;
    }
    return tables;
}

// Chooses the type of the returned values, and moves padding to where no value is.
void choose_type(DicomFile &d, uint32_t bits, bool everywhere, cwi_dicom_facts *f)
{
    const PixelLayout &l = d.layout;
    const double nowhere = everywhere ? -1 : l.allocated > 16 ? -std::ldexp(1, 40) : INT32_MIN;
    d.has_padding = f->has_padding;
    std::copy(f->padding, f->padding + 2, d.padding);
    if (everywhere && !f->has_padding) {
        f->type = bits > 8 ? CW_U16 : CW_U8;
        f->value_bits = bits;
    } else {
        f->type = l.allocated > 16 && !everywhere ? CW_F64 : CW_I32;
        f->value_bits = everywhere       ? bits + 1
                        : f->has_padding ? 32
                                         : std::max(bits, l.stored) + 1;
    }
    d.type = f->type;
    if (f->has_padding)
        f->padding[0] = f->padding[1] = d.nowhere = nowhere;
}

// Values of a table are not scaled; they are Hounsfield units if it says so.
void describe_frame(DcmItem *table, cwi_dicom_frame *f)
{
    f->slope = 1;
    f->intercept = 0;
    f->has &= ~unsigned(CWI_DICOM_RESCALED);
    if (text_of(table, DCM_ModalityLUTType) == "HU")
        f->has |= CWI_DICOM_RESCALED;
}

double value_of(const DicomFile &d, const Table &t, double pixel)
{
    if (d.has_padding && pixel >= d.padding[0] && pixel <= d.padding[1])
        return d.nowhere;
    if (t.values.empty())
        return pixel;
    const double at = std::min(std::max(pixel - double(t.first), 0.0), double(t.count - 1));
    return t.values[size_t(at)];
}

} // namespace

void cw::take_lookups(DicomFile &d, cwi_dicom_facts *facts)
{
    const PixelLayout &l = d.layout;
    cwi_dicom_frame *frames = reinterpret_cast<cwi_dicom_frame *>(facts + 1);
    uint32_t bits = 0;
    bool everywhere = true;
    d.type = facts->type;
    d.tables.clear();
    if (facts->kind != CWI_DICOM_IMAGE || facts->refusal[0])
        return;
    d.tables = find_tables(d.data(), facts->frame_count);
    for (size_t n = 0; n < d.tables.size(); n++) {
        Table t;
        everywhere = everywhere && d.tables[n];
        if (!d.tables[n])
            continue;
        refuse(facts, read_descriptor(d.tables[n], l.is_signed, &t));
        bits = std::max(bits, t.bits);
        describe_frame(d.tables[n], frames + n);
    }
    if (bits == 0) {
        d.tables.clear();
        return;
    }
    if (l.samples != 1 || l.type == CW_F32 || l.type == CW_F64)
        refuse(facts, "it has a ModalityLUTSequence, which is for whole numbers of one sample");
    choose_type(d, bits, everywhere, facts);
}

cw_status cw::apply_lookup(DicomFile &d, uint32_t frame, cw_error *err)
{
    Table t;
    if (d.tables.empty())
        return CW_OK;
    DcmItem *item = d.tables[frame];
    if (item && (read_descriptor(item, d.layout.is_signed, &t) || !read_entries(item, &t)))
        return cwi_fail(err, CW_ERR_FORMAT, "LUTData of frame %u cannot be read", frame + 1);
    const size_t from = cw_type_size(d.layout.type), to = cw_type_size(d.type);
    std::vector<unsigned char> values(d.layout.count() * to);
    for (size_t n = 0; n < d.layout.count(); n++)
        cwi_voxel_put(d.type, &values[n * to],
                      value_of(d, t, cwi_voxel_at(d.layout.type, &d.pixels[n * from])));
    d.pixels.swap(values);
    return CW_OK;
}
