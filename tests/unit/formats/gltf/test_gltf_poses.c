/* glTF read as viewers draw its first frame: morph targets, and skins at rest. */
#include "support/files/gltf_builder.h"

#include "core/base/module.h"

#include <math.h>

static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
static const float upright[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1};

/* --- morph targets ----------------------------------------------------------------------- */

/* A triangle with two targets: one raises corner 2 by 1 along y, one moves all by 4 along z. */
typedef struct morphing {
    gltf_builder b;
    int position, targets[2], sparse;
} morphing;

static void begin_morphing(morphing *m)
{
    static const float up[9] = {0, 0, 0, 0, 0, 0, 0, 1, 0},
                       along[9] = {0, 0, 4, 0, 0, 4, 0, 0, 4};
    static const uint8_t last = 2;
    char accessor[400];
    memset(m, 0, sizeof *m);
    m->position = add_floats(&m->b, "VEC3", 3, 3, corners);
    m->targets[0] = add_floats(&m->b, "VEC3", 3, 3, up);
    m->targets[1] = add_floats(&m->b, "VEC3", 3, 3, along);
    const int index = add_array(&m->b, 5121, "SCALAR", 1, 1, &last);
    const int value = add_floats(&m->b, "VEC3", 3, 1, up + 6);
    snprintf(
        accessor, sizeof accessor,
        "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":1,"
        "\"indices\":{\"bufferView\":%d,\"componentType\":5121},\"values\":{\"bufferView\":%d}}}",
        index, value);
    m->sparse = add_accessor(&m->b, accessor);
}

static void weights_displace_vertices(void **state)
{
    (void)state;
    static const struct {
        const char *mesh, *node;
        double up, along;
        bool sparse;
    } rows[] = {{"", "", 0, 0, false},
                {",\"weights\":[0.5,0]", "", 0.5, 0, false},
                {",\"weights\":[0.5,0.25]", "", 0.5, 0.25, false},
                {",\"weights\":[0.5,0.25]", ",\"weights\":[0,-1]", 0, -1, false},
                {"", ",\"weights\":[2]", 2, 0, false},
                {",\"weights\":[1,1]", ",\"weights\":[0,0]", 0, 0, false},
                {",\"weights\":[0.75,0.5]", "", 0.75, 0.5, true}};
    morphing *m = malloc(sizeof *m);
    assert_non_null(m);
    begin_morphing(m);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char rest[600];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        snprintf(rest, sizeof rest,
                 "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"targets\":["
                 "{\"POSITION\":%d},{\"POSITION\":%d}]}]%s}],\"nodes\":[{\"mesh\":0%s}]",
                 m->position, rows[n].sparse ? m->sparse : m->targets[0], m->targets[1],
                 rows[n].mesh, rows[n].node);
        assert_ok(read_built(&m->b, rest, &mesh, &file, &err), err);
        check_vertex(&mesh, 0, 0, 0, 4 * rows[n].along);
        check_vertex(&mesh, 1, 1, 0, 4 * rows[n].along);
        check_vertex(&mesh, 2, 0, 1 + rows[n].up, 4 * rows[n].along);
        assert_string_equal(file.not_applied, "");
        assert_string_equal(file.fault, "");
        cw_mesh_free(&mesh);
    }
    free(m);
}

/* Displacements in bytes and shorts, with and without "normalized", below a node that turns. */
static void displacements_are_quantized_too(void **state)
{
    (void)state;
    static const int8_t bytes[9] = {0, 0, 0, 0, 0, 0, 0, 0, 127};
    static const int16_t shorts[9] = {0, 0, 0, 0, 0, 0, 0, 0, -32767}, whole[9] = {[8] = 3};
    static const struct {
        int component;
        const char *type;
        const void *array;
        double z;
    } rows[] = {{5120, "VEC3\",\"normalized\":true,\"x\":\"", bytes, 0.5},
                {5122, "VEC3\",\"normalized\":true,\"x\":\"", shorts, -0.5},
                {5122, "VEC3", whole, 1.5}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        gltf_builder *b = calloc(1, sizeof *b);
        cw_mesh mesh;
        cw_error err = {0};
        char rest[600];
        assert_non_null(b);
        const int position = add_floats(b, "VEC3", 3, 3, corners);
        const int target = add_array(b, rows[n].component, rows[n].type, 3, 3, rows[n].array);
        snprintf(
            rest, sizeof rest,
            "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"meshes\":[{\"primitives\":["
            "{\"attributes\":{\"POSITION\":%d},\"targets\":[{\"POSITION\":%d}]}],\"weights\":"
            "[0.5]}],\"nodes\":[{\"mesh\":0,\"translation\":[0,7,0]}]",
            position, target);
        assert_ok(read_built(b, rest, &mesh, NULL, &err), err);
        check_vertex(&mesh, 1, 1, 7, 0);
        check_vertex(&mesh, 2, 0, 8, rows[n].z);
        cw_mesh_free(&mesh);
        free(b);
    }
}

