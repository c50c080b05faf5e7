/* glTF scenes written by hand that tests of the reader share. */
#ifndef TESTS_GLTF_CASES_H
#define TESTS_GLTF_CASES_H

#include "support/meshes.h"

#include "core/base/module.h"
#include "formats/gltf/gltf_scene.h"

#include <math.h>
#include <stdio.h>

/* The bytes behind every scene here: three corners of a right triangle, their indices in bytes,
 * a strip of four in 16 bits, colours, and numbers that are broken. */
static const struct {
    float corners[9];
    uint8_t bytes[4];
    uint16_t strip[4];
    uint8_t colors[12]; /* linear */
    float square[12];
    float broken[9];
    float normals[9];
    uint8_t beyond[4];
    int16_t quantized[12]; /* 3 x 3, each with 2 bytes between */
} bin = {
    {0, 0, 0, 1, 0, 0, 0, 1, 0},
    {0, 1, 2, 0},
    {0, 1, 2, 3},
    {0, 255, 55, 255, 1, 188, 0, 0, 255, 255, 255, 128},
    {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0},
    {0, 0, 0, 1, NAN, 0, 0, 1, 0},
    {0, 0, 1, 0, 0, 1, 0, 0, 1},
    {0, 1, 3, 0},
    {0, 0, 0, 9, 32767, 0, 0, 9, 0, -32768, 0, 9},
};

/* Accessors: 0 corners, 1 bytes, 2 strip, 3 colours, 4 square, 5 broken, 6 normals, 7 beyond,
 * 8 quantized, 9 sparse, 10 a matrix, 11 more than there is, 12 without a view, 13 and 14 far
 * more than there is, 15 sparse without a view, 16 sparse bytes; sparse ones of which: 17 the
 * last index is beyond, 18 indices fall, 19 there are more than elements, 20 nearly all is
 * zero. */
#define SPARSE(count, indices, first, values, at)                                              \
    "{\"count\":" #count ",\"indices\":{\"bufferView\":" #indices ",\"byteOffset\":" #first    \
    ",\"componentType\":5121},\"values\":{\"bufferView\":" #values ",\"byteOffset\":" #at "}}"
