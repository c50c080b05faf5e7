/* Volumes: views of typed voxels, with a map from voxel indices to the world; statistics of
 * values. */
#ifndef CUBEWRIGHT_VOLUME_H
#define CUBEWRIGHT_VOLUME_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One row per voxel type: constant, C type, name in files and on the command line. */
#define CW_TYPE_TABLE(X)                                                                       \
    X(CW_U8, uint8_t, "u8")                                                                    \
    X(CW_I8, int8_t, "i8")                                                                     \
    X(CW_U16, uint16_t, "u16")                                                                 \
    X(CW_I16, int16_t, "i16")                                                                  \
    X(CW_U32, uint32_t, "u32")                                                                 \
    X(CW_I32, int32_t, "i32")                                                                  \
    X(CW_F32, float, "f32")                                                                    \
    X(CW_F64, double, "f64")

/* The types of voxels. */
typedef enum cw_type {
#define CW_TYPE_ENUM(name, ctype, text) name,
    CW_TYPE_TABLE(CW_TYPE_ENUM)
#undef CW_TYPE_ENUM
        CW_TYPE_COUNT
} cw_type;

/* Properties that the file stated: unit, frame, kind of values. The affine is always in LPS
 * millimetres. Where the file states nothing, numbers are taken as millimetres and axes as LPS;
 * the flag is then unset. */
typedef enum cw_known {
    CW_KNOWN_UNIT = 1,
    CW_KNOWN_FRAME = 2,
    CW_KNOWN_LEVEL_SET = 4,  /* values are distances from the surface at 0, negative inside */
    CW_KNOWN_LABELS = 8,     /* values are the numbers of labels */
    CW_KNOWN_HOUNSFIELD = 16 /* values of a CT are in Hounsfield units */
} cw_known;

/* Cells of an irregular grid; their corners are numbered as VTK's cells of that name. */
typedef enum cw_shape {
    CW_TETRAHEDRON, /* three corners, then one that sees them run counter-clockwise */
    CW_PYRAMID,     /* four around its base, then the tip */
    CW_WEDGE,       /* three, then the three opposite */
    CW_HEXAHEDRON,  /* four around its base, then the four above them */
    CW_SHAPE_COUNT
} cw_shape;

/* An irregular grid: samples that stand anywhere, and the cells between them. */
typedef struct cw_cells {
    const double *points;    /* 3 a sample */
    size_t count;            /* number of cells */
    const uint8_t *shapes;   /* cw_shape, one per cell */
    const uint32_t *corners; /* indices of samples, cell after cell: 4, 5, 6 or 8 each */
} cw_cells;

/* A box of voxels with one value. All its sizes and places count in leaves. */
typedef struct cw_tile {
    uint32_t at[3], size[3]; /* its first leaf; number of leaves along each axis */
    double value;            /* as stored, before slope and intercept */
} cw_tile;

/* A sparse grid: voxels are stored in blocks ("leaves") of 8 x 8 x 8, regions of one value in
 * tiles. All other voxels, also beyond dim, have the background's value. No voxel is stored
 * twice. */
typedef struct cw_sparse {
    size_t leaf_count;           /* number of leaves */
    const uint32_t (*leaves)[3]; /* the voxels of leaf n are data + n * 512 voxels, x fastest;
                                    the first of them is voxel 8 * leaves[n] */
    size_t tile_count;           /* number of tiles */
    const cw_tile *tiles;        /* in any order */
    double background;           /* as stored */
} cw_sparse;

/* A view of voxels. A zeroed struct is a valid empty volume; fields left zero mean the default
 * named beside them. Copying the struct copies the view, not the voxels.
 *
 * The voxel (i, j, k) of component c at time step t stands at
 *     data + i stride[0] + j stride[1] + k stride[2] + c component_stride + t step_stride
 * and stands for the value  slope * voxel + intercept  at the world point  affine * (i j k 1),
 * on a rectilinear grid at  affine * (coordinates[0][i] coordinates[1][j] coordinates[2][k] 1).
 * On an irregular grid dim is {samples, 1, 1}, and sample n stands at  affine * (point n, 1).
 * On a sparse grid dim is a box around all leaves and tiles, and strides are those in
 * a leaf. */
