/* 3MF read: packages of other programs, and those that lie. */
#include "support/files/zip.h"
#include "support/meshes.h"

#include <math.h>

#define RELS                                                                                   \
    "<?xml version='1.0'?><Relationships xmlns='http://schemas.openxmlformats.org/package/"    \
    "2006/relationships'><Relationship Id='r0' Type='http://schemas.microsoft.com/"            \
    "3dmanufacturing/2013/01/3dmodel' Target='/3D/3dmodel.model'/></Relationships>"
#define MODEL                                                                                  \
    "<?xml version='1.0'?><model unit='millimeter' xmlns='http://schemas.microsoft.com/"       \
    "3dmanufacturing/core/2015/02'"

/* A tetrahedron with an id and more attributes, and a triangle. */
#define FOUR(id)                                                                               \
    "<object id='" id "'><mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' "      \
    "z='0'/><vertex x='0' y='1' z='0'/><vertex x='0' y='0' z='1'/></vertices><triangles>"      \
    "<triangle v1='0' v2='2' v3='1'/><triangle v1='0' v2='1' v3='3'/>"                         \
    "<triangle v1='0' v2='3' v3='2'/><triangle v1='1' v2='2' v3='3'/></triangles></mesh>"      \
    "</object>"
#define BUILD(items) "</resources><build>" items "</build></model>"

static zip archive;

static cw_status read_package(const zip_entry *entries, size_t count,
                              const cw_mesh_read_desc *desc, cw_mesh *mesh, cw_mesh_file *file,
                              cw_error *err)
{
    zip_make(&archive, entries, count);
    test_file_write(test_path("a.3mf"), archive.bytes, archive.size);
    return cw_mesh_read(test_path("a.3mf"), desc, mesh, file, err);
}

static cw_status read_model(const char *text, cw_mesh *mesh, cw_mesh_file *file, cw_error *err)
{
    const zip_entry entries[] = {{"_rels/.rels", RELS, false},
                                 {"3D/3dmodel.model", text, true}};
    return read_package(entries, 2, NULL, mesh, file, err);
}

static void check_refused_models(const refused *rows, size_t count, cw_status status)
{
    for (size_t i = 0; i < count; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        const cw_status st = read_model(rows[i].text, &mesh, NULL, &err);
        if (st != status || !strstr(err.message, rows[i].words))
            fail_msg("row %zu gives status %d: %s; not: %s", i, (int)st, err.message,
                     rows[i].words);
        assert_null(mesh.positions);
    }
}

/* --- what a model may say ---------------------------------------------------------------- */

static void a_plain_model_is_read(void **state)
{
    (void)state;
    static const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_model(MODEL "><resources>" FOUR("1") BUILD("<item objectid='1'/>"), &mesh,
                         &file, &err),
              err);
    assert_string_equal(file.format, "3mf");
    assert_int_equal(file.known, CW_KNOWN_UNIT);
    check_positions(&mesh, 4, points);
    check_triangles(&mesh, 4, triangles);
    assert_null(mesh.colors);
    cw_mesh_free(&mesh);
}

