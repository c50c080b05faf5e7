/* The driver of N5. */
#ifndef FORMATS_N5_N5_FORMAT_H
#define FORMATS_N5_N5_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_n5;

#endif
