/* glTF read: files that mean harm. */
#include "support/files/gltf_cases.h"

static void broken_primitives_are_told_apart(void **state)
{
    (void)state;
    static const struct {
        const char *primitive, *words;
        cw_status status;
    } rows[] = {
        {"{\"attributes\":{\"POSITION\":0},\"indices\":7}", "names vertex 3 of 3",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":0},\"indices\":2}", "has 4 corners", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":0},\"indices\":0}",
         "primitives[0].indices: accessors[0] is not SCALAR", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":0},\"indices\":99}",
         "meshes[0].primitives[0].indices: 99 is not an index (0 to 20)", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":5}}", "of vertex 1 is nan", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":1}}", "attributes.POSITION: accessors[1] is not VEC3",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":8}}", "with KHR_mesh_quantization required",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":0,\"NORMAL\":8}}", "NORMAL: accessors[8] is not VEC3",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":10}}", "accessors[10] is not VEC3", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":11}}",
         "do not fit into bufferViews[0], which has 36 bytes", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":12}}", "names bufferView -1", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":13}}",
         "do not fit into bufferViews[0], which has 36 bytes", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":14}}",
         "do not fit into bufferViews[0], which has 36 bytes", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":17}}", "index 2 is 3; from 2 to 2 was expected",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":18}}", "index 1 is 0; from 3 to 2 was expected",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":19}}",
         "accessors[19].sparse.count: 4 is more than the 3 elements", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":20}}", "but a file holds only 1 of them", CW_ERR_LIMIT},
        {"{\"attributes\":{\"POSITION\":21}}", "POSITION: 21 is not an index (0 to 20)",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":-3}}", "POSITION: -3 is not an index", CW_ERR_FORMAT},
        {"{\"attributes\":{\"NORMAL\":6}}",
         "meshes[0].primitives[0].attributes: there is no POSITION", CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":4,\"NORMAL\":6}}", "has 3 elements; POSITION has 4",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1}}", "accessors[1] is not VEC3 or VEC4",
         CW_ERR_FORMAT},
        {"{\"attributes\":{\"POSITION\":0},\"mode\":7}",
         "mode: 7 is not a whole number (0 to 6)", CW_ERR_FORMAT},
        {"{}", "meshes[0].primitives[0]: there is no 'attributes'", CW_ERR_FORMAT},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_fails(read_primitive(rows[i].primitive, &mesh, NULL, &err), rows[i].status,
                     rows[i].words, err);
        assert_null(mesh.positions);
    }
}

static void broken_scenes_are_told_apart(void **state)
{
    (void)state;
    static const struct {
        const char *nodes, *words;
        cw_status status;
    } rows[] = {
        {"\"nodes\":[{\"mesh\":0,\"children\":[1]},{\"children\":[0]}],"
         "\"scenes\":[{\"nodes\":[0]}]",
         "node 0 is reached in two ways", CW_ERR_FORMAT},
        {"\"nodes\":[{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]",
         "node 0 is reached in two ways", CW_ERR_FORMAT},
        {"\"nodes\":[{\"children\":[1,1]},{\"mesh\":0}]", "node 1 is reached in two ways",
         CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0,0,0,0]}]",
         "node 0 is reached in two ways", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[1]}]",
         "scenes[0].nodes[0]: 1 is not an index (0 to 0)", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[-1]}]",
         "scenes[0].nodes[0]: -1 is not an index", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":4}]", "nodes[0].mesh: 4 is not an index (0 to 1)",
         CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0}],\"scene\":3,\"scenes\":[{\"nodes\":[0]}]",
         "scene: 3 is not an index (0 to 0)", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0,\"translation\":[1,2]}]",
         "nodes[0].translation: 2 numbers; 3 were expected", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,null,0,0,1,0,0,0,0,1,0,0,0,0,1]}]",
         "nodes[0].matrix[2]: null is not a number", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0,\"scale\":[1,1e400,1]}]",
         "nodes[0].scale[1]: 1e400 is not a finite number", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,2]}]",
         "nodes[0].rotation[3]: 2 is not a number from -1 to 1", CW_ERR_FORMAT},
        {"\"nodes\":[{\"m\\u0065sh\":0}]", "nodes[0].mesh: the name is written with an escape",
         CW_ERR_FORMAT},
        {"\"nodes\":{\"mesh\":0}", "nodes: an object is not a list", CW_ERR_FORMAT},
        {"\"nodes\":[[]]", "nodes[0]: a list is not an object", CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":\"a rather long name, with \xff in it, that is cut short\"}]",
         "nodes[0].mesh: \"a rather long name, with ? in it, that is ... is not",
         CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,0]}]", "matrix is not finite",
         CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0,\"translation\":[1e308,0,0]}]", "matrix is not finite",
         CW_ERR_FORMAT},
        {"\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}]",
         "is not affine", CW_ERR_FORMAT},
        {"\"extensionsRequired\":[\"KHR_mesh_quantization\",\"EXT_some_compression\"]",
         "requires the extension 'EXT_some_compression'", CW_ERR_UNSUPPORTED},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_fails(read_nodes(rows[i].nodes, &mesh, NULL, &err), rows[i].status,
                     rows[i].words, err);
        assert_null(mesh.positions);
    }
}

