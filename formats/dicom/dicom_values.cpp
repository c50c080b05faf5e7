// Reads texts, numbers, lists of numbers and items out of a dataset of DCMTK.
#include "formats/dicom/dicom_values.hpp"

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
} // namespace cw
