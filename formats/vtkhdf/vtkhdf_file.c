/* Opens VTKHDF files: takes the facts of the sandboxed process, checks them, and fetches rows. */
#include "formats/vtkhdf/vtkhdf_file.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/mesh/mesh_writer.h"
#include "formats/mesh/place_parts.h"
#include "formats/vtkhdf/vtkhdf_format.h"

#include <stdarg.h>
#include <string.h>
#include <unistd.h>

enum { DEFLATE_RATIO = 1032 };

/* --- checks ------------------------------------------------------------------------------- */

/* Makes untrusted text printable. */
static void clean_text(char *text, size_t capacity)
{
    char clean[CWI_NAME_BYTES];
    text[capacity - 1] = '\0';
    cwi_clean_name(text, strlen(text), clean);
    memcpy(text, clean, strlen(clean) + 1);
}

static void refuse(cwi_vtkhdf_array *a, const char *format, ...) CW_PRINTF(2, 3);
static void refuse(cwi_vtkhdf_array *a, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(a->refusal, sizeof a->refusal, format, list);
    va_end(list);
}

/* Checks that the numbers of an array can be in the file. */
static void check_bytes(cwi_vtkhdf_array *a, uint64_t file_bytes)
{
    uint64_t bytes = cwi_vtkhdf_number_bytes(a->number);
    bool fits = true;
    for (uint32_t n = 0; n < a->rank; n++)
        fits = fits && !__builtin_mul_overflow(bytes, a->dim[n], &bytes);
    if (!fits || bytes > INT64_MAX / 2 || a->stored_bytes > file_bytes ||
        bytes / DEFLATE_RATIO > a->stored_bytes || (bytes && !a->stored_bytes))
        refuse(a, "its shape asks for %s%llu bytes; %llu are stored in a file of %llu",
               fits ? "" : "more than ", fits ? (unsigned long long)bytes : ~0ull,
               (unsigned long long)a->stored_bytes, (unsigned long long)file_bytes);
    else if (a->offset != UINT64_MAX && (bytes > file_bytes || a->offset > file_bytes - bytes))
        refuse(a, "its %llu bytes from byte %llu on reach beyond the file's end",
               (unsigned long long)bytes, (unsigned long long)a->offset);
}

static void check_array(cwi_vtkhdf_array *a, uint64_t file_bytes)
{
    clean_text(a->name, sizeof a->name);
    clean_text(a->refusal, sizeof a->refusal);
    if (*a->refusal)
        return;
    if (a->rank < 1 || a->rank > CWI_VTKHDF_RANK || !cwi_vtkhdf_number_bytes(a->number))
        refuse(a, "it has no numbers");
    else
        check_bytes(a, file_bytes);
    uint64_t rows = 1;
    for (uint32_t n = 0; n < cwi_vtkhdf_row_rank(a) && !*a->refusal; n++)
        rows *= a->dim[n]; /* below 2^63, as the bytes are */
    if (!*a->refusal && rows > UINT32_MAX)
        refuse(a, "it has %llu rows; at most %u are read", (unsigned long long)rows,
               UINT32_MAX);
}

static cw_status check_type(const cwi_vtkhdf *h, cw_error *err)
{
    const cwi_vtkhdf_facts *f = &h->facts;
    if (f->version[0] > 2)
        return cwi_fail(err, CW_ERR_FORMAT, "its 'Version' is %lld.%lld; 1 and 2 are read",
                        (long long)f->version[0], (long long)f->version[1]);
    if (!*f->type)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the group VTKHDF has no attribute 'Type'; ImageData, "
                        "UnstructuredGrid or PolyData was expected");
    if (cwi_vtkhdf_is(h, "ImageData") || cwi_vtkhdf_is(h, "UnstructuredGrid") ||
        cwi_vtkhdf_is(h, "PolyData"))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "its 'Type' is '%s', which is not read; ImageData, UnstructuredGrid and "
                    "PolyData are: ParaView saves each of its parts as .vti, .vtu or .vtp",
                    f->type);
}

