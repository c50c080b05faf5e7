/* Splits a mesh at its marks into parts; runs of triangles that share vertices stay
 * together. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/union_find.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "core/texture/separate_textures.h"
#include "formats/mesh/picture_store.h"
#include "formats/mesh/place_parts.h"

static const uint32_t NONE = UINT32_MAX;

/* The result in one piece of memory: the parts, and after them the data they point to. */
typedef struct held {
    cw_mesh mesh;
    cw_label_table labels; /* of all parts; in the first one */
    cwi_pictures pictures; /* the same */
    char name[CWI_NAME_BYTES];
} held;

typedef struct split {
    cw_mesh *whole;
    const cwi_marks *marks;
    size_t run_count;  /* number of marks, or 1 */
    uint32_t *part_of; /* of each run of triangles between two marks */
    uint32_t *run_of;  /* of each vertex: the first run that names it */
    uint32_t *new;     /* the vertex' number in its part */
    cw_part *parts;
    held *held;
    size_t count;
    size_t textures;  /* sets of them */
    uint32_t *latest; /* one for each set and for none; NULL where there is no set */
} split;

static size_t run_start(const split *s, size_t run)
{
    return run == 0                ? 0
           : run < s->marks->count ? s->marks->items[run].triangle
                                   : s->whole->triangle_count;
}

/* --- runs joined to parts ----------------------------------------------------------------- */

/* Joins the runs of one object with the same textures. latest: one for each set of textures, and for none */
static void join_textured(split *s, uint32_t *latest, size_t count)
{
    const cwi_mark *marks = s->marks->items;
    for (size_t n = 0; n < count; n++)
        latest[n] = NONE;
    for (uint32_t run = 0; run < s->marks->count; run++) {
        uint32_t *last = &latest[marks[run].textures];
        if (*last != NONE && marks[*last].object == marks[run].object)
            cwi_sets_join(s->part_of, *last, run);
        *last = run;
    }
}

/* Joins runs that share a vertex to one set. */
static void join_runs(split *s)
{
    for (size_t v = 0; v < s->whole->vertex_count; v++)
        s->run_of[v] = NONE;
    for (uint32_t run = 0; run < s->run_count; run++)
        for (size_t i = 3 * run_start(s, run); i < 3 * run_start(s, run + 1); i++) {
            uint32_t *first = &s->run_of[s->whole->triangles[i]];
            if (*first == NONE)
                *first = run;
            cwi_sets_join(s->part_of, *first, run);
        }
}

/* Numbers the sets in the order of the file; runs without triangles have no number. A root is
 * met before the runs that are joined with it. */
static void number_parts(split *s)
{
    for (uint32_t run = 0; run < s->run_count; run++) {
        const bool is_root = s->part_of[run] == run;
        const bool empty = run_start(s, run) == run_start(s, run + 1);
        s->part_of[run] = empty     ? NONE
                          : is_root ? (uint32_t)s->count++
                                    : s->part_of[s->part_of[run]];
    }
}

/* --- the parts --------------------------------------------------------------------------- */

static void count_elements(split *s)
{
    for (size_t run = 0; run < s->run_count; run++)
        if (s->part_of[run] != NONE)
            s->held[s->part_of[run]].mesh.triangle_count +=
                run_start(s, run + 1) - run_start(s, run);
    for (size_t v = 0; v < s->whole->vertex_count; v++)
        if (s->run_of[v] != NONE)
            s->new[v] = (uint32_t)s->held[s->part_of[s->run_of[v]]].mesh.vertex_count++;
}

static void copy_vertex(const split *s, size_t v)
{
    cw_mesh *to = &s->held[s->part_of[s->run_of[v]]].mesh;
    const size_t n = s->new[v];
    memcpy(to->positions + 3 * n, s->whole->positions + 3 * v, 3 * sizeof *to->positions);
    cwi_attributes_put(s->whole, v, to, n);
}

