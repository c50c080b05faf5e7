/* Runs tinygltf in a sandboxed process. JSON goes in, and a scene comes out through memory that
 * both sides see. The scene results from an untrusted file, so every size and range in it is
 * checked. */
#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/sandbox.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/gltf/gltf_wrap.h"

#include <stddef.h>
#include <string.h>

enum { LARGEST_ELEMENT = 256, MAX_JSON = 32 << 20, HEAD = 64 << 10 };
static const uint64_t NO_STRING = UINT64_MAX;

/* The strings of a scene in a row: URIs of buffers, names of meshes, names and codes of nodes. */
static size_t count_strings(const cwi_gltf_scene *s)
{
    return (s->buffers ? s->buffer_count : 0) + (s->meshes ? s->mesh_count : 0) +
           (s->nodes ? s->node_count * (1 + CWI_GLTF_CODES) : 0);
}

static char **string_of(const cwi_gltf_scene *s, size_t n)
{
    if (n < s->buffer_count)
        return &s->buffers[n].uri;
    n -= s->buffer_count;
    if (n < s->mesh_count)
        return &s->meshes[n].name;
    n -= s->mesh_count;
    cwi_gltf_node *node = &s->nodes[n / (1 + CWI_GLTF_CODES)];
    const size_t code = n % (1 + CWI_GLTF_CODES);
    return code ? &node->codes[code - 1] : &node->name;
}

void cwi_gltf_scene_free(cwi_gltf_scene *scene)
{
    for (size_t n = 0; n < count_strings(scene); n++)
        cwi_free(*string_of(scene, n));
    cwi_free(scene->buffers);
    cwi_free(scene->views);
    cwi_free(scene->accessors);
    cwi_free(scene->primitives);
    cwi_free(scene->meshes);
    cwi_free(scene->nodes);
    cwi_free(scene->children);
    cwi_free(scene->roots);
    cwi_free(scene->materials);
    cwi_free(scene->targets);
    cwi_free(scene->skins);
    cwi_free(scene->joints);
    cwi_free(scene->weights);
    *scene = (cwi_gltf_scene){0};
}

cw_status cwi_gltf_functions_load(const cwi_gltf_functions **functions, cw_error *err)
{
    const void *module;
    cw_status st = cwi_module_load("gltf", &module, err);
    if (st == CW_OK)
        *functions = module;
    return st;
}

cw_status cwi_gltf_prepare(cw_error *err)
{
    return cwi_module_find("gltf", err);
}

/* An array of a scene. */
typedef struct column {
    size_t array, count; /* offsets of the pointer and of the number of elements */
    size_t size;         /* of an element */
} column;

#define COLUMN(name, counter)                                                                  \
    {                                                                                          \
        offsetof(cwi_gltf_scene, name), offsetof(cwi_gltf_scene, counter),                     \
            sizeof *((cwi_gltf_scene *)0)->name                                                \
    }
static const column columns[] = {
    COLUMN(buffers, buffer_count),     COLUMN(views, view_count),
    COLUMN(accessors, accessor_count), COLUMN(primitives, primitive_count),
    COLUMN(meshes, mesh_count),        COLUMN(nodes, node_count),
    COLUMN(children, child_count),     COLUMN(roots, root_count),
    COLUMN(materials, material_count), COLUMN(targets, target_count),
    COLUMN(skins, skin_count),         COLUMN(joints, joint_count),
    COLUMN(weights, weight_count),
};
#undef COLUMN
enum { COLUMNS = sizeof columns / sizeof *columns };

static void *array_of(const cwi_gltf_scene *s, const column *c)
{
    void *array;
    memcpy(&array, (const char *)s + c->array, sizeof array);
    return array;
}

static size_t count_of(const cwi_gltf_scene *s, const column *c)
{
    return *(const size_t *)(const void *)((const char *)s + c->count);
}

/* A part of the shared memory, written or read from its start. */
typedef struct tape {
    char *at, *end;
} tape;

static bool put_bytes(tape *t, const void *bytes, size_t size)
{
    if ((size_t)(t->end - t->at) < size)
        return false;
    if (size)
        memcpy(t->at, bytes, size);
    t->at += size;
    return true;
}

static bool take_bytes(tape *t, void *bytes, size_t size)
{
    if ((size_t)(t->end - t->at) < size)
        return false;
    if (size)
        memcpy(bytes, t->at, size);
    t->at += size;
    return true;
}

/* --- in the child ------------------------------------------------------------------------- */

static bool put_string(tape *t, const char *text)
{
    const uint64_t size = text ? strlen(text) : NO_STRING;
    return put_bytes(t, &size, sizeof size) && (!text || put_bytes(t, text, strlen(text)));
}

