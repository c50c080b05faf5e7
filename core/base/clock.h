/* The clock that durations are measured with. */
#ifndef CORE_BASE_CLOCK_H
#define CORE_BASE_CLOCK_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Seconds since some moment; they never run backwards. */
double cwi_now_s(void);

#ifdef __cplusplus
}
#endif

#endif