/* Modifiers of slicers: ranges of triangles, or objects that others are made of. */
static void modifiers_of_slicers_are_left_out(void **state)
{
    (void)state;
    static const char model[] = MODEL "><resources>" FOUR("1") FOUR(
        "2") "<object id='3'><components><component objectid='1'/>"
             "<component objectid='2' transform='1 0 0 0 1 0 0 0 1 9 9 9'/></components></object>" BUILD(
                 "<item objectid='3'/>");
    static const struct {
        const char *name, *text;
        size_t left, left_out;
    } cases[] = {
        {"Metadata/Slic3r_PE_model.config",
         "<config><object id='2'><volume firstid='0' lastid='3'><metadata type='volume' "
         "key='volume_type' value='ParameterModifier'/></volume></object></config>",
         4, 4},
        {"Metadata/Slic3r_PE_model.config",
         "<config><object id='2'><volume firstid='0' lastid='1'><metadata key='volume_type' "
         "value='ModelPart'/></volume><volume firstid='2' lastid='3'><metadata key='volume_type' "
         "value='SupportBlocker'/></volume></object><object id='1'><volume firstid='0' lastid='0'>"
         "<metadata key='modifier' value='1'/></volume></object></config>",
         5, 3},
        {"Metadata/model_settings.config",
         "<config><object id='3'><part id='1' subtype='normal_part'/><part id='2' "
         "subtype='negative_part'/></object></config>",
         4, 4},
        {"Metadata/model_settings.config", "<config/>", 8, 0},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const zip_entry entries[] = {{"_rels/.rels", RELS, false},
                                     {"3D/3dmodel.model", model, true},
                                     {cases[n].name, cases[n].text, true}};
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        double low[3], high[3];
        assert_ok(read_package(entries, 3, NULL, &mesh, &file, &err), err);
        assert_int_equal(mesh.triangle_count, cases[n].left);
        assert_int_equal(file.modifier_triangles, cases[n].left_out);
        assert_true(cw_mesh_bounds(&mesh, low, high));
        assert_true(cases[n].left > 4 || high[0] == 1); /* their points are left out, too */
        cw_mesh_free(&mesh);
    }
    const zip_entry broken[] = {
        {"_rels/.rels", RELS, false},
        {"3D/3dmodel.model", model, true},
        {"Metadata/Slic3r_PE_model.config", "<config><object id='x'/></config>", true}};
    cw_mesh mesh;
    cw_error err = {0};
    assert_fails(read_package(broken, 3, NULL, &mesh, NULL, &err), CW_ERR_FORMAT, "'id' is 'x'",
                 err);
}

static void units_become_millimetres(void **state)
{
    (void)state;
    static const struct {
        const char *unit;
        float mm;
    } rows[] = {{"unit='micron'", 1e-3f}, {"unit='millimeter'", 1},  {"", 1},
                {"unit='meter'", 1000},   {"unit='centimeter'", 10}, {"unit='inch'", 25.4f},
                {"unit='foot'", 304.8f}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[2000];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(text, sizeof text, "<model %s><resources>" FOUR("1") "%s", rows[i].unit,
                 BUILD("<item objectid='1'/>"));
        assert_ok(read_model(text, &mesh, NULL, &err), err);
        assert_true(mesh.positions[3] == rows[i].mm);
        cw_mesh_free(&mesh);
    }
}

/* Rows are points: a quarter turn about z and a move, then the item's doubling; and
 * a mirror. */
static void components_are_placed_one_in_another(void **state)
{
    (void)state;
    static const char text[] = MODEL "><resources>" FOUR(
        "1") "<object id='2' name='pair'><components><component objectid='1'/>"
             "<component objectid='1' transform='0 1 0 -1 0 0 0 0 1 10 20 "
             "30'/></components></object>"
             "<object id='3'><components><component objectid='2'/></components></object>" BUILD(
                 "<item objectid='3' transform='2 0 0 0 2 0 0 0 2 0 0 100'/>"
                 "<item objectid='1' transform='-1 0 0 0 1 0 0 0 1 0 0 0'/>");
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    cw_quality q;
    double low[3], high[3];
    assert_ok(read_model(text, &mesh, &file, &err), err);
    assert_int_equal(file.parts, 2);
    assert_int_equal(mesh.vertex_count, 12);
    assert_true(mesh.positions[3 * 5] == 20 && mesh.positions[3 * 5 + 1] == 42 &&
                mesh.positions[3 * 5 + 2] == 160);
    assert_true(mesh.positions[3 * 9] == -1);
    cw_mesh_bounds(&mesh, low, high);
    assert_true(low[0] == -1 && high[2] == 162);
    assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
    assert_near(q.volume_mm3, 2 * 8 / 6.0 + 1 / 6.0, 1e-6); /* the mirror is not inside out */
    cw_mesh_free(&mesh);
}

/* A move that all share is the mesh's origin: the places keep their bits. */
static void a_common_move_is_the_origin(void **state)
{
    (void)state;
    static const char text[] = MODEL "><resources>" FOUR("1") FOUR("2")
        BUILD("<item objectid='1' transform='1 0 0 0 1 0 0 0 1 1000003.2 -5 0'/>"
              "<item objectid='2' transform='1 0 0 0 1 0 0 0 1 1000003.2 -5 0'/>");
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_model(text, &mesh, NULL, &err), err);
    assert_true(mesh.origin[0] == 1000003.2 && mesh.origin[1] == -5);
    assert_true(mesh.positions[3] == 1 && mesh.vertex_count == 8);
    cw_mesh_free(&mesh);
}

