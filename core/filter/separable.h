/* Filters that are a product of three: a sum of weighted samples along each axis. */
#ifndef CORE_FILTER_SEPARABLE_H
#define CORE_FILTER_SEPARABLE_H

#include "core/filter/filter_work.h"

/* The weights of input samples in each output sample along an axis. They add up to 1. */
typedef struct cwi_axis_weights {
    size_t count, taps; /* output samples; weights of each */
    size_t *first;      /* count: first input sample; these never fall */
    size_t *nearest;    /* count: nearest input sample */
    double *weights;    /* count x taps; those behind the last sample are 0 */
} cwi_axis_weights;

/* Makes room for weights, all 0, of at most `taps` input samples. Free with
 * cwi_axis_weights_free(). Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_axis_weights_init(cwi_axis_weights *w, size_t count, size_t taps,
                                             cw_error *err);
void cwi_axis_weights_free(cwi_axis_weights *w);

/* Sets the weights of output sample n around a position, in input samples: those of a kernel, as wide
 * as its reach. Samples beyond the ends are those at the ends.
 * samples  of the input */
void cwi_axis_weights_set(cwi_axis_weights *w, size_t n, double position, size_t samples,
                          double reach, double (*kernel)(double x, double width), double width);

/* Filters a volume. out is as large as the weights say, of cw_filter_type().
 * in       as of cwi_filter_input()
 * Returns  CW_ERR_LIMIT, CW_ERR_NO_MEMORY, CW_ERR_CANCELLED; then *out is zeroed */
CW_NODISCARD cw_status cwi_separable_filter(const cw_volume *in, const cwi_axis_weights w[3],
                                            const cw_filter_desc *desc, const char *step,
                                            cw_volume *out, cw_error *err);

#endif
