/* Writes the tables of cases, of cubes and of the other shapes of cells, from definitions
 * alone.
 *
 * 1. On every face of the cell the crossed edges are joined by segments, one around each run of
 *    inside corners. A face with two inside corners on a diagonal has two runs; if they are
 *    resolved as joined, the segments go around the outside corners instead. Both cells at a
 * face resolve it alike, so they draw the same segments and no hole opens between them.
 * 2. A segment runs from where its face, walked counter-clockwise from outside, enters the
 * inside to where it leaves. The neighbouring face walks each edge the other way, so what one
 * segment ends at, exactly one other starts from: segments close up into directed loops.
 * 3. Each loop is a polygon, triangulated without new points. No diagonal may join two points
 * of one face: it would lie in the wall between two cells, where the neighbour's may lie too,
 * and four triangles would share an edge. Of the others the triangulation with the widest
 *    smallest angle, points in the middle of their edges, is taken. Some loops of 8, 9 and 12
 *    edges have none left, or only ones that cross themselves: those become cones around a
 * vertex inside the cell.
 *
 * The tests prove the result: every surface is bounded by exactly its face segments, and does
 * not cross itself wherever the points stand on their edges. */
#include "core/cases/case_tables.h"
#include "core/cases/cube_numbering.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LOOP = 12 };

/* A cell by its corners, where they stand, and its faces, walked counter-clockwise seen from
 * outside. */
typedef struct shape {
    const char *name;
    int corner_count, edge_count, face_count;
    double at[8][3];
    int face_size[6], face[6][4];
    int edge[12][2]; /* filled by complete() */
    int face_edge[6][4];
} shape;

