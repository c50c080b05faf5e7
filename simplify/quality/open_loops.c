/* Counts loops of open edges from their ends: a loop is a set of fans that open edges join. */
#include "simplify/quality/open_loops.h"

#include "core/geometry/union_find.h"

#include <stdlib.h>
#include <string.h>

static bool reserve_ends(cwi_border *b, size_t count)
{
    if (count <= b->capacity)
        return true;
    const size_t capacity = count + count / 4 + 16;
    cwi_open_end *more = cwi_realloc_array(b->ends, capacity, sizeof *more);
    if (!more)
        return false;
    b->ends = more;
    b->capacity = capacity;
    return true;
}

bool cwi_border_push(cwi_border *b, cwi_open_end end)
{
    if (!reserve_ends(b, b->count + 1))
        return false;
    b->ends[b->count++] = end;
    return true;
}

bool cwi_border_append(cwi_border *b, const cwi_border *more)
{
    if (!reserve_ends(b, b->count + more->count))
        return false;
    for (size_t i = 0; i < more->count; i++) {
        b->ends[b->count] = more->ends[i];
        b->ends[b->count++].fan += b->fans;
    }
    b->fans += more->fans;
    b->loops += more->fans;
    return true;
}

static int compare_ends(const void *a, const void *b)
{
    const cwi_open_end *s = a, *t = b;
    if (s->high != t->high)
        return s->high < t->high ? -1 : 1;
    return s->low < t->low ? -1 : s->low > t->low;
}

/* Joins the fans of equal edges, which follow each other, and keeps the other ends. */
static void join_pairs(cwi_border *b, uint32_t *sets)
{
    size_t kept = 0;
    for (size_t i = 0; i < b->count; i++) {
        if (i + 1 == b->count || compare_ends(&b->ends[i], &b->ends[i + 1]) != 0) {
            b->ends[kept++] = b->ends[i];
            continue;
        }
        const uint32_t one = cwi_sets_find(sets, b->ends[i].fan),
                       other = cwi_sets_find(sets, b->ends[++i].fan);
        b->loops -= one != other;
        cwi_sets_join(sets, one, other);
    }
    b->count = kept;
}

/* Numbers the fans of the remaining ends from 0: fans that are joined get one number. */
static void number_fans(cwi_border *b, uint32_t *sets, uint32_t *number)
{
    memset(number, 0xff, b->fans * sizeof *number);
    b->fans = 0;
    for (size_t i = 0; i < b->count; i++) {
        const uint32_t root = cwi_sets_find(sets, b->ends[i].fan);
        if (number[root] == UINT32_MAX)
            number[root] = b->fans++;
        b->ends[i].fan = number[root];
    }
}

bool cwi_border_join(cwi_border *b)
{
    if (!b->count)
        return true;
    uint32_t *sets = cwi_sets_alloc(b->fans),
             *number = cwi_alloc_array(b->fans, sizeof *number);
    const bool ok = sets && number;
    if (ok) {
        qsort(b->ends, b->count, sizeof *b->ends, compare_ends);
        join_pairs(b, sets);
        number_fans(b, sets, number);
    }
    cwi_free(sets);
    cwi_free(number);
    return ok;
}

void cwi_border_free(cwi_border *b)
{
    cwi_free(b->ends);
    *b = (cwi_border){0};
}
