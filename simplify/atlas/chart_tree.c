/* Merges the triangles of a surface into sets that face one way. */
#include "simplify/atlas/atlas_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"

#include <string.h>

/* The length of the sum of a chart's normals, as a share of its area: 1 is flat, a half is a
 * hemisphere. */
static const double MIN_FACING = 0.5;

/* Shares of its area that a small set costs, so that those are merged first that differ in nothing. */
static const double SMALL = 0.2;

#define NO_SET UINT32_MAX

/* A round that merges fewer than one set in 16 by their best partners merges others, too. */
enum { FEW = 16 };

typedef struct merging_set {
    double normal[3], area;
    double outline; /* the length of its borders, with those that nothing is across */
    double open;    /* of those */
    double added;   /* the area that it got in this round */
    uint32_t node;
} merging_set;

/* The border between two sets. */
typedef struct shared_border {
    uint32_t a, b; /* a < b */
    double length;
} shared_border;

/* The best partner of a set so far. */
typedef struct partner {
    double cost;
    uint32_t other;
} partner;

typedef struct merging {
    const cwi_sheet *sheet;
    cwi_chart_tree *tree;
    merging_set *sets;
    size_t set_count, border_count;
    shared_border *borders, *sorted;
    partner *best;
    uint32_t *renamed; /* sets: their numbers in the next round */
    size_t *first;
} merging;

static void add_normals(const merging_set *a, const merging_set *b, double sum[3])
{
    for (int k = 0; k < 3; k++)
        sum[k] = a->normal[k] + b->normal[k];
}

static bool faces_one_way(const merging_set *a, const merging_set *b)
{
    double sum[3];
    add_normals(a, b, sum);
    return cwi_length(sum) >= MIN_FACING * (a->area + b->area);
}

static double merging_cost(const merging *m, const shared_border *border)
{
    const merging_set *a = &m->sets[border->a], *b = &m->sets[border->b];
    double sum[3];
    if (!faces_one_way(a, b))
        return INFINITY;
    add_normals(a, b, sum);
    const double area = a->area + b->area,
                 differ = cwi_length(a->normal) + cwi_length(b->normal) - cwi_length(sum),
                 outline = a->outline + b->outline - 2 * border->length,
                 round = area > 0 ? outline / sqrt(4 * CWI_PI * area) : 1;
    return (differ + SMALL * fmin(a->area, b->area)) * round * round;
}

static void consider(const merging *m, uint32_t set, uint32_t other, double cost)
{
    partner *best = &m->best[set];
    if (cost < best->cost || (cost == best->cost && other < best->other))
        *best = (partner){cost, other};
}

static void choose_partners(const merging *m)
{
    for (size_t s = 0; s < m->set_count; s++)
        m->best[s] = (partner){INFINITY, NO_SET};
    for (size_t n = 0; n < m->border_count; n++) {
        const shared_border *border = &m->borders[n];
        const double cost = merging_cost(m, border);
        if (cost < INFINITY) {
            consider(m, border->a, border->b, cost);
            consider(m, border->b, border->a, cost);
        }
    }
}

/* Joins set b to set a, whose number stays. */
static void join_sets(const merging *m, uint32_t a, uint32_t b)
{
    merging_set *to = &m->sets[a], *from = &m->sets[b];
    const size_t merger = m->tree->mergers++;
    m->tree->children[merger][0] = to->node;
    m->tree->children[merger][1] = from->node;
    m->tree->is_root[to->node] = m->tree->is_root[from->node] = false;
    to->node = (uint32_t)(m->tree->triangles + merger);
    m->tree->is_root[to->node] = true;
    to->area += from->area;
    to->added += from->area;
    to->open += from->open;
    for (int k = 0; k < 3; k++)
        to->normal[k] += from->normal[k];
    from->node = NO_SET;
    m->renamed[b] = a;
}

/* Merges each two sets that are each other's best partners; returns how many. */
static size_t merge_pairs(const merging *m)
{
    size_t merged = 0;
    for (uint32_t a = 0; a < m->set_count; a++) {
        const uint32_t b = m->best[a].other;
        if (b > a && b != NO_SET && m->best[b].other == a) {
            join_sets(m, a, b);
            merged++;
        }
    }
    return merged;
}

