/* Places vertices on crossed edges, and computes their normals. Compiled for each engine.
 *
 * Crossed edges are listed until there are enough for arithmetic on many at a time; vertices
 * beside no-data, NaN or infinite values and where the gradient vanishes are computed one by
 * one. */
#include "core/volume/volume.h"
#include "extract/dense/cell_word.h"
#include "extract/dense/cubic_crossing.h"
#include "extract/dense/vertex_writer.h"

#include <float.h>
#include <string.h>
#include <tgmath.h>

#ifdef __SSE4_1__
#include <immintrin.h>
#endif

/* Functions that are compiled once for each axis, and those that need all registers. */
#define ALWAYS_INLINE __attribute__((always_inline)) static inline
#define NEVER_INLINE  __attribute__((noinline)) static

/* Limits for lengths of gradients, between which squares neither overflow nor underflow. */
#define MINIMUM 1e-280
#define MAXIMUM 1e280

enum {
    BATCH = 128, /* edges; arithmetic is on LANES at a time */
    LANES = 16,
    CAPACITY = BATCH + 64 + LANES,
    AHEAD = 3, /* rows by which samples are prefetched, */
    DENSE = 2, /* in rows with more vertices a word than this */
    FAR = 512, /* numbers that memory is prefetched for before they are written */
    TILE = 32  /* rows that are finished in all layers before the next rows */
};

/* Kinds of edges, listed apart: with all samples around them, at the volume's border, and
 * between its last sample along an axis and the padding. */
enum { INNER, OUTER, CAP, KINDS };

/* Neighbouring edges of a row: their vertices are numbered one after another. */
typedef struct cwi_run {
    size_t begin; /* in the list */
    size_t j;
    uint32_t number; /* of the first vertex */
} cwi_run;

/* Crossed edges along one axis of a layer, up to BATCH of them, by the samples where they
 * begin. */
typedef struct cwi_edge_list {
    int axis;
    size_t k, count, runs;
    bool few; /* few vertices in a row: nothing was prefetched for them */
    _Alignas(64) int32_t i[CAPACITY], j[CAPACITY];
    cwi_run run[CAPACITY + 1];
} cwi_edge_list;

/* Begins a run: edges listed from now on are in row j, and their vertices are numbered from
 * `number` on. */
static inline void begin_run(cwi_edge_list *l, size_t j, uint32_t number)
{
    if (!l->runs || l->run[l->runs - 1].begin < l->count)
        l->runs++;
    l->run[l->runs - 1] = (cwi_run){l->count, j, number};
}

/* Returns the number of the vertex on the next edge that is listed in this run. */
static inline uint32_t next_number(const cwi_edge_list *l)
{
    const cwi_run *last = &l->run[l->runs - 1];
    return last->number + (uint32_t)(l->count - last->begin);
}

/* Empties the list; its last run continues. */
static inline void clear_list(cwi_edge_list *l)
{
    if (!l->count)
        return;
    l->run[0] = (cwi_run){0, l->run[l->runs - 1].j, next_number(l)};
    l->runs = 1;
    l->count = 0;
}

/* Adds the edges at the bits of a word of row j, whose lowest bit stands at i. It writes
 * several at a time, even where there are fewer: their number cannot be predicted, and a wrong
 * guess costs more. */
static inline void list_edges(cwi_edge_list *l, uint64_t bits, size_t i, size_t j)
{
    int32_t *to_i = l->i + l->count, *to_j = l->j + l->count;
    const int count = __builtin_popcountll(bits);
    l->count += (size_t)count;
#if CWI_WIDE
    if (__builtin_expect(count <= 8, 1)) {
        const __m512i bit_numbers =
            _mm512_maskz_compress_epi8(bits, _mm512_load_si512(cwi_iota));
        const __m256i wide = _mm256_cvtepu8_epi32(_mm512_castsi512_si128(bit_numbers));
        _mm256_storeu_si256((__m256i *)(void *)to_i,
                            _mm256_add_epi32(wide, _mm256_set1_epi32((int)i)));
        _mm256_storeu_si256((__m256i *)(void *)to_j, _mm256_set1_epi32((int)j));
        return;
    }
#endif
    do {
        for (int c = 0; c < 4; c++, bits &= bits - 1) {
            to_i[c] = (int32_t)(i + cwi_lowest(bits));
            to_j[c] = (int32_t)j;
        }
        to_i += 4;
        to_j += 4;
    } while (bits);
}

