/* Orders the planes of a DICOM series: by their positions, and by what sets those apart that share one. */
#include "formats/dicom/dicom_order.h"

#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "formats/volume/volume_reader.h"

#include <stdlib.h>

static int by_distance(const void *x, const void *y)
{
    const cwi_dicom_plane *a = x, *b = y;
    return (a->distance > b->distance) - (a->distance < b->distance);
}

static int by_position_and_step(const void *x, const void *y)
{
    const cwi_dicom_plane *a = x, *b = y;
    if (a->position_index != b->position_index)
        return a->position_index < b->position_index ? -1 : 1;
    return (a->step > b->step) - (a->step < b->step);
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

/* Ranks the planes at one position by one key; returns false where two have the same value. */
static bool rank_here(cwi_dicom_plane *planes, size_t count, int key)
{
    for (size_t i = 0; i < count; i++) {
        const double mine = planes[i].frame.keys[key];
        planes[i].step = 0;
        for (size_t o = 0; o < count; o++) {
            const double other = planes[o].frame.keys[key];
            if (o != i && !(other < mine || other > mine)) /* NaN too */
                return false;
            planes[i].step += other < mine;
        }
    }
    return true;
}

static bool rank_all(cwi_dicom_sorting *s, int key)
{
    for (size_t i = 0; i < s->count; i += s->steps)
        if (!rank_here(s->planes + i, s->steps, key))
            return false;
    return true;
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
    static const char *const names[] = {"TemporalPosition", "FrameReferenceTime",
                                        "TriggerTime",      "EchoTime",
                                        "DiffusionBValue",  "AcquisitionNumber"};
    s->steps = planes_here(s, 0);
    for (size_t i = 0; i < s->count; i += s->steps)
        if (planes_here(s, i) != s->steps) {
            if (s->desc->gaps != CW_GAPS_ALLOW)
                return fail_duplicates(s, err);
            keep_first_of_each(s);
            s->steps = 1;
        }
    int key = 0;
    for (size_t i = 0; i < s->count; i++)
        s->planes[i].step = i % s->steps; /* in the order of instance numbers */
    if (s->steps == 1)
        return CW_OK;
    while (key < CWI_DICOM_KEYS && !rank_all(s, key))
        key++;
    for (size_t i = 0; key == CWI_DICOM_KEYS && i < s->count; i++)
        s->planes[i].step = i % s->steps;
    cwi_note(s->desc, "%zu images at each of %zu places: taken as steps, in the order of %s",
             s->steps, s->position_count, key < CWI_DICOM_KEYS ? names[key] : "InstanceNumber");
    sort_planes(s, by_position_and_step);
    return CW_OK;
}
