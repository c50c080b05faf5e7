/* Scans DICOM files for their facts, checks these, and sorts the images into series. */
#include "formats/dicom/dicom_series.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/dicom/dicom_format.h"
#include "formats/dicom/dicom_nesting.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_COMPRESSION = 65536, MAX_DEFLATION = 1032 };

static bool is_capital(unsigned char c)
{
    return c >= 'A' && c <= 'Z';
}

/* Passes an element of a few bytes in little-endian order. Returns false where its tag does not
 * follow *tag, or belongs to a group that does not precede pixels. The first must be of group 2
 * or 8. */
static bool pass_element(const unsigned char *head, size_t size, size_t *at, uint32_t *tag)
{
    enum { LONGEST = 128 };
    if (size < *at + 8)
        return false;
    const unsigned char *b = head + *at;
    const uint32_t mine = (uint32_t)(b[0] | b[1] << 8) << 16 | (uint32_t)(b[2] | b[3] << 8);
    const bool has_vr = is_capital(b[4]) && is_capital(b[5]);
    const bool wide = has_vr && memcmp(b + 4, "OB", 2) == 0;
    if (wide && size < *at + 12)
        return false;
    const uint32_t length = wide     ? b[8] | (uint32_t)(b[9] | b[10] | b[11]) << 8
                            : has_vr ? (uint32_t)(b[6] | b[7] << 8)
                                     : b[4] | (uint32_t)(b[5] | b[6] | b[7]) << 8;
    const uint32_t group = mine >> 16;
    const bool first = *tag == 0;
    if ((first && group != 2 && group != 8) || group > 0x28 || group % 2 || mine <= *tag ||
        length > LONGEST || length % 2)
        return false;
    *tag = mine;
    *at += (wide ? 12 : 8) + length;
    return true;
}

/* Recognises DICOM. Without a preamble the file starts with elements: the first three must be
 * some that come first, in order. */
bool cwi_dicom_sniff(const unsigned char *head, size_t size)
{
    uint32_t tag = 0;
    size_t at = 0;
    if (size >= 132 && memcmp(head + 128, "DICM", 4) == 0)
        return true;
    return pass_element(head, size, &at, &tag) && pass_element(head, size, &at, &tag) &&
           pass_element(head, size, &at, &tag);
}

void cwi_dicom_scan_free(cwi_dicom_scan *scan)
{
    for (size_t i = 0; scan->facts && i < scan->files.count; i++)
        cwi_free(scan->facts[i]);
    for (size_t i = 0; scan->segments && i < scan->files.count; i++)
        cwi_free(scan->segments[i]);
    cwi_names_free(&scan->files);
    cwi_damaged_free(&scan->damaged);
    cwi_free(scan->facts);
    cwi_free(scan->segments);
    cwi_free(scan->planes);
    cwi_free(scan->series);
    *scan = (cwi_dicom_scan){0};
}

/* --- the facts of one file ---------------------------------------------------------------- */

#define IS_TERMINATED(text) (memchr((text), '\0', sizeof(text)) != NULL)

/* Checks the claims of a file against its size, before anything is allocated for them. */
static cw_status check_claim(const cwi_dicom_facts *f, uint64_t file_bytes, cw_error *err)
{
    const uint64_t bits =
        f->kind == CWI_DICOM_SEGMENTATION ? 1 : 8 * cw_type_size(f->stored_type);
    const uint64_t frame = (uint64_t)f->columns * f->rows * f->samples * bits; /* below 2^43 */
    const uint64_t have = f->pixel_bytes ? f->pixel_bytes : file_bytes;
    const uint64_t max = f->pixel_bytes ? have : have * MAX_COMPRESSION;
    uint64_t expected;
    if (have / (f->deflated ? MAX_DEFLATION : 1) <= file_bytes &&
        !__builtin_mul_overflow(frame, f->frame_count, &expected) && (expected + 7) / 8 <= max)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'Rows', 'Columns' and 'NumberOfFrames' ask for %u frames of %llu bytes; "
                    "'PixelData' holds %llu bytes%s, the file %llu",
                    f->frame_count, (unsigned long long)(frame + 7) / 8,
                    (unsigned long long)have, f->pixel_bytes ? "" : " at most, compressed",
                    (unsigned long long)file_bytes);
}

