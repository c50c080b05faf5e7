/* Searches around vertices of very many triangles, where boxes overlap nearly all: there the boxes are
 * those of directions. */
#include "simplify/intersections/pair_search.h"

#include "core/base/memory.h"

enum { MAX_WORK = 96 }; /* of a triangle that is held against a fan */

/* A fan, its triangles by their directions, and the triangle that is held against them. */
typedef struct fan_visit {
    const cwi_pair_search *s;
    cwi_pair_list *to;
    uint32_t fan;
    cwi_boxes directions;
    uint32_t triangle;
    float box[6], direction[6];
    size_t triangles; /* held against it so far */
} fan_visit;

static void set_direction(const fan_visit *v, uint32_t triangle, float box[6])
{
    const float *points = v->s->welded.points, *corners[3];
    const uint32_t *vertex = v->s->welded.vertex + 3 * (size_t)triangle,
                   hub = v->s->fans.hubs[v->fan];
    for (int k = 0; k < 3; k++)
        corners[k] = points + 3 * (size_t)vertex[k];
    cwi_direction_box(points + 3 * (size_t)hub, corners,
                      vertex[0] == hub || vertex[1] == hub || vertex[2] == hub, box);
}

static bool boxes_meet(const float a[6], const float b[6])
{
    for (int k = 0; k < 3; k++)
        if (a[k] > b[k + 3] || b[k] > a[k + 3])
            return false;
    return true;
}

static bool is_within_work(const fan_visit *v)
{
    return v->to->work <= v->to->max_work + MAX_WORK * v->triangles;
}

static bool meet_directions(void *context, size_t node)
{
    fan_visit *v = context;
    const cwi_pair_search *s = v->s;
    const bool same = s->fans.fan_of[v->triangle] == v->fan;
    unsigned meeting = cwi_boxes_meeting(&v->directions.nodes[node], v->direction);
    for (size_t c = 0; meeting >> c; c++) {
        if (!(meeting >> c & 1))
            continue;
        const uint32_t other = v->directions.order[node * CWI_WIDTH + c];
        float box[6];
        cwi_boxes_triangle(s->welded.points, s->welded.vertex + 3 * (size_t)other, box);
        v->to->work++;
        if ((same && other <= v->triangle) || !boxes_meet(box, v->box))
            continue; /* each pair once */
        v->to->work++;
        cwi_test_pair(s, v->to, v->triangle, other);
    }
    return is_within_work(v) && !v->to->failed;
}

/* Holds a triangle against those of the fan, if it is near. */
static void meet_fan(fan_visit *v, uint32_t triangle)
{
    const cwi_welded *w = &v->s->welded;
    cwi_boxes_triangle(w->points, w->vertex + 3 * (size_t)triangle, v->box);
    if (v->to->cut || v->to->failed || !boxes_meet(v->box, v->s->around[v->fan]))
        return;
    v->triangle = triangle;
    v->triangles++;
    set_direction(v, triangle, v->direction);
    cwi_boxes_visit(&v->directions, v->direction, 0, meet_directions, v);
    v->to->cut = !is_within_work(v);
}

static bool meet_near_node(void *context, size_t node)
{
    fan_visit *v = context;
    const cwi_boxes *tree = &v->s->tree;
    for (size_t i = node * CWI_WIDTH; i < (node + 1) * CWI_WIDTH && i < tree->count; i++)
        meet_fan(v, tree->order[i]);
    return !v->to->cut && !v->to->failed;
}

static bool sort_directions(fan_visit *v)
{
    const uint32_t *triangles = v->s->fans.triangles + v->s->fans.first[v->fan];
    const size_t count = v->s->fans.first[v->fan + 1] - v->s->fans.first[v->fan];
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    for (size_t n = 0; n < count && boxes; n++)
        set_direction(v, triangles[n], boxes[n]);
    const bool ok = boxes && cwi_boxes_build(&v->directions, (const float(*)[6])boxes, count,
                                             NULL) == CW_OK;
    for (size_t n = 0; n < count && ok; n++)
        v->directions.order[n] = triangles[v->directions.order[n]];
    cwi_free(boxes);
    return ok;
}

void cwi_search_fan(const cwi_pair_search *s, uint32_t fan, cwi_pair_list *to)
{
    fan_visit v = {.s = s, .to = to, .fan = fan};
    to->count = to->work = 0;
    to->cut = false;
    to->failed = !sort_directions(&v);
    if (!to->failed)
        cwi_boxes_visit(&s->tree, s->around[fan], 0, meet_near_node, &v);
    for (size_t f = fan; f < s->fans.count && !to->failed; f++)
        if (boxes_meet(s->around[f], s->around[fan]))
            for (size_t n = s->fans.first[f]; n < s->fans.first[f + 1]; n++)
                meet_fan(&v, s->fans.triangles[n]);
    cwi_boxes_free(&v.directions);
}

static bool is_flat(const void *context, size_t triangle)
{
    return cwi_is_flat(context, triangle);
}

bool cwi_find_fans(cwi_pair_search *s)
{
    const cwi_welded *w = &s->welded;
    if (cwi_wide_fans_find(&s->fans, w->mesh->vertex_count, w->vertex, w->mesh->triangle_count,
                           is_flat, w, NULL) != CW_OK)
        return false;
    s->around = cwi_alloc_array(s->fans.count, sizeof *s->around);
    for (size_t f = 0; f < s->fans.count && s->around; f++) {
        float *around = s->around[f];
        cwi_boxes_triangle(w->points,
                           w->vertex + 3 * (size_t)s->fans.triangles[s->fans.first[f]], around);
        for (size_t n = s->fans.first[f]; n < s->fans.first[f + 1]; n++) {
            float box[6];
            cwi_boxes_triangle(w->points, w->vertex + 3 * (size_t)s->fans.triangles[n], box);
            for (int a = 0; a < 3; a++) {
                around[a] = fminf(around[a], box[a]);
                around[a + 3] = fmaxf(around[a + 3], box[a + 3]);
            }
        }
    }
    return s->around;
}
