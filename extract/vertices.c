/* Vertices and normals. Compiled for each engine.
 *
 * Crossed edges are listed until there are enough for arithmetic on many at a time; vertices of
 * volumes with no-data, beside NaN or infinite values and where the gradient vanishes are
 * computed one by one, and so are those on cubics. */
#include "core/volume.h"
#include "extract/cell_word.h"
#include "extract/crossing.h"
#include "extract/sink.h"

#include <float.h>
#include <math.h>
#include <string.h>

#if CWI_WIDE
#include <immintrin.h>
#endif

/* Lengths of gradients whose squares have lost nothing to overflow or underflow. */
#define LEAST 1e-280
#define MOST  1e280

enum { BATCH = 64, LANES = 8, ROOM = BATCH + 64 + 16, AHEAD = 3, TILE = 32 /* rows */ };

/* Crossed edges along one axis of a layer, until there are BATCH of them: where they begin, and
 * the numbers of their vertices. */
typedef struct cwi_edge_list {
    int axis;
    size_t k, count;
    int32_t i[ROOM], j[ROOM];
    uint32_t number[ROOM];
} cwi_edge_list;

/* Adds the edges at the bits of a word whose lowest stands at i. Several at a time, whether
 * there are so many or not: how many there are cannot be foreseen, and a wrong guess costs
 * more.
 */
static inline void list_edges(cwi_edge_list *l, uint64_t bits, size_t i, size_t j,
                              uint32_t number)
{
    size_t n = l->count;
    l->count += (size_t)__builtin_popcountll(bits);
#if CWI_WIDE
    const __m512i iota = _mm512_load_si512(cwi_iota);
    __m512i places = _mm512_maskz_compress_epi8(bits, iota);
    do {
        const __m512i wide = _mm512_cvtepu8_epi32(_mm512_castsi512_si128(places));
        const __m512i ranks = _mm512_cvtepu8_epi32(_mm512_castsi512_si128(iota));
        _mm512_storeu_si512(l->i + n, _mm512_add_epi32(wide, _mm512_set1_epi32((int)i)));
        _mm512_storeu_si512(l->j + n, _mm512_set1_epi32((int)j));
        _mm512_storeu_si512(l->number + n,
                            _mm512_add_epi32(ranks, _mm512_set1_epi32((int)number)));
        places = _mm512_alignr_epi64(places, places, 2);
        n += 16;
        number += 16;
    } while (n < l->count);
#else
    for (; bits; n += 4)
        for (size_t c = n; c < n + 4; c++) {
            l->i[c] = (int32_t)i + __builtin_ctzll(bits | UINT64_C(1) << 63);
            l->j[c] = (int32_t)j;
            l->number[c] = number++;
            bits &= bits - 1;
        }
#endif
}

/* Component r of vector n, at from[r * stride + n], to place number[n] of an array of vectors.
 */
static inline void scatter(const float *restrict from, size_t stride, const uint32_t *number,
                           size_t count, float *restrict to)
{
#if CWI_WIDE /* three at a time, by stores that leave a fourth place as it is */
    for (size_t n = 0; n < count; n += 4) {
        const __m128 x = _mm_loadu_ps(from + n), y = _mm_loadu_ps(from + stride + n),
                     z = _mm_loadu_ps(from + 2 * stride + n);
        const __m128 low = _mm_unpacklo_ps(x, y), high = _mm_unpackhi_ps(x, y);
        const __m128 vectors[4] = {_mm_shuffle_ps(low, z, 0x04), _mm_shuffle_ps(low, z, 0x5e),
                                   _mm_shuffle_ps(high, z, 0x24),
                                   _mm_shuffle_ps(high, z, 0x3e)};
        for (size_t c = 0; c < 4; c++)
            _mm_mask_storeu_ps(to + 3 * (size_t)number[n + c], n + c < count ? 7 : 0,
                               vectors[c]);
    }
#else
    for (size_t n = 0; n < count; n++)
        for (size_t r = 0; r < 3; r++)
            to[3 * (size_t)number[n] + r] = from[r * stride + n];
#endif
}

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

void cwi_write_vertices(const cwi_grid *g, size_t begin, size_t end, const cwi_row *rows,
                        cwi_vertex_sink *sink)
{
    static void (*const layers[CW_TYPE_COUNT])(const cwi_grid *, size_t, size_t,
                                               const cwi_row *, cwi_vertex_sink *) = {
        [CW_U8] = write_u8,   [CW_I8] = write_i8,   [CW_U16] = write_u16, [CW_I16] = write_i16,
        [CW_U32] = write_u32, [CW_I32] = write_i32, [CW_F32] = write_f32, [CW_F64] = write_f64,
    };
    layers[g->volume.type](g, begin, end, rows, sink);
}
