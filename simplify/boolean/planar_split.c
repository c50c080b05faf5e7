/* A triangulation that grows by points and lines [Lawson1977; Sloan1993]. Turns of points are exact. Edges are
 * flipped towards Delaunay's triangulation by doubles: it makes faces well shaped, and is no condition. */
#include "simplify/boolean/planar_split.h"

#include "core/base/memory.h"

/* Makes room for another element; returns false when memory is out. */
static bool make_room(cwi_split *s, void *array, size_t *capacity, size_t count, size_t size)
{
    void **a = array;
    void *grown = cwi_grow_array(*a, count, capacity, size);
    if (grown)
        *a = grown;
    s->no_memory |= !grown;
    return grown;
}

static bool has_room_for_point(cwi_split *s)
{
    size_t capacity = s->point_capacity, same = s->point_capacity;
    return make_room(s, &s->numbers, &capacity, s->point_count, sizeof *s->numbers) &&
           make_room(s, &s->face_at, &same, s->point_count, sizeof *s->face_at) &&
           make_room(s, &s->points, &s->point_capacity, s->point_count, sizeof *s->points);
}

static uint32_t new_point(cwi_split *s, const cwi_exact_point *p, uint32_t number)
{
    const uint32_t n = (uint32_t)s->point_count++;
    s->points[n] = *p;
    s->numbers[n] = number;
    s->face_at[n] = CWI_NOTHING;
    return n;
}

bool cwi_split_begin(cwi_split *s, const cwi_soup *soup, uint32_t triangle)
{
    s->soup = soup;
    s->triangle = triangle;
    s->point_count = s->face_count = s->line_count = 0;
    s->last = 0;
    s->axis = cwi_soup_axis(soup, triangle);
    const uint32_t *v = soup->triangles[triangle];
    s->turn = cwi_soup_turn(soup, v[0], v[1], v[2], s->axis);
    if (!make_room(s, &s->faces, &s->face_capacity, 0, sizeof *s->faces))
        return false;
    cwi_split_face *f = &s->faces[s->face_count++];
    for (uint32_t k = 0; k < 3; k++) {
        const cwi_exact_point p = cwi_point_vertex(soup, v[k]);
        if (!has_room_for_point(s) ||
            !make_room(s, &s->lines, &s->line_capacity, s->line_count, sizeof *s->lines))
            return false;
        f->corners[k] = new_point(s, &p, v[k]);
        f->beside[k] = CWI_NOTHING;
        f->line[k] = k;
        s->face_at[k] = 0;
        s->lines[s->line_count++] = (cwi_split_line){{v[k], v[(k + 1) % 3]}};
    }
    return true;
}

void cwi_split_free(cwi_split *s)
{
    cwi_free(s->points);
    cwi_free(s->numbers);
    cwi_free(s->face_at);
    cwi_free(s->faces);
    cwi_free(s->lines);
    cwi_free(s->queue);
    *s = (cwi_split){0};
}

/* --- faces -------------------------------------------------------------------------------- */

static int turn_of(const cwi_split *s, uint32_t a, uint32_t b, uint32_t c)
{
    return s->turn *
           cwi_point_turn(s->soup, &s->points[a], &s->points[b], &s->points[c], s->axis);
}

/* Returns the edge of a face beyond which another one is. */
static int find_border(const cwi_split_face *face, uint32_t beyond)
{
    int m = 0;
    while (face->beside[m] != beyond)
        m++;
    return m;
}

static void replace_beside(cwi_split *s, uint32_t face, uint32_t from, uint32_t to)
{
    for (int k = 0; k < 3 && face != CWI_NOTHING; k++)
        if (s->faces[face].beside[k] == from) {
            s->faces[face].beside[k] = to;
            return;
        }
}

static void set_face(cwi_split *s, uint32_t f, const uint32_t corners[3],
                     const uint32_t beside[3], const uint32_t line[3])
{
    for (int k = 0; k < 3; k++) {
        s->faces[f].corners[k] = corners[k];
        s->faces[f].beside[k] = beside[k];
        s->faces[f].line[k] = line[k];
        s->face_at[corners[k]] = f;
    }
}

