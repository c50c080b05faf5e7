/* Reads the elements of a 3MF model: objects, colours, components and the build. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/3mf/3mf.h"
#include "formats/mesh/mesh_axes.h"

#include <math.h>
#include <string.h>
#include <strings.h>

const uint32_t cwi_3mf_none = UINT32_MAX;

enum { TEXT_BYTES = 128 };

/* Facts that our writer stores as metadata. */
typedef enum fact { NO_FACT, FRAME, UP, ORIGIN } fact;

typedef struct parsing {
    cwi_3mf *m;
    size_t model;
    cwi_xml *xml;
    cwi_3mf_object object; /* the current object */
    uint32_t object_id;
    size_t object_triangles;  /* of it so far, those left out among them */
    uint32_t group_id, color; /* of triangles without colours of their own */
    cwi_3mf_resource *group;  /* the group of colours being read */
    cwi_3mf_resource *used;   /* the group that triangles named last, and its id */
    uint32_t used_id;
    fact fact;
    char text[TEXT_BYTES];
    size_t text_bytes;
} parsing;

/* --- attributes -------------------------------------------------------------------------- */

static cw_status fail_attribute(const parsing *p, cw_error *err, const char *what,
                                const char *value)
{
    return cwi_fail(err, CW_ERR_FORMAT, "'%s', line %lu: %s is '%.40s'", p->m->models[p->model],
                    cwi_xml_line(p->xml), what, value ? value : "");
}

static cw_status read_number(const parsing *p, const char *what, const char *value, double *to,
                             cw_error *err)
{
    const char *at = value;
    if (value && cwi_parse_double(&at, to) && !at[strspn(at, " \t\r\n")])
        return CW_OK;
    return fail_attribute(p, err, what, value);
}

/* Reads a whole number up to 2^31 - 1. */
static cw_status read_whole(const parsing *p, const char *what, const char *value, uint32_t *to,
                            cw_error *err)
{
    const char *at = value;
    int64_t number;
    if (!value || !cwi_parse_int(&at, &number) || at[strspn(at, " \t\r\n")] || number < 0 ||
        number > INT32_MAX)
        return fail_attribute(p, err, what, value);
    *to = (uint32_t)number;
    return CW_OK;
}

/* Reads twelve numbers, written for points as row vectors, into an affine. */
static cw_status read_transform(const parsing *p, const char *value, double transform[12],
                                cw_error *err)
{
    static const double unit[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const char *at = value;
    memcpy(transform, unit, sizeof unit);
    for (int i = 0; i < 12 && value; i++) {
        double *to = &transform[4 * (i % 3) + i / 3];
        if (!cwi_parse_double(&at, to) || !isfinite(*to))
            return fail_attribute(p, err, "'transform'", value);
    }
    if (value && at[strspn(at, " \t\r\n")])
        return fail_attribute(p, err, "'transform'", value);
    return CW_OK;
}

/* --- resources --------------------------------------------------------------------------- */

static uint64_t key_of(size_t model, uint32_t id)
{
    return ((uint64_t)model + 1) << 32 | id;
}

/* Finds the slot of a key, or the free slot for it; some slot is free. */
static cwi_3mf_resource *find_slot(cwi_3mf_resource *resources, size_t slots, uint64_t key)
{
    size_t slot = (size_t)(key * 0x9e3779b97f4a7c15u >> 32) % slots;
    while (resources[slot].key && resources[slot].key != key)
        slot = (slot + 1) % slots;
    return &resources[slot];
}

cwi_3mf_resource *cwi_3mf_find(const cwi_3mf *m, size_t model, uint32_t id)
{
    if (m->slots == 0)
        return NULL;
    cwi_3mf_resource *r = find_slot(m->resources, m->slots, key_of(model, id));
    return r->key ? r : NULL;
}

/* Doubles the slots, so that half of them are free. */
static cw_status make_slots(parsing *p, cw_error *err)
{
    cwi_3mf *m = p->m;
    const size_t slots = m->slots ? 2 * m->slots : 32;
    if (2 * m->resource_count < m->slots)
        return CW_OK;
    cw_status st = cwi_mesh_take_bytes(m->in, slots * sizeof *m->resources, err);
    if (st != CW_OK)
        return st;
    cwi_3mf_resource *more = cwi_alloc_zeroed(slots, sizeof *more);
    if (!more)
        return cwi_fail_memory(err);
    for (size_t i = 0; i < m->slots; i++)
        if (m->resources[i].key)
            *find_slot(more, slots, m->resources[i].key) = m->resources[i];
    cwi_free(m->resources);
    m->resources = more;
    m->slots = slots;
    p->used = NULL;
    return CW_OK;
}

static cw_status add_resource(parsing *p, uint32_t id, cwi_3mf_resource **added, cw_error *err)
{
    cwi_3mf *m = p->m;
    if (m->resource_count == CWI_3MF_RESOURCES)
        return cwi_fail(err, CW_ERR_LIMIT, "more than %d objects and groups of colours",
                        CWI_3MF_RESOURCES);
    cw_status st = make_slots(p, err);
    if (st != CW_OK)
        return st;
    cwi_3mf_resource *r = find_slot(m->resources, m->slots, key_of(p->model, id));
    if (r->key)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s', line %lu: the id %u is there twice",
                        m->models[p->model], cwi_xml_line(p->xml), id);
    m->resource_count++;
    r->key = key_of(p->model, id);
    *added = r;
    return CW_OK;
}