/* Normals are displaced, too, and become unit vectors again. */
static void normals_follow_targets(void **state)
{
    (void)state;
    static const float tilt[9] = {0, 1, 0, 0, 2, 0, 3, 0, -1};
    const double half = sqrt(0.5), fifth = 1 / sqrt(5);
    const double expected[9] = {0, -half, half, 0, -fifth, 2 * fifth, 1, 0, 0};
    gltf_builder *b = calloc(1, sizeof *b);
    cw_mesh mesh;
    cw_error err = {0};
    char rest[600];
    assert_non_null(b);
    const int position = add_floats(b, "VEC3", 3, 3, corners);
    const int normal = add_floats(b, "VEC3", 3, 3, upright);
    const int target = add_floats(b, "VEC3", 3, 3, tilt);
    snprintf(rest, sizeof rest,
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"NORMAL\":%d},"
             "\"targets\":[{\"NORMAL\":%d}]}],\"weights\":[1]}],\"nodes\":[{\"mesh\":0}]",
             position, normal, target);
    assert_ok(read_built(b, rest, &mesh, NULL, &err), err);
    check_vertex(&mesh, 2, 0, 1, 0);
    for (size_t i = 0; i < 9; i++)
        assert_near((double)mesh.normals[i], expected[i], 1e-6);
    cw_mesh_free(&mesh);
    free(b);
}

/* --- skins ------------------------------------------------------------------------------- */

/* A triangle whose corners hang on joints 0, 1, and both. */
typedef struct skinning {
    gltf_builder b;
    int position, joints, weights[3], inverse;
} skinning;

static void begin_skinning(skinning *s)
{
    static const uint8_t joints[12] = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
    static const float floats[12] = {1, 0, 0, 0, 1, 0, 0, 0, 0.25f, 0.75f, 0, 0};
    static const uint8_t bytes[12] = {255, 0, 0, 0, 255, 0, 0, 0, 64, 192, 0, 0};
    static const uint16_t shorts[12] = {65535, 0, 0, 0, 65535, 0, 0, 0, 16384, 49152, 0, 0};
    static const char fractions[] = "VEC4\",\"normalized\":true,\"x\":\"";
    static const float matrices[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                       1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};
    memset(s, 0, sizeof *s);
    s->position = add_floats(&s->b, "VEC3", 3, 3, corners);
    s->joints = add_array(&s->b, 5121, "VEC4", 4, 3, joints);
    s->weights[0] = add_floats(&s->b, "VEC4", 4, 3, floats);
    s->weights[1] = add_array(&s->b, 5121, fractions, 4, 3, bytes);
    s->weights[2] = add_array(&s->b, 5123, fractions, 4, 3, shorts);
    s->inverse = add_floats(&s->b, "MAT4", 16, 2, matrices);
}

static cw_status read_skinned(skinning *s, int weights, const char *inverse, const char *nodes,
                              cw_mesh *mesh, cw_mesh_file *file, cw_error *err)
{
    char rest[1200];
    snprintf(rest, sizeof rest,
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"JOINTS_0\":%d,"
             "\"WEIGHTS_0\":%d}}]}],\"skins\":[{\"joints\":[1,2]%s}],%s",
             s->position, s->joints, weights, inverse, nodes);
    return read_built(&s->b, rest, mesh, file, err);
}

