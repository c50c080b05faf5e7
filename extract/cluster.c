#include "extract/cluster.h"

uint64_t cwi_sample_number(const cwi_grid *g, size_t i, size_t j, size_t k)
{
    return (uint64_t)((k * g->rows_y + j) * (64 * g->words) + i + 1);
}

void cwi_sample_place(const cwi_grid *g, uint64_t sample, size_t at[3])
{
    const size_t n = (size_t)sample - 1, row = n / (64 * g->words);
    at[0] = n % (64 * g->words);
    at[1] = row % g->rows_y;
    at[2] = row / g->rows_y;
}

void cwi_to_index(const cwi_snapping *s, const float p[3], double x[3])
{
    for (int a = 0; a < 3; a++)
        x[a] = s->inverse[a][0] * (double)p[0] + s->inverse[a][1] * (double)p[1] +
               s->inverse[a][2] * (double)p[2] + s->centre[a];
}

void cwi_to_position(const cwi_snapping *s, const double x[3], float p[3])
{
    const cw_volume *v = &s->grid->volume;
    for (int r = 0; r < 3; r++)
        p[r] = (float)(v->affine[r][0] * (x[0] - s->centre[0]) +
                       v->affine[r][1] * (x[1] - s->centre[1]) +
                       v->affine[r][2] * (x[2] - s->centre[2]));
}

static size_t first_at(const uint32_t *cell, size_t low, size_t high, size_t i)
{
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (cell[middle] < i)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int cwi_find_triangles(const cwi_snapping *s, const size_t at[3], size_t reach, size_t *out)
{
    const cwi_grid *g = s->grid;
    size_t low[3], count = 0;
    for (int a = 0; a < 3; a++)
        low[a] = at[a] < reach ? 0 : at[a] - reach;
    for (size_t k = low[2]; k < at[2] + reach && k + 1 < g->rows_z; k++)
        for (size_t j = low[1]; j < at[1] + reach && j + 1 < g->rows_y; j++) {
            const cwi_row *row = s->rows + k * g->rows_y + j;
            size_t t = first_at(s->cell, row[0].triangle, row[1].triangle, low[0]);
            for (; t < row[1].triangle && s->cell[t] < at[0] + reach; t++)
                if (!cwi_is_gone(s->mesh->triangles + 3 * t))
                    out[count++] = t;
        }
    return (int)count;
}

bool cwi_is_member(const cwi_cluster *c, uint32_t v)
{
    for (int m = 0; m < c->count; m++)
        if (c->member[m] == v)
            return true;
    return false;
}

static int members_of(const cwi_cluster *c, const uint32_t *triangle)
{
    int count = 0;
    for (int n = 0; n < 3; n++)
        count += cwi_is_member(c, triangle[n]);
    return count;
}

/* Adds the vertices close to the sample that a triangle joins to the cluster. */
static bool join(const cwi_snapping *s, cwi_cluster *c, const uint32_t *triangle)
{
    bool grown = false;
    for (int n = 0; n < 3 && members_of(c, triangle) > 0; n++)
        if (s->near[triangle[n]] == c->sample && !cwi_is_member(c, triangle[n])) {
            c->member[c->count++] = triangle[n];
            grown = true;
        }
    return grown;
}

void cwi_cluster_find(const cwi_snapping *s, uint32_t v, cwi_cluster *c)
{
    c->sample = s->near[v];
    cwi_sample_place(s->grid, c->sample, c->at);
    const int around = cwi_find_triangles(s, c->at, 1, c->star);
    c->count = 1;
    c->member[0] = v;
    for (bool grown = true; grown;) {
        grown = false;
        for (int n = 0; n < around; n++)
            grown = join(s, c, s->mesh->triangles + 3 * c->star[n]) || grown;
    }
    c->star_count = 0;
    for (int n = 0; n < around; n++)
        if (members_of(c, s->mesh->triangles + 3 * c->star[n]) > 0)
            c->star[c->star_count++] = c->star[n];
}

/* The sides of the star's triangles opposite to a lone member, in order; false unless they are
 * one closed line that visits no vertex twice. */
static bool find_rim(const cwi_snapping *s, cwi_cluster *c)
{
    uint32_t from[CWI_STAR], to[CWI_STAR];
    size_t owner[CWI_STAR];
    int count = 0;
    for (int n = 0; n < c->star_count; n++) {
        const uint32_t *t = s->mesh->triangles + 3 * c->star[n];
        if (members_of(c, t) != 1)
            continue;
        const int m = cwi_is_member(c, t[0]) ? 0 : cwi_is_member(c, t[1]) ? 1 : 2;
        from[count] = t[(m + 1) % 3];
        to[count] = t[(m + 2) % 3];
        owner[count++] = c->star[n];
    }
    c->rim_count = 0;
    for (int n = 0, next; c->rim_count < count; n = next) {
        c->owner[c->rim_count] = owner[n];
        cwi_to_index(s, cwi_position(s, from[n]), c->rim_x[c->rim_count]);
        c->rim[c->rim_count++] = from[n];
        for (next = 0; next < count && from[next] != to[n]; next++)
            ;
        if (next == count || (next == 0 && c->rim_count < count))
            return false;
    }
    return count >= 3;
}

/* The star is a surface with one rim, all members inside. It is a disc if its Euler number is
 * one; it has (3 triangles + rim) / 2 sides. And every vertex of the rim is there once. */
bool cwi_cluster_is_disc(const cwi_snapping *s, cwi_cluster *c)
{
    if (!find_rim(s, c))
        return false;
    for (int n = 0; n < c->rim_count; n++)
        for (int m = 0; m < n; m++)
            if (c->rim[m] == c->rim[n])
                return false;
    return 2 * c->count + c->rim_count - c->star_count == 2;
}
