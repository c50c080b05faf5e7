/* Tests where surfaces of labels lie between fields whose interfaces are known on paper, beside those of
 * the map of the largest. */
#include "support/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LABELS = 5 };

/* Scores of labels from 0 at a point; and the distance of a point from the interface of two labels, with
 * the interface's normal. */
typedef void score_function(const double p[3], double scores[MOST_LABELS]);
typedef double truth_function(const double p[3], int a, int b, double normal[3]);

/* A scene: labels, the first of which is the background if `has_background`. */
typedef struct scene {
    const char *name;
    size_t side;
    int labels;
    bool has_background;
    score_function *scores;
    truth_function *truth;
} scene;

static double length_of(const double p[3])
{
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

/* Sets a unit vector from q to p. Returns their distance. */
static double point_from(const double p[3], const double q[3], double normal[3])
{
    for (int a = 0; a < 3; a++)
        normal[a] = p[a] - q[a];
    const double length = length_of(normal);
    for (int a = 0; a < 3; a++)
        normal[a] /= length;
    return length;
}

/* --- two spheres that overlap: each is cut off half way ------------------------------------- */

static const double spheres[2][3] = {{22.3, 31.6, 30.9}, {41.2, 33.1, 32.7}};
static const double RADIUS = 11.2;

static void score_spheres(const double p[3], double scores[MOST_LABELS])
{
    double n[3];
    scores[0] = 0;
    for (int s = 0; s < 2; s++)
        scores[1 + s] = RADIUS - point_from(p, spheres[s], n);
}

static double plane_between(const double p[3], const double a[3], const double b[3],
                            double normal[3])
{
    const double apart = point_from(b, a, normal);
    double sum = -0.5 * apart;
    for (int n = 0; n < 3; n++)
        sum += normal[n] * (p[n] - a[n]);
    return sum;
}

static double truth_of_spheres(const double p[3], int a, int b, double normal[3])
{
    const int low = a < b ? a : b, high = a < b ? b : a;
    if (low > 0)
        return plane_between(p, spheres[0], spheres[1], normal);
    return point_from(p, spheres[high - 1], normal) - RADIUS;
}

/* --- five cells ------------------------------------------------------------------------------ */

static const double centers[5][3] = {{14.2, 17.7, 20.1},
                                     {47.3, 21.4, 13.8},
                                     {30.6, 49.2, 27.5},
                                     {19.8, 28.3, 50.4},
                                     {50.1, 44.7, 46.2}};

static void score_cells(const double p[3], double scores[MOST_LABELS])
{
    double n[3];
    for (int c = 0; c < 5; c++)
        scores[c] = -point_from(p, centers[c], n);
}

static double truth_of_cells(const double p[3], int a, int b, double normal[3])
{
    return plane_between(p, centers[a], centers[b], normal);
}

/* --- a torus in a ball ----------------------------------------------------------------------- */

static double torus(const double p[3], double normal[3])
{
    const double x = p[0] - 31.7, y = p[1] - 32.2, r = hypot(x, y);
    const double ring[3] = {31.7 + 13 * x / r, 32.2 + 13 * y / r, 30.8};
    return point_from(p, ring, normal) - 5.3;
}

static double ball(const double p[3], double normal[3])
{
    return point_from(p, (double[3]){31.7, 32.2, 30.8}, normal) - 25.4;
}

static void score_torus(const double p[3], double scores[MOST_LABELS])
{
    double n[3];
    scores[0] = 0;
    scores[1] = -ball(p, n);
    scores[2] = scores[1] - torus(p, n);
}

static double truth_of_torus(const double p[3], int a, int b, double normal[3])
{
    return a == 2 || b == 2 ? torus(p, normal) : ball(p, normal);
}

static const scene scenes[] = {
    {"spheres", 64, 3, true, score_spheres, truth_of_spheres},
    {"cells", 64, 5, false, score_cells, truth_of_cells},
    {"torus", 64, 3, true, score_torus, truth_of_torus},
};

/* Makes the fields of a scene: the softmax of scores over a width in voxels, or with 0 the scores. */
static void make_fields(const scene *s, double width, cw_type type,
                        cw_volume fields[MOST_LABELS])
{
    cw_error err = {0};
    const size_t dim[3] = {s->side, s->side, s->side};
    for (int n = 0; n < s->labels; n++)
        assert_ok(cw_volume_alloc(&fields[n], type, dim, 1, 1, &err), err);
    for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++) {
        double scores[MOST_LABELS], sum = 0, most = -INFINITY;
        const double p[3] = {(double)(i % dim[0]), (double)(i / dim[0] % dim[1]),
                             (double)(i / dim[0] / dim[1])};
        s->scores(p, scores);
        for (int n = 0; n < s->labels && width > 0; n++)
            most = fmax(most, scores[n]);
        for (int n = 0; n < s->labels && width > 0; n++)
            sum += scores[n] = exp((scores[n] - most) / width);
        sum = width > 0 ? sum : 1;
        for (int n = 0; n < s->labels; n++) {
            if (type == CW_U8)
                ((uint8_t *)cw_volume_voxels(&fields[n]))[i] =
                    (uint8_t)lrint(255 * scores[n] / sum);
            else
                ((float *)cw_volume_voxels(&fields[n]))[i] = (float)(scores[n] / sum);
        }
    }
}

