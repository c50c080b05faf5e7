/* The triangles of each of the 256 cube cases; the tables are made by make_cases.c. */
#ifndef EXTRACT_CASES_H
#define EXTRACT_CASES_H

#include <stdint.h>

enum { CWI_CASE_MAX_TRIANGLES = 5 };

/* Number of triangles of a case. */
extern const uint8_t cwi_case_count[256];

/* Their corners: edges of the cube, three a triangle, counter-clockwise seen from outside the
 * solid. */
extern const uint8_t cwi_case_triangles[256][3 * CWI_CASE_MAX_TRIANGLES];

#endif
