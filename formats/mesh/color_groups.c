/* Groups the triangles of a part by their colours, or splits its vertices so that each has one. */
#include "formats/mesh/color_groups.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/texture/split_seams.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_GROUPS = CWI_MAX_COLOR_GROUPS, SLOTS = 512, NO_SLOT = UINT16_MAX };

static uint32_t pack_color(const uint8_t *c)
{
    return (uint32_t)c[0] << 24 | (uint32_t)c[1] << 16 | (uint32_t)c[2] << 8 | c[3];
}

/* Colours by number, in the order in which they are first met. */
typedef struct color_table {
    uint32_t colors[MAX_GROUPS];
    size_t triangles[MAX_GROUPS];
    size_t count;
    uint16_t slots[SLOTS];
} color_table;

/* Returns the number of a colour, or MAX_GROUPS where there is no room for it. */
static size_t find_color(color_table *table, uint32_t color)
{
    size_t slot = color * 2654435761u >> 23;
    while (table->slots[slot] != NO_SLOT && table->colors[table->slots[slot]] != color)
        slot = (slot + 1) % SLOTS;
    if (table->slots[slot] == NO_SLOT && table->count < MAX_GROUPS) {
        table->colors[table->count] = color;
        table->slots[slot] = (uint16_t)table->count++;
    }
    return table->slots[slot] == NO_SLOT ? MAX_GROUPS : table->slots[slot];
}

/* Counts the triangles of each colour. Returns false if there are more than MAX_GROUPS colours. */
static bool count_colors(const cwi_part *part, color_table *table)
{
    size_t n = 0;
    *table = (color_table){0};
    memset(table->slots, 0xff, sizeof table->slots);
    for (size_t t = 0; t < part->mesh.triangle_count && n < MAX_GROUPS; t++) {
        n = find_color(table, pack_color(part->face_colors + 4 * t));
        if (n < MAX_GROUPS)
            table->triangles[n]++;
    }
    return n < MAX_GROUPS;
}

/* --- groups ----------------------------------------------------------------------------- */

size_t cwi_count_face_colors(const cwi_part *part)
{
    color_table table;
    return count_colors(part, &table) ? table.count : MAX_GROUPS + 1;
}

cw_status cwi_group_faces(const cwi_part *part, cwi_color_groups *groups, cw_error *err)
{
    color_table table;
    size_t next[MAX_GROUPS], first = 0;
    if (!count_colors(part, &table))
        return cwi_fail(err, CW_ERR_LIMIT, "the triangles have more than %d colours",
                        (int)MAX_GROUPS);
    groups->order = cwi_alloc_array(part->mesh.triangle_count, sizeof *groups->order);
    groups->items = cwi_alloc_zeroed(table.count, sizeof *groups->items);
    if (!groups->order || !groups->items)
        return cwi_fail_memory(err);
    groups->count = table.count;
    for (size_t n = 0; n < table.count; n++) {
        cwi_color_group *group = &groups->items[n];
        next[n] = group->first = first;
        group->count = table.triangles[n];
        for (size_t c = 0; c < 4; c++)
            group->color[c] = (uint8_t)(table.colors[n] >> (24 - 8 * c));
        first += group->count;
    }
    for (size_t t = 0; t < part->mesh.triangle_count; t++) {
        const size_t n = find_color(&table, pack_color(part->face_colors + 4 * t));
        groups->order[next[n]++] = (uint32_t)t;
    }
    return CW_OK;
}

void cwi_color_groups_free(cwi_color_groups *groups)
{
    cwi_free(groups->items);
    cwi_free(groups->order);
    *groups = (cwi_color_groups){0};
}

/* --- vertices of one colour each -------------------------------------------------------------- */

/* Vertices while they are split. A triangle's key is its colour, then its number. */
typedef struct splitting {
    const cwi_part *part;
    uint64_t *keys;
    uint32_t *last,
        *index;   /* of each vertex: the colour that it was last met with, counted from 1,
                               and its number then */
    size_t count; /* of vertices, with those added */
} splitting;

