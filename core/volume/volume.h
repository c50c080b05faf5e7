/* Internal access to volumes: single voxels of any type, coordinates, and parts of a volume. */
#ifndef CORE_VOLUME_VOLUME_H
#define CORE_VOLUME_VOLUME_H

#include <cubewright/volume.h>

#include <math.h>

/* Sizes of a sparse grid's leaf: voxels along a side, and in all. */
enum { CWI_LEAF = 8, CWI_LEAF_VOXELS = CWI_LEAF * CWI_LEAF * CWI_LEAF };

/* Returns the stored number at an address, without scaling; exact, as every type fits a
 * double. */
static inline double cwi_voxel_at(cw_type type, const void *p)
{
    switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        return (double)*(const ctype *)p;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        return 0;
    }
}

/* Stores a number that the type can hold; integers are rounded to the nearest. */
static inline void cwi_voxel_put(cw_type type, void *p, double value)
{
    switch (type) {
    case CW_F32:
        *(float *)p = (float)value;
        break;
    case CW_F64:
        *(double *)p = value;
        break;
#define CASE(name, ctype)                                                                      \
    case name:                                                                                 \
        *(ctype *)p = (ctype)rint(value);                                                      \
        break;
        CASE(CW_U8, uint8_t)
        CASE(CW_I8, int8_t)
        CASE(CW_U16, uint16_t)
        CASE(CW_I16, int16_t)
        CASE(CW_U32, uint32_t)
        CASE(CW_I32, int32_t)
#undef CASE
    default:
        break;
    }
}

/* Returns the whole number that a value stands for: it may differ by the rounding of a scale or of a
 * float. Other values, and those that are not finite, are returned as they are. */
static inline double cwi_whole_value(double value)
{
    const double whole = rint(value), size = fabs(value);
    const double rounding = fmin(fmax(1e-4, 1e-6 * size), 0.01);
    return fabs(value - whole) <= rounding ? whole : value;
}

/* Keeps every step-th voxel: changes sizes and affine; strides stay.
 * Returns CW_ERR_ARGUMENT as cw_volume_coarsen(). */
CW_NODISCARD cw_status cwi_volume_thin(cw_volume *volume, const size_t step[3], cw_error *err);

/* Reduces a volume's shape (sizes and affine) to the part inside a box; data are not touched.
 * Returns CW_ERR_ARGUMENT when the box is empty or leaves the volume. */
CW_NODISCARD cw_status cwi_volume_shrink(cw_volume *v, const cw_box *box, cw_error *err);

static inline bool cwi_is_rectilinear(const cw_volume *v)
{
    return v->coordinates[0] != NULL;
}

/* Returns the place of index i + share along an axis of at least 2: the coordinate, or the
 * index itself. Beyond the ends it is extrapolated from the last two. i: -1 to dim - 1 */
static inline double cwi_grid_coordinate(const cw_volume *v, int axis, ptrdiff_t i,
                                         double fraction)
{
    const double *at = v->coordinates[axis];
    const ptrdiff_t last = (ptrdiff_t)v->dim[axis] - 1;
    if (!at)
        return (double)i + fraction;
    const ptrdiff_t low = i < 0 ? 0 : i < last ? i : last - 1;
    return at[i < 0 ? 0 : i] + (i < 0 ? fraction - 1 : fraction) * (at[low + 1] - at[low]);
}

/* Returns the (fractional) index of a coordinate, the inverse of cwi_grid_coordinate(). */
double cwi_coordinate_index(const cw_volume *v, int axis, double coordinate);

/* Gives a copied volume coordinates of its own. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_volume_own_coordinates(cw_volume *v, cw_error *err);

/* Returns "a rectilinear grid", or another kind that is not evenly spaced; NULL for an even
 * one. */
const char *cwi_volume_kind(const cw_volume *v);

/* Fails with CW_ERR_UNSUPPORTED for calls that need evenly spaced grids, or dense grids (even
 * and rectilinear ones). */
CW_NODISCARD cw_status cwi_volume_expect_even(const cw_volume *v, const char *what,
                                              cw_error *err);
CW_NODISCARD cw_status cwi_volume_expect_dense(const cw_volume *v, const char *what,
                                               cw_error *err);

/* Fills in the defaults of a volume without data: the first component and step of a slice source's
 * shape, with packed slices. Returns CW_ERR_UNSUPPORTED, CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cwi_volume_resolve_shape(const cw_volume *shape, cw_volume *whole,
                                                cw_error *err);

static inline const void *cwi_voxel_address(const cw_volume *v, size_t i, size_t j, size_t k)
{
    return (const char *)v->data + (ptrdiff_t)i * v->stride[0] + (ptrdiff_t)j * v->stride[1] +
           (ptrdiff_t)k * v->stride[2];
}

#endif