static cw_status take_facts(cwi_vtkhdf *h, cw_error *err)
{
    const void *shared;
    cwi_vtkhdf_facts *f = &h->facts;
    cw_status st = cwi_planes_facts(&h->planes, h->in->fd, h->in->size, &shared, err);
    if (st != CW_OK)
        return st;
    memcpy(f, shared, sizeof *f);
    if (f->array_count > CWI_VTKHDF_ARRAYS)
        return cwi_fail(err, CW_ERR_LIMIT, "it has %u arrays; at most %d were expected",
                        f->array_count, CWI_VTKHDF_ARRAYS);
    clean_text(f->type, sizeof f->type);
    for (int n = 0; n < 2; n++)
        for (int k = 0; k < CWI_VTKHDF_ATTRIBUTES; k++)
            clean_text(f->names[n][k], sizeof f->names[n][k]);
    for (uint32_t n = 0; n < f->array_count; n++)
        check_array(&f->arrays[n], h->in->size);
    return check_type(h, err);
}

static cw_status check_signature(const cwi_input *in, cw_error *err)
{
    unsigned char head[8];
    size_t size;
    cw_status st = cwi_input_read_at(in->fd, 0, head, sizeof head, &size, err);
    return st == CW_OK && !cwi_vtkhdf_sniff(head, size)
               ? cwi_fail(err, CW_ERR_FORMAT,
                          "it is no HDF5 file: it does not start with the signature of one")
               : st;
}

cw_status cwi_vtkhdf_open(cwi_vtkhdf *h, const cwi_input *in, const cw_read_desc *desc,
                          cw_error *err)
{
    h->in = in;
    h->desc = desc;
    cw_read_desc boxed = *desc;
    boxed.max_bytes = 0; /* chunks that are being decoded do not depend on the array's size */
    cw_status st = check_signature(in, err);
    if (st == CW_OK)
        st = cwi_planes_open(&h->planes, "hdf5", "HDF5", &boxed, err);
    h->planes.box.progress = &desc->progress;
    return st == CW_OK ? take_facts(h, err) : st;
}

void cwi_vtkhdf_close(cwi_vtkhdf *h)
{
    cwi_planes_close(&h->planes);
    if (h->xml)
        fclose(h->xml);
    cwi_free(h->text);
    cwi_free(h->items);
    cwi_memory_give(h->filled_bytes);
    if (h->is_made)
        close(h->made.fd);
}

/* --- arrays ------------------------------------------------------------------------------- */

bool cwi_vtkhdf_is(const cwi_vtkhdf *h, const char *type)
{
    return strcmp(h->facts.type, type) == 0;
}

const cwi_vtkhdf_array *cwi_vtkhdf_find(const cwi_vtkhdf *h, const char *name)
{
    for (uint32_t n = 0; n < h->facts.array_count; n++)
        if (strcmp(h->facts.arrays[n].name, name) == 0)
            return &h->facts.arrays[n];
    return NULL;
}

static bool is_real(const cwi_vtkhdf_array *a)
{
    return a->number == CWI_VTKHDF_F32 || a->number == CWI_VTKHDF_F64;
}

cw_status cwi_vtkhdf_need(const cwi_vtkhdf *h, const char *name, uint64_t components, bool real,
                          const cwi_vtkhdf_array **array, cw_error *err)
{
    const cwi_vtkhdf_array *a = cwi_vtkhdf_find(h, name);
    *array = a;
    if (!a)
        return cwi_fail(err, CW_ERR_FORMAT, "%s has no array '%s', which is needed",
                        h->facts.type, name);
    if (*a->refusal)
        return cwi_fail(err, CW_ERR_FORMAT, "the array '%s' cannot be read: %s", name,
                        a->refusal);
    const uint64_t found = cwi_vtkhdf_row_bytes(a) / cwi_vtkhdf_number_bytes(a->number);
    if ((components == 1 && a->rank > 1 && found != 1) || found != components ||
        is_real(a) != real)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' has %llu %s numbers in each row; %llu %s expected",
                        name, (unsigned long long)found, is_real(a) ? "real" : "whole",
                        (unsigned long long)components,
                        components == 1 ? "whole one was" : "real ones were");
    return CW_OK;
}

uint64_t cwi_vtkhdf_row_bytes(const cwi_vtkhdf_array *a)
{
    uint64_t bytes = cwi_vtkhdf_number_bytes(a->number);
    for (uint32_t n = 1; n < a->rank; n++)
        bytes *= a->dim[n];
    return bytes;
}

