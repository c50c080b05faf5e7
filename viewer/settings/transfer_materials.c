/* Turns classes of materials [Drebin1988] into the curves of a transfer function. Between the
 * ends of classes, fractions are linear. Opacities and indices are linear too where the fractions
 * add up to at most 1; colours never are. Curves are cut where they differ most from a line. */
#include <cubewright/transfer.h>

#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CURVES = 5, /* red, green, blue, opacity, index */
    MAX_ENDS = 4 * CW_MAX_MATERIALS + CW_MAX_MATERIALS * CW_MAX_MATERIALS
};

/* A value, and the curves just below or above it. */
typedef struct sample {
    double value, curves[CURVES];
} sample;

/* A piece between two samples, and how far the curves are from a line at its middle. */
typedef struct piece {
    sample low, high;
    double error;
} piece;

typedef struct mixture {
    const cw_material_class *materials;
    size_t count;
    double index_range; /* above 0 */
} mixture;

/* Returns the fraction of a material at a value, before it is divided by their sum. */
static double find_fraction(const cw_material_class *m, double value)
{
    const double *v = m->values;
    const double rise = value <= v[0] ? 0 : value >= v[1] ? 1 : (value - v[0]) / (v[1] - v[0]);
    const double fall = value >= v[3] ? 0 : value <= v[2] ? 1 : (v[3] - value) / (v[3] - v[2]);
    return fmin(v[0] == -INFINITY ? 1 : rise, v[3] == INFINITY ? 1 : fall);
}

/* Mixes the materials at a value. A mixture of clear ones has the colour of their mean. */
static void mix_materials(const mixture *m, double value, sample *s)
{
    double sum = 0, color[2][3] = {{0}}, opacity = 0, index = 0;
    for (size_t n = 0; n < m->count; n++) {
        const cw_material_class *c = &m->materials[n];
        const double fraction = find_fraction(c, value);
        sum += fraction;
        opacity += fraction * (double)c->opacity;
        index += fraction * (double)c->index;
        for (int a = 0; a < 3; a++) {
            color[0][a] += fraction * (double)c->color[a];
            color[1][a] += fraction * (double)c->opacity * (double)c->color[a];
        }
    }
    const double whole = fmax(sum, 1);
    s->value = value;
    for (int a = 0; a < 3; a++)
        s->curves[a] = opacity > 0 ? color[1][a] / opacity : sum > 0 ? color[0][a] / sum : 0;
    s->curves[3] = opacity / whole;
    s->curves[4] = index / whole;
}

/* Mixes just inside of an end of a piece: at the end itself a material may begin, and its colour
 * is unknown where its fraction is 0. */
static void mix_inside(const mixture *m, double end, double other, sample *s)
{
    mix_materials(m, end + 1e-6 * (other - end), s);
    s->value = end;
}

static void measure_error(const mixture *m, piece *p)
{
    sample middle;
    const double value = p->low.value / 2 + p->high.value / 2;
    p->error = 0;
    if (!(value > p->low.value && value < p->high.value))
        return;
    mix_materials(m, value, &middle);
    for (int c = 0; c < CURVES; c++) {
        const double line = p->low.curves[c] / 2 + p->high.curves[c] / 2;
        const double scale = c == 4 ? 1 / m->index_range : 1;
        p->error = fmax(p->error, fabs(middle.curves[c] - line) * scale);
    }
}

