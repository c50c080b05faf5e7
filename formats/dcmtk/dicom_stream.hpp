// The input stream by which DCMTK reads an open descriptor; DCMTK itself opens files by name.
#ifndef FORMATS_DCMTK_DICOM_STREAM_HPP
#define FORMATS_DCMTK_DICOM_STREAM_HPP

#include "formats/dcmtk/dicom_inflated.hpp"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcerror.h>
#include <dcmtk/dcmdata/dcistrma.h>

#include <cstdint>
#include <cstring>
#include <unistd.h>

namespace cw
{

// The bytes of a file. Behind the meta header of a deflated one, those are the inflated ones.
struct Source {
    int fd;
    int64_t size;
    int64_t inflated_from = 0;          // of a deflated file: the place of
    std::shared_ptr<Inflated> inflated; // its inflated bytes, else NULL
};

class FileProducer : public DcmProducer
{
public:
    FileProducer(const Source &of, int64_t start_at) : source(of), at(start_at)
    {
    }
    // Continues with inflated bytes.
    void inflate()
    {
        source.inflated.reset(new Inflated(source.fd, at, source.size));
        source.inflated_from = at;
        source.size = at + source.inflated->size();
        filled = 0;
    }
    const Source &from() const
    {
        return source;
    }
    OFBool good() const override
    {
        return condition.good();
    }
    OFCondition status() const override
    {
        return condition;
    }
    OFBool eos() override
    {
        return at >= source.size;
    }
    offile_off_t avail() override
    {
        return source.size - at;
    }
    offile_off_t skip(offile_off_t expected) override
    {
        const int64_t step = expected < source.size - at ? expected : source.size - at;
        at += step;
        return step;
    }
    void putback(offile_off_t count) override
    {
        at -= count < at ? count : at;
    }
    offile_off_t read(void *to, offile_off_t expected) override
    {
        offile_off_t got = 0;
        if (source.inflated) {
            got = source.inflated->read(at - source.inflated_from, to, expected);
            at += got;
            return got;
        }
        while (got < expected && at < source.size) {
            if (at < start || at >= start + filled)
                fill();
            if (filled <= 0)
                break;
            const int64_t have = start + filled - at, want = expected - got;
            const int64_t step = have < want ? have : want;
            std::memcpy(static_cast<char *>(to) + got, buffer + (at - start), step);
            at += step;
            got += step;
        }
        return got;
    }

private:
    void fill()
    {
        start = at;
        filled = pread(source.fd, buffer, sizeof buffer, at);
        if (filled <= 0)
            condition = EC_InvalidStream; // the file has become shorter
    }

    Source source;
    int64_t at;
    int64_t start = 0, filled = 0;
    OFCondition condition = EC_Normal;
    char buffer[16384];
};

class FileStream : public DcmInputStream
{
public:
    FileStream(const Source &source, int64_t start = 0)
        : DcmInputStream(&producer), producer(source, start), base(start)
    {
    }
    OFCondition installCompressionFilter(E_StreamCompression kind) override
    {
        if (kind != ESC_zlib)
            return DcmInputStream::installCompressionFilter(kind);
        producer.inflate();
        return EC_Normal;
    }
    // Lets DCMTK leave pixels in the file until they are needed.
    DcmInputStreamFactory *newFactory() const override;

private:
    FileProducer producer;
    int64_t base;
};

class FileFactory : public DcmInputStreamFactory
{
public:
    FileFactory(const Source &of, int64_t start) : source(of), at(start)
    {
    }
    DcmInputStream *create() const override
    {
        return new FileStream(source, at);
    }
    DcmInputStreamFactory *clone() const override
    {
        return new FileFactory(*this);
    }
    DcmInputStreamFactoryType ident() const override
    {
        return DFT_DcmInputFileStreamFactory;
    }

private:
    Source source;
    int64_t at;
};

inline DcmInputStreamFactory *FileStream::newFactory() const
{
    return currentProducer() == &producer ? new FileFactory(producer.from(), base + tell())
                                          : nullptr;
}

} // namespace cw

#endif
