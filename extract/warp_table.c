#include "extract/warp.h"

#include "core/memory.h"

#include <math.h>
#include <string.h>

size_t cwi_warp_slot(const uint32_t at[3], size_t slots)
{
    uint64_t h = at[0] * UINT64_C(0x9E3779B97F4A7C15);
    h = (h ^ (h >> 29) ^ at[1]) * UINT64_C(0xBF58476D1CE4E5B9);
    h = (h ^ (h >> 32) ^ at[2]) * UINT64_C(0x94D049BB133111EB);
    return (size_t)(h ^ (h >> 31)) & (slots - 1);
}

size_t cwi_warp_slots(size_t count)
{
    size_t slots = 16;
    while (slots < 2 * count)
        slots *= 2;
    return slots;
}

double cwi_warp_corner(const double at[3], int n, uint32_t corner[3])
{
    double share = 1;
    for (int a = 0; a < 3; a++) {
        const double base = floor(at[a]), in = at[a] - base;
        corner[a] = (uint32_t)base + (n >> a & 1);
        share *= n >> a & 1 ? in : 1 - in;
    }
    return share;
}

cwi_move *cwi_warp_find(const cwi_warp *w, const uint32_t at[3])
{
    if (!w->slots)
        return NULL;
    for (size_t s = cwi_warp_slot(at, w->slots); w->table[s]; s = (s + 1) & (w->slots - 1)) {
        cwi_move *m = w->moves + w->table[s] - 1;
        if (memcmp(m->at, at, sizeof m->at) == 0)
            return m;
    }
    return NULL;
}

static void enter(cwi_warp *w, size_t n)
{
    size_t s = cwi_warp_slot(w->moves[n].at, w->slots);
    while (w->table[s])
        s = (s + 1) & (w->slots - 1);
    w->table[s] = (uint32_t)n + 1;
}

static bool grow(cwi_warp *w)
{
    const size_t room = w->room ? 2 * w->room : 256, slots = cwi_warp_slots(room);
    cwi_move *moves = cwi_realloc_array(w->moves, room, sizeof *moves);
    w->moves = moves ? moves : w->moves;
    uint32_t *table = moves ? cwi_alloc_zeroed(slots, sizeof *table) : NULL;
    if (!table)
        return false;
    cwi_free(w->table);
    w->table = table;
    w->slots = slots;
    w->room = room;
    for (size_t n = 0; n < w->count; n++)
        enter(w, n);
    return true;
}

bool cwi_warp_put(cwi_warp *w, const cwi_move *move)
{
    cwi_move *old = cwi_warp_find(w, move->at);
    if (old) {
        *old = *move;
        return true;
    }
    if (w->count == w->room && !grow(w))
        return false;
    w->moves[w->count] = *move;
    enter(w, w->count++);
    return true;
}

void cwi_warp_free(cwi_warp *w)
{
    cwi_free(w->moves);
    cwi_free(w->table);
    *w = (cwi_warp){0};
}