/* Returns where the edges of run r end in the list. */
static inline size_t end_of_run(const cwi_edge_list *l, size_t r)
{
    return r + 1 < l->runs ? l->run[r + 1].begin : l->count;
}

/* Returns the number of edges, rounded up to whole vectors. */
static inline size_t lanes_of(const cwi_edge_list *l)
{
    return (l->count + LANES - 1) / LANES * LANES;
}

/* Copies the vectors of a few vertices; a call of memcpy would cost too much. Up to 15 more
 * numbers may be read. The memory behind them, where the next vertices will be written, is
 * prefetched. */
static inline void copy_vectors(float *to, const float *from, size_t count)
{
    count *= 3;
    for (size_t n = 0; n < count; n += 64 / sizeof *to)
        __builtin_prefetch(to + n + FAR, 1);
#if CWI_WIDE
    for (; count >= 16; count -= 16, to += 16, from += 16)
        _mm512_storeu_ps(to, _mm512_loadu_ps(from));
    _mm512_mask_storeu_ps(to, (__mmask16)((1u << count) - 1), _mm512_loadu_ps(from));
#elif defined __AVX2__
    /* the last ones overlap those before */
    for (size_t n = 0; n + 8 < count; n += 8)
        _mm256_storeu_ps(to + n, _mm256_loadu_ps(from + n));
    if (count >= 8)
        _mm256_storeu_ps(to + count - 8, _mm256_loadu_ps(from + count - 8));
    else if (count == 6)
        memcpy(to, from, 6 * sizeof *to);
    else if (count)
        memcpy(to, from, 3 * sizeof *to);
#else
    memcpy(to, from, count * sizeof *to);
#endif
}

/* Stores the vectors of a list's vertices at their places. */
static inline void store_runs(const cwi_edge_list *l, float (*positions)[3],
                              float (*normals)[3], const cwi_vertex_sink *sink)
{
    for (size_t r = 0; r < l->runs; r++) {
        const cwi_run *run = &l->run[r];
        const size_t to = 3 * (run->number - sink->first),
                     count = end_of_run(l, r) - run->begin;
        copy_vectors(sink->positions + to, positions[run->begin], count);
        if (sink->normals)
            copy_vectors(sink->normals + to, normals[run->begin], count);
    }
}

/* Returns the n-th axis of the differences around an edge along `axis`; its own axis is the
 * first. */
static inline int axis_of(int axis, int n)
{
    return n == 0 ? axis : n == 1 ? axis == 0 : axis == 2 ? 1 : 2;
}

/* Returns the address where the padding of a layer begins, counted in padded samples. */
static inline const char *first_padded(const cw_volume *v, size_t k)
{
    const char *first = cwi_voxel_address(v, 0, 0, k - 1);
    return first - v->stride[0] - v->stride[1];
}

enum { ANY_AXIS = -1 };

/* The map from a list's edges to the world. */
typedef struct cwi_edge_frame {
    double affine[3][3];
    double first[2]; /* column and row that stand at the origin, as padded samples count */
    double z;        /* layers from there */
    double along[3]; /* the step along an edge */
} cwi_edge_frame;

static inline cwi_edge_frame make_frame(const cwi_edge_list *list, const cwi_vertex_sink *sink)
{
    cwi_edge_frame f = {.first = {sink->centre[0] + 1, sink->centre[1] + 1},
                        .z = (double)list->k - 1 - sink->centre[2]};
    memcpy(f.affine, sink->affine, sizeof f.affine);
    f.along[list->axis] = 1;
    return f;
}

