/* Patches: are the triangles that take the place of others near the input, and turned as it is? */
#include "core/geometry/point_triangle.h"
#include "simplify/remesh/remesh_state.h"

/* Cosine of the largest angle between a triangle and the input there: 60 degrees. */
static const double MIN_AGREEMENT = 0.5;

typedef struct near_search {
    const cwi_target *target;
    const double *point, *normal;
} near_search;

double cwi_largest_cosine(const float *a, const float *b, const float *c, double normal[3])
{
    double side[3][3], lengths_sq[3], cross[3], largest = -1;
    for (int k = 0; k < 3; k++) {
        side[0][k] = (double)b[k] - (double)a[k];
        side[1][k] = (double)c[k] - (double)b[k];
        side[2][k] = (double)a[k] - (double)c[k];
    }
    cwi_cross(side[0], side[1], cross);
    if (normal)
        for (int k = 0; k < 3; k++)
            normal[k] = cross[k];
    for (int k = 0; k < 3; k++)
        lengths_sq[k] = cwi_dot(side[k], side[k]);
    /* A triangle is flat when its height vanishes beside the rounding of positions. */
    const double longest =
        cwi_greater(lengths_sq[0], cwi_greater(lengths_sq[1], lengths_sq[2]));
    if (!(cwi_dot(cross, cross) > longest * longest * 1e-12))
        return 2;
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3;
        largest = cwi_greater(largest,
                              -cwi_dot(side[k], side[l]) / sqrt(lengths_sq[k] * lengths_sq[l]));
    }
    return largest;
}

/* Ends the search, by a negative square, when the point is near enough to a triangle that faces
 * the same way. */
static void try_triangle(void *context, size_t slot, double *distance_sq)
{
    const near_search *s = context;
    const cw_mesh *m = &s->target->mesh;
    const size_t t = s->target->tree.order[slot];
    const float *n = s->target->normals ? s->target->normals + 3 * t : NULL;
    if (n && !((double)n[0] * s->normal[0] + (double)n[1] * s->normal[1] +
                   (double)n[2] * s->normal[2] >
               MIN_AGREEMENT))
        return;
    const uint32_t *v = m->triangles + 3 * t;
    const double limit = (double)s->target->limits[t];
    const double found =
        cwi_facet_distance_sq(m->positions + 3 * (size_t)v[0], m->positions + 3 * (size_t)v[1],
                              m->positions + 3 * (size_t)v[2], s->point);
    if (found <= limit * limit)
        *distance_sq = -1;
}

static bool is_near(const cwi_remesh *r, const cwi_target *target, const double point[3],
                    const double normal[3])
{
    near_search search = {target, point, normal};
    double distance_sq = r->limit_mm * r->limit_mm * (1 + 1e-6);
    cwi_boxes_nearest(&target->tree, point, try_triangle, &search, &distance_sq);
    return distance_sq < 0;
}

static const float *place_of(const cwi_remesh *r, const cwi_replacement *p, uint32_t v)
{
    return v == p->moved ? p->position : r->positions + 3 * (size_t)v;
}

static void mix_points(const float *a, const float *b, double fraction, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k] + fraction * ((double)b[k] - (double)a[k]);
}

/* Checks an edge at its middle, and a sharp one at its quarters, too. */
static bool is_edge_near(const cwi_remesh *r, const float *a, const float *b, bool is_sharp,
                         const double normal[3])
{
    double point[3];
    mix_points(a, b, 0.5, point);
    if (!is_near(r, &r->surface, point, normal))
        return false;
    for (int k = 1; k < 4 && is_sharp; k++) {
        mix_points(a, b, 0.25 * k, point);
        if (!is_near(r, &r->curves, point, normal))
            return false;
    }
    return true;
}

static bool is_triangle_near(const cwi_remesh *r, const cwi_replacement *p, size_t n)
{
    const float *a = place_of(r, p, p->fresh[n][0]), *b = place_of(r, p, p->fresh[n][1]),
                *c = place_of(r, p, p->fresh[n][2]);
    double normal[3], centre[3];
    if (cwi_largest_cosine(a, b, c, normal) > 1 || !cwi_normalise(normal))
        return false;
    for (int k = 0; k < 3; k++)
        centre[k] = ((double)a[k] + (double)b[k] + (double)c[k]) / 3;
    return is_near(r, &r->surface, centre, normal) &&
           is_edge_near(r, a, b, p->sharp[n] & 1, normal) &&
           (n + 1 < p->count || is_edge_near(r, a, c, p->sharp[n] >> 2 & 1, normal));
}

static double square_to_edge(const float *a, const float *b, const double point[3])
{
    double from[3], along[3];
    for (int k = 0; k < 3; k++) {
        from[k] = point[k] - (double)a[k];
        along[k] = (double)b[k] - (double)a[k];
    }
    return cwi_segment_square(from, along);
}