/* Replaces edge k by the other diagonal of the two faces beside it. */
static void flip_edge(cwi_split *s, uint32_t f, int k)
{
    const cwi_split_face t = s->faces[f];
    const uint32_t g = t.beside[k];
    const cwi_split_face u = s->faces[g];
    const int m = find_border(&u, f);
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3, m1 = (m + 1) % 3, m2 = (m + 2) % 3;
    const uint32_t a = t.corners[k], b = t.corners[k1], c = t.corners[k2], d = u.corners[m2];
    set_face(s, f, (uint32_t[3]){a, d, c}, (uint32_t[3]){u.beside[m1], g, t.beside[k2]},
             (uint32_t[3]){u.line[m1], CWI_NOTHING, t.line[k2]});
    set_face(s, g, (uint32_t[3]){d, b, c}, (uint32_t[3]){u.beside[m2], t.beside[k1], f},
             (uint32_t[3]){u.line[m2], t.line[k1], CWI_NOTHING});
    replace_beside(s, u.beside[m1], g, f);
    replace_beside(s, t.beside[k1], f, g);
}

/* Returns true if the two faces beside an edge have no corner that is flat or bent inwards at its ends. */
static bool may_flip(const cwi_split *s, uint32_t f, int k)
{
    const cwi_split_face *t = &s->faces[f];
    if (t->beside[k] == CWI_NOTHING || t->line[k] != CWI_NOTHING)
        return false;
    const cwi_split_face *u = &s->faces[t->beside[k]];
    const int m = find_border(u, f);
    const uint32_t c = t->corners[(k + 2) % 3], d = u->corners[(m + 2) % 3];
    return turn_of(s, t->corners[k], d, c) > 0 && turn_of(s, d, t->corners[(k + 1) % 3], c) > 0;
}

/* Returns true if the corner beyond edge k is inside of the circle around face f, by doubles. */
static bool is_in_circle(const cwi_split *s, uint32_t f, int k)
{
    const cwi_split_face *t = &s->faces[f], *u = &s->faces[t->beside[k]];
    const int i = (s->axis + 1) % 3, j = (s->axis + 2) % 3;
    const int m = find_border(u, f);
    const double *d = s->points[u->corners[(m + 2) % 3]].x;
    double x[3], y[3], z[3];
    for (int n = 0; n < 3; n++) {
        const double *p = s->points[t->corners[n]].x;
        x[n] = p[i] - d[i];
        y[n] = (p[j] - d[j]) * s->turn;
        z[n] = x[n] * x[n] + y[n] * y[n];
    }
    double sum = 0, size = 0;
    for (int n = 0; n < 3; n++) {
        const int a = (n + 1) % 3, b = (n + 2) % 3;
        sum += z[n] * (x[a] * y[b] - x[b] * y[a]);
        const double xy = x[a] * y[b], yx = x[b] * y[a];
        size += z[n] * ((xy < 0 ? -xy : xy) + (yx < 0 ? -yx : yx));
    }
    return sum > 1e-9 * size;
}

static bool push_edge(cwi_split *s, size_t *count, uint32_t a, uint32_t b)
{
    if (!make_room(s, &s->queue, &s->queue_capacity, *count, sizeof *s->queue))
        return false;
    s->queue[*count][0] = a;
    s->queue[(*count)++][1] = b;
    return true;
}

/* Finds the face that has an edge from a to b, and the edge; false: none has. */
static bool find_edge(const cwi_split *s, uint32_t a, uint32_t b, uint32_t *face, int *edge)
{
    uint32_t f = s->face_at[a];
    for (int direction = 0; direction < 2; direction++) {
        uint32_t at = f;
        do {
            const cwi_split_face *t = &s->faces[at];
            const int k = t->corners[0] == a ? 0 : t->corners[1] == a ? 1 : 2;
            if (t->corners[(k + 1) % 3] == b) {
                *face = at;
                *edge = k;
                return true;
            }
            at = direction == 0 ? t->beside[(k + 2) % 3] : t->beside[k];
        } while (at != CWI_NOTHING && at != f);
        if (at == f)
            return false;
    }
    return false;
}

/* Flips the edges opposite to a new point until circles are empty, as far as doubles see it. */
static bool improve_around(cwi_split *s, uint32_t p, size_t count)
{
    while (count) {
        count--;
        uint32_t f;
        int k;
        const uint32_t a = s->queue[count][0], b = s->queue[count][1];
        if (!find_edge(s, a, b, &f, &k) || s->faces[f].corners[(k + 2) % 3] != p ||
            s->faces[f].beside[k] == CWI_NOTHING || !is_in_circle(s, f, k) ||
            !may_flip(s, f, k))
            continue;
        flip_edge(s, f, k);
        const uint32_t d = s->faces[f].corners[1];
        if (!push_edge(s, &count, a, d) || !push_edge(s, &count, d, b))
            return false;
    }
    return true;
}