/* Finds the colour at an index of a group; none if the resource is no group of colours. */
static cw_status find_color(parsing *p, uint32_t group, uint32_t index, uint32_t *color,
                            cw_error *err)
{
    if (!p->used || p->used_id != group)
        p->used = cwi_3mf_find(p->m, p->model, group);
    p->used_id = group;
    *color = cwi_3mf_none;
    if (!p->used || !p->used->is_group)
        return CW_OK;
    if (index >= p->used->end - p->used->first)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s', line %lu: colour %u of %zu is named",
                        p->m->models[p->model], cwi_xml_line(p->xml), index,
                        p->used->end - p->used->first);
    *color = (uint32_t)(p->used->first + index);
    return CW_OK;
}

/* --- colours ----------------------------------------------------------------------------- */

static cw_status start_group(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    uint32_t id = 0;
    (void)x;
    cw_status st = read_whole(p, "'id'", cwi_attribute(a, "id"), &id, err);
    if (st == CW_OK)
        st = add_resource(p, id, &p->group, err);
    if (st == CW_OK) {
        p->group->is_group = true;
        p->group->first = p->group->end = p->m->color_count;
    }
    return st;
}

static bool parse_color(const char *text, uint32_t *color)
{
    const size_t digits = text && *text == '#' ? strlen(text) - 1 : 0;
    if (digits != 6 && digits != 8)
        return false;
    *color = 0;
    for (const char *c = text + 1; *c; c++) {
        const char *hex = "0123456789abcdef", *digit = strchr(hex, *c | 32);
        if (*c < '0' || !digit)
            return false;
        *color = *color << 4 | (uint32_t)(digit - hex);
    }
    *color = digits == 6 ? *color << 8 | 255 : *color;
    return true;
}

static cw_status add_color(parsing *p, const char *value, cw_error *err)
{
    cwi_3mf *m = p->m;
    uint32_t color;
    if (!parse_color(value, &color))
        return fail_attribute(p, err, "a colour", value);
    cw_status st = cwi_mesh_grow(m->in, &m->colors, &m->color_capacity, m->color_count + 1,
                                 sizeof *m->colors, err);
    if (st == CW_OK) {
        m->colors[m->color_count++] = color;
        p->group->end = m->color_count;
    }
    return st;
}

static cw_status start_color(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return add_color(user, cwi_attribute(a, "color"), err);
}

static cw_status start_base(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return add_color(user, cwi_attribute(a, "displaycolor"), err);
}

/* --- objects ----------------------------------------------------------------------------- */