/* Writes a scene: every array after its length, then the strings. */
bool cwi_gltf_put_scene(const cwi_gltf_scene *s, void *to, size_t capacity)
{
    tape tape_to = {.at = to, .end = (char *)to + capacity}, *t = &tape_to;
    bool good = true;
    for (size_t n = 0; good && n < COLUMNS; n++) {
        const uint64_t count = count_of(s, &columns[n]);
        good = put_bytes(t, &count, sizeof count) &&
               put_bytes(t, array_of(s, &columns[n]), (size_t)count * columns[n].size);
    }
    for (size_t n = 0; good && n < count_strings(s); n++)
        good = put_string(t, *string_of(s, n));
    return good;
}

typedef struct job {
    const cwi_gltf_functions *functions; /* loaded in the child */
    size_t json, shared;                 /* bytes */
} job;

static cw_status load_tinygltf(void *state, cw_error *err)
{
    job *j = state;
    return cwi_gltf_functions_load(&j->functions, err);
}

static cw_status work_on_request(void *state, int fd, const void *request, void *shared,
                                 cw_error *err)
{
    const job *j = state;
    cwi_gltf_scene scene = {0};
    (void)fd, (void)request;
    cw_status st = j->functions->parse(shared, j->json, &scene, err);
    if (st == CW_OK &&
        !cwi_gltf_put_scene(&scene, (char *)shared + j->json, j->shared - j->json))
        st =
            cwi_fail(err, CW_ERR_LIMIT, "the scene takes more memory than its JSON allows for");
    cwi_gltf_scene_free(&scene);
    return st;
}

/* --- in the parent ------------------------------------------------------------------------ */

static cw_status take_string(tape *t, char **text, cw_error *err)
{
    uint64_t size;
    *text = NULL;
    if (!take_bytes(t, &size, sizeof size) ||
        (size != NO_STRING && size > (size_t)(t->end - t->at)))
        return cwi_fail(err, CW_ERR_BACKEND, "tinygltf's answer is not valid");
    if (size == NO_STRING)
        return CW_OK;
    *text = cwi_alloc_array((size_t)size + 1, 1);
    if (!*text)
        return cwi_fail_memory(err);
    take_bytes(t, *text, (size_t)size);
    (*text)[size] = '\0';
    return CW_OK;
}

static cw_status take_column(tape *t, const column *c, cwi_gltf_scene *s, cw_error *err)
{
    uint64_t count;
    if (!take_bytes(t, &count, sizeof count) || count > (size_t)(t->end - t->at) / c->size)
        return cwi_fail(err, CW_ERR_BACKEND, "tinygltf's answer is not valid");
    void *array = cwi_alloc_array((size_t)count, c->size);
    if (!array)
        return cwi_fail_memory(err);
    take_bytes(t, array, (size_t)count * c->size);
    memcpy((char *)s + c->array, &array, sizeof array);
    *(size_t *)(void *)((char *)s + c->count) = (size_t)count;
    return CW_OK;
}

/* Makes a bool valid: untrusted memory may hold any byte. */
static void mend_bool(bool *b)
{
    unsigned char byte;
    memcpy(&byte, b, 1);
    *b = byte != 0;
}

static bool is_range(size_t first, size_t end, size_t count)
{
    return first <= end && end <= count;
}

/* Checks the scene. Our own module keeps these rules, but its process may have been taken
 * over. */
static bool mend_scene(cwi_gltf_scene *s)
{
    for (size_t i = 0; i < s->accessor_count; i++) {
        cwi_gltf_accessor *a = &s->accessors[i];
        mend_bool(&a->normalized);
        mend_bool(&a->has_bounds);
        if (a->numbers < 0 || a->numbers > 16)
            return false;
    }
    for (size_t i = 0; i < s->primitive_count; i++) {
        cwi_gltf_primitive *p = &s->primitives[i];
        if (!is_range(p->first_target, p->end_target, s->target_count))
            return false;
    }
    for (size_t i = 0; i < s->target_count; i++)
        mend_bool(&s->targets[i].has_color);
    for (size_t i = 0; i < s->skin_count; i++)
        if (!is_range(s->skins[i].first, s->skins[i].end, s->joint_count))
            return false;
    for (size_t i = 0; i < s->material_count; i++)
        mend_bool(&s->materials[i].is_plain);
    for (size_t i = 0; i < s->mesh_count; i++) {
        const cwi_gltf_mesh *m = &s->meshes[i];
        if (!is_range(m->first, m->end, s->primitive_count) ||
            !is_range(m->first_weight, m->end_weight, s->weight_count))
            return false;
    }
    for (size_t i = 0; i < s->node_count; i++) {
        cwi_gltf_node *n = &s->nodes[i];
        mend_bool(&n->lps);
        mend_bool(&n->has_origin);
        mend_bool(&n->has_affine);
        mend_bool(&n->has_label);
        mend_bool(&n->label_is_negative);
        mend_bool(&n->has_color);
        mend_bool(&n->is_hidden);
        if (!is_range(n->first, n->end, s->child_count) ||
            !is_range(n->first_weight, n->end_weight, s->weight_count))
            return false;
    }
    return true;
}

