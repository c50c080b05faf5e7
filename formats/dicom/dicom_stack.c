/* Stacks the planes of a DICOM series into a volume: order, time steps, distances, tilt,
 * segmentations. */
#define _GNU_SOURCE /* qsort_r */
#include "formats/dicom/dicom_stack.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "formats/dicom/dicom_pixel_types.h"
#include "formats/dicom/dicom_places.h"
#include "formats/volume/slice_spacing.h"
#include "formats/volume/volume_reader.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- checks of the geometry --------------------------------------------------------------- */

static bool states_spacing(const cw_read_desc *desc)
{
    return desc->spacing_mm[0] > 0;
}

static cw_status check_has(const cwi_dicom_sorting *s, unsigned flag, const char *field,
                           cw_error *err)
{
    size_t missing = 0;
    for (size_t i = 0; i < s->count; i++)
        missing += !(s->planes[i].frame.has & flag);
    if (missing == 0)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_UNSAFE,
        "%zu of %zu images have no '%s', so where they lie is not known; desc->spacing_mm "
        "takes them in the order of their numbers, at that distance",
        missing, s->count, field);
}

/* Expects that the distance of numbered slices is known. */
static cw_status check_distance(const cwi_dicom_sorting *s, cw_error *err)
{
    for (size_t i = 0; i < s->count; i++) {
        const cwi_dicom_frame *f = &s->planes[i].frame;
        if (f->has & CWI_DICOM_NUMBERED && f->slice && f->between == 0 &&
            !states_spacing(s->desc))
            return cwi_fail(
                err, CW_ERR_UNSAFE,
                "'SpacingBetweenSlices' is missing, so the distance of slices is not "
                "known; desc->spacing_mm states it");
    }
    return CW_OK;
}

static cw_status check_geometry(const cwi_dicom_sorting *s, cw_error *err)
{
    const double *x = s->planes[0].frame.axes[0], *y = s->planes[0].frame.axes[1];
    cw_status st = check_has(s, CWI_DICOM_POSITION, "ImagePositionPatient", err);
    if (st == CW_OK)
        st = check_has(s, CWI_DICOM_ORIENTATION, "ImageOrientationPatient", err);
    if (st == CW_OK && !states_spacing(s->desc))
        st = check_has(s, CWI_DICOM_SPACING, "PixelSpacing", err);
    if (st == CW_OK)
        st = check_distance(s, err);
    if (st != CW_OK)
        return st;
    if (fabs(cwi_dot(x, x) - 1) > 1e-2 || fabs(cwi_dot(y, y) - 1) > 1e-2 ||
        fabs(cwi_dot(x, y)) > 1e-2)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'ImageOrientationPatient' gives no two directions of length 1 at right "
            "angles");
    return CW_OK;
}

/* --- the row of slices -------------------------------------------------------------------- */

/* Computes the way from the first to the last position per millimetre along the normal. */
static void find_row(const cwi_dicom_sorting *s, double along[3])
{
    const cwi_dicom_plane *a = &s->planes[0], *b = &s->planes[s->count - 1];
    for (int r = 0; r < 3; r++)
        along[r] = s->position_count > 1 ? (b->frame.position[r] - a->frame.position[r]) /
                                               (b->distance - a->distance)
                                         : s->normal[r];
}

/* Returns the distance of a plane from the row, in mm. */
static double off_row(const cwi_dicom_sorting *s, const cwi_dicom_plane *p,
                      const double along[3])
{
    const cwi_dicom_plane *first = &s->planes[0];
    double off[3];
    for (int r = 0; r < 3; r++)
        off[r] = p->frame.position[r] - first->frame.position[r] -
                 (p->distance - first->distance) * along[r];
    return cwi_length(off);
}

static double smaller_spacing(const cwi_dicom_sorting *s)
{
    return cwi_lesser(s->planes[0].frame.spacing[0], s->planes[0].frame.spacing[1]);
}

/* Finds the tilt. Slices shifted evenly against each other make a sheared frame at their true
 * positions. */
static cw_status find_tilt(cwi_dicom_sorting *s, double along[3], cw_error *err)
{
    double worst = 0;
    find_row(s, along);
    s->findings->tilt_degrees = atan(sqrt(fmax(0, cwi_dot(along, along) - 1))) * 180 / CWI_PI;
    for (size_t i = 0; i < s->count; i++)
        worst = fmax(worst, off_row(s, &s->planes[i], along));
    if (s->desc->tilt == CW_TILT_KEEP) {
        memcpy(along, s->normal, sizeof s->normal);
    } else if (worst > 0.1 * smaller_spacing(s)) {
        return cwi_fail(err, CW_ERR_UNSAFE,
                        "slices are shifted against each other, unevenly, by up to %.6g mm; "
                        "desc->tilt = CW_TILT_KEEP stacks them up as if they were not",
                        worst);
    }
    return CW_OK;
}

