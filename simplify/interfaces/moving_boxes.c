/* Builds the tree of moving triangles, and lets its boxes grow. */
#include "simplify/interfaces/moving_boxes.h"

#include "core/base/memory.h"
#include "core/base/status.h"

static cw_status build_tree(cwi_moving_boxes *m, const cwi_complex *c, uint32_t *triangles,
                            float (*boxes)[6], cw_error *err)
{
    size_t count = 0;
    for (size_t t = 0; t < c->triangle_count; t++)
        if (c->corners[3 * t] != CWI_NO_INDEX) {
            cwi_boxes_triangle(c->points, c->corners + 3 * t, boxes[count]);
            triangles[count++] = (uint32_t)t;
        }
    const cw_status st = cwi_boxes_build(&m->tree, (const float(*)[6])boxes, count, err);
    for (size_t s = 0; s < count && st == CW_OK; s++) {
        m->tree.order[s] = triangles[m->tree.order[s]];
        m->slots[m->tree.order[s]] = (uint32_t)s;
    }
    return st;
}

cw_status cwi_moving_boxes_build(cwi_moving_boxes *m, const cwi_complex *c, cw_error *err)
{
    cwi_boxes_free(&m->tree);
    m->built = c->live;
    if (!m->slots)
        m->slots = cwi_alloc_array(c->triangle_count, sizeof *m->slots);
    uint32_t *triangles = cwi_alloc_array(c->live, sizeof *triangles);
    float(*boxes)[6] = cwi_alloc_array(c->live, sizeof *boxes);
    const cw_status st = m->slots && triangles && boxes
                             ? build_tree(m, c, triangles, boxes, err)
                             : cwi_fail_memory(err);
    cwi_free(triangles);
    cwi_free(boxes);
    return st;
}

void cwi_moving_boxes_free(cwi_moving_boxes *m)
{
    cwi_boxes_free(&m->tree);
    cwi_free(m->slots);
    memset(m, 0, sizeof *m);
}

/* Grows a box of a node. Returns false if it was large enough. */
static bool grow_box(cwi_boxes_node *node, size_t child, const float box[6])
{
    bool is_grown = false;
    for (int k = 0; k < 3; k++) {
        float *low = &node->low[k][child], *high = &node->high[k][child];
        is_grown |= box[k] < *low || box[k + 3] > *high;
        *low = box[k] < *low ? box[k] : *low;
        *high = box[k + 3] > *high ? box[k + 3] : *high;
    }
    return is_grown;
}

void cwi_moving_boxes_update(cwi_moving_boxes *m, const cwi_complex *c, uint32_t triangle)
{
    size_t slot = m->slots[triangle];
    float box[6];
    cwi_boxes_triangle(c->points, c->corners + 3 * (size_t)triangle, box);
    cwi_boxes_put(m->tree.nodes, slot, box);
    for (int level = 1; level < m->tree.levels; level++) {
        slot /= CWI_WIDTH;
        cwi_boxes_node *node = m->tree.nodes + m->tree.first[level] + slot / CWI_WIDTH;
        if (!grow_box(node, slot % CWI_WIDTH, box))
            break;
    }
}

void cwi_moving_boxes_remove(cwi_moving_boxes *m, uint32_t triangle)
{
    const float empty[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    cwi_boxes_put(m->tree.nodes, m->slots[triangle], empty);
}
