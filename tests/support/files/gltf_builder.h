/* A glTF file in text that tests build: arrays become accessors, and the rest is JSON by hand. */
#ifndef TESTS_GLTF_BUILDER_H
#define TESTS_GLTF_BUILDER_H

#include "support/meshes.h"

#include "formats/bytes/base64.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BUILDER_BYTES = 1 << 16 };

typedef struct gltf_builder {
    unsigned char bytes[BUILDER_BYTES];
    size_t size;
    char views[BUILDER_BYTES], accessors[BUILDER_BYTES];
    int count;
} gltf_builder;

static inline size_t builder_component_size(int component)
{
    return component == 5120 || component == 5121   ? 1
           : component == 5122 || component == 5123 ? 2
                                                    : 4;
}

/* Adds an array of `count` elements as a view and an accessor, and returns its index.
 * type  "VEC3", or with more members behind it: "VEC3\",\"normalized\":true,\"x\":\"" */
static inline int add_array(gltf_builder *b, int component, const char *type, size_t numbers,
                            size_t count, const void *array)
{
    const size_t bytes = builder_component_size(component) * numbers * count;
    const size_t used = strlen(b->views), put = strlen(b->accessors);
    assert_true(b->size + bytes + 3 < sizeof b->bytes);
    memcpy(b->bytes + b->size, array, bytes);
    snprintf(b->views + used, sizeof b->views - used,
             "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", used ? "," : "", b->size,
             bytes);
    snprintf(b->accessors + put, sizeof b->accessors - put,
             "%s{\"bufferView\":%d,\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"}",
             put ? "," : "", b->count, component, count, type);
    b->size = (b->size + bytes + 3) / 4 * 4;
    return b->count++;
}

/* Adds an accessor by hand, beside a view that nothing names, so that the numbers of both agree. */
static inline int add_accessor(gltf_builder *b, const char *accessor)
{
    static const uint32_t none = 0;
    char *end = b->accessors + strlen(b->accessors);
    const int index = add_array(b, 5125, "SCALAR", 1, 1, &none);
    snprintf(end, sizeof b->accessors - (size_t)(end - b->accessors), "%s%s", index ? "," : "",
             accessor);
    return index;
}

static inline int add_floats(gltf_builder *b, const char *type, size_t numbers, size_t count,
                             const float *array)
{
    return add_array(b, 5126, type, numbers, count, array);
}

/* Writes a.gltf in the test's folder: the arrays, and the rest of the outermost object. */
static inline const char *write_built(const gltf_builder *b, const char *rest)
{
    const size_t room = 2 * BUILDER_BYTES + 4 * b->size + strlen(rest) + 512;
    char *text = calloc(1, room), *digits = calloc(1, 2 * b->size + 16);
    assert_true(text && digits);
    digits[cwi_base64_encode(b->bytes, b->size, digits)] = '\0';
    snprintf(text, room,
             "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":"
             "\"data:application/octet-stream;base64,%s\"}],\"bufferViews\":[%s],\"accessors\":"
             "[%s],%s}",
             b->size, digits, b->views, b->accessors, rest);
    test_file_write(test_path("a.gltf"), text, strlen(text));
    free(digits);
    free(text);
    return test_path("a.gltf");
}

static inline cw_status read_built(const gltf_builder *b, const char *rest, cw_mesh *mesh,
                                   cw_mesh_file *file, cw_error *err)
{
    return cw_mesh_read(write_built(b, rest), NULL, mesh, file, err);
}

/* Checks a vertex in metres and +Y up, as in the file. */
static inline void check_vertex(const cw_mesh *mesh, size_t v, double x, double y, double z)
{
    const double expected[3] = {1000 * x, -1000 * z, 1000 * y};
    for (size_t a = 0; a < 3; a++) {
        const double is = mesh->origin[a] + (double)mesh->positions[3 * v + a];
        if (!(fabs(is - expected[a]) < 1e-3))
            fail_msg("coordinate %zu of vertex %zu is %g, not %g", a, v, is, expected[a]);
    }
}

#endif