/* --- points ------------------------------------------------------------------------------- */

static bool split_face(cwi_split *s, uint32_t f, uint32_t p)
{
    if (!make_room(s, &s->faces, &s->face_capacity, s->face_count + 1, sizeof *s->faces))
        return false;
    const cwi_split_face t = s->faces[f];
    const uint32_t g = (uint32_t)s->face_count++, h = (uint32_t)s->face_count++;
    const uint32_t a = t.corners[0], b = t.corners[1], c = t.corners[2];
    set_face(s, f, (uint32_t[3]){a, b, p}, (uint32_t[3]){t.beside[0], g, h},
             (uint32_t[3]){t.line[0], CWI_NOTHING, CWI_NOTHING});
    set_face(s, g, (uint32_t[3]){b, c, p}, (uint32_t[3]){t.beside[1], h, f},
             (uint32_t[3]){t.line[1], CWI_NOTHING, CWI_NOTHING});
    set_face(s, h, (uint32_t[3]){c, a, p}, (uint32_t[3]){t.beside[2], f, g},
             (uint32_t[3]){t.line[2], CWI_NOTHING, CWI_NOTHING});
    replace_beside(s, t.beside[1], f, g);
    replace_beside(s, t.beside[2], f, h);
    s->last = f;
    size_t count = 0;
    return push_edge(s, &count, a, b) && push_edge(s, &count, b, c) &&
           push_edge(s, &count, c, a) && improve_around(s, p, count);
}

static bool split_edge(cwi_split *s, uint32_t f, int k, uint32_t p)
{
    if (!make_room(s, &s->faces, &s->face_capacity, s->face_count + 1, sizeof *s->faces))
        return false;
    const cwi_split_face t = s->faces[f];
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    const uint32_t a = t.corners[k], b = t.corners[k1], c = t.corners[k2], g = t.beside[k];
    const uint32_t h = (uint32_t)s->face_count++, line = t.line[k];
    const uint32_t beyond = g == CWI_NOTHING ? CWI_NOTHING : (uint32_t)s->face_count++;
    set_face(s, f, (uint32_t[3]){a, p, c}, (uint32_t[3]){g, h, t.beside[k2]},
             (uint32_t[3]){line, CWI_NOTHING, t.line[k2]});
    set_face(s, h, (uint32_t[3]){p, b, c}, (uint32_t[3]){beyond, t.beside[k1], f},
             (uint32_t[3]){line, t.line[k1], CWI_NOTHING});
    replace_beside(s, t.beside[k1], f, h);
    s->last = f;
    size_t count = 0;
    if (!push_edge(s, &count, c, a) || !push_edge(s, &count, b, c))
        return false;
    if (g != CWI_NOTHING) {
        const cwi_split_face u = s->faces[g];
        const int m = find_border(&u, f);
        const int m1 = (m + 1) % 3, m2 = (m + 2) % 3;
        const uint32_t d = u.corners[m2];
        set_face(s, g, (uint32_t[3]){p, a, d}, (uint32_t[3]){f, u.beside[m1], beyond},
                 (uint32_t[3]){line, u.line[m1], CWI_NOTHING});
        set_face(s, beyond, (uint32_t[3]){b, p, d}, (uint32_t[3]){h, g, u.beside[m2]},
                 (uint32_t[3]){line, CWI_NOTHING, u.line[m2]});
        replace_beside(s, u.beside[m2], g, beyond);
        if (!push_edge(s, &count, a, d) || !push_edge(s, &count, d, b))
            return false;
    }
    return improve_around(s, p, count);
}