static cw_status keep_name(parsing *p, const char *name, cw_error *err)
{
    cwi_3mf *m = p->m;
    const size_t given = name ? strlen(name) : 0;
    const size_t length = given < CWI_SCAN_AHEAD ? given : CWI_SCAN_AHEAD;
    p->object.name = m->name_bytes;
    cw_status st =
        cwi_mesh_grow(m->in, &m->names, &m->name_capacity, m->name_bytes + length + 1, 1, err);
    if (st != CW_OK)
        return st;
    memcpy(m->names + m->name_bytes, name ? name : "", length);
    m->names[m->name_bytes + length] = '\0';
    m->name_bytes += length + 1;
    return CW_OK;
}

static cw_status read_type(const parsing *p, const char *name, cwi_3mf_type *type,
                           cw_error *err)
{
    static const struct {
        const char *name;
        cwi_3mf_type type;
    } types[] = {{"model", CWI_3MF_SHAPE},
                 {"surface", CWI_3MF_SHAPE},
                 {"support", CWI_3MF_SUPPORT},
                 {"solidsupport", CWI_3MF_SUPPORT},
                 {"other", CWI_3MF_OTHER}};
    *type = CWI_3MF_SHAPE;
    for (size_t i = 0; i < sizeof types / sizeof *types && name; i++)
        if (strcmp(types[i].name, name) == 0) {
            *type = types[i].type;
            return CW_OK;
        }
    return name ? fail_attribute(p, err, "'type' of an object", name) : CW_OK;
}

static cw_status start_object(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    const cwi_3mf *m = p->m;
    const char *type = cwi_attribute(a, "type"), *group = cwi_attribute(a, "pid");
    const char *index = cwi_attribute(a, "pindex");
    uint32_t color = 0;
    (void)x;
    p->object = (cwi_3mf_object){.first_point = m->build.point_count,
                                 .first_triangle = m->build.triangle_count,
                                 .first_component = m->component_count};
    p->object_triangles = 0;
    p->group_id = p->color = cwi_3mf_none;
    cw_status st = read_type(p, type, &p->object.type, err);
    if (st == CW_OK)
        st = read_whole(p, "'id'", cwi_attribute(a, "id"), &p->object_id, err);
    if (st == CW_OK && group)
        st = read_whole(p, "'pid'", group, &p->group_id, err);
    if (st == CW_OK && group && index)
        st = read_whole(p, "'pindex'", index, &color, err);
    if (st == CW_OK && group)
        st = find_color(p, p->group_id, color, &p->color, err);
    return st == CW_OK ? keep_name(p, cwi_attribute(a, "name"), err) : st;
}