static cw_status lay_slices(const cwi_dicom_sorting *s, cwi_slices *slices, cw_error *err)
{
    double *positions = cwi_alloc_array(s->position_count, sizeof *positions);
    if (!positions)
        return cwi_fail_memory(err);
    for (size_t i = 0; i < s->position_count; i++)
        positions[i] = s->planes[i * s->steps].distance;
    cw_status st = cwi_slices_lay(positions, s->position_count, "mm along the normal",
                                  s->desc->gaps, slices, err);
    cwi_free(positions);
    memcpy(s->findings->gaps, slices->finding, sizeof slices->finding);
    s->findings->made = slices->made;
    return st;
}

/* --- the stack ---------------------------------------------------------------------------- */

static bool same_scaling(const cwi_dicom_sorting *s)
{
    const cwi_dicom_frame *first = &s->planes[0].frame;
    for (size_t i = 1; i < s->count; i++)
        if (s->planes[i].frame.slope != first->slope ||
            s->planes[i].frame.intercept != first->intercept)
            return false;
    return true;
}

static cw_status check_scaling(const cwi_dicom_sorting *s, cw_error *err)
{
    for (size_t i = 0; i < s->count; i++) {
        const cwi_dicom_frame *f = &s->planes[i].frame;
        if (!isfinite(f->slope) || !isfinite(f->intercept) || f->slope == 0)
            return cwi_fail(err, CW_ERR_FORMAT, "'RescaleSlope' is %g, 'RescaleIntercept' %g",
                            f->slope, f->intercept);
    }
    return CW_OK;
}

/* Sets the kind of values. PET scanners scale each slice by itself: then values are stored, not
 * pixels, as they are where the padding of files differs. */
static void set_values(const cwi_dicom_sorting *s, cwi_stack *stack)
{
    const cwi_dicom_pixels pixels = cwi_dicom_join_pixels(s);
    const cwi_dicom_facts *f = pixels.padded;
    cw_volume *v = &stack->shape;
    stack->type = v->type = pixels.type;
    stack->mixed = pixels.mixed;
    stack->scaled =
        !same_scaling(s) || (!pixels.same_padding && s->desc->nodata == CW_NODATA_FILE);
    v->slope = stack->scaled ? 1 : s->planes[0].frame.slope;
    v->intercept = stack->scaled ? 0 : s->planes[0].frame.intercept;
    if (stack->scaled)
        v->type = pixels.is_long ? CW_F64 : CW_F32;
    stack->has_padding = f->has_padding && s->desc->nodata == CW_NODATA_FILE;
    memcpy(stack->padding, f->padding, sizeof f->padding);
    v->has_nodata = stack->has_padding && !stack->scaled;
    v->nodata = v->has_nodata ? f->padding[0] : 0;
}

static void set_sizes(const cwi_dicom_sorting *s, size_t slices, cwi_stack *stack)
{
    const cwi_dicom_facts *f = s->planes[0].file;
    cw_volume *v = &stack->shape;
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(v->type);
    stack->size_field = "Rows";
    stack->samples = v->components = f->samples;
    v->component_stride = size;
    v->dim[0] = f->columns;
    v->dim[1] = f->rows;
    v->dim[2] = slices;
    v->steps = s->steps;
    v->stride[0] = size * (ptrdiff_t)f->samples;
    v->stride[1] = v->stride[0] * (ptrdiff_t)f->columns;
    v->stride[2] = v->stride[1] * (ptrdiff_t)f->rows;
    v->step_stride = v->stride[2] * (ptrdiff_t)slices;
}

static void set_frame(const cwi_dicom_sorting *s, const double along[3], double step,
                      cwi_stack *stack)
{
    const cwi_dicom_frame *f = &s->planes[0].frame;
    cw_volume *v = &stack->shape;
    for (int r = 0; r < 3; r++) {
        v->affine[r][0] = f->axes[0][r] * f->spacing[0];
        v->affine[r][1] = f->axes[1][r] * f->spacing[1];
        v->affine[r][2] = along[r] * step;
        v->affine[r][3] = f->position[r];
    }
    v->known = CW_KNOWN_UNIT;
    if (s->is_turned && !(f->has & CWI_DICOM_OWN_FRAME))
        v->known |= CW_KNOWN_FRAME;
    if (f->has & CWI_DICOM_RESCALED && strcmp(s->planes[0].file->modality, "CT") == 0)
        v->known |= CW_KNOWN_HOUNSFIELD;
}

