/* Transfer functions: maps from a value to the colour and the opacity with which it is
 * shown. */
#ifndef CUBEWRIGHT_TRANSFER_H
#define CUBEWRIGHT_TRANSFER_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CW_TRANSFER_POINTS = 64 }; /* maximum number of points of each kind */

/* A colour (sRGB, 0 to 1) and an opacity (0 to 1) at a value, in the unit of the voxels. */
typedef struct cw_color_point {
    double value;   /* in the unit of the voxels */
    float color[3]; /* sRGB */
} cw_color_point;

/* An opacity at a value; a factor at a length of the gradient. */
typedef struct cw_opacity_point {
    double value;  /* in the unit of the voxels */
    float opacity; /* 0 to 1 */
} cw_opacity_point;

/* An index at a value: a number that stands for the material there, such as its density. */
typedef struct cw_index_point {
    double value; /* in the unit of the voxels */
    float index;  /* any finite number */
} cw_index_point;

/* A transfer function: linear between points, constant beyond the ends. The values of the
 * points never decrease. Two points at one value are a jump; the value itself belongs to the
 * side above. No colours: white; no opacities: fully transparent; no gradients: 1 everywhere.
 *
 * Opacity o is the opacity of a path of unit_mm through that value. The extinction coefficient
 * is -ln(1 - o) / unit_mm, and o is limited to 1 - 1e-6. The default of unit_mm is the smallest
 * of the three mean spacings on a rectilinear grid. On an irregular one it is the edge of the
 * mean cell: a cube with the mean volume of hexahedra, where a wedge counts as 1/2 of one, a
 * pyramid as 1/3 and a tetrahedron as 1/6.
 *
 * With indices, surfaces are where the index changes [Drebin1988]: light, and the factor of
 * gradients, use the gradient of the index at voxels instead of that of the value. The strength
 * of a surface is the length of that gradient times surface_mm, at most 1. Diffuse and specular
 * reflection are multiplied by it, so that the inside of a material has ambient light only. */
typedef struct cw_transfer {
    size_t color_count, opacity_count, gradient_count, index_count; /* numbers of points */
    cw_color_point colors[CW_TRANSFER_POINTS];                      /* default: white */
    cw_opacity_point opacities[CW_TRANSFER_POINTS];                 /* default: transparent */
    cw_opacity_point gradients[CW_TRANSFER_POINTS]; /* value: length of the gradient, per mm, or
                                                       with indices the strength of the surface;
                                                       opacity: a factor of the extinction
                                                       coefficient */
    cw_index_point indices[CW_TRANSFER_POINTS];     /* default: no surfaces of materials */
    double surface_mm; /* the width over which an index changes by 1 at a surface of full
                          strength; default: twice the volume's smallest spacing */
    double unit_mm;    /* default: the volume's smallest spacing */
} cw_transfer;

/* Checks a transfer function. Returns CW_ERR_ARGUMENT, naming the point, for values that
 * decrease or are not finite, for colours and opacities outside of 0 to 1, for indices that are
 * not finite, for too many points, and for a unit_mm or surface_mm that is not a length. */
CW_NODISCARD CW_API cw_status cw_transfer_check(const cw_transfer *transfer, cw_error *err);

/* Computes the colour and opacity of a value.
 * color    set to sRGB, 0 to 1
 * opacity  set to 0 to 1 */
CW_API void cw_transfer_at(const cw_transfer *transfer, double value, double color[3],
                           double *opacity);

/* Returns the factor of a gradient's length.
 * gradient_per_mm  length of the gradient; with indices, strength of the surface */
CW_API double cw_transfer_gradient_factor(const cw_transfer *transfer, double gradient_per_mm);

/* Returns the index of a value; the value itself without indices. */
CW_API double cw_transfer_index(const cw_transfer *transfer, double value);

enum { CW_MAX_MATERIALS = 8 }; /* maximum of cw_transfer_set_materials() */

/* A material as a class of values [Drebin1988]. The fraction of it rises from 0 at values[0] to
 * 1 at values[1], and falls from 1 at values[2] to 0 at values[3]; in between it is linear. The
 * first two may be -INFINITY, the last two INFINITY: there is no end on that side. */
