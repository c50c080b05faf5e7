/* Moves vertices by the means of their neighbours: Taubin's two passes in turn [Taubin1995], and HC
 * [Vollmer1999]. Passes read one array and write another, so threads do not matter. */
#include "simplify/smoothing/mesh_smooth.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"

#include <string.h>

/* The fraction of the way to the mean of the neighbours, and the pass band: waves of this eigenvalue
 * keep their size, shorter ones shrink, longer ones grow by a factor of at most 1.0003 each
 * iteration. See simplify/smoothing.md. */
static const double SHRINK = 0.63, PASS_BAND = 0.05;

/* Of HC: what counts as the way back. A mean is compared with the first place by FIRST, else with
 * the last one; the vertex goes back by OWN of its own difference, else by that of its neighbours. */
static const double FIRST = 0.1, OWN = 0.6;

typedef struct pass {
    const cwi_smoother *s;
    double factor;      /* of the way to the mean of the neighbours */
    const double *away; /* vertices x 3: of HC, how far means are from where vertices were */
    double *result;     /* vertices x 3 */
} pass;

bool cwi_smooth_is_fixed(const cwi_smoother *s, size_t v)
{
    const uint32_t count = s->rings.count[v];
    return s->rings.border[v] == CWI_BORDER_NONE ? count < 2
                                                 : !s->desc.move_border || count != 2;
}

/* Returns the mean of vectors of the neighbours. */
static void find_mean(const cwi_rings *r, size_t v, const double *vectors, double mean[3])
{
    const uint32_t *neighbours = r->neighbours + r->begin[v], count = r->count[v];
    double sum[3] = {0};
    for (uint32_t i = 0; i < count; i++)
        for (size_t a = 0; a < 3; a++)
            sum[a] += vectors[3 * (size_t)neighbours[i] + a];
    for (int a = 0; a < 3; a++)
        mean[a] = sum[a] / count;
}

static void average_part(void *context, size_t k)
{
    const pass *p = context;
    const cwi_rings *r = &p->s->rings;
    for (size_t v = k * CWI_RING_PART; v < (k + 1) * CWI_RING_PART && v < r->vertices; v++) {
        const double *here = p->s->from + 3 * v;
        double *to = p->result + 3 * v, mean[3];
        memcpy(to, here, 3 * sizeof *to);
        if (cwi_smooth_is_fixed(p->s, v))
            continue;
        find_mean(r, v, p->s->from, mean);
        for (int a = 0; a < 3; a++)
            to[a] += p->factor * (mean[a] - here[a]);
    }
}

/* Finds how far means are from where vertices were. */
static void compare_part(void *context, size_t k)
{
    const pass *p = context;
    const cwi_smoother *s = p->s;
    const cwi_rings *r = &s->rings;
    for (size_t v = k * CWI_RING_PART; v < (k + 1) * CWI_RING_PART && v < r->vertices; v++) {
        double *away = p->result + 3 * v, mean[3];
        memset(away, 0, 3 * sizeof *away);
        if (cwi_smooth_is_fixed(s, v))
            continue;
        find_mean(r, v, s->from, mean);
        for (size_t a = 0; a < 3; a++)
            away[a] = mean[a] - FIRST * (double)s->mesh->positions[3 * v + a] -
                      (1 - FIRST) * s->from[3 * v + a];
    }
}

/* Moves vertices to the means, and back by what they and their neighbours moved too far. */
static void push_back_part(void *context, size_t k)
{
    const pass *p = context;
    const cwi_smoother *s = p->s;
    const cwi_rings *r = &s->rings;
    for (size_t v = k * CWI_RING_PART; v < (k + 1) * CWI_RING_PART && v < r->vertices; v++) {
        const double *here = s->from + 3 * v, *away = p->away + 3 * v;
        double *to = p->result + 3 * v, mean[3], back[3];
        memcpy(to, here, 3 * sizeof *to);
        if (cwi_smooth_is_fixed(s, v))
            continue;
        find_mean(r, v, s->from, mean);
        find_mean(r, v, p->away, back);
        for (int a = 0; a < 3; a++)
            to[a] = mean[a] - OWN * away[a] - (1 - OWN) * back[a];
    }
}

static cw_status run_pass(pass *p, void (*work)(void *, size_t), size_t n, size_t passes,
                          const cw_progress *progress, cw_error *err)
{
    const cwi_part_progress part = {
        .whole = progress, .from = (double)n / (double)passes, .fraction = 1 / (double)passes};
    const cw_progress part_progress = cwi_progress_part(&part);
    return cwi_parallel_for((p->s->rings.vertices + CWI_RING_PART - 1) / CWI_RING_PART,
                            16 * CWI_RING_PART, p->s->desc.threads, &part_progress, "smoothing",
                            work, p, err);
}

static void take_result(cwi_smoother *s)
{
    double *const before = s->from;
    s->from = s->to;
    s->to = before;
}

cw_status cwi_smooth_average(cwi_smoother *s, const cw_progress *progress, cw_error *err)
{
    const double grow = 1 / (PASS_BAND - 1 / SHRINK);
    const size_t passes = 2 * s->desc.iterations;
    const bool is_hc = s->desc.method == CW_SMOOTH_HC;
    double *away = is_hc ? cwi_alloc_large(3 * s->rings.vertices, sizeof *away) : NULL;
    cw_status st = CW_OK;
    if (is_hc && !away)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < passes && st == CW_OK; n++) {
        const bool is_second = n % 2;
        pass p = {.s = s, .factor = is_second ? grow : SHRINK, .away = away, .result = s->to};
        if (is_hc && !is_second)
            p.result = away;
        st = run_pass(&p,
                      !is_hc      ? average_part
                      : is_second ? push_back_part
                                  : compare_part,
                      n, passes, progress, err);
        if (p.result == s->to)
            take_result(s);
    }
    cwi_free(away);
    return st;
}
