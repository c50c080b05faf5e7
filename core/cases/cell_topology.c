/* Resolves ambiguous cells as the trilinear interpolant does [Nielson1991]: decides which faces
 * join, finds tunnels, and builds the triangles. */
#include "core/cases/cell_topology.h"

#include "core/cases/cube_numbering.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* ---- decisions ------------------------------------------------------------------------- */

/* Products of numbers in this range neither overflow nor lose their rounding errors. */
#define PLAIN_MIN 1e-140
#define PLAIN_MAX 1e140

/* Returns the sign of a c - b d, exactly. Compares the products and, if these are equal, their
 * rounding errors, as rounding keeps their order. Where exponents are extreme, it compares the
 * products of the mantissas, the first one scaled by the difference of the exponents. That
 * scale is limited to 2^4, which outweighs any such product. */
static int compare_products(double a, double c, double b, double d)
{
    if (a * c != b * d)
        return a * c > b * d ? 1 : -1;
    const double min = cwi_lesser(cwi_lesser(fabs(a), fabs(b)), cwi_lesser(fabs(c), fabs(d)));
    const double max =
        cwi_greater(cwi_greater(fabs(a), fabs(b)), cwi_greater(fabs(c), fabs(d)));
    if (min < PLAIN_MIN || max > PLAIN_MAX) {
        int exponent[4];
        a = frexp(a, &exponent[0]);
        c = frexp(c, &exponent[1]);
        b = frexp(b, &exponent[2]);
        d = frexp(d, &exponent[3]);
        const int more = exponent[0] + exponent[1] - exponent[2] - exponent[3];
        a = ldexp(a, more > 4 ? 4 : more < -4 ? -4 : more);
    }
    const double ac = a * c, bd = b * d;
    if (ac != bd)
        return ac > bd ? 1 : -1;
    const double e = fma(a, c, -ac), f = fma(b, d, -bd);
    return (e > f) - (e < f);
}

/* Breaks a tie as if the zero side's values were shifted a little, all by the same amount.
 * Without finite values, an outside corner that is infinitely low, or has no value, keeps the
 * inside ones apart. An infinitely high inside corner joins them. */
bool cwi_face_joins(const double inside[2], const double outside[2], bool zero_inside)
{
    if (!isfinite(outside[0]) || !isfinite(outside[1]))
        return false;
    if (!isfinite(inside[0]) || !isfinite(inside[1]))
        return true;
    const int sign = compare_products(inside[0], inside[1], outside[0], outside[1]);
    return sign > 0 || (sign == 0 && zero_inside);
}

static bool face_is_joined(unsigned cube, const double values[8], bool zero_inside, int face)
{
    const uint8_t *corner = cwi_shapes[CW_HEXAHEDRON].faces[face];
    const double even[2] = {values[corner[0]], values[corner[2]]},
                 odd[2] = {values[corner[1]], values[corner[3]]};
    return cube >> corner[0] & 1 ? cwi_face_joins(even, odd, zero_inside)
                                 : cwi_face_joins(odd, even, zero_inside);
}

static const cwi_config *resolve_faces(unsigned cube, const double values[8], bool zero_inside)
{
    unsigned bits = 0, n = 0;
    for (unsigned left = cwi_case_ambiguous_faces[cube]; left; left &= left - 1)
        bits |= (unsigned)face_is_joined(cube, values, zero_inside, __builtin_ctz(left)) << n++;
    return &cwi_configs[cwi_case_first_config[cube] + bits];
}

/* The four columns of a cell along z, counter-clockwise: corner c and c + 4. */
static const int columns[4] = {0, 1, 3, 2};

typedef struct sweep {
    unsigned cube;
    const double *values;
    double low[4];        /* of the columns, scaled */
    long double slope[4]; /* as a double it would lose last digits that decide */
    double root[4];       /* where a column changes sign; 2: nowhere */
    double event[6];      /* 0, the roots, 1, in order */
    int event_column[6];  /* -1 for 0, -2 for 1 */
    int event_count;
    bool zero_inside;
} sweep;

static bool corner_inside(const sweep *s, int corner)
{
    return s->cube >> corner & 1;
}

/* Returns the corner that a column is joined to at height t: its end on this side of the
 * root. */
static int column_corner(const sweep *s, int n, double t)
{
    return t < s->root[n] ? columns[n] : columns[n] + 4;
}