/* Joins further sets to their best partners. In a round a set at most doubles its area: then few rounds
 * do for any surface, while a row of sets, each of which prefers the one before, merges two by two. */
static size_t merge_further(const merging *m)
{
    size_t merged = 0;
    for (uint32_t b = 0; b < m->set_count; b++) {
        const merging_set *from = &m->sets[b];
        uint32_t a = m->best[b].other;
        if (from->node == NO_SET || from->added > 0 || a == NO_SET)
            continue;
        if (m->sets[a].node == NO_SET)
            a = m->renamed[a];
        const merging_set *to = &m->sets[a];
        const bool fits = to->added + from->area <= to->area - to->added || to->added == 0;
        if (a != b && fits && faces_one_way(to, from)) {
            join_sets(m, a, b);
            merged++;
        }
    }
    return merged;
}

/* Closes the ranks of the sets, and sets the new number of each. */
static void rename_sets(merging *m)
{
    uint32_t kept = 0;
    for (size_t s = 0; s < m->set_count; s++)
        if (m->sets[s].node != NO_SET)
            m->first[s] = kept++;
    for (size_t s = 0; s < m->set_count; s++)
        m->renamed[s] = (uint32_t)m->first[m->sets[s].node == NO_SET ? m->renamed[s] : s];
    for (size_t s = 0; s < m->set_count; s++)
        if (m->sets[s].node != NO_SET)
            m->sets[m->renamed[s]] = m->sets[s];
    m->set_count = kept;
}

/* Sorts borders by one of their sets; those of equal ones keep their order. */
static void sort_borders(merging *m, bool by_first)
{
    memset(m->first, 0, (m->set_count + 1) * sizeof *m->first);
    for (size_t n = 0; n < m->border_count; n++)
        m->first[(by_first ? m->borders[n].a : m->borders[n].b) + 1]++;
    for (size_t s = 0; s < m->set_count; s++)
        m->first[s + 1] += m->first[s];
    for (size_t n = 0; n < m->border_count; n++)
        m->sorted[m->first[by_first ? m->borders[n].a : m->borders[n].b]++] = m->borders[n];
    shared_border *borders = m->borders;
    m->borders = m->sorted;
    m->sorted = borders;
}

/* Lets two sets have one border, and sums up the outlines. */
static void join_borders(merging *m)
{
    size_t kept = 0;
    for (size_t n = 0; n < m->border_count; n++) {
        const uint32_t a = m->renamed[m->borders[n].a], b = m->renamed[m->borders[n].b];
        if (a != b)
            m->borders[kept++] =
                (shared_border){a < b ? a : b, a < b ? b : a, m->borders[n].length};
    }
    m->border_count = kept;
    sort_borders(m, false);
    sort_borders(m, true);
    kept = 0;
    for (size_t n = 0; n < m->border_count; n++) {
        const shared_border *border = &m->borders[n];
        shared_border *last = kept ? &m->borders[kept - 1] : NULL;
        if (last && last->a == border->a && last->b == border->b)
            last->length += border->length;
        else
            m->borders[kept++] = *border;
    }
    m->border_count = kept;
    for (size_t s = 0; s < m->set_count; s++) {
        m->sets[s].outline = m->sets[s].open;
        m->sets[s].added = 0;
    }
    for (size_t n = 0; n < kept; n++) {
        m->sets[m->borders[n].a].outline += m->borders[n].length;
        m->sets[m->borders[n].b].outline += m->borders[n].length;
    }
}

