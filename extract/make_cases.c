/* Writes the marching cubes tables, from definitions alone.
 *
 * 1. On every face of the cube the crossed edges are joined by segments, one around each run of
 *    inside corners. A face with two inside corners on a diagonal has two runs; if they are
 *    resolved as joined, the segments go around the outside corners instead. Both cubes at a
 * face resolve it alike, so they draw the same segments and no hole opens between them.
 * 2. A segment runs from where its face, walked counter-clockwise from outside, enters the
 * inside to where it leaves. The neighbouring face walks each edge the other way, so what one
 * segment ends at, exactly one other starts from: segments close up into directed loops.
 * 3. Each loop is a polygon, triangulated without new points. No diagonal may join two points
 * of one face: it would lie in the wall between two cubes, where the neighbour's may lie too,
 * and four triangles would share an edge. Of what is left the triangulation with the widest
 *    smallest angle, points in the middle of their edges, is taken. Some loops of 8, 9 and 12
 *    edges have none left, or only ones that cross themselves: those become cones around a
 * vertex inside the cube.
 *
 * The tests prove the result: every surface is bounded by exactly its face segments, and does
 * not cross itself wherever the points stand on their edges. */
#include "extract/cases.h"
#include "extract/cube.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LOOP = 12 };

typedef struct polygon {
    int count;
    int edge[MAX_LOOP];
} polygon;

typedef struct triangles {
    int count;
    int edge[MAX_LOOP][3];
} triangles;

static bool inside(int cube_case, int corner)
{
    return cube_case >> corner & 1;
}

static bool joins(int cube_case, int joined, int face)
{
    return cwi_face_is_ambiguous(cube_case, face) && (joined >> face & 1);
}

/* next[e] = the edge that the loop through e goes to; -1 where the surface does not cross. Bit
 * f of joined: the inside corners of face f are joined, if it is ambiguous. */
static void trace_faces(int cube_case, int joined, int next[12])
{
    for (int e = 0; e < 12; e++)
        next[e] = -1;
    for (int face = 0; face < 6; face++)
        for (int n = 0; n < 4; n++) {
            const int before = cwi_face_corner(face, n),
                      first = cwi_face_corner(face, (n + 1) % 4);
            if (inside(cube_case, before) || !inside(cube_case, first))
                continue;
            int m = (n + 1) % 4; /* the last corner of the run that begins here */
            while (inside(cube_case, cwi_face_corner(face, (m + 1) % 4)))
                m = (m + 1) % 4;
            if (joins(cube_case, joined, face))
                m = (m + 2) % 4; /* the run goes on through the face, to the other corner */
            next[cwi_edge_between(before, first)] =
                cwi_edge_between(cwi_face_corner(face, m), cwi_face_corner(face, (m + 1) % 4));
        }
}

static int find(const uint8_t *parent, int x)
{
    while (parent[x] != x)
        x = parent[x];
    return x;
}

static void unite(uint8_t *parent, int x, int y)
{
    x = find(parent, x);
    y = find(parent, y);
    parent[x > y ? x : y] = (uint8_t)(x > y ? y : x);
}

/* Corners of a kind are of one patch when edges, or the diagonals of faces, connect them. */
static void trace_patches(int cube_case, int joined, uint8_t patch[8])
{
    for (int c = 0; c < 8; c++)
        patch[c] = (uint8_t)c;
    for (int e = 0; e < 12; e++) {
        const int low = cwi_edge_corner(e), high = low | 1 << cwi_edge_axis(e);
        if (inside(cube_case, low) == inside(cube_case, high))
            unite(patch, low, high);
    }
    for (int face = 0; face < 6; face++)
        if (cwi_face_is_ambiguous(cube_case, face)) {
            const bool first_inside = inside(cube_case, cwi_face_corner(face, 0));
            const int n = first_inside == joins(cube_case, joined, face) ? 0 : 1;
            unite(patch, cwi_face_corner(face, n), cwi_face_corner(face, n + 2));
        }
    for (int c = 0; c < 8; c++)
        patch[c] = (uint8_t)find(patch, c);
}

