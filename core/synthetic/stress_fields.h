/* The table of hard cases: what a sample of each is. */
#ifndef CORE_SYNTHETIC_STRESS_FIELDS_H
#define CORE_SYNTHETIC_STRESS_FIELDS_H

#include <cubewright/hard.h>

/* A sample to be made. */
typedef struct cwi_hard_sample {
    size_t at[3], dim[3];
    cw_type type;
    uint64_t seed;
    double parameter; /* of the case: a radius, a ratio, a share */
} cwi_hard_sample;

typedef struct cwi_hard_row {
    cw_hard hard;
    double parameter;
    double (*value)(const cwi_hard_sample *s);
} cwi_hard_row;

/* NULL after the last. */
const cwi_hard_row *cwi_hard_row_at(size_t n);

/* Cells stand in a grid two samples wide, with one sample of outside between them: the number
 * of the cell that a sample is a corner of, x fastest, and which corner; false in between. */
bool cwi_hard_cell(const cwi_hard_sample *s, size_t *cell, unsigned *corner);

/* Every case of marching cubes in every resolution of its faces and inside: the n-th of
 * CWI_HARD_CELLS, after which they come again. */
enum { CWI_HARD_KINDS = 30, CWI_HARD_CELLS = 96 * CWI_HARD_KINDS };
double cwi_hard_corner(size_t n, unsigned corner);

#endif
