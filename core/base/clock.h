/* The monotonic clock for measuring durations. */
#ifndef CORE_BASE_CLOCK_H
#define CORE_BASE_CLOCK_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the seconds since a fixed moment; they never run backwards. */
double cwi_now_s(void);

#ifdef __cplusplus
}
#endif

#endif
