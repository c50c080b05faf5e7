/* The interface of the module "draco": plain C functions around Draco. */
#ifndef FORMATS_CODEC_DRACO_WRAP_H
#define FORMATS_CODEC_DRACO_WRAP_H

#include "formats/codec/quantization_grid.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_DRACO_COMMENT = 256 };

/* The arrays of one mesh; missing ones are NULL. A zeroed one is empty. */
typedef struct cwi_arrays {
    size_t vertex_count, triangle_count;
    float *positions;                /* vertex_count x 3 */
    uint32_t *grid_points;           /* vertex_count x 3: positions as positions on a grid */
    float *normals;                  /* vertex_count x 3 */
    uint8_t *colors;                 /* vertex_count x 4, linear */
    float *texture;                  /* vertex_count x 2: texture coordinates */
    float *tangents;                 /* vertex_count x 4, with the sign of the bitangent */
    uint32_t *triangles;             /* triangle_count x 3 */
    char comment[CWI_DRACO_COMMENT]; /* left by our own writer; empty: none */
} cwi_arrays;

/* Frees the arrays that a decoder has made, with cwi_free(). */
void cwi_arrays_free(cwi_arrays *arrays);

/* Draco's numbers of attributes; -1: missing. */
typedef struct cwi_draco_ids {
    int position, normal, color, texture, tangent;
} cwi_draco_ids;

typedef struct cwi_draco_settings {
    cwi_quantization_grid grid; /* for positions; of 0 bits: they stay floats */
    int normal_bits;            /* of each of two octahedral coordinates */
    int texture_bits;           /* of each of two texture coordinates */
    int tangent_bits;           /* of each of four numbers of a tangent */
    int level;                  /* 0 (fast) to 10 (small) */
    const char *comment;        /* of the file, kept as metadata; NULL: none */
} cwi_draco_settings;

typedef struct cwi_draco_functions {
    /* Encodes by edgebreaker. The bytes are freed with cwi_free(). Arrays with positions and no
     * positions have them as integers of 32 bits, without a grid. */
    cw_status (*encode)(const cwi_arrays *arrays, const cwi_draco_settings *settings,
                        unsigned char **bytes, size_t *size, cwi_draco_ids *ids, cw_error *err);

    /* Decodes the attributes that ids name; NULL: the first of each kind. Indices are below the
     * vertex count for any input. More than `max` vertices or triangles are CW_ERR_LIMIT,
     * damage is CW_ERR_FORMAT. grid: NULL gives positions as floats. Otherwise they stay positions
     * on this grid, on which they were encoded; CW_ERR_CHECK: it was another grid. */
    cw_status (*decode)(const void *bytes, size_t size, const cwi_draco_ids *ids, size_t max,
                        const cwi_quantization_grid *grid, cwi_arrays *arrays, cw_error *err);
} cwi_draco_functions;

/* Loads the module. Returns CW_ERR_UNSUPPORTED if it is not in this build. */
CW_NODISCARD cw_status cwi_draco_functions_load(const cwi_draco_functions **functions,
                                                cw_error *err);

extern CW_API const cwi_draco_functions cwi_module_draco;

#ifdef __cplusplus
}
#endif

#endif
