/* Derives the tetrahedra of a cube, the rings around their edges, and the label patterns whose
 * tetrahedra can be one point. */
#include "extract/labels/label_cubes.h"

#include <string.h>

enum { WHOLE = 0xff };

/* Cuts the cube along its diagonal [Freudenthal1942]: a tetrahedron goes from corner 0 to corner
 * 7 by one axis after the other, in each of six orders. */
static void make_tets(uint8_t tets[CWI_TETS])
{
    int count = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            if (a != b)
                tets[count++] = (uint8_t)(1 | 1 << (1 << a) | 1 << (1 << a | 1 << b) | 1 << 7);
}

/* Splits the cube into two prisms along each axis, of three tetrahedra each: on the sides of its
 * diagonal plane. The second one has those with the corner along the axis after it, alone or with the
 * first axis. */
static void make_prisms(const uint8_t tets[CWI_TETS], uint8_t prisms[3])
{
    for (int axis = 0; axis < 3; axis++)
        for (int t = 0; t < CWI_TETS; t++) {
            const int corner = 1 << (axis + 1) % 3;
            if (tets[t] >> corner & 1 || tets[t] >> (corner | 1 << axis) & 1)
                prisms[axis] |= (uint8_t)(1 << t);
        }
}

/* Returns true if an edge of tetrahedra joins two corners: one rises from the other. */
static bool is_edge(int a, int b)
{
    return a != b && ((a & b) == a || (a & b) == b);
}

/* Returns true if corners hang together on the cube's surface: by all edges but the diagonal. */
static bool is_connected(int corners)
{
    int reached = corners & -corners, before = 0;
    while (reached != before) {
        before = reached;
        for (int a = 0; a < 8; a++)
            for (int b = 0; b < 8; b++)
                if (reached >> a & 1 && corners >> b & 1 && is_edge(a, b) && (a ^ b) != 7)
                    reached |= 1 << b;
    }
    return reached == corners;
}

/* Returns true if on some face a label has two opposite corners, and no other: its outline there
 * is in two parts, which would run between the same two points. */
static bool has_split_face(int corners)
{
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, low = side << axis;
            const int rising = 1 << low | 1 << (low | u | v);
            const int other = 1 << (low | u) | 1 << (low | v);
            const int here = corners & (rising | other);
            if (here == rising || here == other)
                return true;
        }
    return false;
}

/* A tetrahedron around an edge: its corners among 3 x 3 x 3 places around the edge's start. */
typedef struct around {
    uint32_t corners;
    int8_t cube[3];
    uint8_t tet;
} around;

/* Finds the tetrahedra with an edge, in any order. */
static int find_around(const uint8_t tets[CWI_TETS], int edge, around *found)
{
    int count = 0;
    for (int c = 0; c < 8; c++) /* the cube whose corner c is the edge's start */
        for (int t = 0; t < CWI_TETS && (c & edge) == 0; t++) {
            around *next = &found[count];
            if (!(tets[t] >> c & 1) || !(tets[t] >> (c | edge) & 1))
                continue;
            *next = (around){.tet = (uint8_t)t};
            for (int a = 0; a < 3; a++)
                next->cube[a] = (int8_t) - (c >> a & 1);
            for (int p = 0; p < 8; p++)
                if (tets[t] >> p & 1)
                    next->corners |=
                        1u << (((p >> 2) - (c >> 2) + 1) * 9 +
                               ((p >> 1 & 1) - (c >> 1 & 1) + 1) * 3 + ((p & 1) - (c & 1) + 1));
            count++;
        }
    return count;
}

/* Computes the sum of a tetrahedron's corners, from the edge's start. */
static void sum_corners(const around *t, int sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (int n = 0; n < 27; n++)
        if (t->corners >> n & 1) {
            sum[0] += n % 3 - 1;
            sum[1] += n / 3 % 3 - 1;
            sum[2] += n / 9 - 1;
        }
}

/* Returns the side to which a ring turns: above 0 if as a right-handed screw along the edge. */
static int find_turn(const around *ring, int count, int edge)
{
    int turn = 0;
    for (int n = 0; n < count; n++) {
        int p[3], q[3];
        sum_corners(&ring[n], p);
        sum_corners(&ring[(n + 1) % count], q);
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            turn += (edge >> a & 1) * (p[b] * q[c] - p[c] * q[b]);
        }
    }
    return turn;
}

/* Orders the tetrahedra around an edge: neighbours have a face of three corners in common. */
static void make_ring(const uint8_t tets[CWI_TETS], int edge, cwi_label_ring *ring)
{
    around found[CWI_RING];
    ring->count = find_around(tets, edge, found);
    for (int n = 1; n < ring->count; n++)
        for (int m = n; m < ring->count; m++)
            if (cwi_count_bits(found[n - 1].corners & found[m].corners) == 3) {
                const around next = found[m];
                found[m] = found[n];
                found[n] = next;
                break;
            }
    const bool turns_back = find_turn(found, ring->count, edge) < 0;
    for (int n = 0; n < ring->count; n++) {
        const around *t = &found[turns_back ? ring->count - 1 - n : n];
        memcpy(ring->cube[n], t->cube, sizeof ring->cube[n]);
        ring->tet[n] = t->tet;
    }
}

/* Lists the cubes of a ring. Tetrahedra of one cube follow each other, around the ring's start too. */
static void list_cubes(const cwi_label_ring *ring, cwi_label_edge_cubes *cubes)
{
    for (int n = 0; n < ring->count; n++) {
        bool is_new = true;
        for (int m = 0; m < cubes->count; m++)
            is_new = is_new && memcmp(cubes->cube[m], ring->cube[n], sizeof ring->cube[n]) != 0;
        if (is_new)
            memcpy(cubes->cube[cubes->count++], ring->cube[n], sizeof ring->cube[n]);
    }
}

void cwi_label_rules_make(cwi_label_rules *r)
{
    memset(r, 0, sizeof *r);
    make_tets(r->tets);
    make_prisms(r->tets, r->prisms);
    for (int n = 0; n < 256; n++)
        r->is_simple[n] = is_connected(n) && is_connected(WHOLE & ~n) && !has_split_face(n);
    for (int edge = 1; edge < 8; edge++)
        make_ring(r->tets, edge, &r->rings[edge]);
    for (int edge = 1; edge < 8; edge++)
        list_cubes(&r->rings[edge], &r->around[edge]);
}

/* Returns the corners with a label, as bits. */
static int find_corners(const uint32_t labels[8], uint32_t label)
{
    int corners = 0;
    for (int n = 0; n < 8; n++)
        corners |= (labels[n] == label) << n;
    return corners;
}

uint8_t cwi_label_cube(const cwi_label_rules *r, const uint32_t labels[8])
{
    const int first = find_corners(labels, labels[0]);
    bool is_simple = r->is_simple[first];
    if (first == WHOLE)
        return 0;
    for (int done = first; done != WHOLE && is_simple;) {
        int next = 1;
        while (done >> next & 1)
            next++;
        const int same = find_corners(labels, labels[next]);
        is_simple = r->is_simple[same];
        done |= same;
    }
    if (is_simple)
        return CWI_CUBE_SIMPLE;
    uint8_t cube = 0;
    for (int t = 0; t < CWI_TETS; t++)
        if ((r->tets[t] & first) != r->tets[t]) /* all tetrahedra have corner 0 */
            cube |= (uint8_t)(1 << t);
    return cube;
}