static int compare_keys(const void *a, const void *b)
{
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

static cw_status begin_splitting(splitting *s, const cwi_part *part, cw_error *err)
{
    const cw_mesh *m = &part->mesh;
    *s = (splitting){.part = part};
    if (m->triangle_count > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "glTF colours at most %u triangles; the mesh has %zu", UINT32_MAX,
                        m->triangle_count);
    s->keys = cwi_alloc_array(m->triangle_count, sizeof *s->keys);
    s->last = cwi_alloc_array(m->vertex_count, sizeof *s->last);
    s->index = cwi_alloc_array(m->vertex_count, sizeof *s->index);
    if (!s->keys || !s->last || !s->index)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < m->triangle_count; t++)
        s->keys[t] = (uint64_t)pack_color(part->face_colors + 4 * t) << 32 | t;
    qsort(s->keys, m->triangle_count, sizeof *s->keys, compare_keys);
    return CW_OK;
}

static void end_splitting(splitting *s)
{
    cwi_free(s->keys);
    cwi_free(s->last);
    cwi_free(s->index);
}

static void copy_vertex(const cw_mesh *from, size_t v, cw_mesh *to, size_t at, uint32_t color)
{
    memcpy(to->positions + 3 * at, from->positions + 3 * v, 3 * sizeof *to->positions);
    if (to->normals)
        memcpy(to->normals + 3 * at, from->normals + 3 * v, 3 * sizeof *to->normals);
    if (to->attribute_count) /* texture coordinates alone */
        memcpy((float *)to->attributes->data + 2 * at,
               (const float *)cwi_texture_of(from)->data + 2 * v, 2 * sizeof(float));
    for (size_t c = 0; c < 4; c++)
        to->colors[4 * at + c] = (uint8_t)(color >> (24 - 8 * c));
}

/* Walks over the triangles of each colour. A vertex keeps its number in the first, and is added at
 * the end in others. to: NULL counts the vertices alone */
static void split_vertices(splitting *s, cw_mesh *to)
{
    const cw_mesh *m = &s->part->mesh;
    uint32_t number = 0;
    s->count = m->vertex_count;
    memset(s->last, 0, m->vertex_count * sizeof *s->last);
    for (size_t n = 0; n < m->triangle_count; n++) {
        const size_t t = (uint32_t)s->keys[n];
        const uint32_t color = (uint32_t)(s->keys[n] >> 32);
        number += n == 0 || s->keys[n - 1] >> 32 != color;
        for (size_t c = 0; c < 3; c++) {
            const uint32_t v = m->triangles[3 * t + c];
            if (s->last[v] != number) {
                s->index[v] = s->last[v] ? (uint32_t)s->count++ : v;
                s->last[v] = number;
                if (to)
                    copy_vertex(m, v, to, s->index[v], color);
            }
            if (to)
                to->triangles[3 * t + c] = s->index[v];
        }
    }
}

/* Copies vertices that no triangle names; they are white. */
static void copy_unused(const splitting *s, cw_mesh *to)
{
    for (size_t v = 0; v < s->part->mesh.vertex_count; v++)
        if (!s->last[v])
            copy_vertex(&s->part->mesh, v, to, v, UINT32_MAX);
}

cw_status cwi_split_by_color(const cwi_part *part, cw_mesh *split, cw_error *err)
{
    splitting s;
    const cw_mesh *m = &part->mesh;
    cw_status st = begin_splitting(&s, part, err);
    if (st == CW_OK) {
        split_vertices(&s, NULL);
        st = s.count < UINT32_MAX
                 ? cwi_mesh_alloc(split, s.count, m->triangle_count, m->normals, err)
                 : cwi_fail(err, CW_ERR_LIMIT, "%zu vertices, each of one colour, are too many",
                            s.count);
    }
    if (st == CW_OK && !(split->colors = cwi_alloc_array(s.count, 4)))
        st = cwi_fail_memory(err);
    if (st == CW_OK && part->texture)
        st = cw_mesh_attribute_add(split, part->texture, NULL, err);
    if (st == CW_OK) {
        split_vertices(&s, split);
        copy_unused(&s, split);
    }
    end_splitting(&s);
    return st;
}

cw_status cwi_count_split(const cwi_part *part, size_t *added, cw_error *err)
{
    splitting s;
    cw_status st = begin_splitting(&s, part, err);
    *added = 0;
    if (st == CW_OK) {
        split_vertices(&s, NULL);
        *added = s.count - part->mesh.vertex_count;
    }
    end_splitting(&s);
    return st;
}