cw_status cwi_gltf_take_scene(const void *from, size_t size, cwi_gltf_scene *s, cw_error *err)
{
    tape tape_from = {.at = (char *)(uintptr_t)from}, *t = &tape_from;
    cw_status st = CW_OK;
    t->end = t->at + size;
    for (size_t n = 0; st == CW_OK && n < COLUMNS; n++)
        st = take_column(t, &columns[n], s, err);
    for (size_t n = 0; n < count_strings(s); n++) /* addresses in the child */
        *string_of(s, n) = NULL;
    for (size_t n = 0; st == CW_OK && n < count_strings(s); n++)
        st = take_string(t, string_of(s, n), err);
    if (st == CW_OK && !mend_scene(s))
        return cwi_fail(err, CW_ERR_BACKEND, "tinygltf's answer is not valid");
    return st;
}

cw_status cwi_gltf_parse(const char *json, size_t size, const cw_mesh_read_desc *desc,
                         cwi_gltf_scene *scene, cw_error *err)
{
    const size_t dense = size < MAX_JSON ? size : MAX_JSON; /* without its strings */
    job j = {.json = size, .shared = 2 * size + LARGEST_ELEMENT * dense + HEAD};
    cwi_sandbox box = {0};
    const cwi_sandbox_desc shut = {.library = "tinygltf",
                                   .prepare = load_tinygltf,
                                   .work = work_on_request,
                                   .state = &j,
                                   .shared_bytes = j.shared,
                                   .memory = desc->max_bytes,
                                   .timeout_s = desc->timeout_s,
                                   .inside = desc->no_sandbox};
    cw_status st = cwi_sandbox_open(&box, &shut, err);
    if (st != CW_OK)
        return st;
    memcpy(box.shared, json, size);
    box.progress = &desc->progress;
    st = cwi_sandbox_run(&box, -1, "", 1, err);
    if (st == CW_OK)
        st = cwi_gltf_take_scene((char *)box.shared + size, j.shared - size, scene, err);
    cwi_sandbox_close(&box);
    return st;
}

/* --- writing ------------------------------------------------------------------------------ */

/* A job of the other direction: a document in, and its JSON out: its size, then its bytes. */
typedef struct writing {
    const cwi_gltf_functions *functions; /* loaded in the child */
    const cwi_gltf_document *document;
    size_t capacity;
} writing;

static cw_status load_writer(void *state, cw_error *err)
{
    writing *w = state;
    return cwi_gltf_functions_load(&w->functions, err);
}

static cw_status make_json(void *state, int fd, const void *request, void *shared,
                           cw_error *err)
{
    const writing *w = state;
    char *json = NULL;
    size_t size = 0;
    (void)fd, (void)request;
    cw_status st = w->functions->document(w->document, &json, &size, err);
    tape t = {.at = shared, .end = (char *)shared + w->capacity};
    if (st == CW_OK && (!put_bytes(&t, &size, sizeof size) || !put_bytes(&t, json, size)))
        st = cwi_fail(err, CW_ERR_LIMIT, "the JSON takes more than %zu bytes", w->capacity);
    cwi_free(json);
    return st;
}

/* Returns an upper bound, far above the JSON's size. Unused memory is never touched. */
static size_t capacity_for_json(const cwi_gltf_document *d)
{
    enum { BASE = 1 << 20, PER_PIECE = 16 << 10, PER_GROUP = 2 << 10, WORST_ESCAPE = 6 };
    size_t words = 0, groups = 0;
    for (size_t i = 0; i < d->count; i++)
        groups += d->pieces[i].groups.count;
    for (size_t i = 0; i < d->provenance_count; i++)
        words += strlen(d->provenance[i].key) + strlen(d->provenance[i].value);
    return BASE + PER_PIECE * d->count + PER_GROUP * groups + WORST_ESCAPE * words;
}

static cw_status take_json(const void *shared, char **json, size_t *size, cw_error *err)
{
    memcpy(size, shared, sizeof *size);
    *json = cwi_alloc_array(*size, 1);
    if (!*json)
        return cwi_fail_memory(err);
    memcpy(*json, (const char *)shared + sizeof *size, *size);
    return CW_OK;
}

/* Makes the JSON in a process of its own, or here where the system gives none. */
cw_status cwi_gltf_make_json(const cwi_gltf_document *document, char **json, size_t *size,
                             cw_error *err)
{
    writing w = {.document = document, .capacity = capacity_for_json(document)};
    cwi_sandbox box = {0};
    cwi_sandbox_desc apart = {.library = "tinygltf",
                              .prepare = load_writer,
                              .work = make_json,
                              .state = &w,
                              .shared_bytes = w.capacity,
                              .trusted = true};
    cw_status st = cwi_sandbox_open(&box, &apart, err);
    if (st == CW_ERR_BACKEND) {
        apart.inside = true;
        st = cwi_sandbox_open(&box, &apart, err);
    }
    if (st != CW_OK)
        return st;
    st = cwi_sandbox_run(&box, -1, "", 1, err);
    if (st == CW_ERR_BACKEND && !box.open)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = take_json(box.shared, json, size, err);
    cwi_sandbox_close(&box);
    return st;
}