typedef struct errors {
    double rms, at_vertices, max, normals; /* voxels, and of normals degrees */
} errors;

/* Measures how far triangles are from the truth, between labels of the scene. Patches that close labels at
 * the border are left out. */
static errors measure(const scene *s, const cw_label_surfaces *out, uint32_t none)
{
    double sum = 0, at_vertices = 0, turns = 0, areas = 0, max = 0;
    for (size_t n = 0; n < out->patch_count; n++) {
        const cw_label_patch *patch = &out->patches[n];
        if (patch->labels[1] == none)
            continue;
        for (size_t t = patch->first; t < patch->first + patch->count; t++) {
            double p[3][3], normal[3], truth[3], middle[3] = {0};
            for (size_t c = 0; c < 3; c++)
                for (size_t a = 0; a < 3; a++) {
                    p[c][a] = (double)out->mesh
                                  .positions[3 * (size_t)out->mesh.triangles[3 * t + c] + a] +
                              out->mesh.origin[a];
                    middle[a] += p[c][a] / 3;
                }
            for (int a = 0; a < 3; a++) {
                const int b = (a + 1) % 3, c = (a + 2) % 3;
                normal[a] = (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) -
                            (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
            }
            const double area = length_of(normal);
            for (int c = 0; c < 4; c++) {
                const double d = fabs(s->truth(c < 3 ? p[c] : middle, (int)patch->labels[0],
                                               (int)patch->labels[1], truth));
                max = fmax(max, d);
                sum += 0.25 * area * d * d;
                at_vertices += c < 3 ? area * d * d / 3 : 0;
            }
            const double cosine =
                (normal[0] * truth[0] + normal[1] * truth[1] + normal[2] * truth[2]) / area;
            const double turn = acos(fmin(fabs(cosine), 1)) * 180 / PI;
            turns += area > 0 ? area * turn * turn : 0;
            areas += area;
        }
    }
    return (errors){sqrt(sum / areas), sqrt(at_vertices / areas), max, sqrt(turns / areas)};
}

static void surfaces_lie_where_fields_are_equal(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof scenes / sizeof *scenes; n++)
        for (int w = 0; w < 5; w++) {
            const double width = (double[]){0.5, 1, 2, 2, 0}[w];
            const scene *s = &scenes[n];
            cw_volume fields[MOST_LABELS] = {0}, map;
            cw_label_surfaces by_fields, by_map;
            cw_error err = {0};
            make_fields(s, width, w == 3 ? CW_U8 : CW_F32, fields);
            const uint32_t labels[] = {0, 1, 2, 3, 4}, none = s->has_background ? 9 : 7;
            const cw_label_scores scores = {.fields = fields,
                                            .count = (size_t)s->labels,
                                            .labels = labels,
                                            .rule = s->has_background ? CW_BACKGROUND_FIELD
                                                                      : CW_BACKGROUND_VALUE,
                                            .value = -1000,
                                            .has_value = true};
            const cw_labels_desc desc = {.background = s->has_background ? 0 : none};
            assert_ok(cw_extract_label_scores(&scores, &desc, &by_fields, &err), err);
            assert_ok(cw_label_scores_largest(&scores, desc.background, 0, &map, &err), err);
            assert_ok(cw_extract_labels(&map, &desc, &by_map, &err), err);
            const errors a = measure(s, &by_fields, none), b = measure(s, &by_map, none);
            print_message(
                "%s, width %g, %s: rms %.4f (%.4f at vertices), largest %.3f voxels, normals "
                "%.2f degrees; of the map %.4f (%.4f), %.3f, %.2f\n",
                s->name, width, cw_type_name(fields[0].type), a.rms, a.at_vertices, a.max,
                a.normals, b.rms, b.at_vertices, b.max, b.normals);
            assert_true(a.rms < 0.03 && a.rms * (width == 0.5 ? 1.4 : 2) < b.rms);
            assert_true(a.max < 0.38 && a.max < 0.8 * b.max);
            assert_true(a.normals < (width == 0.5 ? 4 : 2.1));
            cw_label_surfaces_free(&by_fields);
            cw_label_surfaces_free(&by_map);
            cw_volume_free(&map);
            for (int f = 0; f < s->labels; f++)
                cw_volume_free(&fields[f]);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_lie_where_fields_are_equal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