static void copy_elements(split *s)
{
    for (size_t v = 0; v < s->whole->vertex_count; v++)
        if (s->run_of[v] != NONE)
            copy_vertex(s, v);
    for (size_t p = 0; p < s->count; p++)
        s->held[p].mesh.triangle_count = 0;
    for (size_t run = 0; run < s->run_count; run++) {
        if (s->part_of[run] == NONE)
            continue;
        cw_mesh *m = &s->held[s->part_of[run]].mesh;
        for (size_t t = run_start(s, run); t < run_start(s, run + 1); t++) {
            const uint32_t *from = s->whole->triangles + 3 * t;
            for (size_t k = 0; k < 3; k++)
                m->triangles[3 * m->triangle_count + k] = s->new[from[k]];
            cwi_attributes_put_triangle(s->whole, t, from, m, m->triangle_count++);
        }
    }
}

static bool take_apart(split *s)
{
    count_elements(s);
    for (size_t p = 0; p < s->count; p++) {
        cw_mesh *m = &s->held[p].mesh;
        if (cwi_mesh_alloc(m, m->vertex_count, m->triangle_count, false, NULL) != CW_OK ||
            cwi_attributes_alloc(s->whole, m, NULL) != CW_OK)
            return false;
        memcpy(m->origin, s->whole->origin, sizeof m->origin);
        memcpy(m->affine, s->whole->affine, sizeof m->affine);
    }
    copy_elements(s);
    return true;
}

/* Leaves out colours of vertices that are all the label's. */
static void drop_label_color(cw_mesh *mesh, const cw_label *label)
{
    uint8_t color[4];
    if (!cwi_mesh_one_color(mesh, color) || !label->has_color ||
        memcmp(color, label->color, sizeof color) != 0)
        return;
    cwi_free(mesh->colors);
    mesh->colors = NULL;
}

static const cw_label *find_label(const split *s, const cwi_mark *mark)
{
    return mark->labelled ? cw_label_find(&s->held->labels, mark->layer, mark->value) : NULL;
}

/* Gives each part the name and the label of its first run. */
static void name_parts(split *s)
{
    for (size_t p = 0; p < s->count; p++)
        s->parts[p] = (cw_part){.mesh = &s->held[p].mesh};
    for (size_t run = s->marks->count; run-- > 0;)
        if (s->part_of[run] != NONE) {
            const cw_textures *sets = s->held->pictures.sets;
            const cwi_mark *mark = &s->marks->items[run];
            const char *name = s->marks->names + mark->name;
            const uint32_t p = s->part_of[run];
            cwi_clean_name(name, strlen(name), s->held[p].name);
            s->parts[p].name = s->held[p].name[0] ? s->held[p].name : NULL;
            s->parts[p].label = find_label(s, mark);
            s->parts[p].textures = mark->textures ? &sets[mark->textures - 1] : NULL;
        }
    for (size_t p = 0; p < s->count; p++)
        if (s->parts[p].label)
            drop_label_color(&s->held[p].mesh, s->parts[p].label);
}

/* Gives what has other textures other vertices, so that it is another part. sets: of textures */
static cw_status separate_textures(const split *s, size_t sets, cw_error *err)
{
    const size_t count = s->whole->triangle_count;
    uint32_t *textures = sets ? cwi_alloc_array(count, sizeof *textures) : NULL;
    if (!sets)
        return CW_OK;
    if (!textures)
        return cwi_fail_memory(err);
    for (size_t run = 0; run < s->run_count; run++)
        for (size_t t = run_start(s, run); t < run_start(s, run + 1); t++)
            textures[t] = s->marks->items[run].textures;
    const cw_status st = cwi_separate_textures(s->whole, textures, err);
    cwi_free(textures);
    return st;
}

static bool make_parts(split *s)
{
    if (s->run_count > 1) {
        if (s->latest)
            join_textured(s, s->latest, s->textures + 1);
        join_runs(s);
        number_parts(s);
    }
    const size_t count = s->count ? s->count : 1; /* an empty mesh is one part, too */
    s->parts = cwi_alloc_zeroed(count, sizeof *s->parts + sizeof *s->held);
    if (!s->parts)
        return false;
    s->held = (held *)(s->parts + count);
    if (s->count > 1)
        return take_apart(s);
    s->count = 1;
    s->held->mesh = *s->whole;
    *s->whole = (cw_mesh){0};
    return true;
}

