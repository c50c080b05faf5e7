/* Colours of meshes: scalars of vertices from a volume, and colours from scalars. */
#ifndef CUBEWRIGHT_COLOR_H
#define CUBEWRIGHT_COLOR_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Maps from low to high values. */
typedef enum cw_colormap {
    CW_COLORMAP_VIRIDIS,   /* violet, green, yellow: even steps, also in grey */
    CW_COLORMAP_INFERNO,   /* black, red, yellow, white: the same */
    CW_COLORMAP_COOL_WARM, /* blue, grey, red: for values on both sides of a middle */
    CW_COLORMAP_GRAY,      /* black to white */
    CW_COLORMAP_COUNT
} cw_colormap;

/* Returns the name of a map, such as "cool-warm"; static. NULL for an unknown one.
 * map  any number */
CW_API const char *cw_colormap_name(cw_colormap map);

/* Computes a colour of a map.
 * map       an unknown one counts as CW_COLORMAP_VIRIDIS
 * fraction  of the range, from low to high; beyond 0 and 1 the ends, NaN: 0
 * rgb       sRGB */
CW_API void cw_colormap_color(cw_colormap map, double fraction, uint8_t rgb[3]);

/* Options of cw_mesh_sample(). Zero fields mean the default named beside them. */
typedef struct cw_sample_desc {
    uint32_t version;     /* 0: the first version of this struct */
    int threads;          /* default: all */
    cw_progress progress; /* default: none */
} cw_sample_desc;

/* Facts on sampled values. */
typedef struct cw_sample_facts {
    double low, high; /* of all vertices that have a value; 0 where none has */
    size_t missing;   /* vertices outside of the volume, or beside voxels without a value */
} cw_sample_facts;

/* Gives vertices the values of a volume as scalars: trilinear, at their world points. Any frame of
 * the volume does, as it maps to the world. Vertices up to half a voxel outside get the value of the
 * nearest point inside. Others outside, and those beside voxels without a
 * value, get the lowest value of the others; they are counted.
 *
 * mesh     its scalars are set in place, or added; unchanged on failure
 * volume   borrowed: its first component and step; of irregular grids values are linear in the
 *          tetrahedra into which cells are divided, so along edges as well
 * desc     borrowed; NULL means all defaults
 * facts    may be NULL
 * Returns  CW_ERR_ARGUMENT as cw_mesh_check(), cw_volume_resolve(); CW_ERR_UNSUPPORTED for sparse
 *          volumes; CW_ERR_EMPTY: no vertex has a value; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Threads  reentrant; the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_mesh_sample(cw_mesh *mesh, const cw_volume *volume,
                                             const cw_sample_desc *desc, cw_sample_facts *facts,
                                             cw_error *err);

/* Gives vertices the colours of their scalars.
 * mesh       has scalars; its colours are set in place, or added; unchanged on failure
 * map        a known one
 * low, high  values of the ends of the map; finite, and high above low, or equal: then all below
 *            and at low get its first colour, and all above its last
 * Returns    CW_ERR_ARGUMENT  no scalars; low or high as above; an unknown map; or as
 *                             cw_mesh_check()
 *            CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_color(cw_mesh *mesh, cw_colormap map, double low,
                                            double high, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
