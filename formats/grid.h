/* The grid that the positions of a file are rounded to, one for all its parts so that they meet
 * where they met before. */
#ifndef FORMATS_GRID_H
#define FORMATS_GRID_H

#include "formats/mesh_writers.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_MOST_GRID_BITS = 30 };

/* Positions are origin + n * range / (2^bits - 1), n from 0 to 2^bits - 1, along each axis. */
typedef struct cwi_grid {
    float origin[3];
    float range;
    int bits;
} cwi_grid;

/* What rounding to a grid does to meshes. */
typedef struct cwi_grid_harm {
    size_t merged; /* vertices that fall onto another one, from which they were apart */
    size_t flat;   /* triangles that had an area and lose it */
} cwi_grid_harm;

/* The box of the positions (origins left out) of all meshes, as a grid of no bits yet. */
cwi_grid cwi_grid_around(const cwi_parts *parts);

/* The distance of neighbouring places, and the most that rounding moves a point. */
double cwi_grid_step(const cwi_grid *grid);
double cwi_grid_error(const cwi_grid *grid);

/* The fewest bits with which no point moves farther than max_error; more than there can be when
 * even the most are not enough. */
int cwi_grid_bits(const cwi_grid *grid, double max_error);

/* Where a coordinate goes, counted from 0: by the arithmetic of glTF's and Draco's encoders. */
static inline uint32_t cwi_grid_round(const cwi_grid *grid, float coordinate, int axis)
{
    const float most = (float)((1u << grid->bits) - 1), inverse = most / grid->range;
    const float at = (coordinate - grid->origin[axis]) * inverse + 0.5f;
    return at <= 0 ? 0 : at >= most ? (uint32_t)most : (uint32_t)at;
}

/* Counts the harm over all meshes together. CW_ERR_NO_MEMORY. */
cw_status cwi_grid_measure(const cwi_grid *grid, const cwi_parts *parts, cwi_grid_harm *harm,
                           cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