/* Items in another order than their objects, one twice, one not at all, and one for support. */
static void what_is_built_is_what_items_name(void **state)
{
    (void)state;
    static const char text[] = MODEL "><resources>" FOUR("7") FOUR("1")
        FOUR("5' name='five") "<object id='9' type='support'><mesh><vertices><vertex x='9' "
                              "y='9' z='9'/></vertices>"
                              "<triangles/></mesh></object>" BUILD(
                                  "<item objectid='5'/><item objectid='9'/>"
                                  "<item objectid='7' transform='1 0 0 0 1 0 0 0 1 3 0 "
                                  "0'/><item objectid='5'/>");
    cw_part *parts;
    size_t count;
    cw_error err = {0};
    cw_mesh mesh;
    assert_ok(read_model(text, &mesh, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, 12);
    assert_true(mesh.positions[3 * 4] == 3);
    cw_mesh_free(&mesh);
    assert_ok(cw_parts_read(test_path("a.3mf"), NULL, &parts, &count, NULL, &err), err);
    assert_int_equal(count, 3);
    assert_string_equal(parts[0].name, "five");
    assert_null(parts[1].name);
    assert_int_equal(parts[2].mesh->vertex_count, 4);
    cw_parts_free(parts, count);
}

/* An object for support has four triangles, and eight as components; an object of type 'other'
 * is placed by an item and by a component. */
static void what_is_left_out_is_counted_by_type(void **state)
{
    (void)state;
#define OBJECTS                                                                                \
    FOUR("1")                                                                                  \
    FOUR("2' type='support")                                                                   \
    FOUR("3' type='other")                                                                     \
    "<object id='4' type='solidsupport'><components><component objectid='1'/><component "      \
    "objectid='3'/></components></object><object id='5'><components><component objectid='3'/>" \
    "<component objectid='1'/></components></object>"
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_model(MODEL "><resources>" OBJECTS BUILD("<item objectid='2'/><item "
                                                            "objectid='3'/><item objectid='4'/>"
                                                            "<item objectid='5'/>"),
                         &mesh, &file, &err),
              err);
    assert_int_equal(mesh.triangle_count, 4);
    assert_int_equal(file.supports, 2);
    assert_int_equal(file.support_triangles, 4 + 8);
    assert_int_equal(file.others, 2);
    assert_int_equal(file.other_triangles, 8);
    cw_mesh_free(&mesh);
    assert_fails(read_model(MODEL "><resources>" OBJECTS BUILD("<item objectid='2'/><item "
                                                               "objectid='3'/>"),
                            &mesh, &file, &err),
                 CW_ERR_FORMAT,
                 "only what is left out: 1 objects for support (4 triangles) and 1 of type "
                 "'other' (4 triangles)",
                 err);
#undef OBJECTS
}

#define ONE_TRIANGLE(attributes, triangle)                                                     \
    "<object id='9' " attributes "><mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' "  \
    "y='0' z='0'/><vertex x='0' y='1' z='0'/></vertices><triangles><triangle v1='0' v2='1' "   \
    "v3='2' " triangle "/></triangles></mesh></object>" BUILD("<item objectid='9'/>")
#define GROUPS                                                                                 \
    "><resources><m:colorgroup id='1'><m:color color='#FF0000'/><m:color color='#00ff0080'/>"  \
    "</m:colorgroup><basematerials id='2'><base name='x' displaycolor='#0000FFFF'/>"           \
    "</basematerials><m:texture2dgroup id='3'/>"

