/* Reads and checks the segments of Neuroglancer's mesh folders. */
#include "support/files/mesh_folder.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The rest of a file of little-endian numbers. */
typedef struct rest {
    const unsigned char *at, *end;
} rest;

static uint32_t take_u32(rest *r)
{
    assert_true(r->end - r->at >= 4);
    const unsigned char *b = r->at;
    r->at += 4;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static float take_f32(rest *r)
{
    const uint32_t bits = take_u32(r);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static const char *find_key(const char *text, const char *key)
{
    const char *at = strstr(text, key);
    if (!at)
        fail_msg("no %s in %s", key, text);
    return at + strlen(key);
}

static void read_info(const char *folder, folder_segment *s)
{
    char path[512];
    size_t size;
    snprintf(path, sizeof path, "%s/info", folder);
    char *text = test_file_read(path, &size);
    find_key(text, "\"@type\": \"neuroglancer_multilod_draco\"");
    s->bits = atoi(find_key(text, "\"vertex_quantization_bits\":"));
    assert_true(s->bits == 10 || s->bits == 16);
    s->multiplier = strtod(find_key(text, "\"lod_scale_multiplier\":"), NULL);
    char *at = (char *)(uintptr_t)find_key(text, "\"transform\": [");
    for (int i = 0; i < 12; i++) {
        s->transform[i] = strtod(at, &at);
        assert_int_equal(*at++, i < 11 ? ',' : ']');
    }
    free(text);
}

static void read_manifest(const char *path, folder_segment *s)
{
    size_t size;
    unsigned char *bytes = (unsigned char *)test_file_read(path, &size);
    rest r = {bytes, bytes + size};
    for (int a = 0; a < 3; a++)
        s->shape[a] = take_f32(&r);
    for (int a = 0; a < 3; a++)
        s->origin[a] = take_f32(&r);
    s->level_count = take_u32(&r);
    assert_true(s->level_count >= 1 && s->level_count <= FOLDER_LEVELS);
    for (uint32_t l = 0; l < s->level_count; l++)
        s->levels[l].scale = take_f32(&r);
    for (uint32_t l = 0; l < s->level_count; l++)
        for (int a = 0; a < 3; a++)
            s->levels[l].offset[a] = take_f32(&r);
    for (uint32_t l = 0; l < s->level_count; l++)
        s->levels[l].count = take_u32(&r);
    for (uint32_t l = 0; l < s->level_count; l++) {
        folder_level *level = &s->levels[l];
        assert_true(level->count >= 1 && level->count < size);
        level->fragments = calloc(level->count, sizeof *level->fragments);
        for (int a = 0; a < 3; a++)
            for (uint32_t n = 0; n < level->count; n++)
                level->fragments[n].at[a] = take_u32(&r);
        for (uint32_t n = 0; n < level->count; n++)
            level->fragments[n].size = take_u32(&r);
    }
    assert_ptr_equal(r.at, r.end);
    free(bytes);
}

static void read_fragments(const char *path, folder_segment *s)
{
    size_t size, at = 0;
    cw_error err = {0};
    const cwi_draco_functions *draco;
    char *bytes = test_file_read(path, &size);
    assert_ok(cwi_draco_functions_load(&draco, &err), err);
    for (uint32_t l = 0; l < s->level_count; l++)
        for (uint32_t n = 0; n < s->levels[l].count; n++) {
            folder_fragment *f = &s->levels[l].fragments[n];
            assert_true(f->size <= size - at);
            if (f->size)
                assert_ok(
                    draco->decode(bytes + at, f->size, NULL, SIZE_MAX, NULL, &f->arrays, &err),
                    err);
            at += f->size;
        }
    assert_int_equal(at, size);
    free(bytes);
}

/* Returns true if a is in front of b: the highest bit that differs decides, of z before y before
 * x. */
static bool is_before(const uint32_t a[3], const uint32_t b[3])
{
    for (int bit = 31; bit >= 0; bit--)
        for (int axis = 2; axis >= 0; axis--) {
            const uint32_t x = a[axis] >> bit & 1, y = b[axis] >> bit & 1;
            if (x != y)
                return x < y;
        }
    return false;
}

static bool has_child(const folder_level *finer, const uint32_t at[3])
{
    for (uint32_t n = 0; n < finer->count; n++) {
        const uint32_t *c = finer->fragments[n].at;
        if (c[0] / 2 == at[0] && c[1] / 2 == at[1] && c[2] / 2 == at[2])
            return true;
    }
    return false;
}

static bool has_node(const folder_level *level, const uint32_t at[3])
{
    for (uint32_t n = 0; n < level->count; n++)
        if (memcmp(level->fragments[n].at, at, 3 * sizeof *at) == 0)
            return true;
    return false;
}

static void check_nodes(const folder_segment *s, size_t l)
{
    const folder_level *level = &s->levels[l];
    assert_true(level->scale > 0 && (l == 0 || level->scale >= s->levels[l - 1].scale));
    for (uint32_t n = 0; n < level->count; n++) {
        const folder_fragment *f = &level->fragments[n];
        assert_true(n == 0 || is_before(level->fragments[n - 1].at, f->at));
        if (f->size == 0)
            assert_true(l > 0 && has_child(&s->levels[l - 1], f->at));
        else
            assert_true(f->arrays.triangle_count > 0);
        const uint32_t parent[3] = {f->at[0] / 2, f->at[1] / 2, f->at[2] / 2};
        if (l + 1 < s->level_count)
            assert_true(has_node(&s->levels[l + 1], parent));
    }
}

/* Positions are integers of the node, and triangles of coarser levels on one side of the place
 * at which viewers part a node. */
static void check_fragment(const folder_segment *s, size_t l, const cwi_arrays *m)
{
    const float most = (float)((1 << s->bits) - 1), middle = (float)(1 << (s->bits - 1));
    for (size_t i = 0; i < 3 * m->vertex_count; i++)
        assert_true(m->positions[i] >= 0 && m->positions[i] <= most &&
                    m->positions[i] == floorf(m->positions[i]));
    for (size_t t = 0; t < m->triangle_count; t++)
        for (size_t a = 0; a < 3; a++) {
            int below = 0, above = 0;
            for (size_t k = 0; k < 3; k++) {
                const float x = m->positions[3 * (size_t)m->triangles[3 * t + k] + a];
                below += x < middle;
                above += x > middle;
            }
            assert_true(l == 0 || !below || !above);
        }
}

folder_segment test_segment_read(const char *folder, const char *id)
{
    char path[512];
    folder_segment s = {0};
    read_info(folder, &s);
    snprintf(path, sizeof path, "%s/%s.index", folder, id);
    read_manifest(path, &s);
    snprintf(path, sizeof path, "%s/%s", folder, id);
    read_fragments(path, &s);
    for (uint32_t l = 0; l < s.level_count; l++) {
        check_nodes(&s, l);
        for (uint32_t n = 0; n < s.levels[l].count; n++)
            check_fragment(&s, l, &s.levels[l].fragments[n].arrays);
    }
    return s;
}

void test_segment_free(folder_segment *s)
{
    for (uint32_t l = 0; l < s->level_count; l++) {
        for (uint32_t n = 0; n < s->levels[l].count; n++)
            cwi_arrays_free(&s->levels[l].fragments[n].arrays);
        free(s->levels[l].fragments);
    }
    *s = (folder_segment){0};
}

/* Copies a fragment behind the meshes before it. The mesh's origin is where the transform puts
 * zero. */
static void append_fragment(const folder_segment *s, size_t l, const folder_fragment *f,
                            cw_mesh *mesh)
{
    const size_t first = mesh->vertex_count;
    const double most = (double)((1 << s->bits) - 1);
    for (size_t v = 0; v < f->arrays.vertex_count; v++)
        for (size_t a = 0; a < 3; a++) {
            const double stored =
                (double)s->origin[a] + (double)s->levels[l].offset[a] +
                ldexp((double)s->shape[a], (int)l) *
                    (f->at[a] + (double)f->arrays.positions[3 * v + a] / most);
            mesh->positions[3 * (first + v) + a] = (float)(s->transform[5 * a] * stored / 1e6);
        }
    for (size_t i = 0; i < 3 * f->arrays.triangle_count; i++)
        mesh->triangles[3 * mesh->triangle_count + i] =
            (uint32_t)(first + f->arrays.triangles[i]);
    mesh->vertex_count += f->arrays.vertex_count;
    mesh->triangle_count += f->arrays.triangle_count;
}

cw_mesh test_segment_join(const folder_segment *s, size_t l)
{
    const folder_level *level = &s->levels[l];
    size_t vertices = 0, triangles = 0;
    cw_error err = {0};
    for (uint32_t n = 0; n < level->count; n++) {
        vertices += level->fragments[n].arrays.vertex_count;
        triangles += level->fragments[n].arrays.triangle_count;
    }
    cw_mesh mesh = {.positions = cwi_alloc_array(vertices, 12),
                    .triangles = cwi_alloc_array(triangles, 12)};
    assert_true(mesh.positions && mesh.triangles);
    for (size_t a = 0; a < 3; a++)
        mesh.origin[a] = s->transform[4 * a + 3] / 1e6;
    for (uint32_t n = 0; n < level->count; n++)
        append_fragment(s, l, &level->fragments[n], &mesh);
    assert_ok(cw_mesh_weld(&mesh, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, triangles);
    return mesh;
}
