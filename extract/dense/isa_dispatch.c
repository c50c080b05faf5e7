/* Lists the engines (plain, SSE2, AVX2, AVX-512), and picks the best one that the processor can
 * run. */
#include "extract/dense/isa_dispatch.h"

static bool is_always(void)
{
    return true;
}

#ifdef CWI_X86
static bool has_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
}

static bool has_avx512(void)
{
    return has_avx2() && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vbmi") &&
           __builtin_cpu_supports("avx512vbmi2") && __builtin_cpu_supports("avx512vpopcntdq") &&
           __builtin_cpu_supports("gfni");
}
/* Name, test, engine of comparisons, and engine of marching. Baseline x86-64 has an instruction
 * that gathers comparisons in bits, but none that would make marching faster. */
#define ENGINES(X)                                                                             \
    X(plain, is_always, plain, plain)                                                          \
    X(sse2, is_always, sse2, plain)                                                            \
    X(avx2, has_avx2, avx2, avx2)                                                              \
    X(avx512, has_avx512, avx512, avx512)
#else
#define ENGINES(X) X(plain, is_always, plain, plain)
#endif

#define DECLARE(engine, test, compare, march)                                                  \
    void cwi_classify_layer_##engine(const cwi_bit_grid *, size_t, cwi_range *, bool *,        \
                                     bool *);                                                  \
    void cwi_classify_rows_##engine(const cwi_bit_grid *, size_t, size_t, size_t, bool *,      \
                                    bool *);                                                   \
    void cwi_measure_leaves_##engine(const cwi_bit_grid *, const cwi_leaf_box *, cwi_range *); \
    void cwi_find_sides_##engine(const cwi_bit_grid *, const void *, size_t, bool *, bool *);  \
    void cwi_count_layer_##engine(const cwi_bit_grid *, size_t, cwi_row *);                    \
    void cwi_write_span_##engine(const cwi_bit_grid *, const cwi_row_span *, const cwi_row *,  \
                                 const cwi_emission *, cwi_vertex_sink *, uint32_t *);
ENGINES(DECLARE)

static const cwi_engine engines[] = {
#define ROW(engine, test, compare, march)                                                      \
    {#engine,                                                                                  \
     test,                                                                                     \
     cwi_classify_layer_##compare,                                                             \
     cwi_classify_rows_##compare,                                                              \
     cwi_measure_leaves_##compare,                                                             \
     cwi_find_sides_##compare,                                                                 \
     cwi_count_layer_##march,                                                                  \
     cwi_write_span_##march},
    ENGINES(ROW)
#undef ROW
};

const cwi_engine *cwi_engine_at(size_t n)
{
    for (size_t e = 0; e < sizeof engines / sizeof *engines; e++)
        if (engines[e].usable() && n-- == 0)
            return &engines[e];
    return NULL;
}

const cwi_engine *cwi_engine_best(void)
{
    const cwi_engine *best = NULL, *next;
    for (size_t n = 0; (next = cwi_engine_at(n)); n++)
        best = next;
    return best;
}
