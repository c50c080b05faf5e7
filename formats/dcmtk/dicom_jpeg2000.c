/* Decodes JPEG 2000 images in DICOM by OpenJPEG, since Debian's DCMTK does not. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/dcmtk/dicom.h"

#include <openjpeg.h>
#include <string.h>

/* A codestream in memory. */
typedef struct bytes {
    const unsigned char *data;
    size_t size, at;
} bytes;

static OPJ_SIZE_T read_bytes(void *to, OPJ_SIZE_T expected, void *user)
{
    bytes *b = user;
    const size_t left = b->size - b->at, n = expected < left ? expected : left;
    if (n == 0)
        return (OPJ_SIZE_T)-1;
    memcpy(to, b->data + b->at, n);
    b->at += n;
    return n;
}

static OPJ_OFF_T skip_bytes(OPJ_OFF_T expected, void *user)
{
    bytes *b = user;
    if (expected < 0 || (size_t)expected > b->size - b->at)
        return -1;
    b->at += (size_t)expected;
    return expected;
}

static OPJ_BOOL seek_bytes(OPJ_OFF_T to, void *user)
{
    bytes *b = user;
    if (to < 0 || (size_t)to > b->size)
        return OPJ_FALSE;
    b->at = (size_t)to;
    return OPJ_TRUE;
}

static opj_stream_t *open_stream(bytes *b)
{
    opj_stream_t *stream = opj_stream_default_create(OPJ_TRUE);
    if (!stream)
        return NULL;
    opj_stream_set_user_data(stream, b, NULL);
    opj_stream_set_user_data_length(stream, b->size);
    opj_stream_set_read_function(stream, read_bytes);
    opj_stream_set_skip_function(stream, skip_bytes);
    opj_stream_set_seek_function(stream, seek_bytes);
    return stream;
}

static void keep_first_message(const char *text, void *user)
{
    char *why = user;
    if (!why[0])
        strncat(why, text, 99);
    why[strcspn(why, "\n")] = '\0';
}

static cw_status fail_image(const cwi_dicom_image *m, const char *why, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "its JPEG 2000 image of %u x %u cannot be read: %s",
                    m->columns, m->rows, why[0] ? why : "no reason given");
}

/* Checks the header against DICOM's before memory is allocated for pixels. */
static const char *check_header(const opj_image_t *image, const cwi_dicom_image *m)
{
    const unsigned bits = 8 * (unsigned)cw_type_size(m->type);
    if (image->numcomps != m->samples)
        return "it has another number of components";
    for (unsigned c = 0; c < image->numcomps; c++)
        if (image->comps[c].w != m->columns || image->comps[c].h != m->rows)
            return "it is of another size";
        else if (image->comps[c].prec > bits || image->comps[c].prec > 31)
            return "it has more bits than a pixel";
    return NULL;
}

static void put_number(unsigned char *to, int32_t value, size_t size)
{
    const uint16_t word = (uint16_t)value;
    if (size == 1)
        *to = (unsigned char)value;
    else if (size == 2)
        memcpy(to, &word, size);
    else
        memcpy(to, &value, size);
}

static void copy_pixels(const opj_image_t *image, const cwi_dicom_image *m, void *pixels)
{
    const size_t size = cw_type_size(m->type), count = (size_t)m->columns * m->rows;
    for (unsigned c = 0; c < m->samples; c++)
        for (size_t i = 0; i < count; i++)
            put_number((unsigned char *)pixels + (i * m->samples + c) * size,
                       image->comps[c].data[i], size);
}

static cw_status decode_codestream(opj_codec_t *codec, opj_stream_t *stream,
                                   const cwi_dicom_image *m, char why[100], void *pixels,
                                   cw_error *err)
{
    opj_dparameters_t parameters;
    opj_image_t *image = NULL;
    opj_set_default_decoder_parameters(&parameters);
    opj_set_error_handler(codec, keep_first_message, why);
    bool good = opj_setup_decoder(codec, &parameters) &&
                opj_decoder_set_strict_mode(codec, 1) && opj_read_header(stream, codec, &image);
    const char *wrong = good ? check_header(image, m) : NULL;
    good = good && !wrong && opj_decode(codec, stream, image);
    for (unsigned c = 0; good && c < image->numcomps; c++)
        good = image->comps[c].data != NULL;
    if (good)
        copy_pixels(image, m, pixels);
    opj_image_destroy(image);
    return good ? CW_OK : fail_image(m, wrong ? wrong : why, err);
}

cw_status cwi_dicom_jpeg2000(const void *data, size_t size, const cwi_dicom_image *m,
                             void *pixels, cw_error *err)
{
    static const unsigned char boxed[] = {0, 0, 0, 12, 'j', 'P', ' ', ' '};
    bytes b = {.data = data, .size = size};
    char why[100] = "";
    const bool jp2 = size > sizeof boxed && memcmp(data, boxed, sizeof boxed) == 0;
    opj_codec_t *codec = opj_create_decompress(jp2 ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K);
    opj_stream_t *stream = open_stream(&b);
    cw_status st = codec && stream ? decode_codestream(codec, stream, m, why, pixels, err)
                                   : cwi_fail_memory(err);
    opj_stream_destroy(stream);
    opj_destroy_codec(codec);
    return st;
}