static cw_status end_object(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    cwi_3mf *m = p->m;
    cwi_3mf_resource *r;
    (void)x;
    p->object.end_point = m->build.point_count;
    p->object.end_triangle = m->build.triangle_count;
    p->object.end_component = m->component_count;
    cw_status st = add_resource(p, p->object_id, &r, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(m->in, &m->objects, &m->object_capacity, m->object_count + 1,
                           sizeof *m->objects, err);
    if (st != CW_OK)
        return st;
    r->object = m->object_count;
    m->objects[m->object_count++] = p->object;
    return CW_OK;
}

/* Finds the values of some attributes, in one pass; NULL where there is none. */
static void pick_attributes(cwi_attributes a, const char *const *names, const char **values,
                            int count)
{
    for (int i = 0; i < count; i++)
        values[i] = NULL;
    for (; *a; a += 2)
        for (int i = 0; i < count; i++)
            if (strcmp(a[0], names[i]) == 0)
                values[i] = a[1];
}

static cw_status start_vertex(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const names[3] = {"x", "y", "z"};
    static const char *const what[3] = {"'x'", "'y'", "'z'"};
    parsing *p = user;
    const char *values[3];
    double point[3] = {0};
    cw_status st = CW_OK;
    (void)x;
    pick_attributes(a, names, values, 3);
    for (int i = 0; i < 3 && st == CW_OK; i++)
        st = read_number(p, what[i], values[i], &point[i], err);
    return st == CW_OK ? cwi_build_point(&p->m->build, point, err) : st;
}

/* Gives a point a colour, from a corner of a triangle. Once any point has two, none are
 * kept: triangles then have theirs. */
static cw_status give_color(parsing *p, size_t point, uint32_t color, cw_error *err)
{
    cwi_3mf *m = p->m;
    if (color == cwi_3mf_none || m->mixed_colors)
        return CW_OK;
    cw_status st = cwi_mesh_grow(m->in, &m->point_colors, &m->point_color_capacity,
                                 m->build.point_count, sizeof *m->point_colors, err);
    if (st != CW_OK)
        return st;
    while (m->point_color_count < m->build.point_count)
        m->point_colors[m->point_color_count++] = cwi_3mf_none;
    uint32_t *is = &m->point_colors[point];
    m->mixed_colors = *is != cwi_3mf_none && m->colors[*is] != m->colors[color];
    *is = color;
    return CW_OK;
}

/* Keeps the colour of the last triangle. Those before it that have none are marked. */
static cw_status keep_face_color(parsing *p, const uint32_t colors[3], cw_error *err)
{
    cwi_3mf *m = p->m;
    const size_t count = m->build.triangle_count;
    if (colors[0] == cwi_3mf_none && !m->face_colors)
        return CW_OK;
    cw_status st = cwi_mesh_grow(m->in, &m->face_colors, &m->face_color_capacity, count,
                                 sizeof *m->face_colors, err);
    if (st != CW_OK)
        return st;
    while (m->face_color_count < count)
        m->face_colors[m->face_color_count++] = cwi_3mf_none;
    m->face_colors[count - 1] = colors[0];
    for (int c = 1; c < 3 && colors[0] != cwi_3mf_none && colors[c] != cwi_3mf_none; c++)
        m->is_graded = m->is_graded || m->colors[colors[c]] != m->colors[colors[0]];
    return CW_OK;
}

static cw_status color_triangle(parsing *p, const char *const values[4],
                                const size_t corners[3], cw_error *err)
{
    static const char *const what[3] = {"'p1'", "'p2'", "'p3'"};
    uint32_t group = p->group_id, index = 0, colors[3];
    cw_status st = values[0] ? read_whole(p, "'pid'", values[0], &group, err) : CW_OK;
    for (int c = 0; c < 3 && st == CW_OK; c++) {
        uint32_t color = p->color;
        colors[c] = cwi_3mf_none;
        if (values[1] && values[1 + c])
            st = read_whole(p, what[c], values[1 + c], &index, err);
        if (st == CW_OK && values[1] && group != cwi_3mf_none)
            st = find_color(p, group, index, &color, err);
        if (st == CW_OK)
            st = give_color(p, corners[c], color, err);
        colors[c] = color;
    }
    return st == CW_OK ? keep_face_color(p, colors, err) : st;
}

static cw_status start_triangle(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const names[7] = {"v1", "v2", "v3", "pid", "p1", "p2", "p3"};
    static const char *const what[3] = {"'v1'", "'v2'", "'v3'"};
    parsing *p = user;
    cwi_mesh_build *b = &p->m->build;
    const size_t first = p->object.first_point, count = b->point_count - first;
    const char *values[7];
    size_t corners[3];
    cw_status st = CW_OK;
    (void)x;
    if (cwi_3mf_is_modifier(p->m, p->object_id, p->object_triangles++)) {
        p->m->metadata->modifier_triangles++;
        return CW_OK;
    }
    pick_attributes(a, names, values, 7);
    for (int c = 0; c < 3 && st == CW_OK; c++) {
        uint32_t vertex = 0;
        st = read_whole(p, what[c], values[c], &vertex, err);
        if (st == CW_OK && vertex >= count)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s', line %lu: a triangle names vertex %u of %zu",
                            p->m->models[p->model], cwi_xml_line(p->xml), vertex, count);
        corners[c] = first + vertex;
        if (st == CW_OK)
            st = cwi_build_corner(b, (int64_t)corners[c], err);
    }
    b->corners = 0;
    return st == CW_OK ? color_triangle(p, values + 3, corners, err) : st;
}

