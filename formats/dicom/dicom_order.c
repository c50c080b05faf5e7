/* Orders the planes of a DICOM series: by their positions, and by what sets those apart that share one. */
#define _GNU_SOURCE /* qsort_r */
#include "formats/dicom/dicom_order.h"

#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "formats/volume/volume_reader.h"

#include <math.h>
#include <stdlib.h>

static int by_distance(const void *x, const void *y)
{
    const cwi_dicom_plane *a = x, *b = y;
    return (a->distance > b->distance) - (a->distance < b->distance);
}

static void sort_planes(cwi_dicom_sorting *s, int (*compare)(const void *, const void *))
{
    qsort(s->planes, s->count, sizeof *s->planes, compare);
}

static int by_position_and_number(const void *x, const void *y)
{
    const cwi_dicom_plane *a = x, *b = y;
    if (a->position_index != b->position_index)
        return a->position_index < b->position_index ? -1 : 1;
    const int64_t m = a->file->instance_number, n = b->file->instance_number;
    return m != n ? (m < n ? -1 : 1) : (a->number > b->number) - (a->number < b->number);
}

void cwi_dicom_find_positions(cwi_dicom_sorting *s)
{
    const double *x = s->planes[0].frame.axes[0], *y = s->planes[0].frame.axes[1];
    const double same = 1e-3 * s->planes[0].frame.spacing[0];
    cwi_cross(x, y, s->normal);
    for (size_t i = 0; i < s->count; i++)
        s->planes[i].distance = cwi_dot(s->planes[i].frame.position, s->normal);
    sort_planes(s, by_distance);
    s->position_count = 0;
    for (size_t i = 0; i < s->count; i++) {
        const bool next = i > 0 && s->planes[i].distance - s->planes[i - 1].distance > same;
        s->position_count += i == 0 || next;
        s->planes[i].position_index = s->position_count - 1;
    }
    sort_planes(s, by_position_and_number);
}

/* Returns the number of planes at one position, from *first on. */
static size_t planes_here(const cwi_dicom_sorting *s, size_t first)
{
    size_t n = first;
    while (n < s->count && s->planes[n].position_index == s->planes[first].position_index)
        n++;
    return n - first;
}

/* Compares one key; NaN is that of a plane that does not state it. */
static int compare_key(const cwi_dicom_plane *a, const cwi_dicom_plane *b, int key)
{
    const double x = a->frame.keys[key], y = b->frame.keys[key];
    const int stated[2] = {!isnan(x), !isnan(y)};
    return stated[0] && stated[1] ? (x > y) - (x < y) : stated[0] - stated[1];
}

/* Compares by position, then by a key, or by all of them where it is CWI_DICOM_KEYS. */
static int by_position_and_key(const void *x, const void *y, void *user)
{
    const cwi_dicom_plane *a = x, *b = y;
    const int key = *(const int *)user;
    int order =
        (a->position_index > b->position_index) - (a->position_index < b->position_index);
    for (int k = 0; order == 0 && k < CWI_DICOM_KEYS; k++)
        if (key == k || key == CWI_DICOM_KEYS)
            order = compare_key(a, b, k);
    return order;
}

/* Ranks the planes at each position by a key, or by all; returns false, and leaves their order as it was,
 * where two are equal. */
static bool rank_all(cwi_dicom_sorting *s, int key)
{
    qsort_r(s->planes, s->count, sizeof *s->planes, by_position_and_key, &key);
    bool differ = true;
    for (size_t i = 0; differ && i < s->count; i++)
        differ = (i == 0 || by_position_and_key(&s->planes[i - 1], &s->planes[i], &key) != 0) &&
                 (key == CWI_DICOM_KEYS || !isnan(s->planes[i].frame.keys[key]));
    if (!differ)
        sort_planes(s, by_position_and_number);
    return differ;
}

/* Ranks by the first key that tells all planes at a position apart. Returns CWI_DICOM_KEYS where only all
 * together do, and one more where they do not. */
static int rank_by_keys(cwi_dicom_sorting *s)
{
    int key = 0;
    while (key <= CWI_DICOM_KEYS && !rank_all(s, key))
        key++;
    return key;
}

bool cwi_dicom_are_moments(cwi_dicom_sorting *s)
{
    int key = 0;
    cwi_dicom_find_positions(s);
    while (key < CWI_DICOM_ACQUISITION && !rank_all(s, key))
        key++;
    return s->position_count > 1 || key < CWI_DICOM_ACQUISITION;
}

static cw_status fail_duplicates(const cwi_dicom_sorting *s, cw_error *err)
{
    size_t i = 0, shared = 0, first = 0;
    for (size_t n; i < s->count; i += n) {
        n = planes_here(s, i);
        first = n > 1 && shared == 0 ? i : first;
        shared += n > 1;
    }
    return cwi_fail(
        err, CW_ERR_UNSAFE,
        "%zu of %zu places hold more than one image, the first at %.6g mm along the "
        "normal, and not as many as others do; desc->gaps = CW_GAPS_ALLOW takes the first of each",
        shared, s->position_count, s->planes[first].distance);
}

static void keep_first_of_each(cwi_dicom_sorting *s)
{
    size_t kept = 0;
    for (size_t i = 0; i < s->count; i++)
        if (kept == 0 || s->planes[i].position_index != s->planes[kept - 1].position_index)
            s->planes[kept++] = s->planes[i];
    cwi_note(s->desc, "left out, because others have the same position: %zu images",
             s->count - kept);
    s->count = kept;
}

cw_status cwi_dicom_find_steps(cwi_dicom_sorting *s, cw_error *err)
{
    static const char *const names[] = {[CWI_DICOM_TEMPORAL] = "TemporalPosition",
                                        [CWI_DICOM_REFERENCE] = "FrameReferenceTime",
                                        [CWI_DICOM_TRIGGER] = "TriggerTime",
                                        [CWI_DICOM_PHASE] = "NominalPercentageOfCardiacPhase",
                                        [CWI_DICOM_ECHO] = "EchoTime",
                                        [CWI_DICOM_B_VALUE] = "DiffusionBValue",
                                        [CWI_DICOM_ACQUISITION] = "AcquisitionNumber",
                                        [CWI_DICOM_KEYS] = "several attributes",
                                        [CWI_DICOM_KEYS + 1] = "InstanceNumber"};
    s->steps = planes_here(s, 0);
    for (size_t i = 0; i < s->count; i += s->steps)
        if (planes_here(s, i) != s->steps) {
            if (s->desc->gaps != CW_GAPS_ALLOW)
                return fail_duplicates(s, err);
            keep_first_of_each(s);
            s->steps = 1;
        }
    const int key = s->steps > 1 ? rank_by_keys(s) : 0;
    for (size_t i = 0; i < s->count; i++)
        s->planes[i].step = i % s->steps;
    if (s->steps == 1)
        return CW_OK;
    cwi_note(s->desc,
             "%zu images at each of %zu places: taken as %zu steps, in the order of %s",
             s->steps, s->position_count, s->steps,
             key == CWI_DICOM_INCREMENT ? s->planes[0].file->order : names[key]);
    return CW_OK;
}
