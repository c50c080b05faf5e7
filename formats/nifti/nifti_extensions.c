/* Finds the names of labels in the extensions between a NIfTI header and its voxels. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/nifti/nifti.h"
#include "formats/text/label_xml.h"

#include <stdio.h>
#include <string.h>

enum {
    FLAG_BYTES = 4, /* behind the header: the first is not 0 where extensions follow */
    HEAD_BYTES = 8, /* of an extension: its size and its code */
    MIN_EXTENSION = 16,
    MAX_TABLE = 16 << 20,
    MAX_EXTENSIONS = 64 << 20, /* bytes that are searched */
    CODE_UNKNOWN = 0,          /* TotalSegmentator uses it */
    CODE_CARET = 30            /* Connectome Workbench */
};

static int32_t read_int(const unsigned char *bytes, bool swapped)
{
    uint32_t number;
    memcpy(&number, bytes, sizeof number);
    if (swapped)
        number = __builtin_bswap32(number);
    return (int32_t)number;
}

/* Reads bytes. *is_complete is false where the file ends first or is damaged: the reader of the
 * voxels will report it. */
static cw_status read_some(cwi_stream *stream, void *to, size_t size, bool *is_complete,
                           cw_error *err)
{
    size_t got = 0;
    cw_status st = cwi_stream_some(stream, to, size, &got, err);
    *is_complete = st == CW_OK && got == size;
    return st == CW_ERR_FORMAT ? CW_OK : st;
}

/* Parses the text of an extension. XML that cannot be read is noted, as the voxels are good. */
static cw_status parse_table(const char *text, cw_label_table *table, char note[200],
                             cw_error *err)
{
    cw_error why = {0};
    if (!cwi_label_xml_sniff(text))
        return CW_OK;
    cw_status st = cwi_label_xml_read(text, strlen(text), table, &why);
    if (st == CW_OK)
        return CW_OK;
    cw_label_table_free(table);
    if (st == CW_ERR_NO_MEMORY)
        return cwi_fail(err, st, "%s", why.message);
    snprintf(note, 200, "left out: the names of labels in an extension: %.130s", why.message);
    return CW_OK;
}

static cw_status read_table(cwi_stream *stream, size_t size, cw_label_table *table,
                            char note[200], cw_error *err)
{
    bool is_complete = false;
    char *text = cwi_alloc_array(size + 1, 1);
    if (!text)
        return cwi_fail_memory(err);
    cw_status st = read_some(stream, text, size, &is_complete, err);
    text[size] = '\0';
    if (st == CW_OK && is_complete)
        st = parse_table(text, table, note, err);
    cwi_free(text);
    return st;
}

/* Walks over the extensions, to the first with labels. */
static cw_status search_extensions(cwi_stream *stream, const cwi_nifti_span *span,
                                   cw_label_table *table, char note[200], cw_error *err)
{
    unsigned char head[HEAD_BYTES];
    uint64_t left = span->end - span->start - FLAG_BYTES;
    bool is_complete = false;
    if (left > MAX_EXTENSIONS)
        left = MAX_EXTENSIONS;
    cw_status st = cwi_stream_skip(stream, span->start, err);
    if (st == CW_OK)
        st = read_some(stream, head, FLAG_BYTES, &is_complete, err);
    while (st == CW_OK && is_complete && head[0] && !table->count && left >= MIN_EXTENSION) {
        st = read_some(stream, head, HEAD_BYTES, &is_complete, err);
        if (st != CW_OK || !is_complete)
            break;
        const int32_t size = read_int(head, span->swapped);
        const int32_t code = read_int(head + 4, span->swapped);
        if (size < MIN_EXTENSION || (uint64_t)size > left)
            break;
        const size_t bytes = (size_t)size - HEAD_BYTES;
        if ((code == CODE_UNKNOWN || code == CODE_CARET) && bytes <= MAX_TABLE)
            st = read_table(stream, bytes, table, note, err);
        else
            st = cwi_stream_skip(stream, bytes, err);
        left -= (uint64_t)size;
        head[0] = 1;
    }
    return st == CW_ERR_FORMAT ? CW_OK : st;
}

cw_status cwi_nifti_labels(const cwi_input *in, const cwi_nifti_span *span,
                           cw_label_table *table, char note[200], cw_error *err)
{
    cwi_stream stream = {0};
    if (span->end < span->start + FLAG_BYTES + MIN_EXTENSION)
        return CW_OK;
    cw_status st = cwi_stream_open(&stream, in->fd, 0, span->gzipped, err);
    if (st == CW_OK)
        st = search_extensions(&stream, span, table, note, err);
    cwi_stream_close(&stream);
    if (st != CW_OK)
        cw_label_table_free(table);
    return st;
}