/* Returns true if column m's root comes before column n's. Where one of two neighbours leaves
 * the inside and the other enters it, their face is ambiguous, and its decision is the order:
 * the one that enters comes first when the inside corners are joined. */
static bool root_is_before(const sweep *s, int m, int n)
{
    static const int faces[4] = {2, 1, 3, 0}; /* between columns n and n + 1 */
    const bool m_leaves = corner_inside(s, columns[m]), n_leaves = corner_inside(s, columns[n]);
    if ((m - n) % 2 == 0 || m_leaves == n_leaves)
        return s->root[m] < s->root[n];
    const int face = faces[(m + 1) % 4 == n ? m : n];
    return n_leaves == face_is_joined(s->cube, s->values, s->zero_inside, face);
}

static void add_event(sweep *s, double t, int column)
{
    int i = s->event_count++;
    for (; i > 1 && column >= 0 && root_is_before(s, column, s->event_column[i - 1]); i--) {
        s->event[i] = s->event[i - 1];
        s->event_column[i] = s->event_column[i - 1];
    }
    s->event[i] = t;
    s->event_column[i] = column;
}

/* Sets up the sweep. Returns false when a value is not finite: no tunnel is sought there. */
static bool start_sweep(sweep *s, unsigned cube, const double values[8], bool zero_inside)
{
    double largest = 0;
    *s = (sweep){.cube = cube, .values = values, .zero_inside = zero_inside};
    for (int c = 0; c < 8; c++) {
        if (!isfinite(values[c]))
            return false;
        largest = cwi_greater(largest, fabs(values[c]));
    }
    int exponent = 0;
    if (largest < PLAIN_MIN || largest > PLAIN_MAX)
        frexp(largest, &exponent);
    add_event(s, 0, -1);
    for (int n = 0; n < 4; n++) {
        double low = values[columns[n]], high = values[columns[n] + 4];
        if (exponent) {
            low = ldexp(low, -exponent);
            high = ldexp(high, -exponent);
        }
        s->low[n] = low;
        s->slope[n] = (long double)high - low;
        s->root[n] = 2;
        if (corner_inside(s, columns[n]) != corner_inside(s, columns[n] + 4)) {
            s->root[n] = low / (low - high);
            add_event(s, s->root[n], n);
        }
    }
    add_event(s, 1, -2);
    return true;
}

/* Returns true if the inside columns (in, in + 2) are joined in the slice at an event that
 * bounds a stretch of alternating columns. Where an inside column vanishes they are apart;
 * where an outside one vanishes they are joined. The end faces are already decided. */
static bool joined_at(const sweep *s, int event, int in)
{
    const int column = s->event_column[event];
    if (column >= 0)
        return (column - in) % 2 != 0;
    return face_is_joined(s->cube, s->values, s->zero_inside, column == -1 ? 4 : 5);
}

/* Returns true if the difference of products has, between t and u, an extremum whose sign is
 * opposite to the sign at both ends. q(t) = in in' - out out' = A t^2 + B t + C. */
static bool turns_back(const sweep *s, int in, bool joined, double t, double u)
{
    const long double a = s->low[in], c = s->low[in + 2], b = s->low[1 - in],
                      d = s->low[3 - in];
    const long double da = s->slope[in], dc = s->slope[in + 2], db = s->slope[1 - in],
                      dd = s->slope[3 - in];
    const long double A = da * dc - db * dd, B = a * dc + c * da - b * dd - d * db,
                      C = a * c - b * d;
    if (joined ? A <= 0 : A >= 0)
        return false;
    const long double at = -B / (2 * A);
    if (!(at > t && at < u))
        return false;
    const long double q = C + at * B / 2;
    if (joined)
        return q < 0 || (q == 0 && !s->zero_inside);
    return q > 0 || (q == 0 && s->zero_inside);
}

static int find_loop(const cwi_config *config, int patch, int other)
{
    const uint8_t *edge = config->loop_edges;
    for (int l = 0; l < config->loop_count; edge += config->loop_length[l++]) {
        const int low = cwi_edge_corner(*edge), high = low | 1 << cwi_edge_axis(*edge);
        const int p = config->patch[low], q = config->patch[high];
        if ((p == patch && q == other) || (p == other && q == patch))
            return l;
    }
    return -1;
}

