/* The grid that the positions of a file are rounded to, one for all its parts so that they meet
 * where they met before. */
#ifndef FORMATS_CODEC_QUANTIZATION_GRID_H
#define FORMATS_CODEC_QUANTIZATION_GRID_H

#include "formats/mesh/mesh_writer.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_MOST_GRID_BITS = 30 };

/* Positions are origin + n * step, n from 0 to 2^bits - 1, along each axis. The step is
 * range / (2^bits - 1); or it is dyadic: a power of two, of which the origin is a multiple. */
typedef struct cwi_quantization_grid {
    float low[3]; /* of the box */
    float origin[3];
    float range; /* the longest edge of the box */
    int bits;
    bool dyadic;
    bool single;  /* a decoder makes floats of the places: cwi_grid_decode() */
    int exponent; /* of a dyadic step */
    double step;
} cwi_quantization_grid;

/* What rounding to a grid does to meshes. */
typedef struct cwi_grid_harm {
    size_t merged; /* vertices that fall onto another one, from which they were apart */
    size_t flat;   /* triangles that had an area and lose it */
} cwi_grid_harm;

/* The box of the positions (origins left out) of all meshes, as a grid of no bits yet. */
cwi_quantization_grid cwi_grid_around(const cwi_parts *parts);

/* Divides the box again, as finely as the bits allow; dyadic takes 17 to 24 of them. */
void cwi_grid_refine(cwi_quantization_grid *grid, int bits, bool dyadic);

/* The most that rounding moves a point; the last digits of floats aside. */
double cwi_grid_error(const cwi_quantization_grid *grid);

/* By the arithmetic of glTF's and Draco's encoders. From 24 bits on, rounding can give
 * 2^bits. */
static inline uint32_t cwi_grid_round_even(const cwi_quantization_grid *grid, float coordinate,
                                           int axis)
{
    const float most = (float)((1u << grid->bits) - 1), inverse = most / grid->range;
    const float at = (coordinate - grid->origin[axis]) * inverse + 0.5f;
    return at <= 0 ? 0 : (uint32_t)at;
}

/* Where a place is found, counted from the parts' origin: by the arithmetic of Draco's decoder,
 * or exactly. */
static inline double cwi_grid_decode(const cwi_quantization_grid *grid, uint32_t place,
                                     int axis)
{
    const float step = grid->range / (float)((1u << grid->bits) - 1);
    return grid->single ? (double)((float)place * step + grid->origin[axis])
                        : (double)grid->origin[axis] + grid->step * place;
}

/* Single precision has no digit left to round 24 bits with. */
static inline uint32_t cwi_grid_round_dyadic(const cwi_quantization_grid *grid,
                                             float coordinate, int axis)
{
    const double most = (double)((1u << grid->bits) - 1);
    const double at = ((double)coordinate - (double)grid->origin[axis]) / grid->step + 0.5;
    return at <= 0 ? 0 : at >= most ? (uint32_t)most : (uint32_t)at;
}

/* The place of a coordinate, counted from 0. */
static inline uint32_t cwi_grid_round(const cwi_quantization_grid *grid, float coordinate,
                                      int axis)
{
    return grid->dyadic ? cwi_grid_round_dyadic(grid, coordinate, axis)
                        : cwi_grid_round_even(grid, coordinate, axis);
}

/* The same counted from the middle of the places: a signed number of as many bits. */
static inline int32_t cwi_grid_round_signed(const cwi_quantization_grid *grid, float coordinate,
                                            int axis)
{
    return (int32_t)cwi_grid_round(grid, coordinate, axis) - (1 << (grid->bits - 1));
}

static inline double cwi_grid_middle(const cwi_quantization_grid *grid, int axis)
{
    return (double)grid->origin[axis] + (double)(1 << (grid->bits - 1)) * grid->step;
}

/* CW_ERR_ARGUMENT for a compression that there is not, or bits that it has not. */
CW_NODISCARD cw_status cwi_grid_check_bits(const cw_write_desc *desc, cw_error *err);

/* Lays the coarsest grid around the parts, of one origin, that keeps the tolerance and the
 * shape; or one of the bits that are stated, whatever it does to the shape. grid     bits 0:
 * meshopt has none, positions are to stay as they are told     bits, step, error and harm are
 * filled in Returns  CW_ERR_CHECK when there is none; CW_ERR_LIMIT for a box too large;
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_grid_choose(cwi_quantization_grid *grid, const cwi_parts *parts,
                                       const cw_write_desc *desc, cw_compressed *told,
                                       cw_error *err);

/* Counts the harm over all meshes together. CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_grid_measure(const cwi_quantization_grid *grid,
                                        const cwi_parts *parts, cwi_grid_harm *harm,
                                        cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
