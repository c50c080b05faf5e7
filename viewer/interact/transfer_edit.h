/* Changing a transfer function as a person does who sees it over a histogram: values to the
 * right, opacities upwards, colours along the values.
 *
 * Of a transfer function that passes cw_transfer_check() all results pass it. Numbers that are
 * not finite change nothing. Gradients and unit_mm stay as they are. */
#ifndef VIEWER_INTERACT_TRANSFER_EDIT_H
#define VIEWER_INTERACT_TRANSFER_EDIT_H

#include <cubewright/transfer.h>

#ifdef __cplusplus
extern "C" {
#endif

/* No point, no segment. */
#define CWI_TRANSFER_NONE SIZE_MAX

/* The nearest opacity point, colour point, and segment of the opacities' line at most so far
 * away, in value and opacity; of points that lie upon each other the last. Segment n is before
 * point n, that of opacity_count behind the last; there is one at least. */
size_t cwi_transfer_near_opacity(const cw_transfer *transfer, double value, double opacity,
                                 const double tolerance[2]);
size_t cwi_transfer_near_color(const cw_transfer *transfer, double value, double tolerance);
size_t cwi_transfer_near_segment(const cw_transfer *transfer, double value, double opacity,
                                 const double tolerance[2]);

/* Takes point n, which is there, as close as it can go: values stay between those of its
 * neighbours, and beyond the ends there are none; opacities from 0 to 1. */
void cwi_transfer_move_opacity(cw_transfer *transfer, size_t n, double value, double opacity);
void cwi_transfer_move_color(cw_transfer *transfer, size_t n, double value);

/* Puts a point in: an opacity, and the colour that is there already. Its number;
 * CWI_TRANSFER_NONE, and nothing is changed, when there are CW_TRANSFER_POINTS or the numbers
 * are not finite. */
size_t cwi_transfer_insert_opacity(cw_transfer *transfer, double value, double opacity);
size_t cwi_transfer_insert_color(cw_transfer *transfer, double value);

/* Takes point n out, which is there. */
void cwi_transfer_remove_opacity(cw_transfer *transfer, size_t n);
void cwi_transfer_remove_color(cw_transfer *transfer, size_t n);

/* From the first to the last opacity point, without those from the first to the last colour;
 * false: there is neither. */
bool cwi_transfer_range(const cw_transfer *transfer, double range[2]);

/* A whole one made of another: so that a slider that comes back to where it was gives what was
 * there. out may be the original. False, and out is the original, for numbers that make none:
 * those that are not finite, a factor of 0 or less (of opacities: below 0), low not below high,
 * and a window where there is no range.
 * shift   adds to all values
 * scale   moves all values away from the middle, that many times as far
 * window  takes the range to low .. high, and what else there is along; a range of one value
 *         goes to the middle
 * fade    multiplies opacities, which end at 1
 * mirror  turns colours round in their range */
bool cwi_transfer_shift(const cw_transfer *original, double by, cw_transfer *out);
bool cwi_transfer_scale(const cw_transfer *original, double middle, double factor,
                        cw_transfer *out);
bool cwi_transfer_window(const cw_transfer *original, double low, double high,
                         cw_transfer *out);
bool cwi_transfer_fade(const cw_transfer *original, double factor, cw_transfer *out);
bool cwi_transfer_mirror(const cw_transfer *original, cw_transfer *out);

#ifdef __cplusplus
}
#endif

#endif
