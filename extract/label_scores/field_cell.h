/* A cube between 2 x 2 x 2 voxels with the fields of its labels, and the point where those are equal. */
#ifndef EXTRACT_LABEL_SCORES_FIELD_CELL_H
#define EXTRACT_LABEL_SCORES_FIELD_CELL_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Set it, and zero the rest. Bit a of a corner's number is its place along axis a. */
typedef struct cwi_field_cell {
    uint8_t corners;     /* those that count, as bits: not what is beyond the volume */
    int count;           /* of the fields that are the largest at some corner */
    int field_of[8];     /* the number of that field of each corner */
    int group[8];        /* of fields: those of one group have one label */
    double values[8][8]; /* of each field at each corner; NaN: none */
} cwi_field_cell;

/* Finds the mean of the points where fields of different groups are equal, linear along edges.
 * edges  bit 8 * a + b of those from corner a to corner b, of which a is the lower
 * at     set to it, from 0 to 1 along each axis
 * Returns false if there is none */
bool cwi_field_cell_mean(const cwi_field_cell *cell, uint64_t edges, double at[3]);

/* Moves a point to where the fields of all groups are equal, or where they differ least, as trilinear
 * functions. It stays where it is if a field has no value at a corner, or steps do not lead nearer. */
void cwi_field_cell_meet(const cwi_field_cell *cell, double at[3]);

#ifdef __cplusplus
}
#endif

#endif
