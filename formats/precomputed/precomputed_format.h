/* The driver of Neuroglancer's precomputed volumes. */
#ifndef FORMATS_PRECOMPUTED_PRECOMPUTED_FORMAT_H
#define FORMATS_PRECOMPUTED_PRECOMPUTED_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_precomputed;

#endif