static void midpoint(int edge, double p[3])
{
    const int corner = cwi_edge_corner(edge);
    for (int a = 0; a < 3; a++)
        p[a] = (corner >> a & 1) + (a == cwi_edge_axis(edge) ? 0.5 : 0);
}

/* Two edges lie on one face when their midpoints agree in a coordinate that is 0 or 1. */
static bool share_face(int e, int f)
{
    double p[3], q[3];
    midpoint(e, p);
    midpoint(f, q);
    for (int a = 0; a < 3; a++)
        if (p[a] == q[a] && p[a] != 0.5)
            return true;
    return false;
}

static double smallest_angle(const int edge[3])
{
    double p[3][3], smallest = 4;
    for (int i = 0; i < 3; i++)
        midpoint(edge[i], p[i]);
    for (int i = 0; i < 3; i++) {
        double uv = 0, uu = 0, vv = 0;
        for (int a = 0; a < 3; a++) {
            const double u = p[(i + 1) % 3][a] - p[i][a], v = p[(i + 2) % 3][a] - p[i][a];
            uv += u * v;
            uu += u * u;
            vv += v * v;
        }
        smallest = fmin(smallest, acos(uv / sqrt(uu * vv)));
    }
    return smallest;
}

static bool may_join(const polygon *p, int i, int j)
{
    const bool neighbours = j == i + 1 || (i == 0 && j == p->count - 1);
    return neighbours || !share_face(p->edge[i], p->edge[j]);
}

/* The best triangulation of the corners i..j of a polygon, whose side i-j is settled; returns
 * its smallest angle, below 0 when there is none. Exhaustive: loops are short. */
static double triangulate(const polygon *p, int i, int j, triangles *best)
{
    double best_angle = -1;
    best->count = 0;
    if (j - i < 2)
        return 4;
    for (int k = i + 1; k < j; k++) {
        if (!may_join(p, i, k) || !may_join(p, k, j))
            continue;
        const int corner[3] = {p->edge[i], p->edge[k], p->edge[j]};
        triangles left, right;
        double angle = fmin(triangulate(p, i, k, &left), triangulate(p, k, j, &right));
        angle = fmin(angle, smallest_angle(corner));
        if (angle <= best_angle + 1e-9)
            continue;
        best_angle = angle;
        *best = left;
        memcpy(best->edge[best->count++], corner, sizeof corner);
        memcpy(best->edge[best->count], right.edge, (size_t)right.count * sizeof corner);
        best->count += right.count;
    }
    return best_angle;
}

/* Takes the loop through an edge out of next[]. */
static polygon take_loop(int next[12], int edge)
{
    polygon p = {0};
    while (next[edge] >= 0) {
        const int to = next[edge];
        p.edge[p.count++] = edge;
        next[edge] = -1;
        edge = to;
    }
    return p;
}

/* Loops of 9 have no triangulation, and those of 8 and 12 may cross themselves. */
static bool needs_cone(const polygon *loop, triangles *t)
{
    t->count = 0;
    if (loop->count >= 8)
        return true;
    if (triangulate(loop, 0, loop->count - 1, t) >= 0)
        return false;
    fprintf(stderr, "make_cases: a loop of %d edges has no triangulation\n", loop->count);
    exit(1);
}

static cwi_config resolve(int cube_case, int joined)
{
    int next[12];
    cwi_config config = {0};
    uint8_t *edge = config.loop_edges, *corner = config.triangles;
    trace_faces(cube_case, joined, next);
    trace_patches(cube_case, joined, config.patch);
    for (int e = 0; e < 12; e++) {
        const polygon loop = take_loop(next, e);
        triangles t;
        if (loop.count == 0)
            continue;
        config.loop_length[config.loop_count] = (uint8_t)loop.count;
        for (int i = 0; i < loop.count; i++)
            *edge++ = (uint8_t)loop.edge[i];
        config.cone[config.loop_count] = needs_cone(&loop, &t);
        for (int i = 0; i < 3 * t.count && !config.cone[config.loop_count]; i++)
            *corner++ = (uint8_t)t.edge[i / 3][i % 3];
        config.loop_count++;
    }
    return config;
}

