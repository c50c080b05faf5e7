// The open file of the module "dicom", and the state that its two halves share.
#ifndef FORMATS_DCMTK_DICOM_FILE_HPP
#define FORMATS_DCMTK_DICOM_FILE_HPP

#include "formats/dcmtk/dicom_stream.hpp"
#include "formats/dcmtk/dicom_values.hpp"

#include <memory>
#include <vector>

namespace cw
{

// The storage of pixels: the attributes of the Image Pixel module.
struct PixelLayout {
    uint32_t columns = 0, rows = 0, samples = 1, frames = 1;
    unsigned allocated = 0, stored = 0, high = 0;
    bool is_signed = false, by_plane = false;
    cw_type type = CW_U8;
    size_t count() const
    {
        return size_t(columns) * rows * samples;
    } // numbers of a frame
};

// A mosaic: slices side by side in one image, row by row; without a mosaic it is one by one.
struct Mosaic {
    uint32_t across = 1, count = 1;
    double normal[3] = {0, 0, 0}; // from a slice to the next one
};

struct DicomFile {
    int fd = -1;
    std::unique_ptr<FileStream> stream;
    std::unique_ptr<DcmFileFormat> file;
    PixelLayout layout;
    Mosaic mosaic;
    std::vector<DcmItem *>
        tables; // the Modality LUT of each frame, which may have none; empty:
                // no frame has one. Then:
    bool has_padding = false;
    double padding[2] = {0, 0}, nowhere = 0; // stored pixels that are padding, and their value
    cw_type type = CW_U8;                    // of the returned pixels
    std::vector<unsigned char> pixels;       // of the frame decoded last
    int64_t decoded = -1;
    ~DicomFile()
    {
        close_file();
    }

    DcmDataset *data()
    {
        return file->getDataset();
    }
    void close_file()
    {
        tables.clear();
        file.reset();
        stream.reset();
        decoded = -1;
        if (fd >= 0)
            close(fd);
        fd = -1;
    }
};

// Tells whether frames of a transfer syntax are compressed. DCMTK 3.6.9 asks in two parts what
// 3.6.7 answers in one.
template <typename Syntax>
auto is_compressed_syntax(const Syntax &syntax)
    -> decltype(bool(syntax.isPixelDataCompressed()))
{
    return syntax.usesEncapsulatedFormat() && syntax.isPixelDataCompressed();
}

template <typename Syntax, typename... None>
bool is_compressed_syntax(const Syntax &syntax, None...)
{
    return syntax.isEncapsulated();
}

// Decodes a frame into file.pixels: packed, interleaved, of the layout's type.
cw_status decode_frame(DicomFile &file, uint32_t frame, cw_error *err);

} // namespace cw

#endif