/* Finds the face that has a point: its sides of the three edges are not negative. */
static uint32_t find_face(const cwi_split *s, uint32_t p, int sides[3])
{
    uint32_t f = s->last;
    size_t steps = 4 * s->face_count + 16;
    for (size_t step = 0; step < steps;
         step++) { /* other corners first each time: no walk in circles */
        uint32_t next = CWI_NOTHING;
        for (int n = 0; n < 3 && next == CWI_NOTHING; n++) {
            const int k = (int)((step + (size_t)n) % 3);
            const cwi_split_face *t = &s->faces[f];
            sides[k] = turn_of(s, t->corners[k], t->corners[(k + 1) % 3], p);
            if (sides[k] < 0)
                next = t->beside[k];
        }
        if (next == CWI_NOTHING)
            return f;
        f = next;
    }
    for (f = 0; f < s->face_count; f++) {
        bool has = true;
        for (int k = 0; k < 3 && has; k++) {
            const cwi_split_face *t = &s->faces[f];
            sides[k] = turn_of(s, t->corners[k], t->corners[(k + 1) % 3], p);
            has = sides[k] >= 0;
        }
        if (has)
            return f;
    }
    return CWI_NOTHING;
}

bool cwi_split_add_point(cwi_split *s, const cwi_exact_point *p, uint32_t number, uint32_t *n)
{
    int sides[3];
    if (!has_room_for_point(s))
        return false;
    *n = new_point(s, p, number);
    const uint32_t f = find_face(s, *n, sides);
    if (f == CWI_NOTHING)
        return false;
    const int zeros = (sides[0] == 0) + (sides[1] == 0) + (sides[2] == 0);
    if (zeros == 0)
        return split_face(s, f, *n);
    if (zeros == 1)
        return split_edge(s, f, sides[0] == 0 ? 0 : sides[1] == 0 ? 1 : 2, *n);
    s->point_count--; /* a corner: that of both edges */
    *n = s->faces[f].corners[sides[0] != 0 ? 2 : sides[1] != 0 ? 0 : 1];
    return true;
}

/* --- lines -------------------------------------------------------------------------------- */

static void mark_edge(cwi_split *s, uint32_t f, int k, uint32_t line)
{
    const uint32_t g = s->faces[f].beside[k];
    if (s->faces[f].line[k] != CWI_NOTHING)
        return;
    s->faces[f].line[k] = line;
    for (int m = 0; m < 3 && g != CWI_NOTHING; m++)
        if (s->faces[g].beside[m] == f)
            s->faces[g].line[m] = line;
}

/* Returns true if c, on the line through a and b, is on b's side of a. */
static bool is_towards(const cwi_split *s, uint32_t a, uint32_t b, uint32_t c)
{
    return cwi_point_order(s->soup, &s->points[a], &s->points[b]) ==
           cwi_point_order(s->soup, &s->points[a], &s->points[c]);
}

/* The first thing that a line from a to b meets. */
typedef struct first_hit {
    uint32_t face;  /* that the line leaves through */
    int edge;       /* edge `edge`; or that runs along it: */
    uint32_t point; /* its end that is met; CWI_NOTHING: the edge is crossed */
} first_hit;

static bool look_at_face(const cwi_split *s, uint32_t f, uint32_t a, uint32_t b, first_hit *hit)
{
    const cwi_split_face *t = &s->faces[f];
    const int k = t->corners[0] == a   ? 0
                  : t->corners[1] == a ? 1
                                       : 2,
              k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    const int right = turn_of(s, a, b, t->corners[k1]), left = turn_of(s, a, b, t->corners[k2]);
    if (right == 0 && is_towards(s, a, b, t->corners[k1]))
        *hit = (first_hit){f, k, t->corners[k1]};
    else if (left == 0 && is_towards(s, a, b, t->corners[k2]))
        *hit = (first_hit){f, k2, t->corners[k2]};
    else if (right < 0 && left > 0)
        *hit = (first_hit){f, k1, CWI_NOTHING};
    else
        return false;
    return true;
}

static bool find_first_hit(const cwi_split *s, uint32_t a, uint32_t b, first_hit *hit)
{
    const uint32_t f = s->face_at[a];
    for (int direction = 0; direction < 2; direction++) {
        uint32_t at = f;
        do {
            if (look_at_face(s, at, a, b, hit))
                return true;
            const cwi_split_face *t = &s->faces[at];
            const int k = t->corners[0] == a ? 0 : t->corners[1] == a ? 1 : 2;
            at = direction == 0 ? t->beside[(k + 2) % 3] : t->beside[k];
        } while (at != CWI_NOTHING && at != f);
        if (at == f)
            return false;
    }
    return false;
}