/* Checks the facts, which are untrusted: DCMTK's process may have been taken over. */
static cw_status check_facts(const cwi_dicom_facts *f, uint64_t file_bytes, cw_error *err)
{
    if (!IS_TERMINATED(f->series) || !IS_TERMINATED(f->instance) ||
        !IS_TERMINATED(f->modality) || !IS_TERMINATED(f->refusal) ||
        !IS_TERMINATED(f->no_volume) || !IS_TERMINATED(f->order))
        return cwi_fail(err, CW_ERR_BACKEND, "DCMTK's answer is not valid");
    if (f->kind == CWI_DICOM_NO_IMAGE)
        return CW_OK;
    if (f->refusal[0])
        return cwi_fail(err, CW_ERR_FORMAT, "%s", f->refusal);
    const size_t capacity = (CWI_PLANES_SHARED - sizeof *f) / sizeof(cwi_dicom_frame);
    if (f->columns < 1 || f->columns > UINT16_MAX || f->rows < 1 || f->rows > UINT16_MAX ||
        f->samples < 1 || f->samples > 16 || f->frame_count < 1 || f->frame_count > capacity ||
        !cw_type_size(f->type) || !cw_type_size(f->stored_type) || f->value_bits < 1 ||
        f->value_bits > 64)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'Columns' %u, 'Rows' %u, 'SamplesPerPixel' %u and 'NumberOfFrames' %u "
                        "are not valid image sizes",
                        f->columns, f->rows, f->samples, f->frame_count);
    const size_t left =
        CWI_PLANES_SHARED - sizeof *f - f->frame_count * sizeof(cwi_dicom_frame);
    if (f->segment_count > left / sizeof(cwi_dicom_segment))
        return cwi_fail(err, CW_ERR_BACKEND, "DCMTK's answer is not valid");
    return check_claim(f, file_bytes, err);
}

static bool grow_planes(cwi_dicom_scan *scan, size_t more)
{
    const size_t expected = scan->plane_count + more;
    if (expected <= scan->plane_capacity)
        return true;
    const size_t capacity =
        2 * scan->plane_capacity > expected ? 2 * scan->plane_capacity : expected;
    cwi_dicom_plane *planes = cwi_realloc_array(scan->planes, capacity, sizeof *planes);
    if (planes) {
        scan->planes = planes;
        scan->plane_capacity = capacity;
    }
    return planes != NULL;
}

static cw_status keep_file(cwi_dicom_scan *scan, const char *name, const cwi_dicom_facts *facts,
                           const void *frames, cw_error *err)
{
    const size_t n = scan->files.count;
    const void *segments = (const cwi_dicom_frame *)frames + facts->frame_count;
    cwi_dicom_facts *copy = cwi_alloc_array(1, sizeof *copy);
    cwi_dicom_segment *own = cwi_alloc_array(facts->segment_count, sizeof *own);
    cw_status st = copy && own && grow_planes(scan, facts->frame_count)
                       ? cwi_names_add(&scan->files, name, err)
                       : cwi_fail_memory(err);
    if (st != CW_OK) {
        cwi_free(copy);
        cwi_free(own);
        return st;
    }
    *copy = *facts;
    memcpy(own, segments, facts->segment_count * sizeof *own);
    scan->facts[n] = copy;
    scan->segments[n] = own;
    for (uint32_t i = 0; i < facts->frame_count; i++) {
        cwi_dicom_plane *p = &scan->planes[scan->plane_count++];
        *p = (cwi_dicom_plane){.file = copy, .index = n, .number = i};
        memcpy(&p->frame, (const cwi_dicom_frame *)frames + i, sizeof p->frame);
    }
    return CW_OK;
}

