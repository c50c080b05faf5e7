/* Random triangles, counted by the checks and by the plainest loops over all pairs. */
#include "support/surface.h"

#include <stdlib.h>
#include <string.h>

enum { CORNERS = 9, MOST = 48, ROUNDS = 3000 };

static uint64_t seed = 11;

static uint32_t draw_number(uint32_t below)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(seed >> 33) % below;
}

/* Triangles of a few vertices; those that name a vertex twice are left out of what follows. */
typedef struct list {
    uint32_t corner[MOST][3];
    size_t count;
    uint8_t marks[MOST]; /* expected */
} list;

static bool is_collapsed(const uint32_t *c)
{
    return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

static bool has_vertex(const list *l, size_t t, uint32_t v)
{
    const uint32_t *c = l->corner[t];
    return !is_collapsed(c) && (c[0] == v || c[1] == v || c[2] == v);
}

static bool has_edge(const list *l, size_t t, uint32_t a, uint32_t b)
{
    return has_vertex(l, t, a) && has_vertex(l, t, b);
}

static bool runs_along(const uint32_t *c, uint32_t a, uint32_t b)
{
    return (c[0] == a && c[1] == b) || (c[1] == a && c[2] == b) || (c[2] == a && c[0] == b);
}

/* Gives labels that touch the lowest of them, until nothing changes. */
static bool lower_labels(uint32_t *a, uint32_t *b)
{
    const bool differ = *a != *b;
    const uint32_t low = *a < *b ? *a : *b;
    *a = *b = low;
    return differ;
}

/* fan[v][t]: the label of the triangle's fan around the vertex. */
typedef uint32_t fans[CORNERS][MOST];

static void find_fans(const list *l, fans fan)
{
    for (uint32_t v = 0; v < CORNERS; v++) {
        for (size_t t = 0; t < l->count; t++)
            fan[v][t] = (uint32_t)t;
        for (bool changes = true; changes;) {
            changes = false;
            for (size_t s = 0; s < l->count; s++)
                for (size_t t = 0; t < l->count; t++)
                    for (uint32_t u = 0; u < CORNERS; u++)
                        if (u != v && has_edge(l, s, u, v) && has_edge(l, t, u, v))
                            changes |= lower_labels(&fan[v][s], &fan[v][t]);
        }
    }
}

static void count_edges(list *l, cw_quality *q)
{
    for (uint32_t a = 0; a < CORNERS; a++)
        for (uint32_t b = a + 1; b < CORNERS; b++) {
            size_t around = 0, up = 0;
            for (size_t t = 0; t < l->count; t++) {
                around += has_edge(l, t, a, b);
                up += has_edge(l, t, a, b) && runs_along(l->corner[t], a, b);
            }
            const unsigned mark = around == 1              ? CW_DEFECT_OPEN
                                  : around > 2             ? CW_DEFECT_NONMANIFOLD
                                  : around == 2 && up != 1 ? CW_DEFECT_MISORIENTED
                                                           : 0;
            q->edges += around > 0;
            q->open_edges += around == 1;
            q->nonmanifold_edges += around > 2;
            q->contact_edges += around > 2 && 2 * up == around;
            q->misoriented_edges += around == 2 && up != 1;
            for (size_t t = 0; t < l->count; t++)
                l->marks[t] |= has_edge(l, t, a, b) ? (uint8_t)mark : 0;
        }
}

static void count_duplicates(list *l, cw_quality *q)
{
    for (size_t t = 0; t < l->count; t++) {
        bool is_later = false;
        for (size_t s = 0; s < l->count; s++) {
            const uint32_t *c = l->corner[t];
            if (s == t || !has_edge(l, s, c[0], c[1]) || !has_edge(l, s, c[1], c[2]) ||
                is_collapsed(c))
                continue;
            l->marks[t] |= CW_DEFECT_DUPLICATE;
            is_later |= s < t;
        }
        q->duplicates += is_later;
    }
}

/* Returns true if as many triangles run through each edge at a vertex one way as the other. */
static bool has_pairs_around(const list *l, uint32_t v)
{
    for (uint32_t b = 0; b < CORNERS; b++) {
        int sum = 0;
        for (size_t t = 0; t < l->count; t++)
            for (int c = 0; c < 3 && b != v && !is_collapsed(l->corner[t]); c++) {
                const uint32_t from = l->corner[t][c], to = l->corner[t][(c + 1) % 3];
                sum += (from == v && to == b) - (from == b && to == v);
            }
        if (sum)
            return false;
    }
    return true;
}

static void count_vertices(list *l, fans fan, cw_quality *q)
{
    uint32_t part[CORNERS];
    size_t used = 0;
    for (uint32_t v = 0; v < CORNERS; v++)
        part[v] = v;
    for (size_t n = 0; n < CORNERS; n++)
        for (size_t t = 0; t < l->count; t++)
            for (int c = 0; c < 3 && !is_collapsed(l->corner[t]); c++)
                lower_labels(&part[l->corner[t][c]], &part[l->corner[t][(c + 1) % 3]]);
    for (uint32_t v = 0; v < CORNERS; v++) {
        size_t around = 0, own = 0;
        for (size_t t = 0; t < l->count; t++) {
            around += has_vertex(l, t, v);
            own += has_vertex(l, t, v) && fan[v][t] == t;
        }
        used += around > 0;
        q->components += around > 0 && part[v] == v;
        q->nonmanifold_vertices += own > 1;
        q->contact_vertices += own > 1 && has_pairs_around(l, v);
        for (size_t t = 0; t < l->count && own > 1; t++)
            for (int c = 0; c < 3; c++)
                l->marks[t] |= l->corner[t][c] == v ? CW_DEFECT_NONMANIFOLD : 0;
    }
    q->euler = (int64_t)used - (int64_t)q->edges;
    for (size_t t = 0; t < l->count; t++)
        q->euler += !is_collapsed(l->corner[t]);
}

/* Returns the triangle at an open edge; MOST for any other edge. */
static size_t open_triangle(const list *l, uint32_t a, uint32_t b)
{
    size_t found = MOST, around = 0;
    for (size_t t = 0; t < l->count; t++)
        if (has_edge(l, t, a, b)) {
            found = t;
            around++;
        }
    return around == 1 ? found : MOST;
}

/* Fans that open edges join belong to one loop. */
static void count_loops(const list *l, fans fan, cw_quality *q)
{
    static uint32_t loop[CORNERS][MOST];
    bool on_loop[CORNERS * MOST] = {false};
    for (uint32_t v = 0; v < CORNERS; v++)
        for (uint32_t t = 0; t < MOST; t++)
            loop[v][t] = v * MOST + t;
    for (bool changes = true; changes;) {
        changes = false;
        for (uint32_t a = 0; a < CORNERS; a++)
            for (uint32_t b = 0; b < a; b++) {
                const size_t t = open_triangle(l, a, b);
                if (t < MOST)
                    changes |= lower_labels(&loop[a][fan[a][t]], &loop[b][fan[b][t]]);
            }
    }
    for (uint32_t a = 0; a < CORNERS; a++)
        for (uint32_t b = 0; b < a; b++) {
            const size_t t = open_triangle(l, a, b);
            if (t < MOST)
                on_loop[loop[a][fan[a][t]]] = true;
        }
    for (size_t n = 0; n < CORNERS * MOST; n++)
        q->border_loops += on_loop[n];
}

static void hold_counts(const cw_quality *q, const cw_quality *expected)
{
    assert_int_equal(q->edges, expected->edges);
    assert_int_equal(q->components, expected->components);
    assert_int_equal(q->euler, expected->euler);
    assert_int_equal(q->open_edges, expected->open_edges);
    assert_int_equal(q->border_loops, expected->border_loops);
    assert_int_equal(q->nonmanifold_edges, expected->nonmanifold_edges);
    assert_int_equal(q->misoriented_edges, expected->misoriented_edges);
    assert_int_equal(q->nonmanifold_vertices, expected->nonmanifold_vertices);
    assert_int_equal(q->contact_edges, expected->contact_edges);
    assert_int_equal(q->contact_vertices, expected->contact_vertices);
    assert_int_equal(q->duplicates, expected->duplicates);
}

/* The vertices lie `apart` numbers apart, so that some are measured with their neighbours and
 * some without. */
static void hold_list(const list *l, const cw_quality *expected, uint32_t apart)
{
    static float points[3 * CORNERS * 5000];
    uint32_t corners[3 * MOST];
    const cw_mesh mesh = {.vertex_count = (size_t)CORNERS * apart,
                          .triangle_count = l->count,
                          .positions = points,
                          .triangles = corners};
    for (size_t i = 0; i < 3 * l->count; i++)
        corners[i] = l->corner[i / 3][i % 3] * apart + apart / 2;
    for (int threads = 1; threads <= 3; threads += 2) {
        uint8_t marks[MOST] = {0};
        const unsigned counted = CW_DEFECT_OPEN | CW_DEFECT_NONMANIFOLD |
                                 CW_DEFECT_MISORIENTED | CW_DEFECT_DUPLICATE;
        cw_error err = {0};
        cw_quality q;
        assert_ok(cw_quality_measure(&mesh,
                                     &(cw_quality_desc){.threads = threads, .defects = marks},
                                     &q, &err),
                  err);
        hold_counts(&q, expected);
        for (size_t t = 0; t < l->count; t++)
            assert_int_equal(marks[t] & counted, l->marks[t]);
    }
}

static void random_triangles_are_counted_as_by_plain_loops(void **state)
{
    (void)state;
    for (size_t round = 0; round < ROUNDS; round++) {
        static fans fan;
        list l = {.count = 1 + draw_number(round % 2 ? 12 : MOST)};
        cw_quality expected = {0};
        for (size_t i = 0; i < 3 * l.count; i++)
            l.corner[i / 3][i % 3] = draw_number(CORNERS);
        find_fans(&l, fan);
        count_edges(&l, &expected);
        count_duplicates(&l, &expected);
        count_vertices(&l, fan, &expected);
        count_loops(&l, fan, &expected);
        hold_list(&l, &expected, round % 8 ? 1 : 5000);
    }
}

/* A fan around a hub of any size, closed or with a gap, in random order: small ones are put in
 * order, large ones are sorted. */
static void fans_of_any_size_are_seen_as_they_are(void **state)
{
    (void)state;
    enum { LARGEST = 60 };
    static float points[3 * (LARGEST + 1)];
    for (uint32_t size = 3; size <= LARGEST; size++)
        for (uint32_t gap = 0; gap < 2; gap++) {
            uint32_t corners[3 * LARGEST];
            const uint32_t count = size - gap;
            for (uint32_t t = 0; t < count; t++) {
                const uint32_t fan[3] = {0, 1 + t, 1 + (t + 1) % size};
                const uint32_t other = draw_number(t + 1), turn = draw_number(3);
                memcpy(corners + 3 * t, corners + 3 * other, sizeof fan);
                for (uint32_t c = 0; c < 3; c++)
                    corners[3 * other + c] = fan[(c + turn) % 3];
            }
            const cw_mesh mesh = {.vertex_count = size + 1,
                                  .triangle_count = count,
                                  .positions = points,
                                  .triangles = corners};
            cw_error err = {0};
            cw_quality q;
            assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
            assert_int_equal(q.edges, 2 * size - gap);
            assert_int_equal(q.open_edges, size + gap);
            assert_int_equal(q.border_loops, 1);
            assert_int_equal(q.nonmanifold_vertices + q.misoriented_edges, 0);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_triangles_are_counted_as_by_plain_loops),
        cmocka_unit_test(fans_of_any_size_are_seen_as_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
