/* Unites closed components that cross or touch each other, or cross themselves, by an exact boolean. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/repair/repair_state.h"

#include <cubewright/boolean.h>
#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

/* A closed component: its box, and six times its volume, signed. */
typedef struct shell_size {
    double low[3], high[3], volume;
} shell_size;

/* Components joined by edges. Arrays of triangle_count. */
typedef struct shell_list {
    uint32_t *root;   /* of a triangle */
    bool *is_bad;     /* of a root: open, or crosses itself with a patch that may be wrong */
    bool *meets;      /* of a root: itself, or another one that is not bad */
    bool *stays;      /* of a triangle: its component is not united */
    uint8_t *turn;    /* of a triangle: 1 where its component faces the wrong way */
    shell_size *size; /* of a root */
    size_t count;     /* components to unite */
} shell_list;

static void free_shells(shell_list *s)
{
    cwi_free(s->root);
    cwi_free(s->is_bad);
    cwi_free(s->meets);
    cwi_free(s->stays);
    cwi_free(s->turn);
    cwi_free(s->size);
}

static bool join_shells(const cwi_repair *r, shell_list *s)
{
    const size_t count = r->mesh.triangle_count;
    s->root = cwi_sets_alloc(count);
    s->is_bad = cwi_alloc_zeroed(count, sizeof *s->is_bad);
    s->meets = cwi_alloc_zeroed(count, sizeof *s->meets);
    s->stays = cwi_alloc_zeroed(count, sizeof *s->stays);
    s->turn = cwi_alloc_zeroed(count, sizeof *s->turn);
    s->size = cwi_alloc_zeroed(count, sizeof *s->size);
    if (!s->root || !s->is_bad || !s->meets || !s->stays || !s->turn || !s->size)
        return false;
    for (uint32_t c = 0; c < 3 * count; c++)
        if (r->twin[c] != CWI_NO_CORNER)
            cwi_sets_join(s->root, c / 3, r->twin[c] / 3);
    for (uint32_t t = 0; t < count; t++)
        s->root[t] = cwi_sets_find(s->root, t);
    for (uint32_t c = 0; c < 3 * count; c++)
        if (r->twin[c] == CWI_NO_CORNER)
            s->is_bad[s->root[c / 3]] = true;
    return true;
}

/* Finds the components to unite. Without `all`, one that crosses itself must have no patches: those of another
 * kind may not cross it. */
static void choose_shells(const cwi_repair *r, const cw_crossings *found, bool all,
                          bool *has_patch, shell_list *s)
{
    const uint32_t *source = r->mesh.attributes->data;
    for (uint32_t t = 0; t < r->mesh.triangle_count; t++)
        if (source[t] == CWI_NEW && !all)
            has_patch[s->root[t]] = true;
    for (size_t n = 0; n < found->count; n++) {
        const uint32_t a = s->root[found->pairs[2 * n]], b = s->root[found->pairs[2 * n + 1]];
        if (a == b && has_patch[a])
            s->is_bad[a] = true;
    }
    for (size_t n = 0; n < found->count; n++) {
        const uint32_t a = s->root[found->pairs[2 * n]], b = s->root[found->pairs[2 * n + 1]];
        if (!s->is_bad[a] && !s->is_bad[b])
            s->meets[a] = s->meets[b] = true;
    }
    for (uint32_t t = 0; t < r->mesh.triangle_count; t++) {
        s->stays[t] = !s->meets[s->root[t]];
        s->count += s->meets[t];
    }
}

static void measure_shells(const cw_mesh *m, shell_list *s)
{
    for (size_t t = 0; t < m->triangle_count; t++) {
        shell_size *size = &s->size[s->root[t]];
        double p[3][3], from[3], area[3];
        cwi_mesh_corners(m, t, p);
        cwi_mesh_corner(m, s->root[t], 0, from);
        for (int k = 0; k < 9; k++) {
            double *low = &size->low[k % 3], *high = &size->high[k % 3];
            const bool is_first = s->root[t] == t && k < 3;
            *low = is_first ? p[0][k] : fmin(*low, p[k / 3][k % 3]);
            *high = is_first ? p[0][k] : fmax(*high, p[k / 3][k % 3]);
        }
        for (int k = 0; k < 3; k++)
            cwi_sub(p[k], from, p[k]);
        cwi_cross(p[1], p[2], area);
        size->volume += cwi_dot(p[0], area);
    }
}

/* Returns true if a component is within the box of another one that may have it as a cavity. */
static bool may_be_cavity(const cw_mesh *m, const shell_list *s, uint32_t root)
{
    const shell_size *in = &s->size[root];
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        const shell_size *out = &s->size[t];
        bool is_inside = s->root[t] == t && t != root && out->volume > 0;
        for (int k = 0; k < 3; k++)
            is_inside = is_inside && in->low[k] >= out->low[k] && in->high[k] <= out->high[k];
        if (is_inside)
            return true;
    }
    return false;
}