typedef struct cw_volume {
    const void *data;             /* first voxel; aligned for its type, native byte order */
    cw_type type;                 /* default CW_U8 */
    size_t dim[3];                /* voxels along x, y, z; x varies fastest in packed data */
    ptrdiff_t stride[3];          /* bytes from voxel to voxel; all 0: packed */
    size_t components;            /* values per voxel (vectors, colours); 0 means 1 */
    ptrdiff_t component_stride;   /* bytes; 0: interleaved before x in packed data */
    size_t steps;                 /* time steps; 0 means 1 */
    ptrdiff_t step_stride;        /* bytes; 0: one packed volume after another */
    double step_seconds;          /* time between steps; 0: unknown */
    double affine[3][4];          /* index to world, LPS millimetres; all 0: identity */
    const double *coordinates[3]; /* dim[0], dim[1], dim[2] rising values: places of planes of
                                     samples, instead of their index. All three, or NULL */
    const cw_cells *cells;        /* an irregular grid's; else NULL */
    const cw_sparse *sparse;      /* a sparse grid's; else NULL */
    double slope, intercept;      /* value = slope * voxel + intercept; slope 0 means 1 */
    bool has_nodata;     /* voxels equal to nodata, before scaling, are outside the domain */
    double nodata;       /* only with has_nodata */
    unsigned known;      /* cw_known flags */
    double said_unit_mm; /* the file's own unit before conversion to mm; 0: mm */
    bool said_ras;       /* true if the file's own x and y went to the right and the
                                 front */
    void *owned, *owned_grid; /* memory freed by cw_volume_free(), of voxels and of coordinates,
                                 cells or leaves; NULL for a borrowed view */
} cw_volume;

/* An index box: first voxel and number of voxels along each axis. */
typedef struct cw_box {
    size_t first[3]; /* index of the first voxel */
    size_t count[3]; /* number of voxels */
} cw_box;

/* Returns the bytes of a voxel of a type; 0 for an unknown type. */
CW_API size_t cw_type_size(cw_type type);

/* Returns the name of a type, such as "i16"; static. */
CW_API const char *cw_type_name(cw_type type);

/* Makes a volume that owns zeroed, packed voxels: dim, components and steps as given (both 0
 * mean 1), identity affine. Write the voxels through cw_volume_voxels().
 * dim                voxels along x, y, z
 * components, steps  values per voxel, time steps; 0 means 1
 * Returns            CW_ERR_ARGUMENT for a zero dim, CW_ERR_LIMIT when the size overflows,
 * CW_ERR_NO_MEMORY. */
CW_NODISCARD CW_API cw_status cw_volume_alloc(cw_volume *volume, cw_type type,
                                              const size_t dim[3], size_t components,
                                              size_t steps, cw_error *err);

/* Frees what the volume owns and zeroes it. Harmless on a zeroed or already freed volume. */
CW_API void cw_volume_free(cw_volume *volume);

/* Returns the owned voxels, for writing; NULL for a borrowed view.
 * volume  a volume that owns its voxels */
CW_API void *cw_volume_voxels(cw_volume *volume);

/* Copies *in to *out with every defaulted field filled in, so that other functions need no
 * special cases. Borrowed like *in: free only one of them.
 * Returns CW_ERR_ARGUMENT for an unknown type, a zero dim, a missing pointer, an affine or
 * scaling that is not finite or cannot be inverted, strides that break the type's alignment,
 * coordinates that do not rise or are not all there, more than one of coordinates, cells and
 * leaves. Corners of cells and places of leaves are checked where they are used. */
CW_NODISCARD CW_API cw_status cw_volume_resolve(const cw_volume *in, cw_volume *out,
                                                cw_error *err);

/* Makes a borrowed view of one component at one time step.
 * component, step  from 0
 * Returns          CW_ERR_ARGUMENT when it does not exist. */
CW_NODISCARD CW_API cw_status cw_volume_select(const cw_volume *in, size_t component,
                                               size_t step, cw_volume *out, cw_error *err);