/* Checks the memory: the copies exist beside the whole for a while. */
static cw_status limit_memory(const cwi_mesh_input *in, const cw_mesh *m, cw_error *err)
{
    const uint64_t limit = in->desc.max_bytes;
    uint64_t vertex = 12 + sizeof(uint32_t) * 2 /* run_of, new */;
    for (size_t n = 0; n < cwi_attribute_count(m); n++) {
        const cw_attribute row = cwi_attribute_at(m, n);
        vertex += row.data && row.on == CW_ON_VERTICES ? cwi_attribute_bytes(&row) : 0;
    }
    const uint64_t bytes = vertex * m->vertex_count + 12 * (uint64_t)m->triangle_count;
    if (!limit || in->marks.count <= 1 || in->bytes + bytes <= limit)
        return CW_OK;
    char text[CWI_MEMORY_TEXT];
    cwi_print_memory(limit, text);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "the parts need more memory than the %s allowed (desc->max_bytes)", text);
}

cw_status cwi_parts_label(const cwi_mesh_input *in, cw_mesh *mesh, cw_error *err)
{
    const cwi_marks *marks = &in->marks;
    const size_t count = mesh->triangle_count;
    size_t labelled = 0;
    for (size_t n = 0; n < marks->count; n++)
        labelled += marks->items[n].labelled || marks->items[n].triangle == count;
    if (mesh->labels || !in->labels.count || labelled < marks->count)
        return CW_OK;
    mesh->labels = cwi_alloc_zeroed(mesh->vertex_count, sizeof *mesh->labels);
    if (!mesh->labels) {
        cw_mesh_free(mesh);
        return cwi_fail_memory(err);
    }
    for (size_t n = 0; n < marks->count; n++) {
        const size_t end = n + 1 < marks->count ? marks->items[n + 1].triangle : count;
        for (size_t i = 3 * marks->items[n].triangle; i < 3 * end; i++)
            mesh->labels[mesh->triangles[i]] = marks->items[n].value;
    }
    return CW_OK;
}

cw_status cwi_parts_split(cwi_mesh_input *in, cw_mesh *mesh, cw_part **parts, size_t *count,
                          cw_error *err)
{
    split s = {
        .whole = mesh, .marks = &in->marks, .run_count = in->marks.count ? in->marks.count : 1};
    cw_status st = limit_memory(in, mesh, err);
    if (st == CW_OK && s.run_count > 1)
        st = separate_textures(&s, in->pictures.set_count, err);
    if (st != CW_OK)
        return st;
    const size_t vertices = s.run_count > 1 ? mesh->vertex_count : 0;
    s.textures = in->pictures.set_count;
    s.latest = s.textures ? cwi_alloc_array(s.textures + 1, sizeof *s.latest) : NULL;
    s.part_of = cwi_sets_alloc(s.run_count);
    s.run_of = cwi_alloc_array(vertices, sizeof *s.run_of);
    s.new = cwi_alloc_array(vertices, sizeof *s.new);
    const bool ok = s.part_of && s.run_of && s.new && !s.latest == !s.textures &&make_parts(&s);
    if (ok) {
        s.held->labels = in->labels;
        in->labels = (cw_label_table){0};
        s.held->pictures = in->pictures;
        in->pictures = (cwi_pictures){0};
        name_parts(&s);
    } else
        cw_parts_free(s.parts, s.parts ? s.count : 0);
    cwi_free(s.part_of);
    cwi_free(s.run_of);
    cwi_free(s.new);
    cwi_free(s.latest);
    *parts = ok ? s.parts : NULL;
    *count = ok ? s.count : 0;
    return ok ? CW_OK : cwi_fail_memory(err);
}

void cw_parts_free(cw_part *parts, size_t count)
{
    held *h = parts ? (held *)(parts + count) : NULL;
    for (size_t p = 0; p < count; p++) {
        cw_mesh_free(&h[p].mesh);
        cw_label_table_free(&h[p].labels);
        cwi_pictures_free(&h[p].pictures);
    }
    cwi_free(parts);
}
