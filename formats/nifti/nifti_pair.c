/* Reads NIfTI and Analyze 7.5 by the file that was named: a header, or the voxels of a pair, whose header
 * lies beside them. */
#define _GNU_SOURCE /* close */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/nifti/nifti.h"
#include "formats/nifti/nifti_format.h"

#include <string.h>
#include <unistd.h>

/* Returns true for the file of voxels of a pair: named so, and without a header of its own. */
static bool is_image(const cwi_input *in)
{
    unsigned char head[CWI_NIFTI_MAX_HEADER];
    size_t got;
    bool gzipped;
    return cwi_has_extension(in->path, ".img .img.gz") &&
           cwi_stream_head(in->fd, head, sizeof head, &got, &gzipped, NULL) == CW_OK &&
           !cwi_nifti_sniff(head, got);
}

/* Opens the header beside the voxels: "head.hdr", or "head.hdr.gz". name: room for both */
static cw_status open_header(const cwi_input *in, char *name, cwi_input *header, cw_error *err)
{
    static const char *const endings[] = {".hdr", ".hdr.gz"};
    const char *slash = strrchr(in->path, '/'), *image = slash ? slash + 1 : in->path;
    const size_t stem = strlen(image) - (cwi_has_extension(image, ".gz") ? 7 : 4);
    cw_status st = CW_OK;
    *header = *in;
    header->path = name;
    header->fd = -1;
    for (int i = 0; st == CW_OK && header->fd < 0 && i < 2; i++) {
        memcpy(name, image, stem);
        strcpy(name + stem, endings[i]);
        st = cwi_input_find_side(in, name, &header->fd, &header->size, err);
    }
    if (st == CW_OK && header->fd < 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "an .img file has its header beside it, and '%.*s.hdr' is not there; "
                        "voxels without a header need their layout stated (desc->raw)",
                        (int)(stem < 200 ? stem : 200), image);
    return st;
}

cw_status cwi_nifti_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    cwi_input header;
    if (!is_image(in))
        return cwi_nifti_parse_header(in, NULL, src, err);
    const char *slash = strrchr(in->path, '/'), *image = slash ? slash + 1 : in->path;
    char *name = cwi_alloc_array(strlen(image) + 8, 1);
    if (!name)
        return cwi_fail_memory(err);
    cw_status st = open_header(in, name, &header, err);
    if (st == CW_OK) {
        cwi_source_note(src, "the header is '%s', beside it", name);
        st = cwi_nifti_parse_header(&header, image, src, err);
        close(header.fd);
        if (st != CW_OK)
            cwi_fail_in(err, st, name);
    }
    cwi_free(name);
    return st;
}
