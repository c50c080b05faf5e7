/* Keeps the bytes of files without a path in files without a name, and hands them out again. */
#define _GNU_SOURCE /* F_DUPFD_CLOEXEC */
#include "core/files/stored_file.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/unnamed_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PIECE_BYTES = 1 << 20 };

/* Passes on the failure of a function of the caller, which need not say why. */
static cw_status fail_callback(cw_status st, const cw_error *why, const char *otherwise,
                               cw_error *err)
{
    return cwi_fail(err, st, "%s", why->message[0] ? why->message : otherwise);
}

/* --- reading ------------------------------------------------------------------------------ */

/* A stored file that is being filled. */
typedef struct filling {
    const cw_byte_source *source;
    cw_stored_file *file;
    cw_error *err;
} filling;

static cw_status open_storage(const char *folder, int *fd, cw_error *err)
{
    return folder ? cwi_unnamed_open(folder, fd, err) : cwi_unnamed_open_memory(fd, err);
}

static cw_status append_piece(const filling *f, const void *bytes, size_t size)
{
    const cw_byte_source *s = f->source;
    const uint64_t sum = f->file->size + size;
    if (s->max_bytes && sum > s->max_bytes)
        return cwi_fail(f->err, CW_ERR_LIMIT, "more than %llu bytes (source->max_bytes)",
                        (unsigned long long)s->max_bytes);
    if (!s->folder && !cwi_memory_take(size))
        return cwi_fail_memory(f->err);
    f->file->counted += s->folder ? 0 : size;
    cw_status st = cwi_unnamed_write(s->folder ? s->folder : "(memory)", f->file->fd,
                                     (size_t)f->file->size, bytes, size, f->err);
    f->file->size = sum;
    return st;
}

static cw_status keep_array(const filling *f)
{
    const cw_byte_source *s = f->source;
    const char *from = s->bytes;
    cw_status st = CW_OK;
    for (uint64_t at = 0; at < s->size && st == CW_OK; at += PIECE_BYTES) {
        const uint64_t left = s->size - at;
        st = append_piece(f, from + at, left < PIECE_BYTES ? (size_t)left : PIECE_BYTES);
    }
    return st;
}

/* Calls the source's function for up to `capacity` bytes. */
static cw_status read_piece(const filling *f, unsigned char *piece, size_t capacity,
                            size_t *got)
{
    const cw_byte_source *s = f->source;
    cw_error why = {0};
    *got = 0;
    cw_status st = s->read(s->user, piece, capacity, got, &why);
    if (st != CW_OK)
        return fail_callback(st, &why, "its source failed", f->err);
    if (*got > capacity)
        return cwi_fail(f->err, CW_ERR_ARGUMENT,
                        "source->read reports %zu bytes; there is room for %zu", *got,
                        capacity);
    return CW_OK;
}

/* Reads a source to its end, or one byte further than it says it has. */
static cw_status keep_pieces(const filling *f, unsigned char *piece)
{
    const uint64_t stated = f->source->size;
    cw_status st = CW_OK;
    size_t got = 1;
    while (st == CW_OK && got > 0 && (!stated || f->file->size <= stated)) {
        size_t capacity = PIECE_BYTES;
        if (stated && stated - f->file->size < capacity)
            capacity = (size_t)(stated - f->file->size) + 1;
        st = read_piece(f, piece, capacity, &got);
        if (st == CW_OK && got)
            st = append_piece(f, piece, got);
    }
    if (st != CW_OK || !stated || f->file->size == stated)
        return st;
    return cwi_fail(f->err, CW_ERR_IO, "its source gave %s%llu bytes; source->size is %llu",
                    f->file->size > stated ? "at least " : "",
                    (unsigned long long)f->file->size, (unsigned long long)stated);
}

static cw_status keep_source(const filling *f)
{
    if (f->source->bytes)
        return keep_array(f);
    unsigned char *piece = cwi_alloc_array(PIECE_BYTES, 1);
    cw_status st = piece ? keep_pieces(f, piece) : cwi_fail_memory(f->err);
    cwi_free(piece);
    return st;
}

/* Allocates a stored file without bytes. */
static cw_status new_stored(const char *name, cw_stored_file **file, cw_error *err)
{
    cw_stored_file *made = *file = cwi_alloc_zeroed(1, sizeof *made);
    if (!made)
        return cwi_fail_memory(err);
    made->fd = -1;
    made->name = cwi_strdup(name);
    return made->name ? CW_OK : cwi_fail_memory(err);
}

