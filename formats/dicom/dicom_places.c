/* Places planes that state a number instead of a position: of the slice, or of the image. */
#include "formats/dicom/dicom_places.h"

#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "formats/volume/volume_reader.h"

#include <math.h>
#include <string.h>

static const unsigned BOTH = CWI_DICOM_POSITION | CWI_DICOM_ORIENTATION;

static bool states_spacing(const cwi_dicom_sorting *s)
{
    return s->desc->spacing_mm[0] > 0;
}

static size_t count_having(const cwi_dicom_sorting *s, unsigned flags)
{
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += (s->planes[i].frame.has & flags) == flags;
    return count;
}

/* Returns the first plane with a flag; NULL where there is none. */
static const cwi_dicom_plane *find_plane(const cwi_dicom_sorting *s, unsigned flag)
{
    for (size_t i = 0; i < s->count; i++)
        if (s->planes[i].frame.has & flag)
            return &s->planes[i];
    return NULL;
}

static void find_normal(const cwi_dicom_frame *f, double normal[3])
{
    cwi_cross(f->axes[0], f->axes[1], normal);
}

/* Moves planes to the places of their slices. A negative SpacingBetweenSlices stacks them in front of the first
 * (PS3.3 C.8.4.15). */
static void place_slices(cwi_dicom_sorting *s)
{
    for (size_t i = 0; i < s->count; i++) {
        cwi_dicom_frame *f = &s->planes[i].frame;
        if (!(f->has & CWI_DICOM_NUMBERED))
            continue;
        const double step =
            states_spacing(s) ? copysign(s->desc->spacing_mm[2], f->between) : f->between;
        double normal[3];
        find_normal(f, normal);
        for (int r = 0; r < 3; r++)
            f->position[r] += f->slice * step * normal[r];
    }
}

/* Returns -1 where the images run against the normal, as the first and last stated positions tell, else 1. */
static int find_direction(const cwi_dicom_sorting *s, const double normal[3])
{
    const cwi_dicom_plane *first = find_plane(s, CWI_DICOM_POSITION), *last = first;
    for (size_t i = 0; i < s->count; i++)
        if (s->planes[i].frame.has & CWI_DICOM_POSITION)
            last = &s->planes[i];
    return first && cwi_dot(last->frame.position, normal) <
                        cwi_dot(first->frame.position, normal)
               ? -1
               : 1;
}

/* Numbers planes in the order of InstanceNumber and frame, in which the scan has sorted them. */
static cw_status number_planes(cwi_dicom_sorting *s, cw_error *err)
{
    for (size_t i = 1; i < s->count; i++)
        if (s->planes[i].file->instance_number == s->planes[i - 1].file->instance_number &&
            s->planes[i].number == s->planes[i - 1].number)
            return cwi_fail(
                err, CW_ERR_UNSAFE,
                "images have neither place nor 'InstanceNumber': their order is not "
                "known");
    for (size_t i = 0; i < s->count; i++)
        s->planes[i].frame.slice = (int32_t)i;
    return CW_OK;
}

/* Gives all planes the position and the directions that one of them states, and numbers. */
static cw_status share_place(cwi_dicom_sorting *s, cw_error *err)
{
    const cwi_dicom_plane *at = find_plane(s, CWI_DICOM_POSITION),
                          *turned = find_plane(s, CWI_DICOM_ORIENTATION);
    const bool are_numbered = count_having(s, CWI_DICOM_NUMBERED) == s->count;
    cw_status st = are_numbered ? CW_OK : number_planes(s, err);
    if (st != CW_OK)
        return st;
    cwi_dicom_frame from = at ? at->frame : (cwi_dicom_frame){0};
    const double lps[2][3] = {{1, 0, 0}, {0, 1, 0}};
    double normal[3];
    memcpy(from.axes, turned ? turned->frame.axes : lps, sizeof from.axes);
    find_normal(&from, normal);
    const int direction = find_direction(s, normal);
    for (size_t i = 0; i < s->count; i++) {
        cwi_dicom_frame *f = &s->planes[i].frame;
        memcpy(f->axes, from.axes, sizeof f->axes);
        memcpy(f->position, from.position, sizeof f->position);
        f->has |= BOTH | CWI_DICOM_NUMBERED;
        if (!are_numbered) {
            f->slice -= from.slice;
            f->between = direction;
        }
    }
    return CW_OK;
}

cw_status cwi_dicom_place(cwi_dicom_sorting *s, cw_error *err)
{
    const size_t placed = count_having(s, BOTH),
                 positions = count_having(s, CWI_DICOM_POSITION);
    const bool are_numbered = count_having(s, CWI_DICOM_NUMBERED) > 0;
    cw_status st = CW_OK;
    s->is_turned = find_plane(s, CWI_DICOM_ORIENTATION) != NULL;
    if (states_spacing(s) && placed < s->count) {
        st = share_place(s, err);
        if (st == CW_OK && positions)
            cwi_note(
                s->desc,
                "%zu of %zu images say where they lie: the others follow from there, in the order of "
                "their numbers",
                positions, s->count);
        else if (st == CW_OK)
            cwi_note(s->desc,
                     "where images lie is not said: taken in the order of their numbers");
    } else if (states_spacing(s) && s->count > 1 && !are_numbered &&
               !cwi_dicom_are_moments(s)) {
        st = share_place(s, err);
        cwi_note(
            s->desc,
            "all %zu images state the same position: they follow from there, in the order of "
            "their numbers",
            s->count);
    }
    if (st == CW_OK)
        place_slices(s);
    return st;
}
