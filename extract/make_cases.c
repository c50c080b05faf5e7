/* Writes the marching cubes case table, from definitions alone.
 *
 * 1. On every face of the cube the crossed edges are joined by segments, one around each run of
 *    inside corners. A face with two inside corners on a diagonal has two runs: its inside
 *    corners are kept apart. The rule sees only the four corners of the face, so both cubes at
 * a face draw the same segments, and no hole opens between them [Montani1994].
 * 2. A segment runs from where its face, walked counter-clockwise from outside, enters the run
 * to where it leaves. The neighbouring face walks each edge the other way, so what one segment
 *    ends at, exactly one other starts from: segments close up into directed loops.
 * 3. Each loop is a polygon, triangulated without new points. No diagonal may join two points
 * of one face: it would lie in the wall between two cubes, where the neighbour's may lie too,
 * and four triangles would share an edge. Of what is left the triangulation with the widest
 * smallest angle, points in the middle of their edges, is taken.
 *
 * The tests prove the result: every case's triangles are bounded by exactly its face segments.
 */
#include "extract/cases.h"
#include "extract/cube.h"

#include <math.h>
#include <stdbool.h>
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

/* next[e] = the edge that the loop through e goes to; -1 where the surface does not cross. */
static void trace_faces(int cube_case, int next[12])
{
    for (int e = 0; e < 12; e++)
        next[e] = -1;
    for (int face = 0; face < 6; face++)
        for (int n = 0; n < 4; n++) {
            const int before = cwi_face_corner(face, n),
                      first = cwi_face_corner(face, (n + 1) % 4);
            if (inside(cube_case, before) || !inside(cube_case, first))
                continue;
            int m = (n + 1) % 4; /* walk to the end of the run that begins here */
            while (inside(cube_case, cwi_face_corner(face, (m + 1) % 4)))
                m = (m + 1) % 4;
            next[cwi_edge_between(before, first)] =
                cwi_edge_between(cwi_face_corner(face, m), cwi_face_corner(face, (m + 1) % 4));
        }
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

static triangles triangulate_case(int cube_case)
{
    int next[12];
    triangles all = {0};
    trace_faces(cube_case, next);
    for (int e = 0; e < 12; e++) {
        const polygon loop = take_loop(next, e);
        triangles t;
        if (loop.count == 0)
            continue;
        if (triangulate(&loop, 0, loop.count - 1, &t) < 0 ||
            all.count + t.count > CWI_CASE_MAX_TRIANGLES) {
            fprintf(stderr, "make_cases: case %d has no triangulation\n", cube_case);
            exit(1);
        }
        memcpy(all.edge[all.count], t.edge, (size_t)t.count * sizeof t.edge[0]);
        all.count += t.count;
    }
    return all;
}

int main(void)
{
    triangles cases[256];
    for (int c = 0; c < 256; c++)
        cases[c] = triangulate_case(c);

    puts("/* Made by make_cases.c: do not edit. */\n#include \"extract/cases.h\"\n");
    puts("const uint8_t cwi_case_count[256] = {");
    for (int c = 0; c < 256; c++)
        printf("%d,%s", cases[c].count, c % 32 == 31 ? "\n" : "");
    puts("};\n\nconst uint8_t cwi_case_triangles[256][3 * CWI_CASE_MAX_TRIANGLES] = {");
    for (int c = 0; c < 256; c++) {
        printf("{");
        for (int t = 0; t < cases[c].count; t++)
            printf("%d,%d,%d, ", cases[c].edge[t][0], cases[c].edge[t][1], cases[c].edge[t][2]);
        printf("%s},\n", cases[c].count ? "" : "0");
    }
    puts("};");
    return 0;
}
