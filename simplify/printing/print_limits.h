/* The limits of a printer, with their defaults. */
#ifndef SIMPLIFY_PRINTING_PRINT_LIMITS_H
#define SIMPLIFY_PRINTING_PRINT_LIMITS_H

#include <cubewright/print.h>

/* Fills in defaults, and checks ranges: CW_ERR_ARGUMENT. desc may be NULL. */
CW_NODISCARD cw_status cwi_print_limits(const cw_print_desc *desc, cw_print_desc *out,
                                        cw_error *err);

#endif