/* --- components and the build ------------------------------------------------------------ */

/* Finds the model of a path, which a relationship of the package must also name. */
static cw_status find_model(const parsing *p, const char *path, uint32_t *model, cw_error *err)
{
    cwi_3mf *m = p->m;
    *model = (uint32_t)p->model;
    if (!path)
        return CW_OK;
    path += *path == '/';
    for (size_t i = 0; i < m->model_count; i++)
        if (strcasecmp(m->models[i], path) == 0) {
            m->is_wanted[i] = true;
            *model = (uint32_t)i;
            return CW_OK;
        }
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s', line %lu: no relationship of the package names '%.200s'",
                    m->models[p->model], cwi_xml_line(p->xml), path);
}

static cw_status add_component(parsing *p, cwi_attributes a, cwi_3mf_component **list,
                               size_t *count, size_t *capacity, cw_error *err)
{
    cwi_3mf_component c;
    cw_status st = find_model(p, cwi_attribute(a, "path"), &c.model, err);
    if (st == CW_OK)
        st = read_whole(p, "'objectid'", cwi_attribute(a, "objectid"), &c.id, err);
    if (st == CW_OK)
        st = read_transform(p, cwi_attribute(a, "transform"), c.transform, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(p->m->in, list, capacity, *count + 1, sizeof c, err);
    if (st == CW_OK)
        (*list)[(*count)++] = c;
    return st;
}

static cw_status start_component(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    cwi_3mf *m = p->m;
    (void)x;
    return add_component(p, a, &m->components, &m->component_count, &m->component_capacity,
                         err);
}

/* Starts the build, in the package's own model only. */
static cw_status start_build(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)a, (void)err;
    p->m->has_build = p->m->has_build || p->model == 0;
    return CW_OK;
}

static cw_status start_item(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    cwi_3mf *m = p->m;
    (void)x;
    if (p->model > 0)
        return CW_OK;
    return add_component(p, a, &m->items, &m->item_count, &m->item_capacity, err);
}

/* --- the model --------------------------------------------------------------------------- */

/* Returns true for supported extensions that a file may require. Other extensions can hold the
 * printed shape in ways of their own. */
