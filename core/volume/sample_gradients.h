/* Gradients at the samples of an irregular grid, by least squares over the edges of cells. */
#ifndef CORE_VOLUME_SAMPLE_GRADIENTS_H
#define CORE_VOLUME_SAMPLE_GRADIENTS_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The samples to find gradients at, and the unit to find them in. */
typedef struct cwi_gradient_fit {
    const cw_volume *volume; /* resolved, irregular, its shapes and corners checked */
    double centre[3];        /* origin of places, subtracted from the points */
    double largest;          /* absolute stored number, and */
    double reach;            /* side of the points' box: they keep products in range */
    const uint32_t *rows;    /* each sample's row of the result; UINT32_MAX: none is needed.
                                 NULL: all samples in order */
} cwi_gradient_fit;

/* Fits gradients of the stored numbers in the world, all multiplied by *factor, a power of two.
 * Cells with a corner that has no value are left out. An edge counts once for each cell that
 * has it. A gradient is zero where the edges lie in a plane.
 * gradients  one per row
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_gradients_fit(const cwi_gradient_fit *fit, size_t row_count,
                                         double (*gradients)[3], double *factor, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
