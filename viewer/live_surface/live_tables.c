/* Fills what the shaders read: the tables of cases, and the parameters of a surface. */
#include "viewer/live_surface/live_internal.h"

#include "core/base/status.h"
#include "core/cases/case_tables.h"
#include "core/geometry/affine.h"
#include "core/volume/surface_frame.h"
#include "core/volume/volume.h"

#include <float.h>
#include <math.h>
#include <string.h>

_Static_assert(CWI_LIVE_TABLE_WORDS == 256 + 8 * CWI_CASE_CONFIGS, "tables hold all of a cube");

/* A case: its first configuration, whether signs leave it open, its ambiguous faces, and its
 * triangles unless it is open. */
static uint32_t pack_case(unsigned cube)
{
    return (uint32_t)cwi_case_first_config[cube] | (uint32_t)cwi_case_is_ambiguous[cube] << 10 |
           (uint32_t)cwi_case_ambiguous_faces[cube] << 11 |
           (uint32_t)cwi_case_count[cube] << 17;
}

/* A configuration: its loops, their lengths, those that are cones, triangles and inner vertices;
 * the patches of corners; the loops' edges; the triangles' edges. */
static void pack_config(const cwi_config *c, uint32_t words[8])
{
    memset(words, 0, 8 * sizeof *words);
    words[0] =
        c->loop_count | (uint32_t)c->triangle_count << 23 | (uint32_t)c->vertex_count << 28;
    for (int l = 0; l < CWI_CASE_MAX_LOOPS; l++)
        words[0] |= (uint32_t)c->loop_length[l] << (3 + 4 * l) | (uint32_t)c->cone[l]
                                                                     << (19 + l);
    for (int n = 0; n < 8; n++)
        words[1] |= (uint32_t)c->patch[n] << (3 * n);
    for (int n = 0; n < 12; n++)
        words[2 + n / 8] |= (uint32_t)c->loop_edges[n] << (4 * (n % 8));
    for (int n = 0; n < 30; n++)
        words[4 + n / 8] |= (uint32_t)c->triangles[n] << (4 * (n % 8));
}

void cwi_live_fill_tables(uint32_t words[CWI_LIVE_TABLE_WORDS])
{
    for (unsigned cube = 0; cube < 256; cube++)
        words[cube] = pack_case(cube);
    for (size_t n = 0; n < CWI_CASE_CONFIGS; n++)
        pack_config(&cwi_configs[n], words + 256 + 8 * n);
}

/* Returns a float's bits as a number in the order of floats. */
static int32_t key_of_float(float x)
{
    int32_t bits;
    x = x == 0 ? 0 : x; /* no negative zero */
    memcpy(&bits, &x, sizeof bits);
    return bits >= 0 ? bits : bits ^ INT32_MAX;
}

/* Returns the number in the order of voxels, as shaders compare them. */
static int32_t key_of(cw_type type, double x)
{
    return type == CW_F32
               ? key_of_float((float)x)
               : (int32_t)(type == CW_U32 ? (int64_t)x - (INT64_C(1) << 31) : (int64_t)x);
}

static void type_range(cw_type type, double range[2])
{
    static const double ranges[CW_TYPE_COUNT][2] = {
        [CW_U8] = {0, UINT8_MAX},
        [CW_I8] = {INT8_MIN, INT8_MAX},
        [CW_U16] = {0, UINT16_MAX},
        [CW_I16] = {INT16_MIN, INT16_MAX},
        [CW_U32] = {0, UINT32_MAX},
        [CW_I32] = {INT32_MIN, INT32_MAX},
        [CW_F32] = {-(double)FLT_MAX, (double)FLT_MAX}};
    memcpy(range, ranges[type], sizeof ranges[type]);
}

/* Finds the smallest number of the type at the level, or above it if strict. Returns false if
 * there is none. */
static bool find_threshold(cw_type type, double level, bool strict, double *out)
{
    double range[2], t = level;
    type_range(type, range);
    if (type != CW_F32)
        t = strict ? floor(level) + 1 : ceil(level);
    if (t > range[1])
        return false;
    t = fmax(t, range[0]);
    if (type == CW_F32) {
        float v = (float)t;
        if ((double)v < level || (strict && (double)v <= level))
            v = nextafterf(v, INFINITY);
        t = (double)v;
    }
    *out = t;
    return true;
}

/* Returns true if voxels of the type can have this number. */
static bool has_number(cw_type type, double x)
{
    double range[2];
    type_range(type, range);
    if (type == CW_F32)
        return !isnan(x) && (isinf(x) || (x >= range[0] && x <= range[1])) &&
               (double)(float)x == x;
    return x >= range[0] && x <= range[1] && floor(x) == x;
}

static void fill_facts(const cwi_live *live, double level, bool strict, bool invert,
                       bool is_diagonal, int32_t *facts)
{
    const cw_volume *v = &live->key;
    double limit = 0;
    for (int a = 0; a < 3; a++) {
        facts[a] = (int32_t)v->dim[a];
        facts[3 + a] = (int32_t)live->blocks[a];
    }
    facts[7] = !find_threshold(v->type, level, strict, &limit);
    facts[6] = key_of(v->type, limit);
    facts[8] = invert;
    facts[9] = invert == strict;
    facts[10] = v->has_nodata && (live->has_gaps || !live->has_ranges);
    facts[18] = facts[10] && has_number(v->type, v->nodata);
    facts[11] = facts[18] ? key_of(v->type, v->nodata) : 0;
    facts[12] = cwi_affine_determinant(v->affine[0]) < 0;
    facts[13] = is_diagonal;
    facts[14] = (int32_t)live->slots;
    facts[15] = (int32_t)live->open_cells;
    facts[16] = CWI_LIVE_MENDED;
    facts[17] = (int32_t)live->block_count;
}

bool cwi_live_is_crossed(const cwi_live *live)
{
    const int32_t limit = live->params.facts[6];
    const bool none_above = live->params.facts[7];
    return !none_above && live->range[0] < limit && live->range[1] >= limit;
}

/* Levels between which no difference to a voxel is so small or so large that products of two
 * lose digits. */
#define LEVEL_MIN 1e-80
#define LEVEL_MAX 1e60

cw_status cwi_live_fill_params(const cwi_live *live, const cw_live_surface *desc,
                               cwi_live_params *params, cw_error *err)
{
    const cw_volume *v = &live->key;
    const double level = (desc->isovalue - v->intercept) / v->slope;
    const bool strict = v->slope < 0, invert = strict != desc->inside_is_low;
    cwi_surface_frame frame;
    memset(params, 0, sizeof *params);
    if (!isfinite(desc->isovalue) || !isfinite(level))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "isovalue %g is not finite, or not after slope %g and intercept %g",
                        desc->isovalue, v->slope, v->intercept);
    if (level != 0 && (fabs(level) < LEVEL_MIN || fabs(level) > LEVEL_MAX))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "OpenGL extracts at 0 and from %g to %g on either side, not at %g",
                        LEVEL_MIN, LEVEL_MAX, level);
    cwi_surface_frame_make(v, invert, &frame);
    params->numbers[0] = level;
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            params->numbers[1 + 3 * r + c] = v->affine[r][c];
            params->numbers[10 + 3 * r + c] = frame.cofactor[r][c];
        }
        params->numbers[19 + r] = frame.center[r];
    }
    params->numbers[22] = cwi_voxel_scale(v);
    memcpy(params->caps, frame.cap, sizeof frame.cap);
    fill_facts(live, level, strict, invert, frame.is_diagonal, params->facts);
    return CW_OK;
}
