/* The grid to which the positions of a file are rounded. All parts share one grid, so that they
 * still meet where they met before. */
#ifndef FORMATS_CODEC_QUANTIZATION_GRID_H
#define FORMATS_CODEC_QUANTIZATION_GRID_H

#include "formats/mesh/mesh_writer.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_MAX_GRID_BITS = 30 };

/* A grid. Positions are origin + n * step, n from 0 to 2^bits - 1, along each axis. The step is
 * range / (2^bits - 1); or it is dyadic: a power of two, and the origin is a multiple of it. */
typedef struct cwi_quantization_grid {
    float low[3]; /* of the box */
    float origin[3];
    float range; /* the longest edge of the box */
    int bits;
    bool dyadic;
    bool single;  /* decoders compute in single precision: cwi_grid_decode() */
    int exponent; /* of a dyadic step */
    double step;
} cwi_quantization_grid;

/* The damage that rounding to a grid does to meshes. */
typedef struct cwi_grid_harm {
    size_t merged; /* vertices that fall onto another one, different before */
    size_t flat;   /* triangles that had an area and lose it */
} cwi_grid_harm;

/* Returns the box of the positions (origins left out) of all meshes, as a grid with no bits
 * yet. */
cwi_quantization_grid cwi_grid_around(const cwi_parts *parts);

/* Divides the box again, as finely as the bits allow; dyadic takes 17 to 24 of them. */
void cwi_grid_refine(cwi_quantization_grid *grid, int bits, bool dyadic);

/* Returns the maximum move of a point by rounding, apart from the last digits of floats. */
double cwi_grid_error(const cwi_quantization_grid *grid);

/* Rounds a coordinate with the arithmetic of glTF's and Draco's encoders. From 24 bits on, the
 * result can be 2^bits. */
static inline uint32_t cwi_grid_round_even(const cwi_quantization_grid *grid, float coordinate,
                                           int axis)
{
    const float max = (float)((1u << grid->bits) - 1), inverse = max / grid->range;
    const float at = (coordinate - grid->origin[axis]) * inverse + 0.5f;
    return at <= 0 ? 0 : (uint32_t)at;
}

/* Returns the decoded position of a position, relative to the parts' origin. It uses the
 * arithmetic of Draco's decoder, or is exact. */
static inline double cwi_grid_decode(const cwi_quantization_grid *grid, uint32_t grid_point,
                                     int axis)
{
    const float step = grid->range / (float)((1u << grid->bits) - 1);
    return grid->single ? (double)((float)grid_point * step + grid->origin[axis])
                        : (double)grid->origin[axis] + grid->step * grid_point;
}

/* Rounds a coordinate to a dyadic grid, in doubles: single precision has no digit left for 24
 * bits. */
static inline uint32_t cwi_grid_round_dyadic(const cwi_quantization_grid *grid,
                                             float coordinate, int axis)
{
    const double max = (double)((1u << grid->bits) - 1);
    const double at = ((double)coordinate - (double)grid->origin[axis]) / grid->step + 0.5;
    return at <= 0 ? 0 : at >= max ? (uint32_t)max : (uint32_t)at;
}

/* Returns the position of a coordinate, counted from 0. */
static inline uint32_t cwi_grid_round(const cwi_quantization_grid *grid, float coordinate,
                                      int axis)
{
    return grid->dyadic ? cwi_grid_round_dyadic(grid, coordinate, axis)
                        : cwi_grid_round_even(grid, coordinate, axis);
}

/* Returns the position counted from the grid's middle: a signed number of the same bits. */
static inline int32_t cwi_grid_round_signed(const cwi_quantization_grid *grid, float coordinate,
                                            int axis)
{
    return (int32_t)cwi_grid_round(grid, coordinate, axis) - (1 << (grid->bits - 1));
}

static inline double cwi_grid_middle(const cwi_quantization_grid *grid, int axis)
{
    return (double)grid->origin[axis] + (double)(1 << (grid->bits - 1)) * grid->step;
}

/* Returns CW_ERR_ARGUMENT for an unknown compression, or bits that it does not have. */
CW_NODISCARD cw_status cwi_grid_check_bits(const cw_write_desc *desc, cw_error *err);

/* Lays the coarsest grid around the parts, of one origin, that keeps the tolerance and the
 * shape: where points that rounding would put onto each other go to places beside, if need be. With stated bits it
 * lays that grid, whatever the effect on the shape.
 * grid     bits 0: 24 bits are too few for meshopt and Draco, positions stay unchanged
 * parts    their positions are replaced, if points went to places beside
 * settled  set to the array that then holds the positions of all parts; free it after them with cwi_free(). NULL:
 *          they are as they were
 * facts    bits, step, error, settled and harm are filled in
 * Returns  CW_ERR_CHECK when there is none; CW_ERR_LIMIT for a box too large;
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_grid_choose(cwi_quantization_grid *grid, cwi_parts *parts,
                                       const cw_write_desc *desc, float **settled,
                                       cw_compressed *facts, cw_error *err);

/* Counts the harm over all meshes together. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_grid_measure(const cwi_quantization_grid *grid,
                                        const cwi_parts *parts, cwi_grid_harm *harm,
                                        cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
