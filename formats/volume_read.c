#include "core/status.h"
#include "formats/readers.h"
#include "formats/stream.h"
#include "formats/table.h"

#include <stdio.h>
#include <string.h>

/* One row per reader; content decides, then the extension. */
typedef struct reader {
    const char *name, *extensions;
    bool gzipped; /* the whole file may be a gzip file */
    bool (*sniff)(const unsigned char *head, size_t size);
    cw_status (*parse)(const cwi_input *in, cwi_source *src, cw_error *err);
} reader;

static const reader readers[] = {
    {"nrrd", ".nrrd .nhdr", false, cwi_nrrd_sniff, cwi_nrrd_parse},
    {"nifti", ".nii .nii.gz .hdr .hdr.gz .img .img.gz", true, cwi_nifti_sniff, cwi_nifti_parse},
    {"metaimage", ".mha .mhd", false, cwi_metaimage_sniff, cwi_metaimage_parse},
    {"vtk", ".vtk", false, cwi_vtk_sniff, cwi_vtk_parse},
    {"vti", ".vti", false, cwi_vti_sniff, cwi_vti_parse},
    {"mrc", ".mrc .map .ccp4 .rec .mrc.gz .map.gz", true, cwi_mrc_sniff, cwi_mrc_parse},
    {"inr", ".inr .inr.gz", true, cwi_inr_sniff, cwi_inr_parse},
};
enum { READER_COUNT = sizeof readers / sizeof *readers };

static const char *reader_names(char names[128])
{
    size_t used = 0;
    for (size_t i = 0; i < READER_COUNT; i++)
        used +=
            (size_t)snprintf(names + used, 128 - used, "%s%s", i ? ", " : "", readers[i].name);
    return names;
}

static cw_status find_by_name(const char *name, const reader **found, cw_error *err)
{
    char names[128];
    if (strcmp(name, "raw") == 0)
        return cw_fail(err, CW_ERR_ARGUMENT, "the reader 'raw' needs a layout");
    for (size_t i = 0; i < READER_COUNT; i++)
        if (strcmp(readers[i].name, name) == 0) {
            *found = &readers[i];
            return CW_OK;
        }
    return cw_fail(err, CW_ERR_ARGUMENT, "there is no reader '%s'; there are %s", name,
                   reader_names(names));
}

/* A gzip file that is damaged from the start has no content to go by. */
static cw_status read_head(const cwi_input *in, unsigned char *head, size_t *size,
                           bool *gzipped, cw_error *err)
{
    cw_status st = cwi_stream_head(in->fd, head, CWI_SNIFF_BYTES, size, gzipped, err);
    if (st != CW_ERR_FORMAT)
        return st;
    *size = 0;
    return CW_OK;
}

static cw_status find_by_file(const cwi_input *in, const reader **found, cw_error *err)
{
    unsigned char head[CWI_SNIFF_BYTES];
    char names[128];
    size_t size;
    bool gzipped;
    cw_status st = read_head(in, head, &size, &gzipped, err);
    if (st != CW_OK)
        return st;
    for (size_t i = 0; i < READER_COUNT && !*found; i++)
        if ((readers[i].gzipped || !gzipped) && readers[i].sniff(head, size))
            *found = &readers[i];
    for (size_t i = 0; i < READER_COUNT && !*found; i++)
        if (cwi_has_extension(in->path, readers[i].extensions))
            *found = &readers[i];
    if (*found)
        return CW_OK;
    return cw_fail(
        err, CW_ERR_FORMAT,
        "neither content nor extension is of a format that is read (%s); a headerless "
        "file needs its layout stated (--raw)",
        reader_names(names));
}

static cw_status describe(const cwi_input *in, const cw_read_desc *desc, cwi_source *src,
                          const char **format, cw_error *err)
{
    const reader *found = NULL;
    if (desc->raw) {
        *format = "raw";
        return cwi_raw_describe(desc->raw, src, err);
    }
    cw_status st =
        desc->reader ? find_by_name(desc->reader, &found, err) : find_by_file(in, &found, err);
    if (st != CW_OK)
        return st;
    *format = found->name;
    return found->parse(in, src, err);
}

cw_status cw_volume_read(const char *path, const cw_read_desc *desc, cw_volume *volume,
                         const char **format, cw_error *err)
{
    const cw_read_desc defaults = {0};
    const char *name = NULL;
    cwi_input in = {0};
    cwi_source src = {0};
    memset(volume, 0, sizeof *volume);
    if (!desc)
        desc = &defaults;
    cw_status st = cwi_input_open(&in, path, err);
    in.allow_external = desc->allow_external;
    if (st == CW_OK)
        st = describe(&in, desc, &src, &name, err);
    if (st == CW_OK)
        st = cwi_source_load(&src, &in, desc, volume, err);
    cwi_source_free(&src);
    cwi_input_close(&in);
    if (format)
        *format = name;
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
