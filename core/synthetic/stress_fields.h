/* The table of hard cases, and the function that computes a sample of each. */
#ifndef CORE_SYNTHETIC_STRESS_FIELDS_H
#define CORE_SYNTHETIC_STRESS_FIELDS_H

#include <cubewright/hard.h>

/* A sample to be computed. */
typedef struct cwi_hard_sample {
    size_t at[3], dim[3];
    cw_type type;
    uint64_t seed;
    double parameter; /* of the case: a radius, a ratio, a fraction */
} cwi_hard_sample;

typedef struct cwi_hard_row {
    cw_hard hard;
    double parameter;
    double (*value)(const cwi_hard_sample *s);
} cwi_hard_row;

/* Returns the n-th row; NULL after the last. */
const cwi_hard_row *cwi_hard_row_at(size_t n);

/* Finds the cell and the corner of a sample. Cells stand in a grid two samples wide, with one
 * sample of outside between them; returns false there. Cells are numbered with x fastest. */
bool cwi_hard_cell(const cwi_hard_sample *s, size_t *cell, unsigned *corner);

/* Returns a corner of the n-th cell. The cells are every case of marching cubes in every
 * resolution of its faces and inside; after CWI_HARD_CELLS they repeat. */
enum { CWI_HARD_KINDS = 30, CWI_HARD_CELLS = 96 * CWI_HARD_KINDS };
double cwi_hard_corner(size_t n, unsigned corner);

#endif