/* Joint 1 is moved by 10 along y, joint 2, its child and bound at x = 1, by 2 more along z. The
 * node of the mesh is anywhere. */
static void joints_place_vertices_and_the_node_does_not(void **state)
{
    (void)state;
    static const char *const nodes[] = {
        "\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[5,5,5],\"scale\":[0,3,3]},"
        "{\"children\":[2],\"translation\":[0,10,0]},{\"translation\":[1,0,2]}]",
        "\"nodes\":[{\"mesh\":0,\"skin\":0},{\"children\":[2,0],\"translation\":[0,10,0]},"
        "{\"translation\":[1,0,2]}],\"scenes\":[{\"nodes\":[1]}]",
        "\"nodes\":[{\"mesh\":0,\"skin\":0,\"scale\":[0,0,0]},{\"children\":[2],\"translation\":"
        "[0,4,0]},{\"translation\":[1,0,2]},{\"translation\":[0,6,0],\"children\":[1]}],"
        "\"scenes\":[{\"nodes\":[0]}]"}; /* the joints are in no scene */
    skinning *s = malloc(sizeof *s);
    char inverse[64];
    assert_non_null(s);
    begin_skinning(s);
    snprintf(inverse, sizeof inverse, ",\"inverseBindMatrices\":%d", s->inverse);
    for (size_t n = 0; n < 9; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        const double share = n / 3 == 1 ? 192 / 256.0 : 0.75;
        assert_ok(read_skinned(s, s->weights[n / 3], inverse, nodes[n % 3], &mesh, &file, &err),
                  err);
        check_vertex(&mesh, 0, 0, 10, 0);
        check_vertex(&mesh, 1, 1, 10, 2);
        check_vertex(&mesh, 2, 0, 11, 2 * share);
        assert_string_equal(file.not_applied, "");
        assert_string_equal(file.fault, "");
        cw_mesh_free(&mesh);
    }
    free(s);
}

/* Without matrices a joint moves its vertices as a parent would; a mirror turns the winding. */
static void skins_without_matrices_and_in_mirrors(void **state)
{
    (void)state;
    static const uint32_t forward[3] = {0, 1, 2}, back[3] = {2, 1, 0};
    static const struct {
        const char *nodes;
        double x;
        const uint32_t *winding;
    } rows[] = {
        {"\"nodes\":[{\"mesh\":0,\"skin\":0},{\"scale\":[2,1,1]},{\"scale\":[2,1,1]}]", 2,
         forward},
        {"\"nodes\":[{\"mesh\":0,\"skin\":0},{\"scale\":[-1,1,1]},{\"scale\":[-1,1,1]}]", -1,
         back},
        {"\"nodes\":[{\"mesh\":0,\"skin\":0,\"scale\":[-1,1,1]},{},{}]", 1, forward}};
    skinning *s = malloc(sizeof *s);
    assert_non_null(s);
    begin_skinning(s);
    for (size_t n = 0; n < 3; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_skinned(s, s->weights[0], "", rows[n].nodes, &mesh, NULL, &err), err);
        check_triangles(&mesh, 1, rows[n].winding);
        check_vertex(&mesh, 1, rows[n].x, 0, 0);
        cw_mesh_free(&mesh);
    }
    free(s);
}

/* Joints that have no size hide a mesh, as a node does. */
static void joints_without_size_hide_a_mesh(void **state)
{
    (void)state;
    skinning *s = malloc(sizeof *s);
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_non_null(s);
    begin_skinning(s);
    assert_ok(read_skinned(s, s->weights[0], "",
                           "\"nodes\":[{\"mesh\":0,\"skin\":0},{\"scale\":[0,0,0],\"children\":"
                           "[2]},{}],\"scenes\":[{\"nodes\":[0,1]}]",
                           &mesh, &file, &err),
              err);
    assert_int_equal(file.hidden, 1);
    assert_int_equal(mesh.triangle_count, 0);
    cw_mesh_free(&mesh);
    free(s);
}