static shape shapes[CW_SHAPE_COUNT] = {
    [CW_TETRAHEDRON] = {"tetrahedron",
                        4,
                        0,
                        4,
                        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        {3, 3, 3, 3},
                        {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
                        {{0}},
                        {{0}}},
    [CW_PYRAMID] = {"pyramid",
                    5,
                    0,
                    5,
                    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
                    {4, 3, 3, 3, 3},
                    {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
                    {{0}},
                    {{0}}},
    [CW_WEDGE] = {"wedge",
                  6,
                  0,
                  5,
                  {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                  {3, 3, 4, 4, 4},
                  {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
                  {{0}},
                  {{0}}},
    [CW_HEXAHEDRON] = {.name = "hexahedron", .corner_count = 8, .face_count = 6},
};

/* The hexahedron is cube_numbering.h's. */
static void define_cube(shape *s)
{
    for (int c = 0; c < 8; c++)
        for (int a = 0; a < 3; a++)
            s->at[c][a] = c >> a & 1;
    for (int face = 0; face < 6; face++) {
        s->face_size[face] = 4;
        for (int n = 0; n < 4; n++)
            s->face[face][n] = cwi_face_corner(face, n);
    }
    s->edge_count = 12;
    for (int e = 0; e < 12; e++) {
        s->edge[e][0] = cwi_edge_corner(e);
        s->edge[e][1] = cwi_edge_corner(e) | 1 << cwi_edge_axis(e);
    }
}

/* Returns the number of the edge between two corners; adds the edge when there is none yet. */
static int edge_between(shape *s, int a, int b)
{
    for (int e = 0; e < s->edge_count; e++)
        if ((s->edge[e][0] == a && s->edge[e][1] == b) ||
            (s->edge[e][0] == b && s->edge[e][1] == a))
            return e;
    s->edge[s->edge_count][0] = a < b ? a : b;
    s->edge[s->edge_count][1] = a < b ? b : a;
    return s->edge_count++;
}

static void complete_shape(shape *s)
{
    for (int face = 0; face < s->face_count; face++)
        for (int n = 0; n < s->face_size[face]; n++)
            s->face_edge[face][n] =
                edge_between(s, s->face[face][n], s->face[face][(n + 1) % s->face_size[face]]);
}

typedef struct polygon {
    int count;
    int edge[MAX_LOOP];
} polygon;

typedef struct triangles {
    int count;
    int edge[MAX_LOOP][3];
} triangles;

static bool is_inside(int cell_case, int corner)
{
    return cell_case >> corner & 1;
}

/* Returns true if the corners of a face are alternately inside and outside. */
static bool is_ambiguous_face(const shape *s, int cell_case, int face)
{
    bool turns = s->face_size[face] == 4;
    for (int n = 0; n < s->face_size[face]; n++)
        turns = turns && is_inside(cell_case, s->face[face][n]) !=
                             is_inside(cell_case, s->face[face][(n + 1) % s->face_size[face]]);
    return turns;
}

static bool joins_on_face(const shape *s, int cell_case, int joined, int face)
{
    return is_ambiguous_face(s, cell_case, face) && (joined >> face & 1);
}

/* Finds next[e], the edge that the loop through e goes to; -1 where the surface does not cross.
 * Bit f of joined: the inside corners of face f are joined, if it is ambiguous. */
static void trace_faces(const shape *s, int cell_case, int joined, int next[12])
{
    for (int e = 0; e < 12; e++)
        next[e] = -1;
    for (int face = 0; face < s->face_count; face++) {
        const int size = s->face_size[face], *corner = s->face[face];
        for (int n = 0; n < size; n++) {
            int m = (n + 1) % size; /* the last corner of the run that begins after n */
            if (is_inside(cell_case, corner[n]) || !is_inside(cell_case, corner[m]))
                continue;
            while (is_inside(cell_case, corner[(m + 1) % size]))
                m = (m + 1) % size;
            if (joins_on_face(s, cell_case, joined, face))
                m = (m + 2) % size; /* it goes on through the face, to the other corner */
            next[s->face_edge[face][n]] = s->face_edge[face][m];
        }
    }
}

static int find_root(const uint8_t *parent, int x)
{
    while (parent[x] != x)
        x = parent[x];
    return x;
}

static void unite_sets(uint8_t *parent, int x, int y)
{
    x = find_root(parent, x);
    y = find_root(parent, y);
    parent[x > y ? x : y] = (uint8_t)(x > y ? y : x);
}

/* Finds patches. Corners of one kind are in one patch when edges, or the diagonals of faces,
 * connect them. */
static void trace_patches(const shape *s, int cell_case, int joined, uint8_t patch[8])
{
    for (int c = 0; c < 8; c++)
        patch[c] = (uint8_t)c;
    for (int e = 0; e < s->edge_count; e++)
        if (is_inside(cell_case, s->edge[e][0]) == is_inside(cell_case, s->edge[e][1]))
            unite_sets(patch, s->edge[e][0], s->edge[e][1]);
    for (int face = 0; face < s->face_count; face++)
        if (is_ambiguous_face(s, cell_case, face)) {
            const bool first_inside = is_inside(cell_case, s->face[face][0]);
            const int n = first_inside == joins_on_face(s, cell_case, joined, face) ? 0 : 1;
            unite_sets(patch, s->face[face][n], s->face[face][n + 2]);
        }
    for (int c = 0; c < 8; c++)
        patch[c] = (uint8_t)find_root(patch, c);
}

static void edge_midpoint(const shape *s, int edge, double p[3])
{
    cwi_midpoint(s->at[s->edge[edge][0]], s->at[s->edge[edge][1]], p);
}

static bool has_edge(const shape *s, int face, int edge)
{
    bool found = false;
    for (int n = 0; n < s->face_size[face]; n++)
        found = found || s->face_edge[face][n] == edge;
    return found;
}

static bool share_face(const shape *s, int e, int f)
{
    bool shared = false;
    for (int face = 0; face < s->face_count; face++)
        shared = shared || (has_edge(s, face, e) && has_edge(s, face, f));
    return shared;
}

static double smallest_angle(const shape *s, const int edge[3])
{
    double p[3][3], smallest = 4;
    for (int i = 0; i < 3; i++)
        edge_midpoint(s, edge[i], p[i]);
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

static bool may_join(const shape *s, const polygon *p, int i, int j)
{
    const bool neighbours = j == i + 1 || (i == 0 && j == p->count - 1);
    return neighbours || !share_face(s, p->edge[i], p->edge[j]);
}

/* Finds the best triangulation of the corners i..j of a polygon, whose side i-j is settled.
 * Returns its smallest angle, below 0 when there is none. Exhaustive: loops are short. */
static double triangulate_polygon(const shape *s, const polygon *p, int i, int j,
                                  triangles *best)
{
    double best_angle = -1;
    best->count = 0;
    if (j - i < 2)
        return 4;
    for (int k = i + 1; k < j; k++) {
        if (!may_join(s, p, i, k) || !may_join(s, p, k, j))
            continue;
        const int corner[3] = {p->edge[i], p->edge[k], p->edge[j]};
        triangles left, right;
        double angle = fmin(triangulate_polygon(s, p, i, k, &left),
                            triangulate_polygon(s, p, k, j, &right));
        angle = fmin(angle, smallest_angle(s, corner));
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

/* Returns true for loops that become cones: those without a triangulation, and all of 8 edges
 * or more. Loops of 9 have none, and those of 8 and 12 may cross themselves. */
static bool needs_cone(const shape *s, const polygon *loop, triangles *t)
{
    t->count = 0;
    return loop->count >= 8 || triangulate_polygon(s, loop, 0, loop->count - 1, t) < 0;
}

static cwi_config resolve_case(const shape *s, int cell_case, int joined)
{
    int next[12];
    cwi_config config = {0};
    uint8_t *edge = config.loop_edges, *corner = config.triangles;
    trace_faces(s, cell_case, joined, next);
    trace_patches(s, cell_case, joined, config.patch);
    for (int e = 0; e < s->edge_count; e++) {
        const polygon loop = take_loop(next, e);
        triangles t;
        if (loop.count == 0)
            continue;
        config.loop_length[config.loop_count] = (uint8_t)loop.count;
        for (int i = 0; i < loop.count; i++)
            *edge++ = (uint8_t)loop.edge[i];
        config.cone[config.loop_count] = needs_cone(s, &loop, &t);
        for (int i = 0; i < 3 * t.count && !config.cone[config.loop_count]; i++)
            *corner++ = (uint8_t)t.edge[i / 3][i % 3];
        config.triangle_count +=
            (uint8_t)(loop.count - (config.cone[config.loop_count] ? 0 : 2));
        config.vertex_count += config.cone[config.loop_count];
        config.loop_count++;
    }
    return config;
}

static int ambiguous_faces(const shape *s, int cell_case)
{
    int faces = 0;
    for (int face = 0; face < s->face_count; face++)
        faces |= is_ambiguous_face(s, cell_case, face) << face;
    return faces;
}

/* Spreads the bits of a count over the set bits of a mask, lowest first. */
static int spread_mask(int count, int mask)
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
    printf(", %d, %d},\n", c->triangle_count, c->vertex_count);
}

/* Prints a table of one number a case. */
static void print_table(const char *head, int (*number)(int cube_case))
{
    printf("\nconst %s[256] = {\n", head);
    for (int c = 0; c < 256; c++)
        printf("%d,%s", number(c), c % 32 == 31 ? "\n" : "");
    puts("};");
}

static const shape *const cube = &shapes[CW_HEXAHEDRON];

static int simple_count(int cube_case)
{
    const cwi_config c = resolve_case(cube, cube_case, 0);
    if (triangle_count(&c) > CWI_CASE_MAX_TRIANGLES || c.cone[0]) {
        fprintf(stderr, "make_cases: case %d has no simple triangulation\n", cube_case);
        exit(1);
    }
    return triangle_count(&c);
}

static int cube_ambiguous_faces(int cube_case)
{
    return ambiguous_faces(cube, cube_case);
}

static int is_ambiguous(int cube_case)
{
    return cube_ambiguous_faces(cube_case) || resolve_case(cube, cube_case, 0).loop_count > 1;
}

static int config_count(const shape *s, int cell_case)
{
    return 1 << __builtin_popcount((unsigned)ambiguous_faces(s, cell_case));
}

/* Returns the number of configurations of the cases before a case. */
static int count_before(const shape *s, int cell_case)
{
    int first = 0;
    for (int c = 0; c < cell_case; c++)
        first += config_count(s, c);
    return first;
}

static int first_config(int cube_case)
{
    return count_before(cube, cube_case);
}

static void print_configs(const shape *s)
{
    for (int c = 0; c < 1 << s->corner_count; c++)
        for (int n = 0; n < config_count(s, c); n++) {
            const cwi_config config = resolve_case(s, c, spread_mask(n, ambiguous_faces(s, c)));
            print_config(&config);
        }
}

static void print_numbers(const int *numbers, int count)
{
    printf("{");
    for (int i = 0; i < count; i++)
        printf("%d,", numbers[i]);
    printf("}, ");
}

/* Prints the two faces at each edge. */
static void print_edge_faces(const shape *s)
{
    printf("{");
    for (int e = 0; e < s->edge_count; e++) {
        int faces[2], count = 0;
        for (int face = 0; face < s->face_count; face++)
            if (has_edge(s, face, e))
                faces[count++] = face;
        print_numbers(faces, 2);
    }
    printf("}, ");
}

/* Prints a shape. first: the number of its first configuration among those of all shapes. */
static void print_shape(const shape *s, int first)
{
    printf("{%d, %d, %d, {", s->corner_count, s->edge_count, s->face_count);
    for (int e = 0; e < s->edge_count; e++)
        print_numbers(s->edge[e], 2);
    printf("}, ");
    print_edge_faces(s);
    print_numbers(s->face_size, s->face_count);
    for (int which = 0; which < 2; which++) {
        printf("{");
        for (int face = 0; face < s->face_count; face++)
            print_numbers(which ? s->face_edge[face] : s->face[face], s->face_size[face]);
        printf("}, ");
    }
    printf("{");
    for (int c = 0; c < 1 << s->corner_count; c++)
        printf("%d,", ambiguous_faces(s, c));
    printf("}, {");
    for (int c = 0; c < 1 << s->corner_count; c++)
        printf("%d,", first + count_before(s, c));
    printf("}}, /* %s */\n", s->name);
}

int main(void)
{
    int first[CW_SHAPE_COUNT], count = 0;
    define_cube(&shapes[CW_HEXAHEDRON]);
    for (int n = 0; n < CW_SHAPE_COUNT; n++)
        complete_shape(&shapes[n]);
    puts(
        "/* Made by generate_tables.c: do not edit. */\n#include \"core/cases/case_tables.h\"");
    print_table("uint8_t cwi_case_count", simple_count);
    print_table("uint8_t cwi_case_ambiguous_faces", cube_ambiguous_faces);
    print_table("bool cwi_case_is_ambiguous", is_ambiguous);
    print_table("uint16_t cwi_case_first_config", first_config);
    puts("\nconst uint8_t cwi_case_triangles[256][3 * CWI_CASE_MAX_TRIANGLES] = {");
    for (int c = 0; c < 256; c++) {
        const cwi_config config = resolve_case(cube, c, 0);
        print_bytes(config.triangles, 3 * triangle_count(&config));
        puts(",");
    }
    puts("};\n\nconst cwi_config cwi_configs[CWI_CONFIGS] = {");
    for (int n = CW_SHAPE_COUNT - 1; n >= 0; n--) { /* the cube's come first */
        first[n] = count;
        count += count_before(&shapes[n], 1 << shapes[n].corner_count);
        print_configs(&shapes[n]);
    }
    puts("};\n\nconst cwi_shape cwi_shapes[CW_SHAPE_COUNT] = {");
    for (int n = 0; n < CW_SHAPE_COUNT; n++)
        print_shape(&shapes[n], first[n]);
    puts("};");
    if (count != CWI_CONFIGS) {
        fprintf(stderr, "make_cases: there are %d configurations\n", count);
        exit(1);
    }
    return 0;
}