static int ambiguous_faces(int cube_case)
{
    int faces = 0;
    for (int face = 0; face < 6; face++)
        faces |= cwi_face_is_ambiguous(cube_case, face) << face;
    return faces;
}

/* Spreads the bits of a count over the set bits of a mask, lowest first. */
static int spread(int count, int mask)
{
    int spread_bits = 0;
    for (int face = 0; face < 6; face++)
        if (mask >> face & 1) {
            spread_bits |= (count & 1) << face;
            count >>= 1;
        }
    return spread_bits;
}

static int triangle_count(const cwi_config *c)
{
    int count = 0;
    for (int l = 0; l < c->loop_count; l++)
        count += c->cone[l] ? 0 : c->loop_length[l] - 2;
    return count;
}

static void print_bytes(const uint8_t *bytes, int count)
{
    printf("{");
    for (int i = 0; i < count; i++)
        printf("%d,", bytes[i]);
    printf("%s}", count ? "" : "0");
}

static void print_config(const cwi_config *c)
{
    printf("{%d, ", c->loop_count);
    print_bytes(c->loop_length, CWI_CASE_MAX_LOOPS);
    print_bytes((printf(", "), c->loop_edges), 12);
    printf(", {%d,%d,%d,%d}, ", c->cone[0], c->cone[1], c->cone[2], c->cone[3]);
    print_bytes(c->triangles, 3 * triangle_count(c));
    print_bytes((printf(", "), c->patch), 8);
    puts("},");
}

/* One number a case. */
static void print_table(const char *head, int (*number)(int cube_case))
{
    printf("\nconst %s[256] = {\n", head);
    for (int c = 0; c < 256; c++)
        printf("%d,%s", number(c), c % 32 == 31 ? "\n" : "");
    puts("};");
}

static int simple_count(int cube_case)
{
    const cwi_config c = resolve(cube_case, 0);
    if (triangle_count(&c) > CWI_CASE_MAX_TRIANGLES || c.cone[0]) {
        fprintf(stderr, "make_cases: case %d has no simple triangulation\n", cube_case);
        exit(1);
    }
    return triangle_count(&c);
}

static int is_ambiguous(int cube_case)
{
    return ambiguous_faces(cube_case) || resolve(cube_case, 0).loop_count > 1;
}

static int config_count(int cube_case)
{
    return 1 << __builtin_popcount((unsigned)ambiguous_faces(cube_case));
}

static int first_config(int cube_case)
{
    int first = 0;
    for (int c = 0; c < cube_case; c++)
        first += config_count(c);
    return first;
}

int main(void)
{
    puts("/* Made by make_cases.c: do not edit. */\n#include \"extract/cases.h\"");
    print_table("uint8_t cwi_case_count", simple_count);
    print_table("uint8_t cwi_case_ambiguous_faces", ambiguous_faces);
    print_table("bool cwi_case_is_ambiguous", is_ambiguous);
    print_table("uint16_t cwi_case_first_config", first_config);
    puts("\nconst uint8_t cwi_case_triangles[256][3 * CWI_CASE_MAX_TRIANGLES] = {");
    for (int c = 0; c < 256; c++) {
        const cwi_config config = resolve(c, 0);
        print_bytes(config.triangles, 3 * triangle_count(&config));
        puts(",");
    }
    puts("};\n\nconst cwi_config cwi_configs[CWI_CASE_CONFIGS] = {");
    for (int c = 0; c < 256; c++)
        for (int n = 0; n < config_count(c); n++) {
            const cwi_config config = resolve(c, spread(n, ambiguous_faces(c)));
            print_config(&config);
        }
    puts("};");
    return 0;
}