/* Keeps a code such as CT. Anything else may contain any text, and must not be printed. */
static void clean_modality(cwi_dicom_facts *f)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
    if (f->modality[strspn(f->modality, letters)])
        f->modality[0] = '\0';
}

static bool is_real(const cwi_dicom_facts *f)
{
    return f->type == CW_F32 || f->type == CW_F64;
}

/* Whole numbers of any size and sign are alike: their values are what they are. */
static bool same_images(const cwi_dicom_facts *f, const cwi_dicom_facts *g)
{
    return strcmp(f->series, g->series) == 0 && f->columns == g->columns &&
           f->rows == g->rows && f->samples == g->samples && is_real(f) == is_real(g) &&
           f->kind == g->kind;
}

/* Returns true for DICOM, by name, else by content: a damaged image counts, too. */
static cw_status is_dicom(const char *name, int fd, bool *yes, cw_error *err)
{
    unsigned char head[CWI_SNIFF_BYTES];
    size_t got;
    cw_status st = cwi_input_read_at(fd, 0, head, sizeof head, &got, err);
    *yes = cwi_has_extension(name, cwi_format_dicom.extensions) ||
           (st == CW_OK && cwi_dicom_sniff(head, got));
    return st;
}

cw_status cwi_dicom_facts_of(cwi_planes *planes, int fd, uint64_t size, const void **shared,
                             cw_error *err)
{
    cw_status st = cwi_dicom_check_depth(fd, size, err);
    return st == CW_OK ? cwi_planes_facts(planes, fd, size, shared, err) : st;
}

/* Keeps the facts of a file if it is a wanted image. Sets *f as far as it is known. */
static cw_status take_file(cwi_dicom_scan *scan, const cwi_input *in, const char *name, int fd,
                           uint64_t size, const cwi_dicom_facts *only, bool try,
                           cwi_planes *planes, cwi_dicom_facts *f, cw_error *err)
{
    const void *shared;
    bool dicom = cwi_input_is_named(in, name);
    cw_status st = dicom ? CW_OK : is_dicom(name, fd, &dicom, err);
    if (st != CW_OK || !dicom) {
        scan->strangers += !dicom;
        return st;
    }
    st = cwi_dicom_facts_of(planes, fd, size, &shared, err);
    if (st != CW_OK)
        return st;
    memcpy(f, shared, sizeof *f);
    f->series[sizeof f->series - 1] = '\0';
    st = check_facts(f, size, err);
    if (f->kind == CWI_DICOM_NO_IMAGE)
        scan->strangers++;
    if (f->kind == CWI_DICOM_NO_IMAGE || (only && (strcmp(only->series, f->series) != 0 ||
                                                   (st == CW_OK && !same_images(only, f)))))
        return CW_OK; /* with any kind of damage */
    clean_modality(f);
    if (st == CW_OK)
        st = keep_file(scan, name, f, (const char *)shared + sizeof *f, err);
    if (st != CW_OK || !try || f->pixel_bytes)
        return st;
    st = cwi_planes_try(planes, f->frame_count, f->rows,
                        (size_t)f->columns * f->samples * cw_type_size(f->type), err);
    if (st != CW_OK)
        scan->plane_count -= f->frame_count;
    return st;
}

/* --- series ------------------------------------------------------------------------------- */

static bool are_alike(const cwi_dicom_plane *a, const cwi_dicom_plane *b)
{
    if (!same_images(a->file, b->file) ||
        strncmp(a->frame.stack, b->frame.stack, sizeof a->frame.stack) != 0 ||
        (a->frame.has & CWI_DICOM_ORIENTATION) != (b->frame.has & CWI_DICOM_ORIENTATION))
        return false;
    for (int i = 0; i < 6; i++)
        if (!(fabs(a->frame.axes[i / 3][i % 3] - b->frame.axes[i / 3][i % 3]) < 1e-3))
            return !(a->frame.has & CWI_DICOM_ORIENTATION);
    for (int i = 0; i < 2; i++)
        if (!(fabs(a->frame.spacing[i] - b->frame.spacing[i]) <= 1e-4 * b->frame.spacing[i]))
            return false;
    return true;
}