static void colors_are_those_of_corners_triangles_or_objects(void **state)
{
    (void)state;
    static const uint8_t red[4] = {255, 0, 0, 255}, green[4] = {0, 255, 0, 128},
                         blue[4] = {0, 0, 255, 255};
    static const struct {
        const char *text;
        const uint8_t *corners[3]; /* NULL: no colours */
    } rows[] = {
        {MODEL GROUPS ONE_TRIANGLE("", "pid='1' p1='0' p2='1' p3='0'"), {red, green, red}},
        {MODEL GROUPS ONE_TRIANGLE("", "pid='1' p1='1'"), {green, green, green}},
        {MODEL GROUPS ONE_TRIANGLE("pid='2' pindex='0'", ""), {blue, blue, blue}},
        {MODEL GROUPS ONE_TRIANGLE("pid='1' pindex='0'", "p1='1'"), {green, green, green}},
        {MODEL GROUPS ONE_TRIANGLE("pid='1' pindex='1'", "pid='2' p1='0'"), {blue, blue, blue}},
        {MODEL GROUPS ONE_TRIANGLE("pid='3' pindex='7'", "p1='5'"), {NULL}},
        {MODEL GROUPS ONE_TRIANGLE("pid='77' pindex='0'", ""), {NULL}},
        {MODEL GROUPS ONE_TRIANGLE("", ""), {NULL}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_model(rows[i].text, &mesh, NULL, &err), err);
        assert_true(!mesh.colors == !rows[i].corners[0]);
        for (size_t c = 0; c < 3 && mesh.colors; c++)
            assert_memory_equal(mesh.colors + 4 * c, rows[i].corners[c], 4);
        cw_mesh_free(&mesh);
    }
}

/* Vertices that two triangles colour differently have none; objects without colours
 * are white. */
static void colors_are_kept_when_no_vertex_has_two(void **state)
{
    (void)state;
    static const char mixed[] = MODEL GROUPS
        "<object id='9'><mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/>"
        "<vertex x='0' y='1' z='0'/><vertex x='0' y='0' z='1'/></vertices><triangles><triangle "
        "v1='0' v2='1' v3='2' pid='1' p1='0'/><triangle v1='0' v2='2' v3='3' pid='1' p1='1'/>"
        "</triangles></mesh></object>" BUILD("<item objectid='9'/>");
    static const char half[] = MODEL GROUPS FOUR("5") FOUR("6' pid='1' pindex='0")
        BUILD("<item objectid='6'/><item objectid='5'/>");
    static const uint8_t wanted[2][4] = {{255, 0, 0, 255}, {255, 255, 255, 255}};
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_model(mixed, &mesh, NULL, &err), err);
    assert_null(mesh.colors);
    cw_mesh_free(&mesh);
    assert_ok(read_model(half, &mesh, NULL, &err), err);
    assert_non_null(mesh.colors);
    assert_memory_equal(mesh.colors, wanted[0], 4);
    assert_memory_equal(mesh.colors + 4 * 7, wanted[1], 4);
    cw_mesh_free(&mesh);
}

#define PRODUCTION " xmlns:p='http://schemas.microsoft.com/3dmanufacturing/production/2015/06' "
#define MORE_RELS                                                                              \
    "<Relationships><Relationship Type='x/3dmodel' Target='/3D/Objects/one.model'/>"           \
    "<Relationship Type='x/thumbnail' Target='none.png'/></Relationships>"