/* The point at which a line crosses the line that an edge is part of. */
static cwi_exact_point cross_lines(const cwi_split *s, cwi_split_line a, cwi_split_line b)
{
    const bool a_is_plane = a.on[1] == CWI_NOTHING, b_is_plane = b.on[1] == CWI_NOTHING;
    if (a_is_plane && b_is_plane)
        return cwi_point_planes(s->soup, (const uint32_t[3]){s->triangle, a.on[0], b.on[0]});
    if (a_is_plane)
        return cwi_point_line_plane(s->soup, b.on[0], b.on[1], a.on[0]);
    if (b_is_plane)
        return cwi_point_line_plane(s->soup, a.on[0], a.on[1], b.on[0]);
    return cwi_point_line_line(s->soup, (const uint32_t[4]){a.on[0], a.on[1], b.on[0], b.on[1]},
                               s->axis);
}

/* Flips the edges of the queue, all of which a line from a to b crosses, until none does. */
static bool clear_way(cwi_split *s, size_t count, uint32_t a, uint32_t b)
{
    size_t first = 0;
    for (size_t steps = 0; first < count; first++, steps++) {
        uint32_t f;
        int k;
        const uint32_t p = s->queue[first][0], q = s->queue[first][1];
        if (steps > 64 + 16 * s->face_count * s->face_count || !find_edge(s, p, q, &f, &k))
            return false;
        if (!may_flip(s, f, k)) {
            if (!push_edge(s, &count, p, q))
                return false;
            continue;
        }
        flip_edge(s, f, k);
        const uint32_t c = s->faces[f].corners[2], d = s->faces[f].corners[1];
        if (c != a && c != b && d != a && d != b &&
            turn_of(s, a, b, c) * turn_of(s, a, b, d) < 0 && !push_edge(s, &count, d, c))
            return false;
    }
    return true;
}

static bool add_line(cwi_split *s, uint32_t from, uint32_t to, uint32_t line);

/* Splits an edge of another line where the line from a to b crosses it, and makes an edge to there. */
static bool cross_edge(cwi_split *s, uint32_t f, int k, uint32_t a, uint32_t line,
                       uint32_t *reached)
{
    const cwi_exact_point x = cross_lines(s, s->lines[line], s->lines[s->faces[f].line[k]]);
    if (!has_room_for_point(s))
        return false;
    *reached = new_point(s, &x, CWI_NOTHING);
    return split_edge(s, f, k, *reached) && add_line(s, a, *reached, line);
}

/* Follows the line from a to b, which leaves a through an edge, to the first point or other line that it meets,
 * and makes an edge to there. */
static bool make_edge(cwi_split *s, uint32_t a, uint32_t b, uint32_t line, first_hit hit,
                      uint32_t *reached)
{
    size_t count = 0;
    uint32_t f = hit.face, target = CWI_NOTHING;
    int k = hit.edge;
    while (target == CWI_NOTHING) {
        const cwi_split_face *t = &s->faces[f];
        const uint32_t g = t->beside[k];
        if (t->line[k] != CWI_NOTHING)
            return cross_edge(s, f, k, a, line, reached);
        if (g == CWI_NOTHING || !push_edge(s, &count, t->corners[k], t->corners[(k + 1) % 3]))
            return false;
        const cwi_split_face *u = &s->faces[g];
        const int m = find_border(u, f);
        const uint32_t d = u->corners[(m + 2) % 3];
        const int side = d == b ? 0 : turn_of(s, a, b, d);
        if (side == 0)
            target = d;
        k = side > 0 ? (m + 1) % 3
                     : (m + 2) % 3; /* between d and the edge's end on the other side */
        f = g;
    }
    *reached = target;
    if (!clear_way(s, count, a, target) ||
        (!find_edge(s, a, target, &f, &k) && !find_edge(s, target, a, &f, &k)))
        return false;
    mark_edge(s, f, k, line);
    return true;
}

static bool add_line(cwi_split *s, uint32_t from, uint32_t to, uint32_t line)
{
    while (from != to) {
        first_hit hit;
        if (!find_first_hit(s, from, to, &hit))
            return false;
        if (hit.point != CWI_NOTHING) {
            mark_edge(s, hit.face, hit.edge, line);
            from = hit.point;
        } else if (!make_edge(s, from, to, line, hit, &from))
            return false;
    }
    return true;
}

bool cwi_split_add_line(cwi_split *s, uint32_t from, uint32_t to, cwi_split_line line)
{
    if (!make_room(s, &s->lines, &s->line_capacity, s->line_count, sizeof *s->lines))
        return false;
    s->lines[s->line_count] = line;
    return add_line(s, from, to, (uint32_t)s->line_count++);
}