/* Elements that sparse ones replace, or zeros; indices are replaced, too. */
static void sparse_elements_take_the_place_of_others(void **state)
{
    (void)state;
    static const uint32_t triangle[3] = {0, 1, 2};
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_primitive("{\"attributes\":{\"POSITION\":9}}", &mesh, NULL, &err), err);
    check_point(&mesh, 0, 0, 0, 0);
    check_point(&mesh, 1, 0, -1000, 0);
    check_point(&mesh, 2, 0, 0, 1000);
    cw_mesh_free(&mesh);
    assert_ok(
        read_primitive("{\"attributes\":{\"POSITION\":15},\"indices\":16}", &mesh, NULL, &err),
        err);
    check_triangles(&mesh, 1, triangle);
    check_point(&mesh, 0, 0, 0, 0);
    check_point(&mesh, 1, 1000, 0, 0);
    check_point(&mesh, 2, 0, 0, 1000);
    cw_mesh_free(&mesh);
}

static void views_stay_in_their_buffer(void **state)
{
    (void)state;
    static const char form[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%s}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,%s}],\"accessors\":[{"
        "\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"nodes\":[{\"mesh\":0}]}";
    static const struct {
        const char *bytes, *view, *words; /* NULL: it is read */
    } rows[] = {
        {"208", "\"byteLength\":208", NULL},
        {"207", "\"byteLength\":207", NULL},
        {"209", "\"byteLength\":9",
         "buffers[0].byteLength: 209 bytes are more than the 208 there are"},
        {"208", "\"byteLength\":209",
         "bufferViews[1]: 209 bytes from byte 0 on are more than the 208 of buffers[0]"},
        {"208", "\"byteOffset\":18446744073709551615,\"byteLength\":1",
         "bufferViews[1]: 1 bytes"},
        {"208", "\"byteOffset\":18446744073709551616,\"byteLength\":1",
         "bufferViews[1].byteOffset: 18446744073709551616 is not a whole number (0 or more)"},
        {"208", "\"byteLength\":0", "bufferViews[1].byteLength: 0 is not a whole number (1 or"},
        {"208", "\"byteOffset\":4", "bufferViews[1]: there is no 'byteLength'"},
        {"208", "\"byteLength\":8,\"byteStride\":6",
         "bufferViews[1].byteStride: 6 is not a multiple of 4 (4 to 252)"},
        {"208",
         "\"byteLength\":8,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,"
         "\"byteOffset\":4294967332,\"byteLength\":8,\"byteStride\":4,\"count\":1,"
         "\"mode\":\"INDICES\"}}",
         "bufferViews[1].extensions.EXT_meshopt_compression.byteOffset: 4294967332 is not"},
        {"208",
         "\"byteLength\":8,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,"
         "\"byteOffset\":201,\"byteLength\":8,\"byteStride\":4,\"count\":1,"
         "\"mode\":\"INDICES\"}}",
         "bufferViews[1].extensions.EXT_meshopt_compression: 8 bytes from byte 201 on"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char json[2048];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(json, sizeof json, form, rows[i].bytes, rows[i].view);
        const cw_status st = read_glb(json, &mesh, NULL, &err);
        if (rows[i].words)
            assert_fails(st, CW_ERR_FORMAT, rows[i].words, err);
        else
            assert_ok(st, err);
        cw_mesh_free(&mesh);
    }
}

