/* Proves triangles apart. First by planes, several at a time in single precision: all corners of one
 * triangle, besides common ones, are on one side of the plane of the other. Neighbours and triangles
 * in a curved place may be on both sides of each other's planes: those are seen along an axis, where
 * a line through an edge of one may part them. Signs count only beyond the bound of their rounding
 * [Shewchuk1997]. */
#include "simplify/intersections/triangle_packs.h"

#include "core/geometry/exact_predicates.h"

enum { LANES = 4 };

/* Times the sum of the products' sizes: the rounding of a plane's value. The vectors to three corners,
 * two products, a difference and a sum of three round it 8 times; the bounds themselves are rounded
 * as well. */
static const float ROUNDING = 16 * 0x1p-24f;

void cwi_pack_triangles(const float *points, const uint32_t *corners, const uint32_t *order,
                        size_t count, cwi_triangle_pack *pack)
{
    *pack = (cwi_triangle_pack){0};
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = corners[3 * (size_t)order[i] + k];
            pack->vertex[k][i] = v;
            for (size_t x = 0; x < 3; x++)
                pack->at[k][x][i] = points[3 * (size_t)v + x];
        }
}

static inline cwi_lanes load_lanes(const float *from)
{
    cwi_lanes lanes;
    memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

static inline void store_lanes(float *to, cwi_lanes lanes)
{
    memcpy(to, &lanes, sizeof lanes);
}

static inline cwi_lanes select_lanes(cwi_mask mask, cwi_lanes yes, cwi_lanes no)
{
    return (cwi_lanes)(((cwi_mask)yes & mask) | ((cwi_mask)no & ~mask));
}

static inline cwi_lanes find_size(cwi_lanes x, cwi_lanes y, cwi_lanes z)
{
    cwi_lanes low = select_lanes(y < x, y, x), high = select_lanes(y > x, y, x);
    low = select_lanes(z < low, z, low);
    high = select_lanes(z > high, z, high);
    return high - low;
}

static inline cwi_lanes without_sign(cwi_lanes x)
{
    return (cwi_lanes)((cwi_mask)x & INT32_MAX);
}

void cwi_pack_planes(const cwi_triangle_pack *pack, float underflow, cwi_plane_pack *planes)
{
    for (size_t c = 0; c < CWI_WIDTH; c += LANES) {
        cwi_lanes u[3], v[3], own = {underflow, underflow, underflow, underflow};
        for (int x = 0; x < 3; x++) {
            const cwi_lanes p = load_lanes(pack->at[0][x] + c),
                            q = load_lanes(pack->at[1][x] + c),
                            r = load_lanes(pack->at[2][x] + c);
            u[x] = q - p;
            v[x] = r - p;
            store_lanes(planes->size[x] + c, find_size(p, q, r));
        }
        for (int x = 0; x < 3; x++) {
            const int y = (x + 1) % 3, z = (x + 2) % 3;
            const cwi_lanes left = u[y] * v[z], right = u[z] * v[y],
                            error = ROUNDING * (without_sign(left) + without_sign(right));
            store_lanes(planes->normal[x] + c, left - right);
            store_lanes(planes->error[x] + c, error);
            own += error * load_lanes(planes->size[x] + c);
        }
        store_lanes(planes->own_error + c, own);
    }
}

/* --- planes ------------------------------------------------------------------------------- */

typedef struct side_masks {
    cwi_mask above, below; /* lanes in which all corners so far are there, or common */
} side_masks;

static inline void narrow_sides(side_masks *sides, cwi_mask is_common, cwi_lanes value,
                                cwi_lanes error)
{
    sides->above &= is_common | (value > error);
    sides->below &= is_common | (value < -error);
}

/* Returns the lanes in which triangle i of a is on one side of the planes of b. */
static inline cwi_mask is_beside_planes(const cwi_triangle_pack *a,
                                        const cwi_plane_pack *planes_a, size_t i,
                                        const cwi_triangle_pack *b,
                                        const cwi_plane_pack *planes_b, size_t c,
                                        const cwi_mask common_a[3])
{
    side_masks sides = {{-1, -1, -1, -1}, {-1, -1, -1, -1}};
    cwi_lanes error = load_lanes(planes_b->own_error + c), value[3] = {{0}};
    for (int x = 0; x < 3; x++) {
        const cwi_lanes normal = load_lanes(planes_b->normal[x] + c),
                        from = load_lanes(b->at[0][x] + c);
        error += planes_a->size[x][i] * load_lanes(planes_b->error[x] + c);
        for (int k = 0; k < 3; k++)
            value[k] += normal * (a->at[k][x][i] - from);
    }
    for (int k = 0; k < 3; k++)
        narrow_sides(&sides, common_a[k], value[k], error);
    return sides.above | sides.below;
}

/* Returns the lanes in which the triangles of b are on one side of the plane of triangle i of a. */
static inline cwi_mask are_beside_plane(const cwi_triangle_pack *a,
                                        const cwi_plane_pack *planes_a, size_t i,
                                        const cwi_triangle_pack *b,
                                        const cwi_plane_pack *planes_b, size_t c,
                                        const cwi_mask common_b[3])
{
    side_masks sides = {{-1, -1, -1, -1}, {-1, -1, -1, -1}};
    const float own = planes_a->own_error[i];
    cwi_lanes error = {own, own, own, own}, value[3] = {{0}};
    for (int x = 0; x < 3; x++) {
        const float normal = planes_a->normal[x][i], from = a->at[0][x][i];
        error += planes_a->error[x][i] * load_lanes(planes_b->size[x] + c);
        for (int k = 0; k < 3; k++)
            value[k] += normal * (load_lanes(b->at[k][x] + c) - from);
    }
    for (int k = 0; k < 3; k++)
        narrow_sides(&sides, common_b[k], value[k], error);
    return sides.above | sides.below;
}

/* Returns the lanes from c on in which planes part triangle i of a from those of b. */
static inline unsigned are_parted_by_planes(const cwi_triangle_pack *a,
                                            const cwi_plane_pack *planes_a, size_t i,
                                            const cwi_triangle_pack *b,
                                            const cwi_plane_pack *planes_b, size_t c)
{
    cwi_mask common_a[3] = {{0}}, common_b[3] = {{0}};
    for (int j = 0; j < 3; j++) {
        cwi_mask vertex;
        memcpy(&vertex, b->vertex[j] + c, sizeof vertex);
        for (int k = 0; k < 3; k++) {
            const cwi_mask is_same = vertex == (int32_t)a->vertex[k][i];
            common_a[k] |= is_same;
            common_b[j] |= is_same;
        }
    }
    const cwi_mask parted = (is_beside_planes(a, planes_a, i, b, planes_b, c, common_a) |
                             are_beside_plane(a, planes_a, i, b, planes_b, c, common_b)) &
                            ~(common_a[0] & common_a[1] & common_a[2]);
    return cwi_mask_bits(&parted);
}

/* --- lines -------------------------------------------------------------------------------- */

/* Two triangles seen along an axis. */
typedef struct plan {
    double a[3][2], b[3][2];
} plan;

static int find_longest_axis(const cwi_plane_pack *planes, size_t i)
{
    const float x = fabsf(planes->normal[0][i]), y = fabsf(planes->normal[1][i]),
                z = fabsf(planes->normal[2][i]);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

static plan see_along(const cwi_triangle_pack *a, size_t i, const cwi_triangle_pack *b,
                      size_t j, int axis)
{
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    plan p;
    for (int k = 0; k < 3; k++) {
        p.a[k][0] = (double)a->at[k][x][i];
        p.a[k][1] = (double)a->at[k][y][i];
        p.b[k][0] = (double)b->at[k][x][j];
        p.b[k][1] = (double)b->at[k][y][j];
    }
    return p;
}

static int find_turn(const double p[2], const double q[2], const double r[2])
{
    return cwi_sure_turn(p[0], p[1], q[0], q[1], r[0], r[1]);
}

/* Returns true if the line through an edge of t, whose corners turn by `turn`, has all of the other
 * triangle on its far side. t, other: three corners */
static bool edge_parts(const double (*t)[2], int turn, const double (*other)[2])
{
    for (int k = 0; k < 3; k++) {
        const double *p = t[k], *q = t[(k + 1) % 3];
        if (find_turn(p, q, other[0]) == -turn && find_turn(p, q, other[1]) == -turn &&
            find_turn(p, q, other[2]) == -turn)
            return true;
    }
    return false;
}

static bool strangers_are_parted(const plan *p)
{
    const int turn_a = find_turn(p->a[0], p->a[1], p->a[2]),
              turn_b = find_turn(p->b[0], p->b[1], p->b[2]);
    return (turn_a && edge_parts(p->a, turn_a, p->b)) ||
           (turn_b && edge_parts(p->b, turn_b, p->a));
}

enum { LEFT = 1, RIGHT = 2 };

/* Returns on which side of the ray from v through p the point q is. A point straight behind v counts
 * as on both sides; 0 where rounding might decide. */
static int find_ray_side(const double p[2], const double q[2], const double v[2])
{
    const int turn = find_turn(p, q, v);
    if (turn)
        return turn > 0 ? LEFT : RIGHT;
    for (int x = 0; x < 2; x++) /* both are exactly on a line along axis x */
        if (p[1 - x] == v[1 - x] && q[1 - x] == v[1 - x] &&
            ((p[x] < v[x] && q[x] > v[x]) || (p[x] > v[x] && q[x] < v[x])))
            return LEFT | RIGHT;
    return 0;
}

/* Decides for triangles with corner k of a and corner j of b in common: a line along one of the four
 * sides that begin there has its own triangle on one side, and the other triangle on the other. */
static bool wedges_are_parted(const plan *p, int k, int j)
{
    const double *v = p->a[k], *a[2] = {p->a[(k + 1) % 3], p->a[(k + 2) % 3]},
                 *b[2] = {p->b[(j + 1) % 3], p->b[(j + 2) % 3]};
    const int turn_a = find_turn(a[0], a[1], v), turn_b = find_turn(b[0], b[1], v);
    int side
        [2]
        [2]; /* of the sides of b from those of a, if both triangles turn counter-clockwise */
    if (!turn_a || !turn_b)
        return false;
    for (int m = 0; m < 2; m++)
        for (int n = 0; n < 2; n++)
            side[m][n] = find_ray_side(a[turn_a < 0 ? 1 - m : m], b[turn_b < 0 ? 1 - n : n], v);
    return (side[0][0] & side[0][1] & RIGHT) || (side[1][0] & side[1][1] & LEFT) ||
           (side[0][0] & side[1][0] & LEFT) || (side[0][1] & side[1][1] & RIGHT);
}

/* Decides for triangles with an edge in common, by their third corners. */
static bool sides_are_parted(const plan *p, int third_a, int third_b)
{
    const double *from = p->a[(third_a + 1) % 3], *to = p->a[(third_a + 2) % 3];
    return find_turn(from, to, p->a[third_a]) * find_turn(from, to, p->b[third_b]) < 0;
}

/* Returns true if triangle i of a and triangle j of b are apart as seen along the axis that a faces
 * most. */
static bool are_parted_in_plan(const cwi_triangle_pack *a, const cwi_plane_pack *planes_a,
                               size_t i, const cwi_triangle_pack *b, size_t j)
{
    const plan p = see_along(a, i, b, j, find_longest_axis(planes_a, i));
    int common = 0, corner_a = 0, corner_b = 0, sum_a = 0, sum_b = 0;
    for (int k = 0; k < 3; k++)
        for (int n = 0; n < 3; n++)
            if (a->vertex[k][i] == b->vertex[n][j]) {
                common++;
                corner_a = k;
                corner_b = n;
                sum_a += k;
                sum_b += n;
            }
    return common == 0   ? strangers_are_parted(&p)
           : common == 1 ? wedges_are_parted(&p, corner_a, corner_b)
           : common == 2 ? sides_are_parted(&p, 3 - sum_a, 3 - sum_b)
                         : false;
}

unsigned cwi_find_unproved(const cwi_triangle_pack *a, const cwi_plane_pack *planes_a, size_t i,
                           const cwi_triangle_pack *b, const cwi_plane_pack *planes_b,
                           unsigned near)
{
    unsigned unproved = near;
    for (size_t c = 0; c < CWI_WIDTH; c += LANES)
        if (near >> c & ((1u << LANES) - 1))
            unproved &= ~(are_parted_by_planes(a, planes_a, i, b, planes_b, c) << c);
    for (unsigned left = unproved; left; left &= left - 1) {
        const size_t j = (size_t)__builtin_ctz(left);
        if (are_parted_in_plan(a, planes_a, i, b, j))
            unproved &= ~(1u << j);
    }
    return unproved;
}
