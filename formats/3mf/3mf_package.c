/* Reads entries of a 3MF package as XML, with progress. */
#include "core/base/status.h"
#include "formats/3mf/3mf.h"

static cw_status take_text(cwi_3mf *m, const cwi_unzip_entry *entry, cw_error *err)
{
    if (entry->size > m->text_left)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "'%s' has %llu bytes of text in an archive of %llu; state a limit if that "
            "is meant (desc->max_triangles)",
            entry->name, (unsigned long long)entry->size, (unsigned long long)m->in->file.size);
    m->text_left -= entry->size;
    return CW_OK;
}

/* An entry that is read by the parser, with progress. */
typedef struct reading {
    cwi_unzip_stream stream;
    const cw_progress *progress;
} reading;

static cw_status read_some(void *from, void *to, size_t size, size_t *got, cw_error *err)
{
    reading *r = from;
    const cwi_unzip_entry *entry = &r->stream.entry;
    const double done = entry->size ? (double)r->stream.given / (double)entry->size : 0;
    cw_status st = cwi_progress(r->progress, "reading", done, err);
    return st == CW_OK ? cwi_unzip_some(&r->stream, to, size, got, err) : st;
}

cw_status cwi_3mf_read_xml(cwi_3mf *m, const char *path, const cwi_xml_rules *rules, void *user,
                           cw_error *err)
{
    reading r = {.progress = &m->in->desc.progress};
    cwi_unzip_entry entry;
    cw_status st = cwi_unzip_find(&m->zip, path, &entry, err);
    if (st == CW_OK)
        st = take_text(m, &entry, err);
    if (st == CW_OK)
        st = cwi_unzip_start(&r.stream, &m->zip, &entry, err);
    if (st == CW_OK)
        st = cwi_xml_read(rules, user, read_some, &r, err);
    cwi_unzip_end(&r.stream);
    return st;
}