/* --- every member, wrong ----------------------------------------------------------------- */

/* Behind a JSON value that is valid. */
static const char *value_end(const char *at)
{
    size_t depth = 0;
    do {
        if (*at == '"') {
            for (at++; *at != '"'; at++)
                at += *at == '\\';
            at++;
        } else if (strchr("{[}]", *at)) {
            depth += *at == '{' || *at == '[';
            depth -= *at == '}' || *at == ']';
            at++;
        } else {
            at += strcspn(at, depth ? "\"{}[]" : ",{}[] \n");
        }
    } while (depth);
    return at;
}

/* Whether a value begins here: at a number, a word or a bracket behind one of [ : , but not at
 * a key. */
static bool value_begins(const char *json, const char *at)
{
    const char *before = at - 1;
    if (at == json || strchr(",:]} \n", *at))
        return false;
    while (before > json && strchr(" \n", *before))
        before--;
    if (!strchr("[:,", *before))
        return false;
    if (*at != '"')
        return true;
    const char *end = value_end(at);
    return end[strspn(end, " \n")] != ':';
}

static bool same_array(const void *a, const void *b, size_t size)
{
    return (!a && !b) || (a && b && memcmp(a, b, size) == 0);
}

static bool same_surface(const cw_mesh *a, const cw_mesh *b)
{
    const size_t n = a->vertex_count;
    return n == b->vertex_count && a->triangle_count == b->triangle_count &&
           same_array(a->positions, b->positions, 3 * n * sizeof(float)) &&
           same_array(a->normals, b->normals, 3 * n * sizeof(float)) &&
           same_array(a->colors, b->colors, 4 * n) &&
           memcmp(a->origin, b->origin, sizeof a->origin) == 0 &&
           same_array(a->triangles, b->triangles, 3 * a->triangle_count * sizeof(uint32_t));
}

/* An element of a transform may be any number. */
static bool is_free_number(const char *json, const char *at, const char *instead)
{
    static const char *const keys[] = {"\"matrix\":[", "\"translation\":[", "\"scale\":["};
    while (at > json && *at != '[' && *at != '{')
        at--;
    if (*at != '[' || !strchr("-0123456789", *instead))
        return false;
    for (size_t i = 0; i < 3; i++)
        if ((size_t)(at + 1 - json) > strlen(keys[i]) &&
            memcmp(at + 1 - strlen(keys[i]), keys[i], strlen(keys[i])) == 0)
            return true;
    return false;
}