/* Computes the length of each voxel's vector of components, at one time step. It is the root of
 * the sum of their squares, scaled, computed in double precision and stored as CW_F32. NaN
 * where a component has no value.
 *
 * step     from 0
 * out      owns its voxels, and borrows coordinates or cells of *in; free it before *in
 * Returns  CW_ERR_ARGUMENT  no such step, or one component; as cw_volume_resolve()
 *          CW_ERR_UNSUPPORTED on a sparse grid; CW_ERR_LIMIT; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_volume_magnitude(const cw_volume *in, size_t step, int threads,
                                                  cw_volume *out, cw_error *err);

enum { CW_LABELS_MAX = 255 }; /* maximum number of values that are listed */

/* Labels of a volume: whole numbers that stand for objects, not for amounts. */
typedef struct cw_labels {
    bool found;                  /* CW_KNOWN_LABELS, or values that look like labels */
    bool more;                   /* more values exist than are listed */
    bool scattered;              /* amounts rather than labels: more than 32 values, and fewer
                                    than half of the neighbours that `found` looks at are equal */
    size_t count;                /* number of values; at most CW_LABELS_MAX */
    double value[CW_LABELS_MAX]; /* rising: the lowest of all voxels' values */
} cw_labels;

/* Finds if the first component and step holds labels. A volume with CW_KNOWN_LABELS does. The
 * values of another one must meet three conditions. They are whole numbers from 0, in any type, and at least three. Of neighbours along x that are not both the most frequent value, 7 in 10 are equal.
 * Of those that differ, 2 in 10 skip a value that occurs. A smooth picture skips none, and a
 * noisy one has no equal neighbours. For this, at most 2^22 voxels are examined, in rows spread
 * evenly. Of a label map, all voxels are then passed over for their values.
 * out      filled on success
 * Returns  CW_ERR_ARGUMENT as cw_volume_resolve(). */
CW_NODISCARD CW_API cw_status cw_volume_labels(const cw_volume *volume, cw_labels *out,
                                               cw_error *err);

/* Makes a borrowed view of the voxels inside a box; its affine leaves them where they were.
 * box      borrowed
 * Returns  CW_ERR_ARGUMENT when the box is empty or leaves the volume. */
CW_NODISCARD CW_API cw_status cw_volume_crop(const cw_volume *in, const cw_box *box,
                                             cw_volume *out, cw_error *err);

/* Makes a borrowed view of every step[a]-th voxel along axis a, starting with the first, for a
 * quick look. Each voxel stays where it was. Values are picked, not averaged. Up to step[a] - 1
 * voxels at the far end are beyond the view.
 * step     1 or more along each axis
 * Returns  CW_ERR_ARGUMENT for a step of 0, for a step other than 1 that leaves a single
 *          voxel (at most dim[a] - 1 is allowed), and when the affine leaves the range of
 *          doubles; CW_ERR_UNSUPPORTED on a rectilinear grid. */
CW_NODISCARD CW_API cw_status cw_volume_coarsen(const cw_volume *in, const size_t step[3],
                                                cw_volume *out, cw_error *err);

/* Copies the voxels in the box around the leaves and tiles of a sparse grid into a dense one.
 *
 * sparse      borrowed
 * max_voxels  in the box, at most
 * dense       filled on success, emptied on failure; free it with cw_volume_free()
 * Returns     CW_ERR_ARGUMENT  the grid is not sparse
 *             CW_ERR_LIMIT     the box has more voxels; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_volume_densify(const cw_volume *sparse, size_t max_voxels,
                                                cw_volume *dense, cw_error *err);

/* Returns the (scaled) value of one voxel of the first component and step; slow, for tests and
 * probes. NaN outside the volume, and on a sparse grid.
 * i, j, k  the index */
CW_API double cw_volume_value(const cw_volume *volume, size_t i, size_t j, size_t k);

/* Computes the world point of a (fractional) index.
 * index  place in voxels, from the middle of the first
 * world  set to the point, LPS millimetres */
CW_API void cw_volume_to_world(const cw_volume *volume, const double index[3], double world[3]);

/* Computes the millimetres between neighbours along each axis; on a rectilinear grid their mean.
 * spacing_mm  set to them */
CW_API void cw_volume_spacing(const cw_volume *volume, double spacing_mm[3]);

/* Computes the world positions of the corners of a volume that has samples. Corner n has the
 * last index along axis a where n >> a & 1, else the first. The corners of an irregular grid
 * are those of the smallest axis-aligned box around its samples.
 * corners  set to eight world points */
