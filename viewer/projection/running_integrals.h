/* Running integrals of a transfer function: a segment of any length, along which the value
 * changes linearly, is the difference of two of them. */
#ifndef VIEWER_PROJECTION_RUNNING_INTEGRALS_H
#define VIEWER_PROJECTION_RUNNING_INTEGRALS_H

#include "viewer/scene/transfer_table.h"

#ifdef __cplusplus
extern "C" {
#endif

/* sums[n]: the integrals up to row n of the colours times the extinction, and of that. */
typedef struct cwi_integrals {
    cwi_table table;
    double (*sums)[4];
} cwi_integrals;

/* CW_ERR_NO_MEMORY. It may be freed twice. */
CW_NODISCARD cw_status cwi_integrals_make(const cwi_frame *frame, cwi_integrals *integrals,
                                          cw_error *err);
void cwi_integrals_free(cwi_integrals *integrals);

/* Computes the means between two values: colour times extinction, and extinction. */
void cwi_integrals_mean(const cwi_integrals *integrals, double from, double to, double mean[4]);

#ifdef __cplusplus
}
#endif

#endif