/* Each value of a file in turn becomes something else: that is refused, or changes nothing. */
static void check_mutants(const char *json)
{
    static const char *const others[] = {"null", "true", "\"3\"",       "\"\"",   "{}",
                                         "-5",   "2.5",  "99999999999", "[null]", "1e3"};
    const cw_mesh_read_desc here = {.no_sandbox = true};
    const size_t length = strlen(json);
    char *mutant = malloc(length + 64);
    cw_mesh mesh, other;
    cw_error err = {0};
    size_t tried = 0;
    assert_non_null(mutant);
    assert_ok(read_text("a.gltf", json, &mesh, NULL, &err), err);
    for (const char *at = json; *at; at++) {
        if (!value_begins(json, at))
            continue;
        for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
            const char *end = value_end(at);
            const bool object = *others[i] == '{' && (*at == '{' || *at == '[');
            if (object || is_free_number(json, at, others[i]))
                continue;
            snprintf(mutant, length + 64, "%.*s%s%s", (int)(at - json), json, others[i], end);
            test_file_write(test_path("b.gltf"), mutant, strlen(mutant));
            const cw_status st = cw_mesh_read(test_path("b.gltf"), &here, &other, NULL, &err);
            tried++;
            if (st == CW_OK && !same_surface(&mesh, &other))
                fail_msg("%s in place of %.40s makes another surface, at byte %zu", others[i],
                         at, (size_t)(at - json));
            if (st != CW_OK && st != CW_ERR_FORMAT && st != CW_ERR_LIMIT && st != CW_ERR_IO &&
                st != CW_ERR_UNSUPPORTED)
                fail_msg("%s in place of %.40s: status %d, %s", others[i], at, (int)st,
                         err.message);
            cw_mesh_free(&other);
        }
        if (*at == '"')
            at = value_end(at) - 1;
    }
    assert_true(tried > 500);
    cw_mesh_free(&mesh);
    free(mutant);
}

/* One with every kind of member, by hand. */
static void no_wrong_member_of_a_scene_is_taken_for_none(void **state)
{
    (void)state;
    check_mutants(
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"hands\"},\"scene\":0,\"scenes\":[{"
        "\"name\":\"s\",\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0,\"children\":[2],\"scale\":["
        "1,2,3]},{\"mesh\":1,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,4,5,6,1]},{\"mesh\":0,"
        "\"rotation\":[0,1,0,0],\"translation\":[7,8,9]}],\"meshes\":[{\"primitives\":[{"
        "\"attributes\":{\"POSITION\":0},\"indices\":1}]},{\"primitives\":[{\"attributes\":{"
        "\"POSITION\":2},\"mode\":5}]}],\"accessors\":[{\"bufferView\":0,\"byteOffset\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,"
        "\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"},{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"normalized\":false,"
        "\"max\":[1,1,0],\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"byteOffset\":"
        "1,"
        "\"componentType\":5121},\"values\":{\"bufferView\":0,\"byteOffset\":24}}}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36,\"byteStride\":12,\"target\":34962},{"
        "\"buffer\":0,\"byteOffset\":36,\"byteLength\":3}],\"buffers\":[{\"byteLength\":39,"
        "\"uri\":\"data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC\"}]}");
}

/* And those that we write, in each compression that there is. */
static void no_wrong_member_of_what_we_write_is_taken_for_none(void **state)
{
    (void)state;
    static const cw_compression kinds[] = {CW_COMPRESS_NONE, CW_COMPRESS_QUANTIZE,
                                           CW_COMPRESS_MESHOPT, CW_COMPRESS_DRACO};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const cw_write_desc desc = {.compression = kinds[i]};
        cw_mesh mesh;
        cw_error err = {0};
        test_make_cube(&mesh);
        const cw_status st = cw_mesh_write(test_path("a.gltf"), &mesh, &desc, &err);
        cw_mesh_free(&mesh);
        if (st == CW_ERR_UNSUPPORTED)
            continue;
        assert_ok(st, err);
        size_t size;
        char *json = test_file_read(test_path("a.gltf"), &size);
        check_mutants(json);
        free(json);
    }
}