/* Marks the roots of components that enclose a negative volume and are no cavities. Those that face outward
 * stay so, even where they begin inside of another. */
static cw_status find_inverted(const cwi_repair *r, shell_list *s, cw_error *err)
{
    const cw_mesh *m = &r->mesh;
    const cw_quality_desc desc = {.threads = r->desc.threads, .shells = true, .turn = s->turn};
    cw_quality q;
    measure_shells(m, s);
    const cw_status st = cw_quality_measure(m, &desc, &q, err);
    for (uint32_t t = 0; t < m->triangle_count && st == CW_OK; t++)
        if (s->root[t] == t)
            s->turn[t] = !s->stays[t] && s->size[t].volume < 0 &&
                         (s->turn[t] || r->desc.outer_only || !may_be_cavity(m, s, t));
    return st;
}

/* Copies the components to unite. Labels are numbers of vertices. */
static cw_status copy_solids(const cwi_repair *r, const shell_list *s, cw_mesh *solids,
                             cw_error *err)
{
    cw_status st = cwi_mesh_copy(&r->mesh, solids, err);
    if (st != CW_OK)
        return st;
    for (uint32_t v = 0; v < solids->vertex_count; v++)
        solids->labels[v] = v;
    for (size_t t = 0; t < solids->triangle_count; t++)
        if (s->turn[s->root[t]])
            cwi_mesh_swap_corners(solids, t, 1, 2);
    return cwi_mesh_drop_marked(solids, s->stays, err);
}

/* Puts a union in the place of the components. Vertices that are where they were keep their sources. */
static cw_status replace_solids(cwi_repair *r, const shell_list *s, cw_mesh *united,
                                cw_error *err)
{
    const cw_mesh *m = &r->mesh;
    for (size_t v = 0; v < united->vertex_count; v++) {
        const size_t from = united->labels[v];
        const bool is_same =
            cwi_point_distance_sq(united->positions + 3 * v, m->positions + 3 * from) == 0;
        united->labels[v] = is_same ? m->labels[from] : CWI_NEW;
    }
    for (size_t t = 0; t < m->triangle_count; t++)
        s->meets[t] = !s->stays[t]; /* from here on of a triangle */
    cw_status st = cwi_mesh_drop_marked(&r->mesh, s->meets, err);
    if (st != CW_OK)
        return st;
    const size_t vertices = m->vertex_count, triangles = m->triangle_count;
    for (size_t c = 0; c < 3 * united->triangle_count; c++)
        united->triangles[c] += (uint32_t)vertices;
    st = cwi_repair_append(r, united->positions, united->vertex_count, united->triangles,
                           united->triangle_count, err);
    if (st != CW_OK || !united->triangle_count)
        return st;
    memcpy(m->labels + vertices, united->labels, united->vertex_count * sizeof *m->labels);
    memcpy((uint32_t *)m->attributes->data + triangles, united->attributes->data,
           united->triangle_count * sizeof(uint32_t));
    return CW_OK;
}

/* Reports the progress of the repair, which stands still. */
static bool stand_still(void *user, const char *step, double done)
{
    cwi_repair *r = user;
    cw_error none;
    (void)step;
    (void)done;
    return cwi_repair_progress(r, "repair", 0, &none) == CW_OK;
}

static cw_status unite_shells(cwi_repair *r, const shell_list *s, cw_error *err)
{
    cw_mesh solids = {0}, united = {0};
    const cw_mesh *const meshes[] = {&solids};
    const cw_boolean_desc desc = {.threads = r->desc.threads, .progress = {stand_still, r}};
    cw_status st = copy_solids(r, s, &solids, err);
    if (st == CW_OK)
        st = cw_mesh_boolean(meshes, 1, &desc, &united, NULL, err);
    if (st == CW_ERR_CHECK || st == CW_ERR_LIMIT) { /* triangles are dropped instead */
        if (err)
            *err = (cw_error){0};
        r->facts.is_union_lacking = true;
        st = CW_OK;
    } else if (st == CW_OK) {
        st = replace_solids(r, s, &united, err);
        r->facts.united_shells += s->count;
    }
    cw_mesh_free(&solids);
    cw_mesh_free(&united);
    return st;
}

cw_status cwi_unite_solids(cwi_repair *r, const cw_crossings *found, bool all, bool *changed,
                           cw_error *err)
{
    shell_list s = {0};
    bool *has_patch = cwi_alloc_zeroed(r->mesh.triangle_count, sizeof *has_patch);
    const size_t before = r->facts.united_shells;
    cw_status st = has_patch && join_shells(r, &s) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        choose_shells(r, found, all, has_patch, &s);
    if (st == CW_OK && s.count)
        st = find_inverted(r, &s, err);
    if (st == CW_OK && s.count)
        st = unite_shells(r, &s, err);
    *changed = r->facts.united_shells > before;
    cwi_free(has_patch);
    free_shells(&s);
    return st;
}