/* Returns a power of two that scales a non-negative number to at least 1 and below 2. Its
 * exponent bits are those of the largest power minus the number's. For numbers that are not
 * finite, or too huge, it is negative or zero. */
#define POWER_BESIDE(name, real, word, digits)                                                 \
    static inline real name(real x)                                                            \
    {                                                                                          \
        const word one = (word)1 << ((digits)-1), exponent = ((word)-1 >> 1) - (one - 1);      \
        word bits;                                                                             \
        memcpy(&bits, &x, sizeof bits);                                                        \
        bits = exponent - one - (bits & exponent);                                             \
        memcpy(&x, &bits, sizeof x);                                                           \
        return x;                                                                              \
    }
POWER_BESIDE(power_beside_f32, float, uint32_t, FLT_MANT_DIG)
POWER_BESIDE(power_beside_f64, double, uint64_t, DBL_MANT_DIG)
#define power_beside(x) _Generic(x, float : power_beside_f32, double : power_beside_f64)(x)

/* Converts four adjacent numbers of small types; compilers convert them one by one. */
#ifdef __SSE4_1__
#define SMALL_TYPE(name, load)                                                                 \
    static inline void side_by_side_##name(const void *at,                                     \
                                           int32_t __attribute__((vector_size(16))) * out)     \
    {                                                                                          \
        *(__m128i *)out = _mm_cvtep##name##_epi32(load(at));                                   \
    }
SMALL_TYPE(u8, _mm_loadu_si32)
SMALL_TYPE(i8, _mm_loadu_si32)
SMALL_TYPE(u16, _mm_loadu_si64)
SMALL_TYPE(i16, _mm_loadu_si64)
#endif

#if CWI_WIDE
/* Vectors of numbers, and of bits, in LANES lanes. */
typedef int32_t cwi_lanes __attribute__((vector_size(4 * LANES)));
typedef uint32_t cwi_bit_lanes __attribute__((vector_size(4 * LANES)));
typedef float cwi_float_lanes __attribute__((vector_size(4 * LANES)));

/* Loads the 32 bits at an offset in bytes from an address, in each lane. It avoids the shorter
 * intrinsic, which waits for the previous content of its register. */
ALWAYS_INLINE cwi_bit_lanes gather(const char *at, cwi_lanes bytes)
{
    return (cwi_bit_lanes)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), 0xffff,
                                                      (__m512i)bytes, at, 1);
}

/* Returns true if the samples of a volume, `voxel` bytes each, can be gathered, and gathering
 * is fast. It is slow where microcode mitigates Gather Data Sampling, on processors older than
 * those with bfloat16. */
static inline bool can_gather(const cw_volume *v, ptrdiff_t voxel)
{
    const ptrdiff_t row = v->stride[1];
    return v->stride[0] == voxel && !cwi_is_rectilinear(v) &&
           (row < 0 ? -row : row) * ((ptrdiff_t)v->dim[1] + 1) +
                   voxel * ((ptrdiff_t)v->dim[0] + 1) <=
               INT32_MAX &&
           __builtin_cpu_supports("avx512bf16");
}

/* Does the same as cwi_off_ends, for all lanes. */
ALWAYS_INLINE void all_off_ends(double fraction[LANES])
{
    for (int n = 0; n < LANES; n += 8) {
        const __m512d t =
            _mm512_max_pd(_mm512_loadu_pd(fraction + n), _mm512_set1_pd(CWI_NUDGE));
        _mm512_storeu_pd(fraction + n, _mm512_min_pd(t, _mm512_set1_pd(1 - CWI_NUDGE)));
    }
}

/* Interleaves three arrays into one of vectors. Each 16 numbers from the n-th on are made in
 * two steps, as an instruction selects from two registers. */