static cw_status ensure_capacity(const cwi_dicom_sorting *s, size_t slots, cwi_stack *stack,
                                 cw_error *err)
{
    stack->planes = cwi_alloc_array(s->count, sizeof *stack->planes);
    stack->slots = cwi_alloc_array(slots, sizeof *stack->slots);
    if (!stack->planes || !stack->slots)
        return cwi_fail_memory(err);
    stack->plane_count = s->count;
    stack->slot_count = slots;
    for (size_t i = 0; i < s->count; i++) {
        const cwi_dicom_plane *p = &s->planes[i];
        const cwi_dicom_facts *f = p->file;
        stack->planes[i] = (cwi_plane){.file = p->index,
                                       .number = p->number,
                                       .slope = p->frame.slope,
                                       .intercept = p->frame.intercept,
                                       .type = f->type,
                                       .padding = {f->has_padding ? f->padding[0] : 1,
                                                   f->has_padding ? f->padding[1] : 0}};
    }
    return CW_OK;
}

/* Compares by file and frame: each file is opened once, and read from start to end. */
static int by_file(const void *x, const void *y, void *planes)
{
    const cwi_plane *a = (const cwi_plane *)planes + ((const cwi_slot *)x)->low;
    const cwi_plane *b = (const cwi_plane *)planes + ((const cwi_slot *)y)->low;
    if (a->file != b->file)
        return a->file < b->file ? -1 : 1;
    return (a->number > b->number) - (a->number < b->number);
}

static cw_status fill_slots(const cwi_dicom_sorting *s, const cwi_slices *slices,
                            cwi_stack *stack, cw_error *err)
{
    cw_status st = ensure_capacity(s, slices->count * s->steps, stack, err);
    for (size_t k = 0; st == CW_OK && k < slices->count; k++)
        for (size_t t = 0; t < s->steps; t++) {
            const cwi_slice *from = &slices->items[k];
            stack->slots[k * s->steps + t] = (cwi_slot){.slice = t * slices->count + k,
                                                        .low = from->low * s->steps + t,
                                                        .high = from->high * s->steps + t,
                                                        .t = from->t};
        }
    if (st == CW_OK)
        qsort_r(stack->slots, stack->slot_count, sizeof *stack->slots, by_file, stack->planes);
    return st;
}

static void note_findings(const cwi_dicom_sorting *s)
{
    const cwi_dicom_findings *f = s->findings;
    if (s->planes[0].frame.has & CWI_DICOM_OWN_FRAME)
        cwi_note(
            s->desc,
            "places are in the frame of the ultrasound volume: how the patient lies in it is "
            "not read");
    if (f->tilt_degrees > 0.05)
        cwi_note(s->desc, "slices are tilted by %.4g degrees: %s", f->tilt_degrees,
                 s->desc->tilt == CW_TILT_KEEP
                     ? "stacked up as if they were not, the shape is sheared"
                     : "corrected, each stands where it was taken");
    if (f->gaps[0])
        cwi_note(s->desc, "%s: %s", f->gaps,
                 s->desc->gaps == CW_GAPS_ALLOW ? "taken as if they were even"
                                                : "interpolated to even ones");
}

/* Stacks slices with a known position. */
static cw_status stack_placed(cwi_dicom_sorting *s, cwi_stack *stack, cw_error *err)
{
    cwi_slices slices = {0};
    double along[3];
    cw_status st = check_geometry(s, err);
    if (st != CW_OK)
        return st;
    cwi_dicom_find_positions(s);
    st = cwi_dicom_find_steps(s, err);
    if (st == CW_OK)
        st = find_tilt(s, along, err);
    if (st == CW_OK)
        st = lay_slices(s, &slices, err);
    if (st == CW_OK) {
        const cwi_dicom_frame *f = &s->planes[0].frame;
        const double single =
            f->has & CWI_DICOM_BETWEEN && f->between != 0 ? fabs(f->between) : 1;
        set_values(s, stack);
        set_sizes(s, slices.count, stack);
        set_frame(s, along, s->position_count > 1 ? slices.step : single, stack);
        st = fill_slots(s, &slices, stack, err);
    }
    if (st == CW_OK)
        note_findings(s);
    cwi_slices_free(&slices);
    return st;
}

/* --- segmentations ------------------------------------------------------------------------ */

/* Returns the distance of slices: stated, or the smallest found. Slices in which a segment is
 * empty may be left out, so gaps are no error. */
