/* Reads an array out of an archive of NumPy: a zip archive with a .npy file for each
 * (numpy.org/doc/stable/reference/generated/numpy.savez.html). Arrays of networks are the first choice. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/zip_read.h"
#include "formats/npy/npy_format.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { NAME = 256, LISTED = 8, LOCAL_HEADER = 30 };

/* The arrays that are taken before others: nnU-Net's probabilities, by their names of today and before. */
static const char *const preferred[] = {"probabilities.npy", "softmax.npy"};

/* Returns true if a name ends as that of an array. */
static bool is_array(const char *name, size_t length)
{
    return length > 4 && strncasecmp(name + length - 4, ".npy", 4) == 0;
}

bool cwi_npz_sniff(const unsigned char *head, size_t size)
{
    const size_t length = size > LOCAL_HEADER ? head[26] | (size_t)head[27] << 8 : 0;
    return length > 0 && LOCAL_HEADER + length <= size && memcmp(head, "PK\3\4", 4) == 0 &&
           is_array((const char *)head + LOCAL_HEADER, length);
}

/* Finds the first array of the archive, and lists its arrays. Returns their number. */
static size_t list_arrays(const cwi_unzip *z, char first[NAME], char list[NAME])
{
    char name[NAME];
    size_t count = 0, used = 0, at = 0;
    *first = *list = '\0';
    while (cwi_unzip_next(z, &at, name)) {
        if (!is_array(name, strlen(name)))
            continue;
        if (count == 0)
            snprintf(first, NAME, "%s", name);
        if (count < LISTED && used < NAME)
            used += (size_t)snprintf(list + used, NAME - used, "%s'%.*s'", count ? ", " : "",
                                     (int)(strlen(name) < 44 ? strlen(name) - 4 : 40), name);
        count++;
    }
    return count;
}

/* Chooses the array that was asked for, or else one of a network, or else the first. */
static cw_status choose_array(const cwi_unzip *z, const cwi_input *in, cwi_source *src,
                              char name[NAME], cw_error *err)
{
    char list[NAME];
    const size_t count = list_arrays(z, name, list);
    if (count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the archive holds no array: no file ends in .npy");
    if (in->array) {
        snprintf(name, NAME, "%s.npy", in->array);
        if (!cwi_unzip_has(z, name))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "there is no array '%.100s'; the archive has %zu: %s", in->array,
                            count, list);
        return CW_OK;
    }
    for (size_t n = sizeof preferred / sizeof *preferred; n-- > 0;)
        if (cwi_unzip_has(z, preferred[n]))
            snprintf(name, NAME, "%s", preferred[n]);
    if (count > 1)
        cwi_source_note(src, "the array '%.*s' is taken; desc->array takes any of %zu: %s",
                        (int)(strlen(name) - 4), name, count, list);
    return CW_OK;
}

/* Reads the first bytes of an entry. */
static cw_status read_head(const cwi_unzip *z, const cwi_unzip_entry *entry, char *head,
                           size_t *got, cw_error *err)
{
    cwi_unzip_stream stream;
    size_t n = 1;
    cw_status st = cwi_unzip_start(&stream, z, entry, err);
    if (st != CW_OK)
        return st;
    for (*got = 0; st == CW_OK && n > 0 && *got < CWI_NPY_HEADER; *got += n)
        st = cwi_unzip_some(&stream, head + *got, CWI_NPY_HEADER - *got, &n, err);
    cwi_unzip_end(&stream);
    return st;
}

static cw_status describe_entry(const cwi_unzip *z, const char *name, cwi_source *src,
                                cw_error *err)
{
    cwi_unzip_entry entry;
    size_t got = 0;
    char *head = cwi_alloc_array(CWI_NPY_HEADER + 1, 1);
    cw_status st = head ? cwi_unzip_find(z, name, &entry, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = read_head(z, &entry, head, &got, err);
    if (st == CW_OK)
        st = cwi_npy_describe(head, got, src, err);
    cwi_free(head);
    if (st != CW_OK)
        return st;
    src->has_arrays = true;
    src->encoding = entry.deflated ? CWI_BARE : CWI_RAW;
    src->crc = entry.crc;
    src->offset = entry.start;
    src->span = entry.packed - (entry.deflated ? 0 : src->skip);
    return CW_OK;
}

cw_status cwi_npz_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    cwi_unzip z;
    char name[NAME];
    cw_status st = cwi_unzip_open(&z, in, err);
    if (st == CW_OK)
        st = choose_array(&z, in, src, name, err);
    if (st == CW_OK) {
        st = describe_entry(&z, name, src, err);
        st = st == CW_OK ? st : cwi_fail_in(err, st, name);
    }
    cwi_unzip_close(&z);
    return st;
}
