/* Finds the cluster of vertices close to one sample, the triangles around it, and its rim. */
#include "extract/snap/snap_cluster.h"

uint64_t cwi_sample_number(const cwi_bit_grid *g, size_t i, size_t j, size_t k)
{
    return (uint64_t)((k * g->rows_y + j) * (64 * g->words) + i + 1);
}

void cwi_sample_index(const cwi_bit_grid *g, uint64_t sample, size_t at[3])
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

/* Returns the first triangle of a row's `count` cells (4 at most) from i on, and the end of
 * these. */
static size_t find_in_row(const cwi_snapping *s, size_t row, size_t i, unsigned count,
                          size_t *end)
{
    const size_t w = i / 64, shift = i % 64;
    const cwi_cell_word *word = s->cells + row * s->grid->words + w;
    uint64_t here = word->has >> shift;
    if (shift + count > 64 && w + 1 < s->grid->words)
        here |= word[1].has << (64 - shift);
    here &= (1u << count) - 1;
    if (!here)
        return *end = 0;
    const size_t first = s->rows[row].triangle,
                 n = word->cells_before +
                     (size_t)__builtin_popcountll(word->has & ((UINT64_C(1) << shift) - 1));
    const size_t cells = (0x4332322132212110 >> 4 * here) & 15; /* bits of `here` */
    *end = first + s->triangle_ends[first + n + cells - 1];
    return n ? first + s->triangle_ends[first + n - 1] : first;
}

int cwi_find_triangles(const cwi_snapping *s, const size_t at[3], size_t reach, size_t *out)
{
    const cwi_bit_grid *g = s->grid;
    size_t low[3], count = 0;
    for (int a = 0; a < 3; a++)
        low[a] = at[a] < reach ? 0 : at[a] - reach;
    for (size_t k = low[2]; k < at[2] + reach && k + 1 < g->rows_z; k++)
        for (size_t j = low[1]; j < at[1] + reach && j + 1 < g->rows_y; j++) {
            size_t end, t = find_in_row(s, k * g->rows_y + j, low[0],
                                        (unsigned)(at[0] + reach - low[0]), &end);
            for (; t < end; t++)
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
static bool join_triangle(const cwi_snapping *s, cwi_cluster *c, const uint32_t *triangle)
{
    bool grown = false;
    for (int n = 0; n < 3 && members_of(c, triangle) > 0; n++)
        if (s->indices[triangle[n]].near_sample == c->sample &&
            !cwi_is_member(c, triangle[n])) {
            c->member[c->count++] = triangle[n];
            grown = true;
        }
    return grown;
}

/* Keeps, of the triangles around the sample, those that have a vertex close to it. Returns true
 * if some triangle has two. */
static bool find_candidates(const cwi_snapping *s, cwi_cluster *c)
{
    const int around = cwi_find_triangles(s, c->at, 1, c->fan);
    bool joined = false;
    c->fan_count = 0;
    for (int n = 0; n < around; n++) {
        const uint32_t *t = s->mesh->triangles + 3 * c->fan[n];
        const int close = (s->indices[t[0]].near_sample == c->sample) +
                          (s->indices[t[1]].near_sample == c->sample) +
                          (s->indices[t[2]].near_sample == c->sample);
        joined = joined || close > 1;
        c->fan[c->fan_count] = c->fan[n];
        c->fan_count += close > 0;
    }
    return joined;
}

void cwi_cluster_find(const cwi_snapping *s, uint32_t v, cwi_cluster *c)
{
    c->sample = s->indices[v].near_sample;
    cwi_sample_index(s->grid, c->sample, c->at);
    c->count = 1;
    c->member[0] = v;
    if (!find_candidates(s, c))
        return;
    for (bool grown = true; grown;) {
        grown = false;
        for (int n = 0; n < c->fan_count; n++)
            grown = join_triangle(s, c, s->mesh->triangles + 3 * c->fan[n]) || grown;
    }
    const int candidates = c->fan_count;
    c->fan_count = 0;
    for (int n = 0; n < candidates; n++)
        if (members_of(c, s->mesh->triangles + 3 * c->fan[n]) > 0)
            c->fan[c->fan_count++] = c->fan[n];
}

/* Finds the sides of the star's triangles opposite to a lone member, in order. Returns false
 * unless they are one closed line that visits no vertex twice. */
static bool find_link(const cwi_snapping *s, cwi_cluster *c)
{
    uint32_t from[CWI_FAN], to[CWI_FAN];
    size_t owner[CWI_FAN];
    int count = 0;
    for (int n = 0; n < c->fan_count; n++) {
        const uint32_t *t = s->mesh->triangles + 3 * c->fan[n];
        if (members_of(c, t) != 1)
            continue;
        const int m = cwi_is_member(c, t[0]) ? 0 : cwi_is_member(c, t[1]) ? 1 : 2;
        from[count] = t[(m + 1) % 3];
        to[count] = t[(m + 2) % 3];
        owner[count++] = c->fan[n];
    }
    c->link_count = 0;
    if (count < 3 || count > CWI_LINK)
        return false;
    for (int n = 0, next; c->link_count < count; n = next) {
        c->owner[c->link_count] = owner[n];
        c->link[c->link_count++] = from[n];
        for (next = 0; next < count && from[next] != to[n]; next++)
            ;
        if (next == count || (next == 0 && c->link_count < count))
            return false;
    }
    return true;
}

/* Decides if the star is a disc. It is a surface with one rim, and all members are inside. It
 * is a disc if its Euler number is one; it has (3 triangles + rim) / 2 sides. Every vertex of
 * the rim must occur once. */
bool cwi_cluster_is_disc(const cwi_snapping *s, cwi_cluster *c)
{
    if (!find_link(s, c))
        return false;
    for (int n = 0; n < c->link_count; n++)
        for (int m = 0; m < n; m++)
            if (c->link[m] == c->link[n])
                return false;
    return 2 * c->count + c->link_count - c->fan_count == 2;
}