/* Eight influences; weights that do not add up to 1; and none at all, which is joint 0's. */
static void weights_count_relative_to_their_sum(void **state)
{
    (void)state;
    static const uint16_t joints[2][12] = {{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0},
                                           {1, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0}};
    static const float weights[2][12] = {{0.5f, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0},
                                         {0.125f, 0.125f, 0.125f, 0.125f, 3, 0, 0, 0, 0}};
    gltf_builder *b = calloc(1, sizeof *b);
    cw_mesh mesh;
    cw_error err = {0};
    char rest[600];
    assert_non_null(b);
    const int position = add_floats(b, "VEC3", 3, 3, corners);
    int set[4];
    for (size_t n = 0; n < 2; n++) {
        set[2 * n] = add_array(b, 5123, "VEC4", 4, 3, joints[n]);
        set[2 * n + 1] = add_floats(b, "VEC4", 4, 3, weights[n]);
    }
    snprintf(
        rest, sizeof rest,
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"JOINTS_0\":%d,"
        "\"WEIGHTS_0\":%d,\"JOINTS_1\":%d,\"WEIGHTS_1\":%d}}]}],\"skins\":[{\"joints\":[1,2]}],"
        "\"nodes\":[{\"mesh\":0,\"skin\":0},{},{\"translation\":[0,0,8]}]",
        position, set[0], set[1], set[2], set[3]);
    assert_ok(read_built(b, rest, &mesh, NULL, &err), err);
    check_vertex(&mesh, 0, 0, 0, 4);
    check_vertex(&mesh, 1, 1, 0, 6);
    check_vertex(&mesh, 2, 0, 1, 8);
    cw_mesh_free(&mesh);
    free(b);
}

/* --- what is not applied, and what is refused --------------------------------------------- */

#define SKINNED "\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}"

/* Arrays: 0 positions, 1 joints of 8 bits, 2 weights, 3 joints beyond, 4 negative weights, 5 two
 * vectors, 6 a matrix, 7 more vectors than there are, 8 two million vectors of zero. */
static void begin_broken(gltf_builder *b)
{
    static const uint8_t joints[12] = {0}, beyond[12] = {[8] = 2};
    static const float weights[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    static const float negative[12] = {1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0};
    static const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    add_floats(b, "VEC3", 3, 3, corners);
    add_array(b, 5121, "VEC4", 4, 3, joints);
    add_floats(b, "VEC4", 4, 3, weights);
    add_array(b, 5121, "VEC4", 4, 3, beyond);
    add_floats(b, "VEC4", 4, 3, negative);
    add_floats(b, "VEC3", 3, 2, corners);
    add_floats(b, "MAT4", 16, 1, matrix);
    add_accessor(
        b, "{\"bufferView\":0,\"componentType\":5126,\"count\":1000000,\"type\":\"VEC3\"}");
    add_accessor(b, "{\"componentType\":5126,\"count\":1000000,\"type\":\"VEC3\",\"sparse\":{"
                    "\"count\":1,\"indices\":{\"bufferView\":1,\"componentType\":5121},"
                    "\"values\":{\"bufferView\":0}}}");
}

static void what_is_not_applied_is_named(void **state)
{
    (void)state;
    static const struct {
        const char *primitive, *node, *named, *fault;
    } rows[] = {
        {SKINNED,
         ",\"skin\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{"
         "\"TRANSLATION\":5}}}",
         "skins of instanced nodes", ""},
        {"\"attributes\":{\"POSITION\":0},\"targets\":[{\"COLOR_0\":2}]", ",\"weights\":[1]",
         "colours of morph targets", ""},
        {"\"attributes\":{\"POSITION\":0},\"targets\":[{\"COLOR_0\":2}]", ",\"weights\":[0]",
         "", ""},
        {"\"attributes\":{\"POSITION\":0}", ",\"skin\":0", "",
         "nodes[0] has a skin, and meshes[0] no JOINTS_0 and WEIGHTS_0"},
        {"\"attributes\":{\"POSITION\":0},\"targets\":[{}]", ",\"weights\":[0,1]", "",
         "nodes[0] has 2 weights for the 1 morph targets of meshes[0]"},
    };
    gltf_builder *b = calloc(1, sizeof *b);
    assert_non_null(b);
    begin_broken(b);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char rest[800];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        snprintf(
            rest, sizeof rest,
            "\"meshes\":[{\"primitives\":[{%s}]}],\"skins\":[{\"joints\":[1]}],\"nodes\":[{"
            "\"mesh\":0%s},{}]",
            rows[n].primitive, rows[n].node);
        assert_ok(read_built(b, rest, &mesh, &file, &err), err);
        assert_string_equal(file.not_applied, rows[n].named);
        assert_string_equal(file.fault, rows[n].fault);
        cw_mesh_free(&mesh);
    }
    free(b);
}

