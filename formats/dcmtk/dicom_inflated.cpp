// Inflates DICOM files ahead of DCMTK, which would allocate any length that an element of a deflated file states.
#include "formats/dcmtk/dicom_inflated.hpp"

#include <algorithm>
#include <cstring>
#include <unistd.h>
#include <zlib.h>

using namespace cw;

Inflated::Inflated(int fd, int64_t start, int64_t end)
{
    unsigned char packed[16384];
    z_stream z = {};
    int code = inflateInit2(&z, -MAX_WBITS);
    if (code != Z_OK)
        return;
    while (code == Z_OK) {
        if (z.avail_in == 0 && start < end) {
            const size_t count = size_t(std::min<int64_t>(sizeof packed, end - start));
            const ssize_t got = pread(fd, packed, count, start);
            z.next_in = packed;
            z.avail_in = got > 0 ? uInt(got) : 0;
            start = got > 0 ? start + got : end;
        }
        const int64_t used = bytes % BLOCK;
        if (used == 0 && size_t(bytes / BLOCK) == blocks.size())
            blocks.emplace_back(new unsigned char[BLOCK]);
        z.next_out = blocks.back().get() + used;
        z.avail_out = uInt(BLOCK - used);
        code = inflate(&z, Z_NO_FLUSH);
        bytes += BLOCK - used - z.avail_out;
    }
    inflateEnd(&z);
}

int64_t Inflated::read(int64_t at, void *to, int64_t count) const
{
    count = at < 0 ? 0 : std::max<int64_t>(std::min(count, bytes - at), 0);
    for (int64_t done = 0, step; done < count; done += step) {
        const int64_t used = (at + done) % BLOCK;
        step = std::min(count - done, BLOCK - used);
        std::memcpy(static_cast<char *>(to) + done,
                    blocks[size_t((at + done) / BLOCK)].get() + used, size_t(step));
    }
    return count;
}