/* Adds the tunnel that joins the patches of two opposite columns of one kind; around it lies
 * the patch of the other two. One tube replaces the discs of the two loops between them. */
static void set_tunnel(cwi_cell_plan *plan, const sweep *s, int column, double t)
{
    const uint8_t *patch = plan->config->patch;
    const int ends[2] = {column_corner(s, column, t), column_corner(s, column + 2, t)};
    const int around = column_corner(s, 1 - column, t);
    for (int i = 0; i < 2; i++) {
        plan->tunnel[i] = find_loop(plan->config, patch[ends[i]], patch[around]);
        plan->tunnel_corner[i] = ends[i];
    }
}

/* Returns true if some slice across an axis may have columns alternately inside and outside:
 * two opposite ones are inside at one end at least, and the other two outside. */
static bool may_alternate(unsigned cube, int axis)
{
    /* columns by their low corners: all, and opposite ones */
    static const unsigned all[3] = {0x55, 0x33, 0x0f}, even[3] = {0x41, 0x21, 0x09};
    const unsigned odd = all[axis] ^ even[axis], ends = cube >> (1 << axis);
    const unsigned inside = cube | ends, outside = ~(cube & ends);
    return ((inside & even[axis]) == even[axis] && (outside & odd) == odd) ||
           ((inside & odd) == odd && (outside & even[axis]) == even[axis]);
}

/* Returns true if a tunnel is possible: it shows in slices across any axis. */
static bool may_have_tunnel(const cwi_config *config, unsigned cube)
{
    return config->loop_count > 1 && may_alternate(cube, 0) && may_alternate(cube, 1) &&
           may_alternate(cube, 2);
}

/* Returns true if, in a cell with two opposite corners alone on their side, no slice across z
 * finds both of their columns there: the lower one's ends before the other's begins. */
static bool columns_pass(const cwi_config *config, unsigned cube, const double values[8])
{
    const unsigned alone = __builtin_popcount(cube) == 2 ? cube : ~cube & 255;
    const int low = __builtin_ctz(alone), high = 7 - low;
    if (cwi_case_ambiguous_faces[cube] || config->loop_count != 2)
        return false;
    const double a = values[low] - values[low + 4], b = values[high - 4] - values[high];
    return fabs(a) < PLAIN_MAX && fabs(b) < PLAIN_MAX &&
           values[low] / a <= values[high - 4] / b;
}

static void find_tunnel(cwi_cell_plan *plan, unsigned cube, const double values[8],
                        bool zero_inside)
{
    sweep s;
    if (!may_have_tunnel(plan->config, cube) || columns_pass(plan->config, cube, values) ||
        !start_sweep(&s, cube, values, zero_inside))
        return;
    for (int e = 0; e + 1 < s.event_count; e++) {
        const double t = s.event[e], u = s.event[e + 1], middle = 0.5 * (t + u);
        bool in[4];
        for (int n = 0; n < 4; n++)
            in[n] = corner_inside(&s, column_corner(&s, n, middle));
        if (!(t < u) || in[0] == in[1] || in[0] != in[2] || in[1] != in[3])
            continue;
        const int first = in[0] ? 0 : 1;
        const bool joined = joined_at(&s, e, first);
        if (joined == joined_at(&s, e + 1, first) && turns_back(&s, first, joined, t, u)) {
            set_tunnel(plan, &s, joined ? 1 - first : first, middle);
            return;
        }
    }
}

/* Returns the number of triangles of a loop's disc. */
static int disc_triangles(const cwi_config *config, int loop)
{
    return config->loop_length[loop] - (config->cone[loop] ? 0 : 2);
}

/* Returns true if a loop is an end of the tunnel, not of a disc. */
static bool is_tube(const cwi_cell_plan *plan, int loop)
{
    return loop == plan->tunnel[0] || loop == plan->tunnel[1];
}

static bool has_tunnel(const cwi_cell_plan *plan)
{
    return plan->tunnel[0] >= 0;
}

/* Returns true if a tube can be built: tubes are known between a loop of three edges and any
 * other, and between two of four. By enumeration there are no others. */
static bool can_tunnel(const cwi_cell_plan *plan)
{
    const int i = plan->tunnel[0], j = plan->tunnel[1];
    if (i < 0 || j < 0 || i == j)
        return false;
    const int m = plan->config->loop_length[i], n = plan->config->loop_length[j];
    return m == 3 || n == 3 || (m == 4 && n == 4);
}

