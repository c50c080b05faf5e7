/* Differences of two pictures of surfaces. */
#ifndef VIEWER_APPEARANCE_LOOK_DIFFERENCE_H
#define VIEWER_APPEARANCE_LOOK_DIFFERENCE_H

#include <cubewright/appearance.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sums over pixels. */
typedef struct cwi_look_sums {
    size_t pixels, alone; /* shown by at least one picture; by only one */
    uint64_t square, square_alone;
    double delta, delta_alone;
} cwi_look_sums;

/* Colours in CIELAB, and differences of greys; make it once. */
typedef struct cwi_look_greys {
    float delta_e[256][256];
} cwi_look_greys;

void cwi_look_greys_make(cwi_look_greys *greys);

/* Compares two pictures of size x size pixels, colours times opacity. Sums are added in the order of rows.
 * Returns  CW_ERR_NO_MEMORY, CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_look_compare(const cwi_look_greys *greys, const uint8_t *a,
                                        const uint8_t *b, uint32_t size, int threads,
                                        cwi_look_sums *sums, cw_error *err);

void cwi_look_sums_add(cwi_look_sums *to, const cwi_look_sums *from);

/* Computes the figures. */
void cwi_look_figures(const cwi_look_sums *sums, cw_look_difference *figures);

#ifdef __cplusplus
}
#endif

#endif