static void begin_merging(merging *m)
{
    const cwi_sheet *s = m->sheet;
    for (size_t t = 0; t < s->mesh->triangle_count; t++) {
        merging_set *set = &m->sets[t];
        *set = (merging_set){0};
        memcpy(set->normal, s->normal[t], sizeof set->normal);
        set->area = cwi_length(set->normal);
        set->node = (uint32_t)t;
        m->tree->is_root[t] = true;
        for (size_t k = 0; k < 3; k++) {
            const uint32_t twin = s->twin[3 * t + k], *v = s->mesh->triangles + 3 * t;
            const float *from = s->mesh->positions + 3 * (size_t)v[k],
                        *to = s->mesh->positions + 3 * (size_t)v[(k + 1) % 3];
            const double length = sqrt(cwi_point_distance_sq(from, to));
            if (twin == CWI_NO_CORNER)
                set->open += length;
            else if (twin / 3 > t)
                m->borders[m->border_count++] = (shared_border){(uint32_t)t, twin / 3, length};
        }
        m->renamed[t] = (uint32_t)t;
    }
    m->set_count = s->mesh->triangle_count;
    join_borders(m);
}

/* Returns false where no two sets merge. */
static bool merge_round(const merging *m)
{
    size_t merged = merge_pairs(m);
    if (merged * FEW < m->set_count)
        merged += merge_further(m);
    return merged > 0;
}

/* Sorts triangles so that those of a node follow each other. */
static void order_triangles(cwi_chart_tree *tree)
{
    uint32_t next = 0;
    for (size_t t = 0; t < tree->triangles; t++)
        tree->size[t] = 1;
    for (size_t n = 0; n < tree->mergers; n++)
        tree->size[tree->triangles + n] =
            tree->size[tree->children[n][0]] + tree->size[tree->children[n][1]];
    for (size_t n = 0; n < tree->triangles + tree->mergers; n++)
        if (tree->is_root[n]) {
            tree->begin[n] = next;
            next += tree->size[n];
        }
    for (size_t n = tree->mergers; n-- > 0;) {
        const uint32_t *child = tree->children[n], begin = tree->begin[tree->triangles + n];
        tree->begin[child[0]] = begin;
        tree->begin[child[1]] = begin + tree->size[child[0]];
    }
    for (uint32_t t = 0; t < tree->triangles; t++)
        tree->order[tree->begin[t]] = t;
}

cw_status cwi_chart_tree_build(cwi_chart_tree *tree, const cwi_sheet *sheet, cw_error *err)
{
    const size_t triangles = sheet->mesh->triangle_count;
    *tree = (cwi_chart_tree){.triangles = triangles};
    tree->children = cwi_alloc_array(triangles, sizeof *tree->children);
    tree->is_root = cwi_alloc_zeroed(2 * triangles + 1, sizeof *tree->is_root);
    tree->order = cwi_alloc_array(triangles, sizeof *tree->order);
    tree->begin = cwi_alloc_array(2 * triangles + 1, sizeof *tree->begin);
    tree->size = cwi_alloc_array(2 * triangles + 1, sizeof *tree->size);
    merging m = {.sheet = sheet, .tree = tree};
    m.sets = cwi_alloc_array(triangles, sizeof *m.sets);
    m.borders = cwi_alloc_array(triangles + triangles / 2 + 1, sizeof *m.borders);
    m.sorted = cwi_alloc_array(triangles + triangles / 2 + 1, sizeof *m.sorted);
    m.best = cwi_alloc_array(triangles, sizeof *m.best);
    m.renamed = cwi_alloc_array(triangles, sizeof *m.renamed);
    m.first = cwi_alloc_array(triangles + 2, sizeof *m.first);
    const bool ok = tree->children && tree->is_root && tree->order && tree->begin &&
                    tree->size && m.sets && m.borders && m.sorted && m.best && m.renamed &&
                    m.first;
    if (ok) {
        begin_merging(&m);
        for (choose_partners(&m); merge_round(&m); choose_partners(&m)) {
            rename_sets(&m);
            join_borders(&m);
        }
        order_triangles(tree);
    }
    cwi_free(m.sets);
    cwi_free(m.borders);
    cwi_free(m.sorted);
    cwi_free(m.best);
    cwi_free(m.renamed);
    cwi_free(m.first);
    return ok ? CW_OK : cwi_fail_memory(err);
}

void cwi_chart_tree_free(cwi_chart_tree *tree)
{
    cwi_free(tree->children);
    cwi_free(tree->is_root);
    cwi_free(tree->order);
    cwi_free(tree->begin);
    cwi_free(tree->size);
    *tree = (cwi_chart_tree){0};
}