CW_API void cw_volume_corners(const cw_volume *volume, double corners[8][3]);

/* Computes the (fractional) index of a world point.
 * index    set to the index
 * Returns  CW_ERR_ARGUMENT when the affine cannot be inverted. */
CW_NODISCARD CW_API cw_status cw_volume_to_index(const cw_volume *volume, const double world[3],
                                                 double index[3], cw_error *err);

/* Returns the (scaled) value at a world point of an even or rectilinear grid, of the first
 * component and step. It is trilinear between the voxels around. For probes. NaN outside, where
 * one of those voxels has no value, and on other grids. An axis of one voxel reaches half a
 * voxel to both sides. */
CW_API double cw_volume_sample(const cw_volume *volume, const double world[3]);

/* Statistics of the values: range and frequencies. */
typedef struct cw_statistics {
    double min, max;   /* over finite values inside the domain; both 0 when there are none */
    size_t finite;     /* values counted in the range */
    size_t not_finite; /* NaN and infinite values */
    size_t nodata;     /* voxels outside the domain */
    double quantum;   /* step between neighbouring values of an integer type; 0: a float type */
    size_t bin_count; /* bins asked for; for integer types never more than there are values */
    double bin_width; /* bin b holds min + b * bin_width <= value < min + (b+1) * bin_width */
    uint64_t *bins;   /* bin_count counts; the last bin holds max too */
} cw_statistics;

/* Counts the values of the first component and step into bin_count bins (0: range only). On a
 * sparse grid only values in leaves are counted.
 * threads  0 means all
 * Returns  CW_ERR_ARGUMENT as cw_volume_resolve(); CW_ERR_NO_MEMORY; free with
 *          cw_statistics_free(). The result is the same for any number of threads. */
CW_NODISCARD CW_API cw_status cw_volume_statistics(const cw_volume *volume, size_t bin_count,
                                                   int threads, cw_statistics *out,
                                                   cw_error *err);

/* Frees the bins and zeroes the struct. Harmless on a zeroed or already freed one. */
CW_API void cw_statistics_free(cw_statistics *statistics);

/* Joins the statistics of several volumes, such as the steps of a series, into bin_count bins
 * over the range of all. A bin's values count where its middle is.
 * parts    count of them; borrowed, and apart from out
 * Returns  CW_ERR_NO_MEMORY; free out with cw_statistics_free() */
CW_NODISCARD CW_API cw_status cw_statistics_join(const cw_statistics *parts, size_t count,
                                                 size_t bin_count, cw_statistics *out,
                                                 cw_error *err);

/* Finds the levels that separate the histogram into level_count + 1 classes (level_count is 1
 * to 3) with the largest variance between classes: [Otsu1979], and [Liao2001] for more than one
 * level.
 * Returns false when the histogram has too few filled bins.
 * statistics   borrowed, with bins
 * level_count  1 to 3
 * levels       set to level_count values, rising */
CW_API bool cw_statistics_otsu(const cw_statistics *statistics, int level_count,
                               double *levels);

/* Finds the isovalue that a name stands for, rounded to six digits: the level that the command's
 * --iso and `info` find.
 * name     "otsu", between two classes of values; "dark", "medium" or "bright", between four;
 *          "50%" or another share of the range of the values; "bone", "skin", "soft", "lung" or
 *          "metal" of a CT in Hounsfield units
 * threads  0 means all
 * level    set to the isovalue
 * Returns  CW_ERR_ARGUMENT for another name, and for a tissue where values are not in Hounsfield
 *          units; CW_ERR_EMPTY where no value is finite or no level parts them; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_volume_level(const cw_volume *volume, const char *name,
                                              int threads, double *level, cw_error *err);

/* The same, by statistics that were made before.
 * statistics  of the volume, with 512 bins for the levels of the command
 * volume      borrowed; its voxels are not read
 * name        as of cw_volume_level()
 * level       set to the isovalue
 * Returns     as cw_volume_level() */
CW_NODISCARD CW_API cw_status cw_statistics_level(const cw_statistics *statistics,
                                                  const cw_volume *volume, const char *name,
                                                  double *level, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