/* As several slicers write them: objects in models of their own. */
static void models_may_take_objects_of_others(void **state)
{
    (void)state;
    static const char root[] = MODEL PRODUCTION
        "requiredextensions='p'><resources><object id='1'><components><component "
        "p:path='/3D/Objects/One.model' objectid='1' transform='1 0 0 0 1 0 0 0 1 5 0 0'/>"
        "</components></object>" BUILD("<item objectid='1'/>");
    static const char one[] =
        MODEL "><resources>" FOUR("1") "</resources><build>"
                                       "<item objectid='99'/></build></model>";
    const zip_entry entries[] = {{"_rels/.rels", RELS, true},
                                 {"3D/3dmodel.model", root, true},
                                 {"3D/_rels/3dmodel.model.rels", MORE_RELS, false},
                                 {"3D/Objects/one.model", one, true}};
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_package(entries, 4, NULL, &mesh, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, 4);
    assert_true(mesh.origin[0] == 5);
    cw_mesh_free(&mesh);
    assert_fails(read_package(entries, 2, NULL, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "no relationship of the package names '3D/Objects/One.model'", err);
    assert_fails(read_package(entries, 3, NULL, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "the zip archive has no '3D/Objects/one.model'", err);
}

/* --- what is refused --------------------------------------------------------------------- */

static void broken_models_are_told_by_line(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"<model", "line 1 is not XML"},
        {"<models/>", "the first element is not model"},
        {"<model unit='parsec'/>", "'3D/3dmodel.model', line 1: 'unit' is 'parsec'"},
        {"<model>\n<resources>\n<object/>", "line 3: 'id' is ''"},
        {"<model><resources><object id='-1'/>", "'id' is '-1'"},
        {"<model><resources><object id='3000000000'/>", "'id' is '3000000000'"},
        {MODEL "><resources>" FOUR("1") FOUR("1") BUILD(""), "the id 1 is there twice"},
        {MODEL "><resources>" FOUR("1") "</resources></model>",
         "'3D/3dmodel.model' has no 'build'"},
        {MODEL "><resources>" FOUR("1' type='invalidtype") BUILD(""),
         "'type' of an object is 'invalidtype'"},
        {MODEL "><resources>" FOUR("1") BUILD("<item objectid='2'/>"),
         "places object 2, which is not there"},
        {MODEL "><resources><colorgroup id='2'/>" BUILD("<item objectid='2'/>"),
         "places object 2, which is not there"},
        {MODEL "><resources>" FOUR("1") BUILD("<item/>"), "'objectid' is ''"},
        {MODEL "><resources>" FOUR("1") BUILD("<item objectid='1' transform='1 0 0'/>"),
         "'transform' is '1 0 0'"},
        {MODEL "><resources>" FOUR("1")
             BUILD("<item objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0 nan'/>"),
         "'transform' is"},
        {MODEL "><resources>" FOUR("1")
             BUILD("<item objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0 0 0'/>"),
         "'transform' is"},
        {MODEL "><resources><object id='1'><mesh><vertices><vertex x='1' y='2'/>", "'z' is ''"},
        {MODEL "><resources><object id='1'><mesh><vertices><vertex x='1' y='2' z='3,'/>",
         "'z' is '3,'"},
        {MODEL "><resources><object id='1'><mesh><vertices><vertex x='1' y='inf' z='3'/>"
               "<vertex x='1' y='1' z='3'/><vertex x='1' y='2' z='3'/></vertices><triangles>"
               "<triangle v1='0' v2='1' v3='2'/></triangles></mesh></object>" BUILD(
                   "<item objectid='1'/>"),
         "'y' of vertex 0 is inf"},
        {MODEL "><resources><object id='1'><mesh><triangles><triangle v1='0' v2='0' v3='0'/>",
         "a triangle names vertex 0 of 0"},
        {MODEL "><resources>" FOUR(
             "1") "<object id='2'><mesh><vertices><vertex x='1' y='2' "
                  "z='3'/></vertices><triangles><triangle v1='0' v2='1' v3='0'/>",
         "a triangle names vertex 1 of 1"},
        {MODEL "><resources><object id='1'><mesh><triangles><triangle v1='0' v2='x'/>",
         "a triangle names vertex 0 of 0"},
        {MODEL "><resources><colorgroup id='1'><color color='#12345'/>",
         "a colour is '#12345'"},
        {MODEL "><resources><colorgroup id='1'><color color='#12345g'/>", "a colour is"},
        {MODEL "><resources><colorgroup id='1'><color/>", "a colour is ''"},
        {MODEL GROUPS ONE_TRIANGLE("", "pid='1' p1='2'"), "colour 2 of 2 is named"},
        {MODEL GROUPS ONE_TRIANGLE("", "pid='1' p1='-2'"), "'p1' is '-2'"},
        {MODEL GROUPS ONE_TRIANGLE("pid='1' pindex='9'", ""), "colour 9 of 2 is named"},
        {MODEL "><resources><object id='1'><components><component objectid='1'/></components>"
               "</object>" BUILD("<item objectid='1'/>"),
         "nested deeper than 64, or hold themselves"},
    };
    check_refused_models(rows, sizeof rows / sizeof *rows, CW_ERR_FORMAT);
}

static void document_types_and_unknown_extensions_are_refused(void **state)
{
    (void)state;
    static const refused doctype[] = {
        {"<!DOCTYPE model [<!ENTITY a 'b'>]><model/>", "a document type"}};
    static const refused extensions[] = {
        {"<model xmlns:b='http://x/beamlattice/2017/02' requiredextensions='b'/>",
         "it needs the extension 'http://x/beamlattice/2017/02' of 3MF"},
        {"<model requiredextensions='s'/>", "it needs the extension 's'"}};
    check_refused_models(doctype, 1, CW_ERR_UNSAFE);
    check_refused_models(extensions, 2, CW_ERR_UNSUPPORTED);
}