/* Returns the square of a sample's distance from a new triangle, or from its sharp edges. */
static double square_to_fresh(const cwi_remesh *r, const cwi_replacement *p, size_t n,
                              bool to_edges, const double point[3])
{
    const float *corner[3];
    double best = INFINITY;
    for (int k = 0; k < 3; k++)
        corner[k] = place_of(r, p, p->fresh[n][k]);
    if (!to_edges)
        return cwi_facet_distance_sq(corner[0], corner[1], corner[2], point);
    for (int k = 0; k < 3; k++)
        if (p->sharp[n] >> k & 1)
            best = cwi_lesser(best, square_to_edge(corner[k], corner[(k + 1) % 3], point));
    return best;
}

/* Finds the new triangle of a sample, and returns the square of its distance. */
static double assign_sample(cwi_remesh *r, const cwi_replacement *p, size_t sample)
{
    const uint32_t v = r->scratch[sample];
    double point[3], best = INFINITY;
    for (size_t k = 0; k < 3; k++)
        point[k] = (double)r->input->positions[3 * (size_t)v + k];
    r->scratch_to[sample] = 0;
    for (size_t n = 0; n < p->count && best > 0; n++) {
        const double found = square_to_fresh(r, p, n, r->input_freedom[v] != CWI_FREE, point);
        if (found < best) {
            best = found;
            r->scratch_to[sample] = (uint8_t)n;
        }
    }
    return best;
}

static void gather_samples(cwi_remesh *r, cwi_replacement *p)
{
    p->samples = 0;
    for (size_t n = 0; n < p->old_count; n++)
        for (uint32_t s = r->first_sample[p->old[n]]; s != CWI_NONE; s = r->next_sample[s])
            r->scratch[p->samples++] = s;
}

void cwi_patch_assign(cwi_remesh *r, cwi_replacement *p)
{
    gather_samples(r, p);
    for (size_t n = 0; n < p->samples; n++)
        assign_sample(r, p, n);
}

bool cwi_patch_fits(cwi_remesh *r, cwi_replacement *p)
{
    gather_samples(r, p);
    for (size_t n = 0; n < p->samples; n++) {
        const double limit = (double)r->sample_limits[r->scratch[n]];
        if (!(assign_sample(r, p, n) <= limit * limit))
            return false;
    }
    for (size_t n = 0; n < p->count; n++)
        if (!is_triangle_near(r, p, n))
            return false;
    return true;
}

void cwi_patch_attach(cwi_remesh *r, const cwi_replacement *p)
{
    for (size_t n = 0; n < p->old_count; n++)
        r->first_sample[p->old[n]] = CWI_NONE;
    for (size_t n = 0; n < p->count; n++)
        r->first_sample[p->ids[n]] = CWI_NONE;
    for (size_t n = p->samples; n-- > 0;) {
        const uint32_t t = p->ids[r->scratch_to[n]], sample = r->scratch[n];
        r->next_sample[sample] = r->first_sample[t];
        r->first_sample[t] = sample;
    }
}

double cwi_patch_cosine(const cwi_remesh *r, const cwi_replacement *p)
{
    double largest = -1;
    for (size_t n = 0; n < p->count && largest < 2; n++) {
        const uint32_t *v = p->fresh[n];
        largest =
            cwi_greater(largest, cwi_largest_cosine(place_of(r, p, v[0]), place_of(r, p, v[1]),
                                                    place_of(r, p, v[2]), NULL));
    }
    return largest;
}

double cwi_patch_cosine_before(const cwi_remesh *r, const cwi_replacement *p)
{
    double largest = -1;
    for (size_t n = 0; n < p->old_count; n++) {
        const uint32_t *v = r->triangles + 3 * (size_t)p->old[n];
        largest =
            cwi_greater(largest, cwi_largest_cosine(r->positions + 3 * (size_t)v[0],
                                                    r->positions + 3 * (size_t)v[1],
                                                    r->positions + 3 * (size_t)v[2], NULL));
    }
    return largest;
}

size_t cwi_list_one_ring(const cwi_remesh *r, uint32_t vertex,
                         uint32_t corners[CWI_MAX_ONE_RING], bool *is_border)
{
    uint32_t start = r->corner[vertex], c = start;
    *is_border = false;
    do { /* clockwise, to the first corner at a border */
        const uint32_t across = r->twin[c];
        *is_border = across == CWI_NONE;
        if (*is_border)
            break;
        c = cwi_corner_next(across);
    } while (c != start);
    start = c;
    size_t count = 0;
    do {
        if (count == CWI_MAX_ONE_RING)
            return 0;
        corners[count++] = c;
        const uint32_t across = r->twin[cwi_corner_prev(c)];
        if (across == CWI_NONE)
            break;
        c = across;
    } while (c != start);
    return count;
}