static void broken_files_are_told_apart(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"{", "not valid"},
        {"{    }", "the JSON: there is no 'asset'"},
        {"{\"asset\":{}}", "asset: there is no 'version'"},
        {"{\"asset\":{\"version\":2.0}}", "asset.version: 2.0 is not a string"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}}}", "its JSON is broken at byte 38"},
        {"{\"asset\":{\"version\":\"1.0\"}}", "'asset.version' is '1.0'"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[3]}", "nodes[0]: 3 is not an object"},
        {"{\"asset\":{\"version\":\"2.0\"},\"a\":"
         "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["
         "]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]}",
         "deeper than 64"},
    };
    cw_mesh mesh;
    cw_error err = {0};
    check_refused("a.gltf", rows, sizeof rows / sizeof *rows);
    assert_fails(read_text("a.glb", "glTF\1\0\0\0", &mesh, NULL, &err), CW_ERR_FORMAT,
                 "does not begin with 'glTF'", err);
    assert_fails(read_bytes("a.glb", "glTF\1\0\0\0\24\0\0\0", 12, &mesh, NULL, &err),
                 CW_ERR_FORMAT, "of version 1", err);
    assert_fails(read_bytes("a.glb", "glTF\2\0\0\0\377\0\0\0", 12, &mesh, NULL, &err),
                 CW_ERR_FORMAT, "the header says 255 bytes; the file has 12", err);
    assert_fails(
        read_bytes("a.glb", "glTF\2\0\0\0\24\0\0\0\1\0\0\0JSON", 20, &mesh, NULL, &err),
        CW_ERR_FORMAT, "the chunk at byte 12", err);
}

/* A GLB cut short anywhere is refused. */
static void no_beginning_of_a_file_is_a_file(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    size_t size;
    test_make_tetrahedron(&mesh);
    assert_ok(cw_mesh_write(test_path("a.glb"), &mesh, NULL, &err), err);
    cw_mesh_free(&mesh);
    char *bytes = test_file_read(test_path("a.glb"), &size);
    for (size_t n = 4; n < size; n++)
        if (read_bytes("cut.glb", bytes, n, &mesh, NULL, &err) == CW_OK)
            fail_msg("%zu of %zu bytes were read", n, size);
    free(bytes);
}

/* A node drawn `nodes` times, of 2^15 triangles; read with limits. */
static cw_status read_repeated(int nodes, const cw_mesh_read_desc *desc, cw_error *err)
{
    enum { TRIANGLES = 1 << 15 };
    const size_t room = 500 + 16 * (size_t)nodes;
    char *json = malloc(room);
    unsigned char *data = calloc(36 + 3 * TRIANGLES, 1);
    cw_mesh mesh;
    assert_true(json && data);
    size_t used = (size_t)snprintf(
        json, room,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"a.bin\","
        "\"byteLength\":%d}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%d}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":"
        "5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":36,"
        "\"componentType\":5121,\"count\":%d,\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":"
        "[" BY_BYTES "]}],\"nodes\":[{\"mesh\":0}",
        36 + 3 * TRIANGLES, 36 + 3 * TRIANGLES, 3 * TRIANGLES);
    for (int i = 1; i < nodes; i++)
        used += (size_t)snprintf(json + used, room - used, ",{\"mesh\":0}");
    snprintf(json + used, room - used, "]}");
    test_file_write(test_path("a.bin"), data, 36 + 3 * TRIANGLES);
    test_file_write(test_path("a.gltf"), json, strlen(json));
    const cw_status st = cw_mesh_read(test_path("a.gltf"), desc, &mesh, NULL, err);
    cw_mesh_free(&mesh);
    free(json);
    free(data);
    return st;
}