/* 40 objects, each of two of the one before: 2^40 tetrahedra. */
static void instancing_without_end_is_refused(void **state)
{
    (void)state;
    static char text[20000];
    int used = snprintf(text, sizeof text, MODEL "><resources>" FOUR("1"));
    for (int i = 2; i <= 41; i++)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "<object id='%d'><components><component objectid='%d'/><component "
                         "objectid='%d'/></components></object>",
                         i, i - 1, i - 1);
    snprintf(text + used, sizeof text - (size_t)used, BUILD("<item objectid='41'/>"));
    const refused rows[] = {{text, "objects are placed more than 1048576 times"}};
    check_refused_models(rows, 1, CW_ERR_LIMIT);
}

static void packages_without_a_model_are_refused(void **state)
{
    (void)state;
    static const char external[] =
        "<Relationships><Relationship Type='x/3dmodel' "
        "Target='http://x/y' TargetMode='External'/></Relationships>";
    static const char none[] = "<Relationships><Relationship Type='x/y'/></Relationships>";
    static const char two[] =
        "<Relationships><Relationship Type='x/3dmodel' Target='/a.model'/>"
        "<Relationship Type='x/3dmodel' Target='/b.model'/></Relationships>";
    const zip_entry rows[] = {{"_rels/.rels", external, true},
                              {"_rels/.rels", none, true},
                              {"_rels/.rels", RELS, true},
                              {"word/document.xml", "<x/>", true},
                              {"_rels/.rels", two, true}};
    static const char *const words[] = {
        "its model 'http://x/y' is outside the package", "the package has no model",
        "the zip archive has no '3D/3dmodel.model'", "the zip archive has no '_rels/.rels'",
        "the package names 2 models to build, 'a.model' and 'b.model'; one was expected"};
    for (size_t i = 0; i < 5; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_fails(read_package(&rows[i], 1, NULL, &mesh, NULL, &err),
                     i ? CW_ERR_FORMAT : CW_ERR_UNSAFE, words[i], err);
    }
}

/* --- archives that lie ------------------------------------------------------------------- */

#define TEXT MODEL "><resources>" FOUR("1") BUILD("<item objectid='1'/>")

static const zip_entry plain[] = {{"_rels/.rels", RELS, false},
                                  {"3D/3dmodel.model", TEXT, true}};

static cw_status read_archive(cw_mesh *mesh, cw_error *err)
{
    test_file_write(test_path("a.3mf"), archive.bytes, archive.size);
    return cw_mesh_read(test_path("a.3mf"), NULL, mesh, NULL, err);
}