/* A tube is a ring of three vertices, and two sheets between it and the loops. */
static void count_parts(cwi_cell_plan *plan)
{
    const cwi_config *config = plan->config;
    plan->triangle_count = config->triangle_count;
    plan->vertex_count = config->vertex_count;
    if (!has_tunnel(plan))
        return;
    plan->vertex_count += 3;
    for (int i = 0; i < 2; i++) {
        const int loop = plan->tunnel[i];
        plan->triangle_count += config->loop_length[loop] + 3 - disc_triangles(config, loop);
        plan->vertex_count -= config->cone[loop];
    }
}

void cwi_cell_plan_make(unsigned cube, const double values[8], bool zero_inside,
                        cwi_cell_plan *plan)
{
    *plan =
        (cwi_cell_plan){.config = resolve_faces(cube, values, zero_inside), .tunnel = {-1, -1}};
    find_tunnel(plan, cube, values, zero_inside);
    if (!can_tunnel(plan))
        plan->tunnel[0] = plan->tunnel[1] = -1;
    count_parts(plan);
}

/* Packs a plan. From the lowest bit: the configuration and, for each end of a tunnel, its loop,
 * from 1, and its corner. */
uint32_t cwi_cell_plan_pack(const cwi_cell_plan *plan)
{
    uint32_t code = (uint32_t)(plan->config - cwi_configs);
    for (int i = 0; i < 2 && has_tunnel(plan); i++)
        code |= (uint32_t)((plan->tunnel[i] + 1) << 3 | plan->tunnel_corner[i]) << (10 + 6 * i);
    return code;
}

void cwi_cell_plan_unpack(uint32_t code, cwi_cell_plan *plan)
{
    plan->config = cwi_configs + (code & 1023);
    for (int i = 0; i < 2; i++) {
        plan->tunnel[i] = (int)(code >> (13 + 6 * i) & 7) - 1;
        plan->tunnel_corner[i] = (int)(code >> (10 + 6 * i) & 7);
    }
    count_parts(plan);
}

/* ---- surfaces -------------------------------------------------------------------------- */

typedef struct builder {
    const cwi_cell_plan *plan;
    const double *crossings;
    cwi_cell *cell;
    uint8_t *next;    /* triangle */
    int vertex_count; /* inside the cell, so far */
} builder;

static void add_triangle(builder *b, int i, int j, int k)
{
    *b->next++ = (uint8_t)i;
    *b->next++ = (uint8_t)j;
    *b->next++ = (uint8_t)k;
}

static void edge_point(const builder *b, int edge, double p[3])
{
    const int corner = cwi_edge_corner(edge);
    for (int a = 0; a < 3; a++)
        p[a] = (corner >> a & 1) + (a == cwi_edge_axis(edge) ? b->crossings[edge] : 0);
}

/* Builds a cone from the mean of a loop's points. Every loop on the cube's surface is seen
 * whole from any point inside, so a cone does not cross itself. */
static void build_cone(builder *b, const uint8_t *edges, int count)
{
    double *apex = b->cell->vertices[b->vertex_count];
    const int top = CWI_CELL_INNER + b->vertex_count++;
    for (int i = 0; i < count; i++) {
        double p[3];
        edge_point(b, edges[i], p);
        for (int a = 0; a < 3; a++)
            apex[a] += p[a] / count;
        add_triangle(b, edges[i], edges[(i + 1) % count], top);
    }
}

static void build_discs(builder *b)
{
    const cwi_config *config = b->plan->config;
    const uint8_t *edges = config->loop_edges, *disc = config->triangles;
    for (int l = 0; l < config->loop_count; edges += config->loop_length[l++]) {
        const bool tube = is_tube(b->plan, l);
        const int count = config->loop_length[l];
        if (config->cone[l] && !tube)
            build_cone(b, edges, count);
        for (int i = 0; i < count - 2 && !config->cone[l]; i++, disc += 3)
            if (!tube)
                add_triangle(b, disc[0], disc[1], disc[2]);
    }
}

/* A tube is two sheets that meet in a ring, a small triangle inside the cell. Some plane
 * separates its two loops; the ring lies in it. Seen along suitable lines (a projection) each
 * loop is a polygon that can be seen whole from one point, around which the ring is drawn small
 * enough: the sheet from loop to ring then covers the projection once, and the sheets stay on
 * their sides of the plane. So the tube does not cross itself.
 *
 * Around a corner (a loop of three): lines through the corner; the other loop lies on the far
 * faces. Between two opposite edges of the cube (two loops of four): lines across them. */