#define ARRAYS                                                                                 \
    "\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":208}],\"bufferViews\":["     \
    "{\"buffer\":0,\"byteLength\":36},"                                                        \
    "{\"buffer\":0,\"byteOffset\":36,\"byteLength\":4},"                                       \
    "{\"buffer\":0,\"byteOffset\":40,\"byteLength\":8},"                                       \
    "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12},"                                      \
    "{\"buffer\":0,\"byteOffset\":60,\"byteLength\":48},"                                      \
    "{\"buffer\":0,\"byteOffset\":108,\"byteLength\":36},"                                     \
    "{\"buffer\":0,\"byteOffset\":144,\"byteLength\":36},"                                     \
    "{\"buffer\":0,\"byteOffset\":180,\"byteLength\":4},"                                      \
    "{\"buffer\":0,\"byteOffset\":184,\"byteLength\":24,\"byteStride\":8}],"                   \
    "\"accessors\":["                                                                          \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                 \
    "{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"},"               \
    "{\"bufferView\":2,\"componentType\":5123,\"count\":4,\"type\":\"SCALAR\"},"               \
    "{\"bufferView\":3,\"componentType\":5121,\"count\":3,\"type\":\"VEC4\","                  \
    "\"normalized\":true},"                                                                    \
    "{\"bufferView\":4,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                 \
    "{\"bufferView\":5,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                 \
    "{\"bufferView\":6,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                 \
    "{\"bufferView\":7,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"},"               \
    "{\"bufferView\":8,\"componentType\":5122,\"count\":3,\"type\":\"VEC3\","                  \
    "\"normalized\":true},"                                                                    \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","                  \
    "\"sparse\":" SPARSE(                                                                      \
        1, 1, 1, 6,                                                                            \
        0) "},"                                                                                \
           "{\"bufferView\":0,\"componentType\":5126,\"count\":1,\"type\":\"MAT2\"},"          \
           "{\"bufferView\":0,\"componentType\":5126,\"count\":300,\"type\":\"VEC3\"},"        \
           "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                           \
           "{\"bufferView\":0,\"byteOffset\":9223372036854775807,\"componentType\":5126,"      \
           "\"count\":3,\"type\":\"VEC3\"},"                                                   \
           "{\"bufferView\":0,\"componentType\":5126,\"count\":1537228672809129302,"           \
           "\"type\":\"VEC3\"},"                                                               \
           "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","                            \
           "\"sparse\":" SPARSE(                                                               \
               2, 1, 1, 0,                                                                     \
               12) "},"                                                                        \
                   "{\"bufferView\":7,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"," \
                   "\"sparse\":" SPARSE(                                                       \
                       1, 1, 2, 1,                                                             \
                       2) "},"                                                                 \
                          "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":"     \
                          "\"VEC3\","                                                          \
                          "\"sparse\":" SPARSE(                                                \
                              3, 7, 0, 6,                                                      \
                              0) "},"                                                          \
                                 "{\"bufferView\":0,\"componentType\":5126,\"count\":3,"       \
                                 "\"type\":\"VEC3\","                                          \
                                 "\"sparse\":" SPARSE(                                         \
                                     2, 1, 2, 6,                                               \
                                     0) "},"                                                   \
                                        "{\"bufferView\":0,\"componentType\":5126,\"count\":"  \
                                        "3,\"type\":\"VEC3\","                                 \
                                        "\"sparse\":" SPARSE(                                  \
                                            4, 1, 0, 4,                                        \
                                            0) "},"                                            \
                                               "{\"componentType\":5126,\"count\":2000000000," \
                                               "\"type\":\"VEC3\","                            \
                                               "\"sparse\":" SPARSE(1, 1, 1, 6, 0) "}]"

static inline void put_u32(unsigned char *to, size_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

static inline cw_status read_glb(const char *json, cw_mesh *mesh, cw_mesh_file *file,
                                 cw_error *err)
{
    const size_t length = (strlen(json) + 3) / 4 * 4, size = 12 + 8 + length + 8 + sizeof bin;
    unsigned char *glb = calloc(size, 1);
    assert_non_null(glb);
    memcpy(glb, "glTF", 4);
    put_u32(glb + 4, 2);
    put_u32(glb + 8, size);
    put_u32(glb + 12, length);
    memcpy(glb + 16, "JSON", 4);
    memset(glb + 20, ' ', length);
    memcpy(glb + 20, json, strlen(json));
    put_u32(glb + 20 + length, sizeof bin);
    memcpy(glb + 24 + length, "BIN", 3);
    memcpy(glb + 28 + length, &bin, sizeof bin);
    const cw_status st = read_bytes("a.glb", glb, size, mesh, file, err);
    free(glb);
    return st;
}

/* A scene of one node with one primitive. */
static inline cw_status read_primitive(const char *primitive, cw_mesh *mesh, cw_mesh_file *file,
                                       cw_error *err)
{
    char json[8192];
    snprintf(json, sizeof json,
             "{" ARRAYS ",\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
             "\"meshes\":[{\"primitives\":[%s]}]}",
             primitive);
    return read_glb(json, mesh, file, err);
}

#define BY_BYTES "{\"attributes\":{\"POSITION\":0},\"indices\":1}"
#define MESHES                                                                                 \
    ",\"meshes\":[{\"primitives\":[" BY_BYTES                                                  \
    "]},{\"primitives\":[{\"attributes\":{\"POSITION\":8},\"mode\":%d}]}]"

/* Nodes and scenes by hand, around a mesh of one triangle and a quantized one, which is points
 * unless the file requires the extension. */
static inline cw_status read_nodes(const char *nodes, cw_mesh *mesh, cw_mesh_file *file,
                                   cw_error *err)
{
    char json[8192];
    snprintf(json, sizeof json, "{" ARRAYS MESHES ",%s}",
             strstr(nodes, "KHR_mesh_quantization") ? 4 : 0, nodes);
    return read_glb(json, mesh, file, err);
}

static inline void check_point(const cw_mesh *mesh, size_t v, double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (size_t a = 0; a < 3; a++)
        assert_near(mesh->origin[a] + (double)mesh->positions[3 * v + a], expected[a], 1e-4);
}

#endif