static void archives_that_lie_are_told(void **state)
{
    (void)state;
    enum { LOCAL, CENTRAL, LAST };
    static const struct {
        int record; /* of the model, or the last one */
        size_t at;  /* the field in it */
        uint64_t value;
        size_t size;
        const char *words;
    } rows[] = {
        {LAST, 0, 1, 4, "it has no directory"},
        {LAST, 20, 9, 2, "it has no directory"},
        {LAST, 16, 0x7fffffff, 4, "its directory does not fit into the file"},
        {LAST, 12, 0x7fffffff, 4, "its directory does not fit into the file"},
        {LAST, 16, UINT32_MAX, 4, "sizes of 64 bits are missing"},
        {LAST, 10, 60000, 2, "has 60000 entries in"},
        {CENTRAL, 0, 1, 4, "its directory breaks off"},
        {CENTRAL, 28, 60000, 2, "its directory breaks off"},
        {CENTRAL, 8, 1, 2, "'3D/3dmodel.model' in the zip archive is encrypted"},
        {CENTRAL, 10, 12, 2, "'3D/3dmodel.model' is packed by method 12"},
        {CENTRAL, 10, 0, 2, "cannot have"},
        {CENTRAL, 24, 0x7fffffff, 4, "cannot have 2147483647 bytes"},
        {CENTRAL, 24, UINT32_MAX, 4, "sizes of 64 bits are missing"},
        {CENTRAL, 24, 900, 4, "it has another size than the directory says"},
        {CENTRAL, 24, 100000, 4, "it has another size than the directory says"},
        {CENTRAL, 16, 7, 4, "its checksum is another"},
        {CENTRAL, 20, 100, 4, "it breaks off"},
        {CENTRAL, 20, 100000, 4, "an entry is larger than the file"},
        {CENTRAL, 42, 3, 4, "an entry is not where the directory says"},
        {CENTRAL, 42, 0x7fffffff, 4, "an entry is not where the directory says"},
        {LOCAL, 0, 1, 4, "an entry is not where the directory says"},
        {LOCAL, 8, 0, 2, "an entry is not where the directory says"},
        {LOCAL, 30, 'x', 1, "an entry is not where the directory says"},
        {LOCAL, 28, 60000, 2, "an entry is larger than the file"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        zip_make(&archive, plain, 2);
        const size_t starts[] = {archive.local[1], archive.central[1], archive.end};
        zip_change(&archive, starts[rows[i].record] + rows[i].at, rows[i].value, rows[i].size);
        const cw_status st = read_archive(&mesh, &err);
        if (st != CW_ERR_FORMAT || !strstr(err.message, rows[i].words))
            fail_msg("row %zu gives status %d: %s; not: %s", i, (int)st, err.message,
                     rows[i].words);
        assert_null(mesh.positions);
    }
}

/* Text that packs to a thousandth, as blanks do: more of it than any model has. */
static void bombs_are_refused_unless_they_are_meant(void **state)
{
    (void)state;
    enum { SIZE = 80 << 20 };
    const cw_mesh_read_desc meant = {.max_triangles = 100};
    cw_mesh mesh;
    cw_error err = {0};
    char *text = malloc(SIZE + 1);
    assert_non_null(text);
    memset(text, ' ', SIZE);
    memcpy(text, "<model><build/>", 15);
    memcpy(text + SIZE - 8, "</model>", 8);
    text[SIZE] = '\0';
    const zip_entry entries[] = {{"_rels/.rels", RELS, false},
                                 {"3D/3dmodel.model", text, true}};
    assert_fails(read_package(entries, 2, NULL, &mesh, NULL, &err), CW_ERR_LIMIT,
                 "has 83886080 bytes of text in an archive of", err);
    assert_ok(read_package(entries, 2, &meant, &mesh, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, 0);
    cw_mesh_free(&mesh);
    free(text);
}

static void a_cut_is_never_a_mesh(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    zip_make(&archive, plain, 2);
    const size_t size = archive.size;
    for (archive.size = 4; archive.size < size; archive.size++) {
        if (read_archive(&mesh, &err) != CW_ERR_FORMAT)
            fail_msg("cut at %zu of %zu: %s", archive.size, size, err.message);
        assert_null(mesh.positions);
    }
}

static void no_byte_is_trusted(void **state)
{
    (void)state;
    zip_make(&archive, plain, 2);
    for (size_t i = 0; i < archive.size; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        archive.bytes[i] ^= 0x11;
        if (read_archive(&mesh, &err) == CW_OK)
            assert_usable(&mesh);
        cw_mesh_free(&mesh);
        archive.bytes[i] ^= 0x11;
    }
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const char text[] = MODEL GROUPS FOUR("5") FOUR("6' pid='1' pindex='0")
        BUILD("<item objectid='6'/><item objectid='5'/>");
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_model(text, &mesh, NULL, &err), err);
    cw_mesh_free(&mesh);
    check_starved_mesh_reads("a.3mf");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(a_plain_model_is_read),
        TEST(modifiers_of_slicers_are_left_out),
        TEST(units_become_millimetres),
        TEST(components_are_placed_one_in_another),
        TEST(a_common_move_is_the_origin),
        TEST(what_is_built_is_what_items_name),
        TEST(what_is_left_out_is_counted_by_type),
        TEST(colors_are_those_of_corners_triangles_or_objects),
        TEST(colors_are_kept_when_no_vertex_has_two),
        TEST(models_may_take_objects_of_others),
        TEST(broken_models_are_told_by_line),
        TEST(document_types_and_unknown_extensions_are_refused),
        TEST(instancing_without_end_is_refused),
        TEST(packages_without_a_model_are_refused),
        TEST(archives_that_lie_are_told),
        TEST(bombs_are_refused_unless_they_are_meant),
        TEST(a_cut_is_never_a_mesh),
        TEST(no_byte_is_trusted),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