typedef struct projection {
    bool central;
    int corner;        /* that lines go through, or on the edge they start from */
    int along;         /* the axis of that edge */
    double stretch[3]; /* central: the plane is sum of x / stretch = 1 */
} projection;

/* Turns a point into coordinates from the projection's corner, or back. */
static void mirror_point(const projection *p, double x[3])
{
    for (int a = 0; a < 3; a++)
        if (p->corner >> a & 1)
            x[a] = 1 - x[a];
}

static void project_point(const projection *p, const double point[3], double flat[2])
{
    double x[3] = {point[0], point[1], point[2]};
    const int v = (p->along + 1) % 3, w = (p->along + 2) % 3;
    mirror_point(p, x);
    if (p->central) {
        const double sum = x[0] + x[1] + x[2];
        flat[0] = x[0] / sum;
        flat[1] = x[1] / sum;
    } else {
        flat[0] = x[p->along];
        flat[1] = x[v] - x[w];
    }
}

/* Finds the point of the plane that is seen at a place of the projection. */
static void lift_point(const projection *p, const double flat[2], double point[3])
{
    const int v = (p->along + 1) % 3, w = (p->along + 2) % 3;
    if (p->central) {
        const double x[3] = {flat[0], flat[1], 1 - flat[0] - flat[1]};
        const double sum = x[0] / p->stretch[0] + x[1] / p->stretch[1] + x[2] / p->stretch[2];
        for (int a = 0; a < 3; a++)
            point[a] = x[a] / sum;
    } else {
        point[p->along] = flat[0];
        point[v] = 0.5 + 0.5 * flat[1];
        point[w] = 0.5 - 0.5 * flat[1];
    }
    mirror_point(p, point);
}

typedef struct flat_loop {
    const uint8_t *edges;
    int count;
    double at[12][2];
    double turn; /* 1 counter-clockwise, -1 clockwise */
} flat_loop;