static double segment_step(const cwi_dicom_sorting *s)
{
    const cwi_dicom_frame *f = &s->planes[0].frame;
    double min = INFINITY;
    for (size_t i = 1; i < s->count; i++)
        if (s->planes[i].position_index != s->planes[i - 1].position_index)
            min = fmin(min, s->planes[i].distance - s->planes[i - 1].distance);
    return f->has & CWI_DICOM_BETWEEN && f->between != 0 ? fabs(f->between)
           : isfinite(min)                               ? min
                                                         : 1;
}

/* Sets the index of each plane in the row; *slices is the row's length. */
static cw_status find_segment_positions(cwi_dicom_sorting *s, double step, size_t *slices,
                                        cw_error *err)
{
    for (size_t i = 0; i < s->count; i++) {
        const double at = (s->planes[i].distance - s->planes[0].distance) / step;
        const double nearest = nearbyint(at);
        if (fabs(at - nearest) > 0.05 || nearest >= 65536)
            return cwi_fail(err, CW_ERR_UNSAFE,
                            "the frame at %.6g mm along the normal is not on a row of slices "
                            "%.6g mm apart",
                            s->planes[i].distance, step);
        s->planes[i].position_index = (size_t)nearest;
        *slices = s->planes[i].position_index + 1;
    }
    return CW_OK;
}

static uint32_t highest_segment(const cwi_dicom_sorting *s)
{
    uint32_t max = 0;
    for (size_t i = 0; i < s->count; i++)
        max = s->planes[i].frame.segment > max ? s->planes[i].frame.segment : max;
    return max;
}

/* Compares by label: where segments overlap, the one of the highest number stays. */
static int by_label(const void *x, const void *y)
{
    const cwi_slot *a = x, *b = y;
    if (a->label != b->label)
        return a->label < b->label ? -1 : 1;
    return (a->low > b->low) - (a->low < b->low);
}

static cw_status fill_labels(const cwi_dicom_sorting *s, cwi_stack *stack, cw_error *err)
{
    cw_status st = ensure_capacity(s, s->count, stack, err);
    for (size_t i = 0; st == CW_OK && i < s->count; i++) {
        const cwi_dicom_plane *p = &s->planes[i];
        if (p->frame.segment < 1 || p->frame.segment > UINT16_MAX)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "'ReferencedSegmentNumber' of frame %u is %u; it must be 1 to 65535",
                p->number + 1, p->frame.segment);
        stack->slots[i] = (cwi_slot){
            .slice = p->position_index, .low = i, .high = i, .label = p->frame.segment};
    }
    if (st == CW_OK)
        qsort(stack->slots, stack->slot_count, sizeof *stack->slots, by_label);
    return st;
}

/* Fills label maps: a frame holds all segments of its position. */
static cw_status fill_maps(const cwi_dicom_sorting *s, cwi_stack *stack, cw_error *err)
{
    cw_status st = ensure_capacity(s, s->count, stack, err);
    for (size_t i = 0; st == CW_OK && i < s->count; i++) {
        const cwi_dicom_plane *p = &s->planes[i];
        if (i > 0 && p->position_index == s->planes[i - 1].position_index)
            return cwi_fail(
                err, CW_ERR_UNSAFE,
                "two frames of the label map stand at %.6g mm along the normal; one "
                "was expected at each place",
                p->distance);
        stack->slots[i] = (cwi_slot){.slice = p->position_index, .low = i, .high = i};
    }
    if (st == CW_OK)
        qsort_r(stack->slots, stack->slot_count, sizeof *stack->slots, by_file, stack->planes);
    return st;
}

/* Lists the numbers of segments that occur, rising; *count of them. */
static void list_segments(const cwi_dicom_sorting *s, uint32_t *numbers, size_t *count)
{
    *count = 0;
    for (size_t i = 0; i < s->count; i++) {
        const uint32_t number = s->planes[i].frame.segment;
        size_t at = *count;
        while (at > 0 && numbers[at - 1] >= number)
            at--;
        if (at < *count && numbers[at] == number)
            continue;
        memmove(numbers + at + 1, numbers + at, (*count - at) * sizeof *numbers);
        numbers[at] = number;
        ++*count;
    }
}

static size_t find_segment(const uint32_t *numbers, uint32_t number)
{
    size_t n = 0;
    while (numbers[n] != number)
        n++;
    return n;
}

