// Values of a dataset of DCMTK: texts, numbers, items.
#ifndef FORMATS_DCMTK_DICOM_VALUES_HPP
#define FORMATS_DCMTK_DICOM_VALUES_HPP

#include "formats/dcmtk/dicom.h"

#include <dcmtk/dcmdata/dctk.h>

#include <cstdio>
#include <vector>

namespace cw
{

// Returns the text of a value; empty where there is none.
OFString text_of(DcmItem *item, const DcmTagKey &tag, unsigned long at = 0);

// Reads a number in any representation; returns false where there is none that is finite.
bool number_of(DcmItem *item, const DcmTagKey &tag, unsigned long at, double *out);

// Reads the first numbers of an element; returns false where it has fewer.
bool numbers_of(DcmItem *item, const DcmTagKey &tag, unsigned count, double *out);

// Reads all numbers of an element; none where one of them is no finite number.
std::vector<double> list_of(DcmItem *item, const DcmTagKey &tag);

// Reads the tags that an element points to.
std::vector<DcmTagKey> tags_of(DcmItem *item, const DcmTagKey &tag);

uint32_t count_of(DcmItem *item, const DcmTagKey &tag, uint32_t otherwise);

// Returns a whole number; INT64_MIN where there is none.
int64_t integer_of(DcmItem *item, const DcmTagKey &tag);

// Returns the first item of a sequence; NULL where there is none.
DcmItem *first_item(DcmItem *item, const DcmTagKey &sequence);

// Returns all items of a sequence.
std::vector<DcmItem *> items_of(DcmItem *item, const DcmTagKey &sequence);

// Copies a text as far as there is room for it.
template <size_t size> void copy_text(char (&to)[size], const OFString &text)
{
    std::snprintf(to, size, "%s", text.c_str());
}

// Keeps the first reason why pixels are not read; NULL is none.
inline void refuse(cwi_dicom_facts *f, const char *why)
{
    if (why && !f->refusal[0])
        copy_text(f->refusal, why);
}

} // namespace cw

#endif