static void broken_poses_are_refused(void **state)
{
    (void)state;
#define JOINT ",\"skins\":[{\"joints\":[1]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}]"
#define NODE  ",\"nodes\":[{\"mesh\":0}]"
#define PLACED(attributes)                                                                             \
    ",\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{" attributes \
    "}}}}]"
    static const struct {
        const char *primitive, *rest;
        cw_status status;
        const char *words;
    } rows[] = {
        {SKINNED, ",\"skins\":[{\"joints\":[1]}],\"nodes\":[{\"mesh\":0,\"skin\":1},{}]",
         CW_ERR_FORMAT, "nodes[0].skin: 1 is not an index (0 to 0)"},
        {SKINNED, ",\"skins\":[{\"joints\":[2]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}]",
         CW_ERR_FORMAT, "skins[0].joints[0]: 2 is not an index (0 to 1)"},
        {SKINNED, ",\"skins\":[{}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}]", CW_ERR_FORMAT,
         "skins[0]: there is no 'joints'"},
        {"\"attributes\":{\"POSITION\":0,\"JOINTS_0\":3,\"WEIGHTS_0\":2}", JOINT, CW_ERR_FORMAT,
         "vertex 2 names joint 2; the skin has 1"},
        {"\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":4}", JOINT, CW_ERR_FORMAT,
         "a weight of vertex 1 is -1; it must be 0 or more"},
        {"\"attributes\":{\"POSITION\":0,\"JOINTS_0\":2,\"WEIGHTS_0\":2}", JOINT, CW_ERR_FORMAT,
         "JOINTS_0 (accessor 2) is not VEC4 of 8 or 16 bits, unsigned"},
        {"\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":1}", JOINT, CW_ERR_FORMAT,
         "WEIGHTS_0 (accessor 1) is not VEC4 of floats"},
        {"\"attributes\":{\"POSITION\":0,\"JOINTS_0\":5,\"WEIGHTS_0\":2}", JOINT, CW_ERR_FORMAT,
         "JOINTS_0 (accessor 5) has elements of 3 numbers"},
        {SKINNED,
         ",\"skins\":[{\"joints\":[1,1],\"inverseBindMatrices\":6}],\"nodes\":[{\"mesh\":0,\"skin\":"
         "0},{}]",
         CW_ERR_FORMAT, "accessors[6] has 1 matrices; there are 2 joints"},
        {SKINNED,
         ",\"skins\":[{\"joints\":[1],\"inverseBindMatrices\":0}],\"nodes\":[{\"mesh\":0,\"skin\":"
         "0},{}]",
         CW_ERR_FORMAT, "accessors[0] is not MAT4 of floats"},
        {SKINNED,
         ",\"scenes\":[{\"nodes\":[0]}],\"skins\":[{\"joints\":[1]}],\"nodes\":[{\"mesh\":0,\"skin\":"
         "0},{\"children\":[2]},{\"children\":[1]}]",
         CW_ERR_FORMAT, "node 1, a joint, is nested deeper than 1024, or holds itself"},
        {"\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":5}]",
         ",\"nodes\":[{\"mesh\":0,\"weights\":[1]}]", CW_ERR_FORMAT,
         "a target's POSITION (accessor 5) has 2 elements; POSITION has 3"},
        {"\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":99}]", NODE, CW_ERR_FORMAT,
         "meshes[0].primitives[0].targets[0].POSITION: 99 is not an index"},
        {"\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":1}]",
         ",\"nodes\":[{\"mesh\":0,\"weights\":[1]}]", CW_ERR_FORMAT,
         "has elements of 4 numbers"},
        {"\"attributes\":{\"POSITION\":0}", ",\"nodes\":[{\"mesh\":0,\"weights\":[\"1\"]}]",
         CW_ERR_FORMAT, "nodes[0].weights[0]"},
        {"\"attributes\":{\"POSITION\":0}", PLACED("\"TRANSLATION\":0,\"SCALE\":5"),
         CW_ERR_FORMAT, "SCALE of instances (accessor 5) has 2 elements; the other has 3"},
        {"\"attributes\":{\"POSITION\":0}", PLACED("\"TRANSLATION\":2"), CW_ERR_FORMAT,
         "TRANSLATION of instances (accessor 2) is not VEC3 of floats"},
        {"\"attributes\":{\"POSITION\":0}", PLACED("\"ROTATION\":1"), CW_ERR_FORMAT,
         "ROTATION of instances (accessor 1) is not VEC4 of floats, or of 8 or 16 bits"},
        {"\"attributes\":{\"POSITION\":0}", PLACED("\"TRANSLATION\":7"), CW_ERR_FORMAT,
         "accessors[7] (TRANSLATION): 1000000 elements do not fit"},
        {"\"attributes\":{\"POSITION\":8}", PLACED("\"TRANSLATION\":8"), CW_ERR_LIMIT,
         "draws its triangles so often that they are more than"},
        {"\"attributes\":{\"POSITION\":0}",
         ",\"nodes\":[{\"mesh\":0,\"extensions\":{\"KHR_node_visibility\":{\"visible\":0}}}]",
         CW_ERR_FORMAT, "KHR_node_visibility.visible: 0 is not true or false"},
    };
    gltf_builder *b = calloc(1, sizeof *b);
    assert_non_null(b);
    begin_broken(b);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char rest[1000];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(rest, sizeof rest, "\"meshes\":[{\"primitives\":[{%s}]}]%s", rows[n].primitive,
                 rows[n].rest);
        assert_fails(read_built(b, rest, &mesh, NULL, &err), rows[n].status, rows[n].words,
                     err);
    }
    free(b);
}