static size_t find_series(const cwi_dicom_scan *scan, const cwi_dicom_plane *p)
{
    size_t s = 0;
    while (s < scan->series_count && !are_alike(p, scan->series[s].sample))
        s++;
    return s;
}

static int compare_numbers(int64_t a, int64_t b)
{
    return (a > b) - (a < b);
}

/* Compares by number, then by identity: names of files decide nothing. */
static int compare_planes(const void *x, const void *y)
{
    const cwi_dicom_plane *a = x, *b = y;
    int order = compare_numbers(a->file->number, b->file->number);
    order = order ? order : strcmp(a->file->series, b->file->series);
    order = order ? order : compare_numbers(a->file->instance_number, b->file->instance_number);
    order = order ? order : strcmp(a->file->instance, b->file->instance);
    return order ? order : compare_numbers(a->number, b->number);
}

/* Returns true for a copy: an image of the same identity at the same place, under another file
 * name. */
static bool is_copy(const cwi_dicom_plane *a, const cwi_dicom_plane *b)
{
    const cwi_dicom_facts *f = a->file, *g = b->file;
    return a->index != b->index && a->number == b->number && f->instance[0] &&
           strcmp(f->instance, g->instance) == 0 && f->columns == g->columns &&
           f->rows == g->rows &&
           memcmp(a->frame.position, b->frame.position, sizeof a->frame.position) == 0;
}

/* Drops copies. The file that was named stays, else the first one. */
static void drop_copies(cwi_dicom_scan *scan, const cwi_input *in)
{
    size_t kept = 0;
    for (size_t i = 0; i < scan->plane_count; i++) {
        const cwi_dicom_plane *p = &scan->planes[i];
        if (!kept || !is_copy(p, &scan->planes[kept - 1])) {
            scan->planes[kept++] = *p;
            continue;
        }
        scan->copies++;
        if (cwi_input_is_named(in, scan->files.items[p->index]))
            scan->planes[kept - 1] = *p;
    }
    scan->plane_count = kept;
}

static void label_series(cwi_dicom_scan *scan)
{
    for (size_t s = 0; s < scan->series_count; s++) {
        cwi_dicom_series *me = &scan->series[s];
        const int64_t number = me->sample->file->number;
        int before = 0, all = 0;
        for (size_t o = 0; o < scan->series_count; o++)
            if (scan->series[o].sample->file->number == number) {
                before += o < s;
                all++;
            }
        int n = number == INT64_MIN
                    ? snprintf(me->label, sizeof me->label, "0")
                    : snprintf(me->label, sizeof me->label, "%lld", (long long)number);
        if (all > 1)
            snprintf(me->label + n, sizeof me->label - (size_t)n, ".%d", before + 1);
    }
}

static cw_status sort_into_series(cwi_dicom_scan *scan, const cwi_input *in, cw_error *err)
{
    if (scan->plane_count)
        qsort(scan->planes, scan->plane_count, sizeof *scan->planes, compare_planes);
    drop_copies(scan, in);
    for (size_t i = 0; i < scan->plane_count; i++) {
        cwi_dicom_plane *p = &scan->planes[i];
        p->series = find_series(scan, p);
        if (p->series == scan->series_count) {
            cwi_dicom_series *more =
                cwi_realloc_array(scan->series, scan->series_count + 1, sizeof *scan->series);
            if (!more)
                return cwi_fail_memory(err);
            scan->series = more;
            scan->series[scan->series_count++] = (cwi_dicom_series){.sample = p};
        }
        scan->series[p->series].count++;
    }
    label_series(scan);
    return CW_OK;
}

