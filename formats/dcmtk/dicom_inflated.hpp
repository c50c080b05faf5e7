// The inflated data of a deflated DICOM file, in memory.
#ifndef FORMATS_DCMTK_DICOM_INFLATED_HPP
#define FORMATS_DCMTK_DICOM_INFLATED_HPP

#include <cstdint>
#include <memory>
#include <vector>

namespace cw
{

class Inflated
{
public:
    // Inflates a file from a place to its end (raw deflate, PS3.5 A.5); what follows damage is left out.
    Inflated(int fd, int64_t start, int64_t end);

    int64_t size() const
    {
        return bytes;
    }
    // Copies bytes that are there; returns their number.
    int64_t read(int64_t at, void *to, int64_t count) const;

private:
    enum { BLOCK = 1 << 20 };
    std::vector<std::unique_ptr<unsigned char[]>> blocks;
    int64_t bytes = 0;
};

} // namespace cw

#endif