#define XY(n)       ((n) / 3 + ((n) % 3 == 1 ? LANES : 0))
#define XYZ(n)      ((n) % 3 == 2 ? (n) / 3 + LANES : (n) % LANES)
#define FOUR(of, n) of(n), of((n) + 1), of((n) + 2), of((n) + 3)
#define ALL(of, n)  FOUR(of, n), FOUR(of, (n) + 4), FOUR(of, (n) + 8), FOUR(of, (n) + 12)
#define VECTORS(n)                                                                             \
    __builtin_shufflevector(__builtin_shufflevector(x, y, ALL(XY, n)), z, ALL(XYZ, n))
ALWAYS_INLINE void interleave_lanes(float from[3][LANES], float (*to)[3])
{
    cwi_float_lanes x, y, z;
    memcpy(&x, from[0], sizeof x);
    memcpy(&y, from[1], sizeof y);
    memcpy(&z, from[2], sizeof z);
    const cwi_float_lanes all[3] = {VECTORS(0), VECTORS(16), VECTORS(32)};
    memcpy(to, all, sizeof all);
}
#endif

_Static_assert((int)CWI_CUBICS == (int)LANES, "cubics fill the lanes");

/* Edges whose vertices are on cubics: the samples before them, at their ends and after them;
 * the differences between neighbours of these, one and two voxels away along both other axes;
 * and the results. */
typedef struct cwi_cubic_lanes {
    _Alignas(64) double along[4][LANES], near[2][4][LANES], far[2][4][LANES];
    int64_t found[LANES]; /* 1: usable */
    float normal[3][LANES];
} cwi_cubic_lanes;

/* Computes normals to cubics at fractions t of their edges: along the edge from the slope,
 * across it from a cubic through derivatives of fourth order. */
static void turn_cubics(cwi_cubic_lanes *restrict c, const double *restrict t,
                        const cwi_vertex_sink *sink, int axis)
{
    double cofactor[3][3];
    for (int r = 0; r < 3; r++)
        for (int a = 0; a < 3; a++)
            cofactor[r][a] = sink->cofactor[r][axis_of(axis, a)];
    for (size_t n = 0; n < LANES; n++) {
        double slope[4], weight[4], g[3] = {0, 0, 0}, d[3];
        cwi_cubic_slopes(t[n], slope);
        cwi_cubic_weights(t[n], weight);
        for (int s = 0; s < 4; s++) {
            g[0] += slope[s] * c->along[s][n];
            for (int a = 0; a < 2; a++)
                g[1 + a] += weight[s] * ((8 * c->near[a][s][n] - c->far[a][s][n]) / 12);
        }
        for (int r = 0; r < 3; r++)
            d[r] = cofactor[r][0] * g[0] + cofactor[r][1] * g[1] + cofactor[r][2] * g[2] + 0.0;
        const double sum = fabs(d[0]) + fabs(d[1]) + fabs(d[2]), power = power_beside(sum);
        for (int r = 0; r < 3; r++)
            d[r] *= power;
        const double scale = 1 / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int r = 0; r < 3; r++)
            c->normal[r][n] = (float)(d[r] * scale);
        c->found[n] &= (sum > MINIMUM) & (sum < MAXIMUM);
    }
}

#define TYPED "extract/dense/place_vertices.inc"
#include "extract/dense/for_each_type.inc"

void cwi_place_vertices(const cwi_bit_grid *g, const cwi_row_span *span, const cwi_row *rows,
                        cwi_vertex_sink *sink)
{
    static void (*const write[CW_TYPE_COUNT])(const cwi_bit_grid *, const cwi_row_span *,
                                              const cwi_row *, cwi_vertex_sink *) = {
        [CW_U8] = write_u8,   [CW_I8] = write_i8,   [CW_U16] = write_u16, [CW_I16] = write_i16,
        [CW_U32] = write_u32, [CW_I32] = write_i32, [CW_F32] = write_f32, [CW_F64] = write_f64,
    };
    write[g->volume.type](g, span, rows, sink);
}
