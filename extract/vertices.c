/* Vertices and normals. Compiled for each engine.
 *
 * Vertices are collected, with the samples they need, until there are enough for arithmetic on
 * many at a time; those of volumes with no-data, beside NaN or infinite values and where the
 * gradient vanishes are computed one by one. */
#include "core/volume.h"
#include "extract/crossing.h"
#include "extract/crossings.h"
#include "extract/engine.h"
#include "extract/sink.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Lengths of gradients whose squares have lost nothing to overflow or underflow. */
#define LEAST 1e-280
#define MOST  1e280

enum { BATCH = 32, LANES = 8, AHEAD = 3 /* rows */ };

/* The vertex between the volume's last sample along an axis and the padding. */
static void store_cap(const cwi_vertex_sink *sink, const size_t at[3], int axis, size_t n)
{
    const bool high = at[axis] > 0;
    double x[3] = {0, 0, 0};
    x[axis] = high ? CWI_NUDGE : 1 - CWI_NUDGE;
    cwi_store_position(sink, at, x, n);
    if (sink->normals)
        memcpy(sink->normals + 3 * n, sink->cap[axis][high], sizeof sink->cap[axis][high]);
}

#define TYPED "extract/vertices.inc"
#include "extract/types.inc"

void cwi_write_vertices(const cwi_grid *g, size_t k, const cwi_row *rows, cwi_vertex_sink *sink)
{
    static void (*const layers[CW_TYPE_COUNT])(const cwi_grid *, size_t, const cwi_row *,
                                               cwi_vertex_sink *) = {
        [CW_U8] = write_u8,   [CW_I8] = write_i8,   [CW_U16] = write_u16, [CW_I16] = write_i16,
        [CW_U32] = write_u32, [CW_I32] = write_i32, [CW_F32] = write_f32, [CW_F64] = write_f64,
    };
    layers[g->volume.type](g, k, rows, sink);
}