/* Lists a file as damaged. Reading it may have ended the library's process. */
static cw_status add_damaged(cwi_dicom_scan *scan, const char *name, const cwi_dicom_facts *f,
                             const cw_error *reason, cwi_planes *planes, cw_error *err)
{
    cw_status st = cwi_damaged_add(&scan->damaged, name, f->series, reason, err);
    return st == CW_OK && !planes->box.open ? cwi_planes_restart(planes, err) : st;
}

cw_status cwi_dicom_scan_files(cwi_dicom_scan *scan, const cwi_input *in, cwi_names *names,
                               const cwi_dicom_facts *only, const cw_read_desc *desc,
                               cwi_planes *planes, cw_error *err)
{
    cw_status st = CW_OK;
    scan->facts = cwi_alloc_zeroed(names->count, sizeof(cwi_dicom_facts *));
    scan->segments = cwi_alloc_zeroed(names->count, sizeof(cwi_dicom_segment *));
    if (!scan->facts || !scan->segments)
        return cwi_fail_memory(err);
    for (size_t i = 0; st == CW_OK && i < names->count; i++) {
        cwi_dicom_facts f = {0};
        cw_error why = {0};
        uint64_t size;
        int fd;
        planes->box.done = (double)i / (double)names->count;
        st = cwi_input_open_side(in, names->items[i], &fd, &size, &why);
        if (st == CW_OK) {
            st = take_file(scan, in, names->items[i], fd, size, only, desc->skip_damaged,
                           planes, &f, &why);
            close(fd);
        }
        if (cwi_is_damage(st))
            st = add_damaged(scan, names->items[i], &f, &why, planes, err);
        else if (st != CW_OK)
            return cwi_fail(err, st, "%s", why.message);
    }
    return st == CW_OK ? sort_into_series(scan, in, err) : st;
}

static cw_status fail_several(const cwi_dicom_scan *scan, cw_error *err)
{
    char list[320];
    size_t used = 0;
    for (size_t s = 0; s < scan->series_count && used < sizeof list - 64; s++) {
        const cwi_dicom_series *me = &scan->series[s];
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s (%.8s, %zu of %u x %u)",
                                 s ? ", " : "", me->label, me->sample->file->modality,
                                 me->count, me->sample->file->columns, me->sample->file->rows);
    }
    return cwi_fail(err, CW_ERR_UNSAFE, "it holds %zu series: %s%s; choose one by desc->series",
                    scan->series_count, list, used < sizeof list - 64 ? "" : ", ...");
}

cw_status cwi_dicom_choose(const cwi_dicom_scan *scan, const char *name, size_t *series,
                           cw_error *err)
{
    size_t matches = 0;
    if (scan->series_count == 0 && scan->damaged.count)
        return cwi_fail(err, scan->damaged.items[0].status, "%s: %s",
                        scan->damaged.items[0].name, scan->damaged.items[0].reason);
    if (scan->series_count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "it holds no DICOM image");
    for (size_t s = 0; s < scan->series_count; s++) {
        const cwi_dicom_series *me = &scan->series[s];
        if (name && strcmp(name, me->label) != 0 && strcmp(name, me->sample->file->series) != 0)
            continue;
        *series = s;
        matches++;
    }
    if (matches == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "there is no series '%.64s'; 'info' lists them",
                        name);
    return matches == 1 ? CW_OK : fail_several(scan, err);
}

cw_status cwi_dicom_expect_whole(const cwi_dicom_scan *scan, size_t series, bool chosen,
                                 cw_error *err)
{
    for (size_t n = 0; n < scan->damaged.count; n++) {
        const cwi_damaged_file *d = &scan->damaged.items[n];
        if (!chosen || strcmp(d->owner, scan->series[series].sample->file->series) == 0)
            return cwi_damaged_fail(d, err);
    }
    return CW_OK;
}