static double cross_in_plane(const double o[2], const double a[2], const double b[2])
{
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

static void flatten_loop(const builder *b, const projection *p, int loop, flat_loop *f)
{
    double area = 0;
    f->edges = b->plan->config->loop_edges;
    for (int l = 0; l < loop; l++)
        f->edges += b->plan->config->loop_length[l];
    f->count = b->plan->config->loop_length[loop];
    for (int i = 0; i < f->count; i++) {
        double point[3];
        edge_point(b, f->edges[i], point);
        project_point(p, point, f->at[i]);
    }
    for (int i = 2; i < f->count; i++)
        area += cross_in_plane(f->at[0], f->at[i - 1], f->at[i]);
    f->turn = area < 0 ? -1 : 1;
}

/* Returns the smallest distance from a point inside to the lines of a polygon's sides. */
static double measure_clearance(const flat_loop *f, const double centre[2])
{
    double min = 1;
    for (int i = 0; i < f->count; i++) {
        const double *p = f->at[i], *q = f->at[(i + 1) % f->count];
        const double length = hypot(q[0] - p[0], q[1] - p[1]);
        if (length > 0)
            min = fmin(min, f->turn * cross_in_plane(p, q, centre) / length);
    }
    return fmax(min, 1e-6);
}

/* Computes the direction of corner i of the ring, counter-clockwise. */
static void ring_direction(int i, double d[2])
{
    static const double directions[3][2] = {
        {1, 0}, {-0.5, 0.86602540378443865}, {-0.5, -0.86602540378443865}};
    d[0] = directions[i][0];
    d[1] = directions[i][1];
}

/* Returns the loop's point that is farthest out across the ring's side from corner i to j: that
 * point sees the side. */
static int find_farthest(const flat_loop *f, const double centre[2], int i, int j)
{
    double d[2], e[2], max = -INFINITY;
    int found = 0;
    ring_direction(i, d);
    ring_direction(j, e);
    for (int n = 0; n < f->count; n++) {
        const double out = (d[0] + e[0]) * (f->at[n][0] - centre[0]) +
                           (d[1] + e[1]) * (f->at[n][1] - centre[1]);
        if (out > max) {
            max = out;
            found = n;
        }
    }
    return found;
}

/* Builds the sheet between a loop and the ring whose corners are numbered from `ring` on. */
static void build_sheet(builder *b, const flat_loop *f, const double centre[2], int ring)
{
    const int step = f->turn > 0 ? 1 : 2; /* the ring is walked the way the loop is */
    int i = find_farthest(f, centre, 2 * step % 3, 0), walked = 0;
    for (int n = 0; n < 3; n++) {
        const int corner = n * step % 3, following = (n + 1) * step % 3;
        const int last = find_farthest(f, centre, corner, following);
        /* the third stretch takes the rest of the loop, even when that is all or nothing */
        const int steps = n < 2 ? (last - i + f->count) % f->count : f->count - walked;
        for (int k = 0; k < steps; k++) {
            const int from = f->edges[i], to = f->edges[(i + 1) % f->count];
            add_triangle(b, from, to, ring + corner);
            i = (i + 1) % f->count;
        }
        walked += steps;
        add_triangle(b, f->edges[i], ring + following, ring + corner);
    }
}

/* Computes the mean of the directions, seen from the projection's corner, to the corners of a
 * patch: a point from which the loop around that patch is seen whole. */
static void patch_centre(const builder *b, const projection *p, int corner, double centre[2])
{
    const uint8_t *patch = b->plan->config->patch;
    int count = 0;
    centre[0] = centre[1] = 0;
    for (int c = 0; c < 8; c++)
        if (patch[c] == patch[corner]) {
            const double point[3] = {c & 1, c >> 1 & 1, c >> 2 & 1};
            double flat[2];
            project_point(p, point, flat);
            centre[0] += flat[0];
            centre[1] += flat[1];
            count++;
        }
    centre[0] /= count;
    centre[1] /= count;
}

/* Projects from a corner: the plane halfway between the loop's points on its three edges and
 * the edges' ends. */
static void project_from_corner(const builder *b, int corner, projection *p)
{
    *p = (projection){.central = true, .corner = corner};
    for (int a = 0; a < 3; a++) {
        const double t = b->crossings[cwi_edge_between(corner, corner ^ 1 << a)];
        p->stretch[a] = 0.5 + 0.5 * (corner >> a & 1 ? 1 - t : t);
    }
}

/* Projects across the cell from an edge, both of whose corners are in one patch. */
static void project_from_edge(const builder *b, int corner, projection *p)
{
    const uint8_t *patch = b->plan->config->patch;
    *p = (projection){.corner = corner};
    while (p->along < 2 && patch[corner ^ 1 << p->along] != patch[corner])
        p->along++;
}

static void build_tunnel(builder *b)
{
    const cwi_cell_plan *plan = b->plan;
    const int near = plan->config->loop_length[plan->tunnel[0]] == 3   ? 0
                     : plan->config->loop_length[plan->tunnel[1]] == 3 ? 1
                                                                       : -1;
    projection p;
    flat_loop loops[2];
    double centre[2] = {0.5, 0};
    if (near >= 0) {
        project_from_corner(b, plan->tunnel_corner[near], &p);
        patch_centre(b, &p, plan->tunnel_corner[1 - near], centre);
    } else {
        project_from_edge(b, plan->tunnel_corner[0], &p);
    }
    for (int i = 0; i < 2; i++)
        flatten_loop(b, &p, plan->tunnel[i], &loops[i]);
    const double radius =
        0.5 * fmin(measure_clearance(&loops[0], centre), measure_clearance(&loops[1], centre));
    for (int i = 0; i < 3; i++) {
        double d[2];
        ring_direction(i, d);
        const double flat[2] = {centre[0] + radius * d[0], centre[1] + radius * d[1]};
        lift_point(&p, flat, b->cell->vertices[b->vertex_count + i]);
    }
    for (int i = 0; i < 2; i++)
        build_sheet(b, &loops[i], centre, CWI_CELL_INNER + b->vertex_count);
    b->vertex_count += 3;
}

void cwi_cell_build(const cwi_cell_plan *plan, const double crossings[12], cwi_cell *cell)
{
    builder b = {.plan = plan, .crossings = crossings, .cell = cell, .next = cell->triangles};
    memset(cell->vertices, 0, sizeof cell->vertices);
    build_discs(&b);
    if (has_tunnel(plan))
        build_tunnel(&b);
}