/* Fills fractions: each segment is a component, in the order of their numbers. */
static cw_status fill_fractions(const cwi_dicom_sorting *s, cwi_stack *stack, cw_error *err)
{
    enum { MAX_SEGMENTS = 16 };
    cw_volume *v = &stack->shape;
    uint32_t *numbers = cwi_alloc_array(s->count, sizeof *numbers);
    size_t count;
    if (!numbers)
        return cwi_fail_memory(err);
    list_segments(s, numbers, &count);
    cw_status st = ensure_capacity(s, s->count, stack, err);
    if (st == CW_OK && count > MAX_SEGMENTS)
        st = cwi_fail(err, CW_ERR_LIMIT,
                      "%zu segments by fractions; up to %d are read, a component each", count,
                      MAX_SEGMENTS);
    for (size_t i = 0; st == CW_OK && i < s->count; i++) {
        const cwi_dicom_plane *p = &s->planes[i];
        const size_t component = find_segment(numbers, p->frame.segment);
        stack->slots[i] =
            (cwi_slot){.slice = component * v->dim[2] + p->position_index, .low = i, .high = i};
    }
    v->components = count;
    v->component_stride = v->stride[2] * (ptrdiff_t)v->dim[2];
    cwi_free(numbers);
    return st;
}

static cw_status stack_segments(cwi_dicom_sorting *s, cwi_stack *stack, cw_error *err)
{
    double along[3];
    size_t slices = 1;
    cw_status st = check_geometry(s, err);
    if (st != CW_OK)
        return st;
    cwi_dicom_find_positions(s);
    s->steps = 1;
    const double step = segment_step(s);
    st = find_tilt(s, along, err);
    if (st == CW_OK)
        st = find_segment_positions(s, step, &slices, err);
    if (st != CW_OK)
        return st;
    const cwi_dicom_kind kind = s->planes[0].file->kind;
    if (kind != CWI_DICOM_SEGMENTATION) {
        set_values(s, stack);
    } else {
        stack->type = CW_U8;
        stack->shape.type = highest_segment(s) > UINT8_MAX ? CW_U16 : CW_U8;
        stack->shape.slope = 1;
    }
    stack->sparse = true;
    set_sizes(s, slices, stack);
    set_frame(s, along, step, stack);
    if (kind == CWI_DICOM_FRACTIONS)
        return fill_fractions(s, stack, err);
    stack->shape.known |= CW_KNOWN_LABELS;
    return kind == CWI_DICOM_LABELMAP ? fill_maps(s, stack, err) : fill_labels(s, stack, err);
}

/* --- the series --------------------------------------------------------------------------- */

/* Expects that the images are slices: one that is none may still be looked at alone. */
static cw_status expect_slices(const cwi_dicom_sorting *s, cw_error *err)
{
    for (size_t i = 0; s->count > 1 && i < s->count; i++)
        if (s->planes[i].file->no_volume[0])
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "its %zu images make no volume: %s; a surface needs slices, such as those "
                "of CT, MR or a reconstructed series",
                s->count, s->planes[i].file->no_volume);
    return CW_OK;
}

static cw_status gather_planes(cwi_dicom_scan *scan, size_t series, cwi_dicom_sorting *s,
                               cw_error *err)
{
    s->planes = cwi_alloc_array(scan->series[series].count, sizeof *s->planes);
    if (!s->planes)
        return cwi_fail_memory(err);
    for (size_t i = 0; i < scan->plane_count; i++)
        if (scan->planes[i].series == series) {
            cwi_dicom_frame *f = &s->planes[s->count].frame;
            s->planes[s->count++] = scan->planes[i];
            for (int a = 0; a < 2; a++)
                if (states_spacing(s->desc))
                    f->spacing[a] = s->desc->spacing_mm[a];
                else if (!(f->has & CWI_DICOM_SPACING))
                    f->spacing[a] = 1;
        }
    return CW_OK;
}

cw_status cwi_dicom_stack(cwi_dicom_scan *scan, size_t series, const cw_read_desc *desc,
                          cwi_stack *stack, cwi_dicom_findings *findings, cw_error *err)
{
    cwi_dicom_sorting s = {.desc = desc, .findings = findings};
    *findings = (cwi_dicom_findings){0};
    cw_status st = gather_planes(scan, series, &s, err);
    if (st == CW_OK)
        st = expect_slices(&s, err);
    if (st == CW_OK)
        st = check_scaling(&s, err);
    if (st == CW_OK)
        st = cwi_dicom_place(&s, err);
    if (st == CW_OK && s.planes[0].file->kind != CWI_DICOM_IMAGE)
        st = stack_segments(&s, stack, err);
    else if (st == CW_OK)
        st = stack_placed(&s, stack, err);
    cwi_free(s.planes);
    return st;
}