/* 600 nodes with the same 2^15 triangles: 110 KB that would be a quarter of a gigabyte. */
static void a_scene_cannot_multiply_itself_without_end(void **state)
{
    (void)state;
    const cw_mesh_read_desc plain = {0}, small = {.max_bytes = 100 << 20},
                            few = {.max_triangles = 1 << 20},
                            many = {.max_triangles = 1 << 22, .max_bytes = 64 << 20};
    cw_error err = {0};
    assert_fails(read_repeated(600, &plain, &err), CW_ERR_LIMIT, "draws its triangles so often",
                 err);
    assert_fails(read_repeated(400, &small, &err), CW_ERR_LIMIT, "100 MiB allowed", err);
    assert_fails(read_repeated(100, &few, &err), CW_ERR_LIMIT, "more than 1048576 triangles",
                 err);

    assert_ok(read_repeated(100, &many, &err), err);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

/* --- what comes out of the process that parses ------------------------------------------- */

enum { TAPE = 4096 };

/* Whatever is wrong in the bytes, nothing outside of them is read, and no scene is made. */
static void a_scene_crosses_between_processes(void **state)
{
    (void)state;
    static const char *const uris[] = {"data.bin", NULL};
    cwi_gltf_buffer buffers[2] = {{(char *)(uintptr_t)uris[0], 7}, {NULL, 0}};
    cwi_gltf_accessor accessors[1] = {{.numbers = 3, .count = 9}};
    cwi_gltf_primitive primitives[2] = {{.mode = 4}, {.mode = 5}};
    cwi_gltf_mesh meshes[1] = {{.first = 0, .end = 2}};
    cwi_gltf_node nodes[2] = {{.first = 0, .end = 1}, {.first = 1, .end = 1}};
    int children[1] = {1}, roots[1] = {0};
    const cwi_gltf_scene scene = {.buffers = buffers,
                                  .accessors = accessors,
                                  .primitives = primitives,
                                  .meshes = meshes,
                                  .nodes = nodes,
                                  .children = children,
                                  .roots = roots,
                                  .buffer_count = 2,
                                  .accessor_count = 1,
                                  .primitive_count = 2,
                                  .mesh_count = 1,
                                  .node_count = 2,
                                  .child_count = 1,
                                  .root_count = 1};
    char *bytes = calloc(1, TAPE);
    cw_error err = {0};
    cwi_gltf_scene back = {0};
    size_t room = 0;
    while (!cwi_gltf_put_scene(&scene, bytes, room)) /* the least there must be */
        assert_true(++room < TAPE);
    assert_ok(cwi_gltf_take_scene(bytes, room, &back, &err), err);
    assert_string_equal(back.buffers[0].uri, "data.bin");
    assert_null(back.buffers[1].uri);
    assert_true(back.accessors[0].count == 9 && back.primitives[1].mode == 5);
    assert_true(back.node_count == 2 && back.nodes[0].end == 1 && back.children[0] == 1);
    cwi_gltf_scene_free(&back);

    for (size_t cut = 0; cut < room; cut++) {
        char *piece = malloc(cut + 1); /* its own size, for sanitizers */
        memcpy(piece, bytes, cut);
        assert_fails(cwi_gltf_take_scene(piece, cut, &back, &err), CW_ERR_BACKEND,
                     "is not valid", err);
        cwi_gltf_scene_free(&back);
        free(piece);
    }
    for (size_t i = 0; i < room; i++) /* any byte turned round: a scene or an error */
        for (int bit = 0; bit < 8; bit++) {
            bytes[i] = (char)(bytes[i] ^ 1 << bit);
            if (cwi_gltf_take_scene(bytes, room, &back, &err) == CW_OK)
                for (size_t n = 0; n < back.node_count; n++)
                    assert_true(back.nodes[n].first <= back.nodes[n].end &&
                                back.nodes[n].end <= back.child_count);
            cwi_gltf_scene_free(&back);
            bytes[i] = (char)(bytes[i] ^ 1 << bit);
        }
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(broken_primitives_are_told_apart),
        TEST(broken_scenes_are_told_apart),
        TEST(sparse_elements_take_the_place_of_others),
        TEST(views_stay_in_their_buffer),
        TEST(no_wrong_member_of_a_scene_is_taken_for_none),
        TEST(no_wrong_member_of_what_we_write_is_taken_for_none),
        TEST(broken_files_are_told_apart),
        TEST(no_beginning_of_a_file_is_a_file),
        TEST(a_scene_crosses_between_processes),
        TEST(a_scene_cannot_multiply_itself_without_end),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