static int compare_values(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the sum of the fractions at a value. */
static double sum_fractions(const mixture *m, double value)
{
    double sum = 0;
    for (size_t n = 0; n < m->count; n++)
        sum += find_fraction(&m->materials[n], value);
    return sum;
}

/* Lists the finite ends of the classes in order, each once, and the places where the sum of the
 * fractions crosses 1. Returns their number. */
static size_t list_ends(const mixture *m, double ends[MAX_ENDS])
{
    size_t count = 0, all = 0;
    for (size_t n = 0; n < m->count; n++)
        for (int i = 0; i < 4; i++)
            if (isfinite(m->materials[n].values[i]))
                ends[all++] = m->materials[n].values[i];
    qsort(ends, all, sizeof *ends, compare_values);
    for (size_t n = 0; n < all; n++)
        if (count == 0 || ends[n] > ends[count - 1])
            ends[count++] = ends[n];
    for (size_t n = 0, was = count; n + 1 < was; n++) {
        const double width = ends[n + 1] - ends[n];
        const double a = sum_fractions(m, ends[n] + 1e-6 * width) - 1;
        const double b = sum_fractions(m, ends[n + 1] - 1e-6 * width) - 1;
        const double at = ends[n] + a / (a - b) * width;
        if (a * b < -1e-12 && at > ends[n] && at < ends[n + 1])
            ends[count++] = at;
    }
    qsort(ends, count, sizeof *ends, compare_values);
    return count;
}

static bool is_equal(const sample *a, const sample *b)
{
    return a->value == b->value && memcmp(a->curves, b->curves, sizeof a->curves) == 0;
}

/* Halves the pieces that are farthest from a line, until all are close or there are too many
 * points. Returns the number of pieces. */
static size_t halve_pieces(const mixture *m, piece *pieces, size_t count, size_t max)
{
    static const double TOLERANCE = 1.0 / 512; /* half a step of what is displayed */
    while (count < max) {
        size_t worst = 0;
        for (size_t n = 1; n < count; n++)
            worst = pieces[n].error > pieces[worst].error ? n : worst;
        if (!(pieces[worst].error > TOLERANCE))
            break;
        memmove(pieces + worst + 1, pieces + worst, (count - worst) * sizeof *pieces);
        piece *low = &pieces[worst], *high = low + 1;
        mix_materials(m, low->low.value / 2 + low->high.value / 2, &low->high);
        high->low = low->high;
        measure_error(m, low);
        measure_error(m, high);
        count++;
    }
    return count;
}

static void put_sample(cw_transfer *t, const sample *s)
{
    cw_color_point *color = &t->colors[t->color_count++];
    color->value = s->value;
    for (int c = 0; c < 3; c++)
        color->color[c] = (float)fmin(fmax(s->curves[c], 0), 1);
    t->opacities[t->opacity_count++] =
        (cw_opacity_point){s->value, (float)fmin(fmax(s->curves[3], 0), 1)};
    t->indices[t->index_count++] = (cw_index_point){s->value, (float)s->curves[4]};
}

static cw_status make_curves(const mixture *m, cw_transfer *t, cw_error *err)
{
    double ends[MAX_ENDS];
    piece pieces[CW_TRANSFER_POINTS] = {0};
    sample points[2 * CW_TRANSFER_POINTS + 2] = {0}, *last = points;
    const size_t count = list_ends(m, ends);
    if (2 * count > CW_TRANSFER_POINTS)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the materials have %zu different ends: at most %d were expected",
                        count, CW_TRANSFER_POINTS / 2);
    for (size_t n = 0; n + 1 < count; n++) {
        mix_inside(m, ends[n], ends[n + 1], &pieces[n].low);
        mix_inside(m, ends[n + 1], ends[n], &pieces[n].high);
        measure_error(m, &pieces[n]);
    }
    /* each piece may begin and end with a jump, and there are values beyond the ends */
    const size_t jumps = count + 1, fine = count > 1 ? halve_pieces(m, pieces, count - 1,
                                                                    CW_TRANSFER_POINTS - jumps)
                                                     : 0;
    const double beyond = fmax(fabs(ends[0]), fabs(ends[count - 1])) + 1;
    mix_inside(m, ends[0], -beyond, last);
    for (size_t n = 0; n < fine; n++) {
        if (!is_equal(last, &pieces[n].low))
            *++last = pieces[n].low;
        *++last = pieces[n].high;
    }
    sample above;
    mix_inside(m, ends[count - 1], beyond, &above);
    if (!is_equal(last, &above))
        *++last = above;
    t->color_count = t->opacity_count = t->index_count = 0;
    for (const sample *s = points; s <= last; s++)
        put_sample(t, s);
    return CW_OK;
}

static cw_status check_material(const cw_material_class *m, size_t n, cw_error *err)
{
    for (int i = 0; i < 4; i++) {
        const double v = m->values[i], open = i < 2 ? -INFINITY : INFINITY;
        if (!isfinite(v) && v != open)
            return cwi_fail(err, CW_ERR_ARGUMENT, "value %d of material %zu is not a number%s",
                            i, n, isnan(v) ? "" : ", or open on the other side");
        if (i > 0 && !(v >= m->values[i - 1]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "value %d of material %zu is %g, below the one before, %g", i, n, v,
                            m->values[i - 1]);
    }
    if ((m->values[0] == -INFINITY) != (m->values[1] == -INFINITY) ||
        (m->values[2] == INFINITY) != (m->values[3] == INFINITY))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "material %zu: both values of an open end were expected to be open", n);
    for (int c = 0; c < 3; c++)
        if (!(m->color[c] >= 0 && m->color[c] <= 1))
            return cwi_fail(err, CW_ERR_ARGUMENT, "the colour of material %zu is not 0 to 1",
                            n);
    if (!(m->opacity >= 0 && m->opacity <= 1))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the opacity of material %zu is %g, not 0 to 1",
                        n, (double)m->opacity);
    if (!(fabsf(m->index) <= 1e6f))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the index of material %zu is %g: -1e6 to 1e6 was expected", n,
                        (double)m->index);
    return CW_OK;
}

cw_status cw_transfer_set_materials(cw_transfer *t, const cw_material_class *materials,
                                    size_t count, cw_error *err)
{
    CWI_REQUIRE(err, t);
    CWI_REQUIRE_ARRAY(err, materials, count);
    mixture m = {materials, count, 0};
    double low = 0, high = 0; /* no material has the index 0 */
    bool is_bounded = false;
    cw_status st = CW_OK;
    if (count < 1 || count > CW_MAX_MATERIALS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%zu materials: expected 1 to %d", count,
                        CW_MAX_MATERIALS);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        st = check_material(&materials[n], n, err);
        low = fmin(low, (double)materials[n].index);
        high = fmax(high, (double)materials[n].index);
        is_bounded =
            is_bounded || isfinite(materials[n].values[1]) || isfinite(materials[n].values[2]);
    }
    if (st == CW_OK && !is_bounded)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "no material has an end");
    m.index_range = high > low ? high - low : 1;
    return st == CW_OK ? make_curves(&m, t, err) : st;
}
