/* One pass of edge collapses over a label complex. */
#ifndef SIMPLIFY_INTERFACES_LABEL_COLLAPSE_H
#define SIMPLIFY_INTERFACES_LABEL_COLLAPSE_H

#include "simplify/interfaces/label_samples.h"

/* Collapses edges, the cheapest first, until `target` triangles are left, or no collapse is
 * allowed.
 * samples   NULL: distances do not matter
 * Returns   CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_label_collapse(cwi_complex *c, cwi_label_samples *samples,
                                          size_t target, const cw_progress *progress,
                                          cw_error *err);

#endif
