/* Cells of every case of marching cubes. Up to the 48 motions of a cube and a change of sign
 * there are 30 kinds of cells that have a surface. They are the 33 of [Chernyaev1995] without
 * the empty one and the mirror images 12.3 and 14. Their corners are small whole numbers, found
 * by a random search. Adding or subtracting a quarter at any of them does not change the
 * case. */
#include "core/synthetic/stress_fields.h"

static const signed char kinds[CWI_HARD_KINDS][8] = {
    /* one to three corners inside, or outside */
    {1, -1, 1, 1, 1, 1, 1, 1},
    {-1, -1, 1, 1, -1, -1, -1, -1},
    {-1, -1, -1, -1, 1, -1, -1, 2},
    {1, -1, 1, 2, 1, 1, 1, -1},
    {-1, 1, 1, 1, 1, 1, 1, -1},
    {3, -1, -1, -1, -1, -1, -1, 4}, /* through a tunnel */
    {-1, 1, -1, 1, 2, -1, 1, 1},
    {-1, 1, 1, 1, -1, 1, -1, 1},
    {1, -1, 2, -1, -1, -1, -1, 1},
    {1, 1, -4, 3, 1, -4, 2, -1}, /* tunnel */
    {1, 1, -2, 1, -1, 2, 1, -1},
    {1, 1, -2, 1, -1, 1, 1, -2},
    {-1, 1, 1, 1, 2, -1, -1, 1},
    {-1, 1, 2, -1, 1, -2, 1, 3},
    {-2, 1, 2, -2, 1, 5, -2, 1}, /* tunnel */
    /* four */
    {-1, -1, 1, 1, -1, -1, 1, 1},
    {-1, 1, -1, -1, 1, 1, -1, 1},
    {-1, 1, -1, -1, 1, 1, 1, -1},
    {-1, 1, -1, 2, 2, -1, 1, -1},
    {-1, -2, 1, 1, 2, 1, -1, -1},
    {1, 4, -2, -2, -4, -3, 6, 1}, /* tunnel */
    {-1, -1, 2, -1, 1, 1, -1, 1},
    {2, -1, -1, 1, 1, -1, 1, -2},
    {1, -2, 3, -1, -3, 4, 1, -2}, /* tunnel */
    /* every other corner: six ambiguous faces */
    {2, -1, -1, 2, -1, 1, 2, -1},
    {-1, 2, 2, -2, 2, -2, -2, 1},
    {1, -2, -1, 3, -1, 1, 2, -1},
    {1, -1, -1, 2, -2, 1, 1, -1},
    {1, -3, -1, 1, -2, 1, 3, -2},
    {4, -7, -1, 7, -5, 7, 5, -8}, /* tunnel */
};

/* Offsets for the corners after multiplication by twelve, so that no two are equal by chance.
 * Equal corners put critical points where counters cannot distinguish them. */
static const signed char uneven[8] = {0, 1, -2, 2, -1, 1, -1, 2};

bool cwi_hard_cell(const cwi_hard_sample *s, size_t *cell, unsigned *corner)
{
    *cell = *corner = 0;
    for (int a = 2; a >= 0; a--) {
        const size_t cells = (s->dim[a] + 1) / 3;
        if (s->at[a] % 3 == 2 || s->at[a] / 3 >= cells)
            return false;
        *cell = *cell * cells + s->at[a] / 3;
        *corner |= (unsigned)(s->at[a] % 3) << a;
    }
    return true;
}

/* Returns a corner. Motion 8 m + n is the m-th order of axes, after reversal of the axes in n's
 * bits. */
double cwi_hard_corner(size_t n, unsigned corner)
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const size_t motion = n / CWI_HARD_KINDS % 48;
    const int *order = orders[motion / 8];
    unsigned from = 0;
    for (int a = 0; a < 3; a++)
        from |= ((corner ^ (unsigned)motion) >> a & 1) << order[a];
    const int value = 12 * kinds[n % CWI_HARD_KINDS][from] + uneven[from];
    return n / CWI_HARD_KINDS / 48 % 2 ? -value : value;
}