/* A few bytes that displace a million vertices by hundreds of targets are refused before that. */
static void too_many_targets_are_refused(void **state)
{
    (void)state;
    static char rest[1 << 15];
    gltf_builder *b = calloc(1, sizeof *b);
    cw_mesh mesh;
    cw_error err = {0};
    assert_non_null(b);
    begin_broken(b);
    strcpy(rest,
           "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":8},\"targets\":[{}");
    for (int n = 0; n < 600; n++)
        strcat(rest, ",{\"POSITION\":8}");
    strcat(rest, "]}],\"weights\":[1");
    for (int n = 0; n < 600; n++)
        strcat(rest, ",1");
    strcat(rest, "]}],\"nodes\":[{\"mesh\":0}]");
    assert_fails(read_built(b, rest, &mesh, NULL, &err), CW_ERR_LIMIT,
                 "morph targets displace vertices so often that they are more than", err);
    free(b);
}

/* Whatever allocation fails, it is an error and nothing is left behind. */
static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    skinning *s = malloc(sizeof *s);
    char rest[1200];
    assert_non_null(s);
    begin_skinning(s);
    snprintf(
        rest, sizeof rest,
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"JOINTS_0\":%d,"
        "\"WEIGHTS_0\":%d},\"targets\":[{\"POSITION\":%d}]}],\"weights\":[1]}],\"skins\":[{"
        "\"joints\":[1,2],\"inverseBindMatrices\":%d}],\"nodes\":[{\"mesh\":0,\"skin\":0},{},{},{"
        "\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":"
        "%d}}}}]",
        s->position, s->joints, s->weights[0], s->position, s->inverse, s->position);
    write_built(&s->b, rest);
    check_starved_mesh_reads("a.gltf");
    free(s);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(weights_displace_vertices),
        TEST(displacements_are_quantized_too),
        TEST(normals_follow_targets),
        TEST(joints_place_vertices_and_the_node_does_not),
        TEST(skins_without_matrices_and_in_mirrors),
        TEST(joints_without_size_hide_a_mesh),
        TEST(weights_count_relative_to_their_sum),
        TEST(what_is_not_applied_is_named),
        TEST(broken_poses_are_refused),
        TEST(too_many_targets_are_refused),
        TEST(memory_may_run_out_anywhere),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