uint64_t cwi_vtkhdf_rows(const cwi_vtkhdf_array *a)
{
    uint64_t rows = 1;
    for (uint32_t n = 1; n < cwi_vtkhdf_row_rank(a); n++)
        rows *= a->dim[n];
    return rows;
}

cw_status cwi_vtkhdf_fetch_rows(cwi_vtkhdf *h, const cwi_vtkhdf_array *a, uint64_t first,
                                uint64_t count, void *to, cw_error *err)
{
    return count == 0
               ? CW_OK
               : cwi_planes_read(&h->planes, (uint32_t)(a - h->facts.arrays), first, count,
                                 cwi_vtkhdf_row_bytes(a) / cwi_vtkhdf_rows(a), to, err);
}

cw_status cwi_vtkhdf_fetch(cwi_vtkhdf *h, const cwi_vtkhdf_array *a, uint64_t first,
                           uint64_t count, void *to, cw_error *err)
{
    const uint64_t rows = cwi_vtkhdf_rows(a);
    return cwi_vtkhdf_fetch_rows(h, a, first * rows, count * rows, to, err);
}

/* Returns a whole number in this machine's order; UINT64_MAX for one below 0. */
static uint64_t whole_at(const cwi_vtkhdf_array *a, const void *numbers, uint64_t n)
{
    int64_t value;
    switch ((cwi_vtkhdf_number)a->number) {
    case CWI_VTKHDF_I8:
        value = ((const int8_t *)numbers)[n];
        break;
    case CWI_VTKHDF_U8:
        value = ((const uint8_t *)numbers)[n];
        break;
    case CWI_VTKHDF_I16:
        value = ((const int16_t *)numbers)[n];
        break;
    case CWI_VTKHDF_U16:
        value = ((const uint16_t *)numbers)[n];
        break;
    case CWI_VTKHDF_I32:
        value = ((const int32_t *)numbers)[n];
        break;
    case CWI_VTKHDF_U32:
        value = ((const uint32_t *)numbers)[n];
        break;
    default:
        value = ((const int64_t *)numbers)[n];
        break;
    }
    return value < 0 ? UINT64_MAX : (uint64_t)value;
}

cw_status cwi_vtkhdf_counts(cwi_vtkhdf *h, const char *name, uint32_t column, uint64_t first,
                            uint64_t count, uint64_t *to, cw_error *err)
{
    const cwi_vtkhdf_array *a = cwi_vtkhdf_find(h, name);
    const uint64_t columns = a && a->rank ? (a->rank > 1 ? a->dim[1] : 1) : 0;
    if (!a || *a->refusal)
        return cwi_fail(err, CW_ERR_FORMAT, "the array '%s' %s%s", name,
                        a ? "cannot be read: " : "is missing", a ? a->refusal : "");
    if (is_real(a) || a->rank > 2 || column >= columns || first > a->dim[0] ||
        count > a->dim[0] - first)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' has %llu x %llu %s numbers; whole numbers %llu to %llu "
                        "were expected",
                        name, (unsigned long long)a->dim[0], (unsigned long long)columns,
                        is_real(a) ? "real" : "whole", (unsigned long long)first,
                        (unsigned long long)(first + count));
    void *numbers = cwi_alloc_array(count ? count : 1, cwi_vtkhdf_row_bytes(a));
    cw_status st =
        numbers ? cwi_vtkhdf_fetch(h, a, first, count, numbers, err) : cwi_fail_memory(err);
    for (uint64_t n = 0; n < count && st == CW_OK; n++) {
        to[n] = whole_at(a, numbers, n * columns + column);
        if (to[n] > INT64_MAX / 4)
            st = cwi_fail(err, CW_ERR_FORMAT,
                          "number %llu of the array '%s' is below 0, or beyond 2^61",
                          (unsigned long long)(first + n), name);
    }
    cwi_free(numbers);
    return st;
}

cw_status cwi_vtkhdf_start(cwi_vtkhdf *h, const char *name, uint32_t column, uint64_t *to,
                           cw_error *err)
{
    *to = 0;
    return h->facts.has_steps && cwi_vtkhdf_find(h, name)
               ? cwi_vtkhdf_counts(h, name, column, 0, 1, to, err)
               : CW_OK;
}