static bool is_known_extension(const char *name)
{
    static const char *const known[] = {"/material/", "/production/", "/trianglesets/"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (name && strstr(name, known[i]))
            return true;
    return false;
}

/* Checks the required extensions: prefixes, whose names the same element declares. */
static cw_status check_extensions(cwi_attributes a, cw_error *err)
{
    const char *at = cwi_attribute(a, "requiredextensions");
    while (at && *(at += strspn(at, " \t\r\n"))) {
        const size_t length = strcspn(at, " \t\r\n");
        const char *name = NULL;
        for (cwi_attributes n = a; *n; n += 2)
            if (strncmp(n[0], "xmlns:", 6) == 0 && strlen(n[0]) == 6 + length &&
                memcmp(n[0] + 6, at, length) == 0)
                name = n[1];
        if (!is_known_extension(name))
            return cwi_fail(err, CW_ERR_UNSUPPORTED, "it needs the extension '%.80s' of 3MF",
                            name ? name : at);
        at += length;
    }
    return CW_OK;
}

static cw_status start_model(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const struct {
        const char *name;
        cw_unit unit;
    } units[] = {{"millimeter", CW_UNIT_MM}, {"micron", CW_UNIT_UM}, {"centimeter", CW_UNIT_CM},
                 {"meter", CW_UNIT_M},       {"inch", CW_UNIT_IN},   {"foot", CW_UNIT_FT}};
    parsing *p = user;
    const char *unit = cwi_attribute(a, "unit");
    bool known = !unit || p->model > 0;
    p->xml = x;
    for (size_t i = 0; i < sizeof units / sizeof *units && !known; i++) {
        known = strcmp(units[i].name, unit) == 0;
        p->m->metadata->axes.unit = units[i].unit;
    }
    p->m->metadata->known |= CW_KNOWN_UNIT;
    return known ? check_extensions(a, err) : fail_attribute(p, err, "'unit'", unit);
}

static cw_status start_metadata(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const names[] = {
        [FRAME] = "cw:frame", [UP] = "cw:up", [ORIGIN] = "cw:origin"};
    parsing *p = user;
    const char *name = cwi_attribute(a, "name");
    (void)x, (void)err;
    p->fact = NO_FACT;
    p->text_bytes = 0;
    for (int f = FRAME; f <= ORIGIN && name && p->model == 0; f++)
        if (strcmp(names[f], name) == 0)
            p->fact = (fact)f;
    return CW_OK;
}

static cw_status end_metadata(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    const char *text = p->text;
    (void)x, (void)err;
    p->text[p->text_bytes] = '\0';
    if (p->fact == FRAME)
        cwi_parse_frame(&text, p->m->metadata);
    if (p->fact == UP)
        p->m->metadata->axes.y_up = strcmp(text, "Y") == 0;
    if (p->fact == ORIGIN)
        p->m->metadata->local = cwi_parse_origin(text, p->m->mesh->origin);
    p->fact = NO_FACT;
    return CW_OK;
}

typedef enum element {
    E_MODEL,
    E_METADATA,
    E_RESOURCES,
    E_MATERIALS,
    E_MATERIAL,
    E_COLORS,
    E_COLOR,
    E_OBJECT,
    E_MESH,
    E_VERTICES,
    E_VERTEX,
    E_TRIANGLES,
    E_TRIANGLE,
    E_COMPONENTS,
    E_COMPONENT,
    E_BUILD,
    E_ITEM,
    ELEMENT_COUNT
} element;

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_MODEL] = {"model", CWI_XML_ROOT, start_model, NULL},
    [E_METADATA] = {"metadata", E_MODEL, start_metadata, end_metadata},
    [E_RESOURCES] = {"resources", E_MODEL, NULL, NULL},
    [E_MATERIALS] = {"basematerials", E_RESOURCES, start_group, NULL},
    [E_MATERIAL] = {"base", E_MATERIALS, start_base, NULL},
    [E_COLORS] = {"colorgroup", E_RESOURCES, start_group, NULL},
    [E_COLOR] = {"color", E_COLORS, start_color, NULL},
    [E_OBJECT] = {"object", E_RESOURCES, start_object, end_object},
    [E_MESH] = {"mesh", E_OBJECT, NULL, NULL},
    [E_VERTICES] = {"vertices", E_MESH, NULL, NULL},
    [E_VERTEX] = {"vertex", E_VERTICES, start_vertex, NULL},
    [E_TRIANGLES] = {"triangles", E_MESH, NULL, NULL},
    [E_TRIANGLE] = {"triangle", E_TRIANGLES, start_triangle, NULL},
    [E_COMPONENTS] = {"components", E_OBJECT, NULL, NULL},
    [E_COMPONENT] = {"component", E_COMPONENTS, start_component, NULL},
    [E_BUILD] = {"build", E_MODEL, start_build, NULL},
    [E_ITEM] = {"item", E_BUILD, start_item, NULL},
};

static cw_status take_text(void *user, int row, const char *text, size_t size, cw_error *err)
{
    parsing *p = user;
    const size_t left = TEXT_BYTES - 1 - p->text_bytes, n = size < left ? size : left;
    (void)err;
    if (row != E_METADATA || p->fact == NO_FACT)
        return CW_OK;
    memcpy(p->text + p->text_bytes, text, n);
    p->text_bytes += n;
    return CW_OK;
}

static const cwi_xml_rules rules = {
    .elements = elements, .element_count = ELEMENT_COUNT, .text = take_text};

cw_status cwi_3mf_read_model(cwi_3mf *m, size_t model, cw_error *err)
{
    parsing p = {.m = m, .model = model};
    return cwi_3mf_read_xml(m, m->models[model], &rules, &p, err);
}
