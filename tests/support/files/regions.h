/* Volumes read from a region, compared with the crop of the whole volume. */
#ifndef TESTS_REGIONS_H
#define TESTS_REGIONS_H

#include <cubewright/formats.h>

/* Reads a file of the test's folder as a whole, with limits that are enough and that are not,
 * and then every box of it, or some of each kind where it has many; desc may be NULL. Fails the
 * test at the first difference. */
void check_regions(const char *name, const cw_read_desc *desc);

#endif
