/* Edits a transfer function as a person does who sees it over a histogram: values to the right,
 * opacities upwards, colours along the values.
 *
 * If a transfer function passes cw_transfer_check(), all results pass it. Numbers that are not
 * finite change nothing. Gradients and unit_mm stay as they are. */
#ifndef VIEWER_INTERACT_TRANSFER_EDIT_H
#define VIEWER_INTERACT_TRANSFER_EDIT_H

#include <cubewright/transfer.h>

#ifdef __cplusplus
extern "C" {
#endif

/* No point, no segment. */
#define CWI_TRANSFER_NONE SIZE_MAX

/* Find the nearest opacity point, colour point, and segment of the opacities' line within a
 * tolerance, in value and opacity; of points that coincide the last. Segment n is before point
 * n, segment opacity_count is behind the last; there is at least one. */
size_t cwi_transfer_near_opacity(const cw_transfer *transfer, double value, double opacity,
                                 const double tolerance[2]);
size_t cwi_transfer_near_color(const cw_transfer *transfer, double value, double tolerance);
size_t cwi_transfer_near_segment(const cw_transfer *transfer, double value, double opacity,
                                 const double tolerance[2]);

/* Move point n, which must exist, as close as it can go. Values stay between those of its
 * neighbours, with no limit beyond the ends; opacities stay from 0 to 1. */
void cwi_transfer_move_opacity(cw_transfer *transfer, size_t n, double value, double opacity);
void cwi_transfer_move_color(cw_transfer *transfer, size_t n, double value);

/* Insert a point: an opacity, or the colour that is already there. Return its number, or
 * CWI_TRANSFER_NONE, with nothing changed, when there are CW_TRANSFER_POINTS or the numbers are
 * not finite. */
size_t cwi_transfer_insert_opacity(cw_transfer *transfer, double value, double opacity);
size_t cwi_transfer_insert_color(cw_transfer *transfer, double value);

/* Remove point n, which must exist. */
void cwi_transfer_remove_opacity(cw_transfer *transfer, size_t n);
void cwi_transfer_remove_color(cw_transfer *transfer, size_t n);

/* Finds the range from the first to the last opacity point or, without those, from the first to
 * the last colour. Returns false if there is neither. */
bool cwi_transfer_range(const cw_transfer *transfer, double range[2]);

/* Make a whole transfer function from another, so that a slider that returns to its old place
 * restores the old function. out may be the original. They return false, and out is the
 * original, for unusable numbers: those that are not finite, a factor of 0 or less (of
 * opacities: below 0), low not below high, and a window where there is no range.
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