cw_status cw_stored_file_open(const cw_byte_source *source, cw_stored_file **file,
                              cw_error *err)
{
    CWI_REQUIRE(err, source, file);
    CWI_REQUIRE_VERSION(err, source, 0);
    *file = NULL;
    if (!source->bytes == !source->read)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a source has either bytes or read (source->bytes, source->read): %s",
                        source->bytes ? "both are set" : "neither is set");
    const char *name = source->name ? source->name : source->bytes ? "(memory)" : "(stream)";
    cw_stored_file *made;
    cw_status st = new_stored(name, &made, err);
    if (st == CW_OK)
        st = open_storage(source->folder, &made->fd, err);
    if (st == CW_OK)
        st = keep_source(&(filling){source, made, err});
    if (st == CW_OK && made->size == 0)
        st = cwi_fail(err, CW_ERR_IO, "the file is empty");
    if (st == CW_OK) {
        *file = made;
        return CW_OK;
    }
    cw_stored_file_close(made);
    return cwi_fail_in(err, st, name);
}

cw_status cwi_stored_file_adopt(int fd, uint64_t size, const char *name, cw_stored_file **file,
                                cw_error *err)
{
    cw_status st = new_stored(name, file, err);
    if (st == CW_OK && size == 0)
        st = cwi_fail_in(err, cwi_fail(err, CW_ERR_IO, "the file is empty"), name);
    if (st != CW_OK) {
        cw_stored_file_close(*file);
        *file = NULL;
        return st;
    }
    (*file)->fd = fd;
    (*file)->size = size;
    return CW_OK;
}

void cw_stored_file_close(cw_stored_file *file)
{
    if (!file)
        return;
    if (file->fd >= 0)
        close(file->fd);
    cwi_memory_give(file->counted);
    cwi_free(file->name);
    cwi_free(file);
}

uint64_t cw_stored_file_size(const cw_stored_file *file)
{
    return file ? file->size : 0;
}

/* A descriptor made by dup() would share its position with others; without /proc it has to do. */
cw_status cwi_stored_file_reopen(const cw_stored_file *file, int *fd, cw_error *err)
{
    char path[40];
    snprintf(path, sizeof path, "/proc/self/fd/%d", file->fd);
    *fd = open(path, O_RDONLY | O_CLOEXEC);
    if (*fd < 0)
        *fd = fcntl(file->fd, F_DUPFD_CLOEXEC, 0);
    return *fd >= 0 ? CW_OK : cwi_fail(err, CW_ERR_IO, "its bytes cannot be opened");
}

/* --- writing ------------------------------------------------------------------------------ */

cw_status cwi_byte_output_open(cwi_byte_output *file, const cw_byte_sink *sink,
                               cwi_outfile **out, cw_error *err)
{
    *file = (cwi_byte_output){.sink = sink, .fd = -1};
    CWI_REQUIRE_VERSION(err, sink, 0);
    if (!sink->write)
        return cwi_fail(err, CW_ERR_ARGUMENT, "its sink has no function (sink->write)");
    cw_status st = open_storage(sink->folder, &file->fd, err);
    if (st == CW_OK)
        st = cwi_outfile_open_at(out, file->fd, !sink->folder, err);
    if (st != CW_OK)
        cwi_byte_output_close(file);
    return st;
}

static cw_status fail_sink(cw_status st, const cw_error *why, cw_error *err)
{
    return st == CW_OK ? CW_OK : fail_callback(st, why, "its sink failed", err);
}

static cw_status deliver_pieces(const cwi_byte_output *file, uint64_t size, void *piece,
                                cw_error *err)
{
    const cw_byte_sink *sink = file->sink;
    cw_error why = {0};
    cw_status st = sink->begin ? sink->begin(sink->user, size, &why) : CW_OK;
    st = fail_sink(st, &why, err);
    for (uint64_t at = 0; at < size && st == CW_OK;) {
        const size_t count = size - at < PIECE_BYTES ? (size_t)(size - at) : PIECE_BYTES;
        st = cwi_unnamed_read(file->fd, (size_t)at, piece, count, err);
        if (st == CW_OK)
            st = fail_sink(sink->write(sink->user, piece, count, &why), &why, err);
        at += count;
    }
    return st;
}

cw_status cwi_byte_output_deliver(const cwi_byte_output *file, cw_error *err)
{
    struct stat info;
    if (fstat(file->fd, &info) != 0)
        return cwi_fail(err, CW_ERR_IO, "its bytes cannot be looked at");
    void *piece = cwi_alloc_array(PIECE_BYTES, 1);
    cw_status st =
        piece ? deliver_pieces(file, (uint64_t)info.st_size, piece, err) : cwi_fail_memory(err);
    cwi_free(piece);
    return st;
}

void cwi_byte_output_close(cwi_byte_output *file)
{
    if (file->sink && file->fd >= 0)
        close(file->fd);
    *file = (cwi_byte_output){.fd = -1};
}
