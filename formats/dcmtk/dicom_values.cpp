// Reads texts, numbers, lists of numbers and items out of a dataset of DCMTK.
#include "formats/dcmtk/dicom_values.hpp"

#include "core/base/text.h"

#include <cmath>

namespace cw
{

OFString text_of(DcmItem *item, const DcmTagKey &tag, unsigned long at)
{
    OFString text;
    if (!item || item->findAndGetOFString(tag, text, at).bad())
        text.clear();
    return text;
}

bool number_of(DcmItem *item, const DcmTagKey &tag, unsigned long at, double *out)
{
    Float64 value = 0;
    if (!item)
        return false;
    if (item->findAndGetFloat64(tag, value, at).bad()) { // not one of the real representations
        const OFString text = text_of(item, tag, at);
        const char *s = text.c_str();
        if (!cwi_parse_double(&s, &value))
            return false;
    }
    *out = value;
    return std::isfinite(value);
}
// Parts the text once, since DCMTK searches it from the start for each number.
static std::vector<double> parse_list(const OFString &text)
{
    std::vector<double> list;
    const char *s = text.c_str();
    for (double value; cwi_parse_double(&s, &value) && std::isfinite(value); s++) {
        list.push_back(value);
        while (*s == ' ')
            s++;
        if (*s != '\\')
            break;
    }
    return *s ? std::vector<double>() : list;
}

// Reads numbers that are too many for their own representation, and so are stored as unknown (PS3.5 6.2.2).
static std::vector<double> parse_unknown(DcmElement *element)
{
    std::vector<double> list;
    const DcmEVR usual = DcmTag(element->getTag().getXTag()).getEVR();
    Uint8 *bytes = nullptr;
    const size_t size = element->getLengthField();
    if (element->getUint8Array(bytes).bad() || !bytes)
        return list;
    if (usual == EVR_DS || usual == EVR_IS)
        return parse_list(OFString(reinterpret_cast<char *>(bytes), size));
    for (size_t n = 0; usual == EVR_US && n + 1 < size; n += 2)
        list.push_back(bytes[n] | bytes[n + 1] << 8);
    return list;
}

std::vector<double> list_of(DcmItem *item, const DcmTagKey &tag)
{
    std::vector<double> list;
    DcmElement *element = nullptr;
    OFString text;
    if (!item || item->findAndGetElement(tag, element).bad())
        return list;
    if (element->ident() == EVR_DS || element->ident() == EVR_IS)
        return element->getOFStringArray(text).good() ? parse_list(text) : list;
    if (element->ident() == EVR_UN)
        return parse_unknown(element);
    const unsigned long count = element->getVM();
    list.resize(count);
    for (unsigned long n = 0; n < count; n++)
        if (!number_of(item, tag, n, &list[n]))
            return std::vector<double>();
    return list;
}

std::vector<DcmTagKey> tags_of(DcmItem *item, const DcmTagKey &tag)
{
    std::vector<DcmTagKey> tags;
    DcmElement *element = nullptr;
    if (!item || item->findAndGetElement(tag, element).bad())
        return tags;
    DcmAttributeTag *list = dynamic_cast<DcmAttributeTag *>(element);
    DcmTagKey key;
    for (unsigned long n = 0; list && list->getTagVal(key, n).good(); n++)
        tags.push_back(key);
    return tags;
}

uint32_t count_of(DcmItem *item, const DcmTagKey &tag, uint32_t otherwise)
{
    double value;
    return number_of(item, tag, 0, &value) && value >= 0 && value <= UINT32_MAX
               ? uint32_t(value)
               : otherwise;
}

int64_t integer_of(DcmItem *item, const DcmTagKey &tag)
{
    double value;
    return number_of(item, tag, 0, &value) && std::fabs(value) < 1e15 ? int64_t(value)
                                                                      : INT64_MIN;
}
bool numbers_of(DcmItem *item, const DcmTagKey &tag, unsigned count, double *out)
{
    for (unsigned n = 0; n < count; n++)
        if (!number_of(item, tag, n, out + n))
            return false;
    return true;
}
DcmItem *first_item(DcmItem *item, const DcmTagKey &sequence)
{
    DcmItem *found = nullptr;
    if (item && item->findAndGetSequenceItem(sequence, found, 0).good())
        return found;
    return nullptr;
}

std::vector<DcmItem *> items_of(DcmItem *item, const DcmTagKey &sequence)
{
    std::vector<DcmItem *> items;
    DcmSequenceOfItems *list = nullptr;
    if (!item || item->findAndGetSequence(sequence, list).bad())
        return items;
    for (DcmObject *o = list->nextInContainer(nullptr); o; o = list->nextInContainer(o))
        items.push_back(static_cast<DcmItem *>(o));
    return items;
}

} // namespace cw
