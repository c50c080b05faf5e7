// The input stream by which DCMTK reads an open descriptor; DCMTK itself opens files by name.
#ifndef FORMATS_DICOM_DICOM_STREAM_HPP
#define FORMATS_DICOM_DICOM_STREAM_HPP

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcerror.h>
#include <dcmtk/dcmdata/dcistrma.h>

#include <cstdint>
#include <cstring>
#include <unistd.h>

namespace cw
{

class FileProducer : public DcmProducer
{
public:
    FileProducer(int file, int64_t bytes, int64_t start_at)
        : fd(file), size(bytes), at(start_at)
    {
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
        return at >= size;
    }
    offile_off_t avail() override
    {
        return size - at;
    }
    offile_off_t skip(offile_off_t expected) override
    {
        const int64_t step = expected < size - at ? expected : size - at;
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
        while (got < expected && at < size) {
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
        filled = pread(fd, buffer, sizeof buffer, at);
        if (filled <= 0)
            condition = EC_InvalidStream; // the file has become shorter
    }

    int fd;
    int64_t size, at;
    int64_t start = 0, filled = 0;
    OFCondition condition = EC_Normal;
    char buffer[16384];
};

class FileStream : public DcmInputStream
{
public:
    FileStream(int file, int64_t bytes, int64_t start = 0)
        : DcmInputStream(&producer), producer(file, bytes, start), fd(file), size(bytes),
          base(start)
    {
    }
    // Lets DCMTK leave pixels in the file until they are needed.
    DcmInputStreamFactory *newFactory() const override;

private:
    FileProducer producer;
    int fd;
    int64_t size, base;
};

class FileFactory : public DcmInputStreamFactory
{
public:
    FileFactory(int file, int64_t bytes, int64_t start) : fd(file), size(bytes), at(start)
    {
    }
    DcmInputStream *create() const override
    {
        return new FileStream(fd, size, at);
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
    int fd;
    int64_t size, at;
};

inline DcmInputStreamFactory *FileStream::newFactory() const
{
    return currentProducer() == &producer ? new FileFactory(fd, size, base + tell()) : nullptr;
}

} // namespace cw

#endif