typedef struct cw_material_class {
    double values[4]; /* never decreasing */
    float color[3];   /* sRGB, 0 to 1 */
    float opacity;    /* of the pure material, 0 to 1 */
    float index;      /* where it changes there is a surface */
} cw_material_class;

/* Computes colours, opacities and indices of a transfer function from classes of materials, and
 * leaves its other fields. In a mixture, opacities and indices are weighted by the fractions, and
 * colours by fractions times opacities, as sheets of the materials on top of each other would
 * be. Fractions whose sum is above 1 are divided by it; where it is below 1 the rest is clear,
 * with index 0. Curves that are not linear are kept to 1/512, or as exactly as
 * CW_TRANSFER_POINTS allow.
 * materials  count of them, borrowed
 * count      1 to CW_MAX_MATERIALS
 * Returns    CW_ERR_ARGUMENT, naming the material, for values that decrease or are not numbers,
 *            no finite value at all, and colours, opacities and indices out of range */
CW_NODISCARD CW_API cw_status cw_transfer_set_materials(cw_transfer *transfer,
                                                        const cw_material_class *materials,
                                                        size_t count, cw_error *err);

/* Returns the name of the n-th preset, or its description; NULL after the last. */
CW_API const char *cw_transfer_preset_name(size_t n);
CW_API const char *cw_transfer_preset_about(size_t n);

/* Makes a preset. Those of CT are in Hounsfield units; others are fitted to the values.
 * statistics  of the volume, with 256 bins or more; borrowed
 * Returns CW_ERR_ARGUMENT for an unknown name, with the existing names. */
CW_NODISCARD CW_API cw_status cw_transfer_preset(const char *name,
                                                 const cw_statistics *statistics,
                                                 cw_transfer *transfer, cw_error *err);

/* Finds the box, along the world's axes, of what a transfer function shows of a volume: a thing
 * in a large volume can then be framed. A thousandth of the opacity may be outside at each end
 * of an axis, so that specks do not count. If nothing is visible it is the box of all samples.
 *
 * volume     borrowed; evenly spaced
 * low, high  corners, LPS millimetres
 * Returns    CW_ERR_ARGUMENT as cw_transfer_check(), cw_volume_resolve(); CW_ERR_UNSUPPORTED for
 *            other volumes; CW_ERR_NO_MEMORY
 * Cost       a pass over the voxels; of more than 2^24, over evenly chosen rows */
CW_NODISCARD CW_API cw_status cw_transfer_box(const cw_volume *volume,
                                              const cw_transfer *transfer, int threads,
                                              double low[3], double high[3], cw_error *err);

enum { CW_TRANSFER_TEXT = 20480 }; /* bytes that the text of one takes at most */

/* Reads or writes a transfer function as JSON, in a file or as text:
 *     {"schema": "cubewright-transfer-1", "unit_mm": 1,
 *      "colors": [[-1000, "#000000"], [300, "#ffeedd"]],
 *      "opacities": [[100, 0], [300, 0.5]], "gradients": [[0, 0], [40, 1]],
 *      "indices": [[100, 0], [300, 1]], "surface_mm": 2}
 * Instead of colours, opacities and indices a file may have classes of materials, as
 * cw_transfer_set_materials(); null is an open end:
 *     "materials": [{"name": "fat", "values": [-300, -150, -70, -10], "color": "#ffd27f",
 *                    "opacity": 0.02, "index": 1}, ...]
 * They are written as the curves that they make. Values are read back to the bit; colours are kept in steps of 1/255.
 * text     as in a file; when written, at most CW_TRANSFER_TEXT bytes with the final 0
 * Returns  CW_ERR_IO; CW_ERR_FORMAT, with the line or the field that is wrong; CW_ERR_OUTPUT;
 *          CW_ERR_ARGUMENT as cw_transfer_check() */
CW_NODISCARD CW_API cw_status cw_transfer_read(const char *path, cw_transfer *transfer,
                                               cw_error *err);
CW_NODISCARD CW_API cw_status cw_transfer_write(const char *path, const cw_transfer *transfer,
                                                cw_error *err);
CW_NODISCARD CW_API cw_status cw_transfer_parse(const char *text, cw_transfer *transfer,
                                                cw_error *err);
CW_NODISCARD CW_API cw_status cw_transfer_format(const cw_transfer *transfer,
                                                 char text[CW_TRANSFER_TEXT], cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
