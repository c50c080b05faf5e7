/* Checks glTF's JSON against a table of the members that are read, before tinygltf reads it.
 * tinygltf treats a member of the wrong type as missing. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/gltf/gltf_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- the table --------------------------------------------------------------------------- */

typedef enum value_kind {
    ANYTHING,
    OBJECT,
    OBJECTS, /* a list of them */
    INDEX,   /* into a list of the outermost object */
    INDICES,
    WHOLE,     /* a whole number from min to max, a multiple of step */
    FRACTIONS, /* up to `max` numbers from 0 to 1 */
    FRACTION,
    NUMBERS, /* `max` numbers, or any count if that is 0; none is larger than `largest`, unless
                that is 0 */
    BOOLEAN,
    STRING,
    STRINGS,
    WORD,       /* a string out of `choices` */
    NUMBER_CODE /* a number out of `choices` */
} value_kind;

typedef enum list_name {
    BUFFERS,
    VIEWS,
    ACCESSORS,
    MESHES,
    NODES,
    SCENES,
    SKINS,
    LIST_COUNT,
    NO_LIST = LIST_COUNT
} list_name;

static const char *const list_names[LIST_COUNT] = {
    "buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes", "skins"};

typedef struct rule {
    const char *key; /* NULL ends a table */
    value_kind kind;
    bool required;
    list_name list;    /* of an index: the list it points into */
    uint64_t min, max; /* of WHOLE; max 0: no limit */
    uint64_t step;
    double largest;             /* of NUMBERS */
    const char *choices;        /* words separated by blanks */
    const struct rule *members; /* of an object */
} rule;

/* The maximum of small numbers. tinygltf keeps whole numbers of extensions and of "sparse" in
 * 31 bits, and cuts off the rest; those of buffers pass through it in 32 bits. */
#define MAX_SMALL INT32_MAX
#define ALL_CODES "5120 5121 5122 5123 5125 5126"

static const rule draco_attributes[] = {{.key = "POSITION", .kind = WHOLE, .max = MAX_SMALL},
                                        {.key = "NORMAL", .kind = WHOLE, .max = MAX_SMALL},
                                        {.key = "COLOR_0", .kind = WHOLE, .max = MAX_SMALL},
                                        {0}};
static const rule draco[] = {
    {.key = "bufferView", .kind = INDEX, .list = VIEWS, .required = true},
    {.key = "attributes", .kind = OBJECT, .members = draco_attributes, .required = true},
    {0}};
static const rule primitive_extensions[] = {
    {.key = "KHR_draco_mesh_compression", .kind = OBJECT, .members = draco}, {0}};
static const rule attributes[] = {{.key = "POSITION", .kind = INDEX, .list = ACCESSORS},
                                  {.key = "NORMAL", .kind = INDEX, .list = ACCESSORS},
                                  {.key = "COLOR_0", .kind = INDEX, .list = ACCESSORS},
                                  {.key = "JOINTS_0", .kind = INDEX, .list = ACCESSORS},
                                  {.key = "JOINTS_1", .kind = INDEX, .list = ACCESSORS},
                                  {.key = "WEIGHTS_0", .kind = INDEX, .list = ACCESSORS},
                                  {.key = "WEIGHTS_1", .kind = INDEX, .list = ACCESSORS},
                                  {0}};
static const rule target[] = {{.key = "POSITION", .kind = INDEX, .list = ACCESSORS},
                              {.key = "NORMAL", .kind = INDEX, .list = ACCESSORS},
                              {0}};
static const rule primitive[] = {
    {.key = "attributes", .kind = OBJECT, .members = attributes, .required = true},
    {.key = "indices", .kind = INDEX, .list = ACCESSORS},
    {.key = "mode", .kind = WHOLE, .max = 6},
    {.key = "targets", .kind = OBJECTS, .members = target},
    {.key = "extensions", .kind = OBJECT, .members = primitive_extensions},
    {0}};
static const rule mesh[] = {
    {.key = "primitives", .kind = OBJECTS, .members = primitive, .required = true},
    {.key = "weights", .kind = NUMBERS},
    {0}};

static const rule placings[] = {{.key = "TRANSLATION", .kind = INDEX, .list = ACCESSORS},
                                {.key = "ROTATION", .kind = INDEX, .list = ACCESSORS},
                                {.key = "SCALE", .kind = INDEX, .list = ACCESSORS},
                                {0}};
static const rule instancing[] = {{.key = "attributes", .kind = OBJECT, .members = placings},
                                  {0}};
static const rule visibility[] = {{.key = "visible", .kind = BOOLEAN}, {0}};
static const rule node_extensions[] = {
    {.key = "EXT_mesh_gpu_instancing", .kind = OBJECT, .members = instancing},
    {.key = "KHR_node_visibility", .kind = OBJECT, .members = visibility},
    {0}};
static const rule node[] = {
    {.key = "mesh", .kind = INDEX, .list = MESHES},
    {.key = "children", .kind = INDICES, .list = NODES},
    {.key = "matrix", .kind = NUMBERS, .max = 16},
    {.key = "translation", .kind = NUMBERS, .max = 3},
    {.key = "rotation", .kind = NUMBERS, .max = 4, .largest = 1.001}, /* allows for rounding */
    {.key = "scale", .kind = NUMBERS, .max = 3},
    {.key = "skin", .kind = INDEX, .list = SKINS},
    {.key = "weights", .kind = NUMBERS},
    {.key = "extensions", .kind = OBJECT, .members = node_extensions},
    {0}};
static const rule skin[] = {{.key = "joints", .kind = INDICES, .list = NODES, .required = true},
                            {.key = "inverseBindMatrices", .kind = INDEX, .list = ACCESSORS},
                            {0}};
static const rule scene[] = {{.key = "nodes", .kind = INDICES, .list = NODES}, {0}};

static const rule sparse_indices[] = {
    {.key = "bufferView", .kind = INDEX, .list = VIEWS, .required = true},
    {.key = "byteOffset", .kind = WHOLE, .max = MAX_SMALL},
    {.key = "componentType",
     .kind = NUMBER_CODE,
     .choices = "5121 5123 5125",
     .required = true},
    {0}};
static const rule sparse_values[] = {
    {.key = "bufferView", .kind = INDEX, .list = VIEWS, .required = true},
    {.key = "byteOffset", .kind = WHOLE, .max = MAX_SMALL},
    {0}};
static const rule sparse[] = {
    {.key = "count", .kind = WHOLE, .min = 1, .max = MAX_SMALL, .required = true},
    {.key = "indices", .kind = OBJECT, .members = sparse_indices, .required = true},
    {.key = "values", .kind = OBJECT, .members = sparse_values, .required = true},
    {0}};
static const rule accessor[] = {
    {.key = "bufferView", .kind = INDEX, .list = VIEWS},
    {.key = "byteOffset", .kind = WHOLE},
    {.key = "componentType", .kind = NUMBER_CODE, .choices = ALL_CODES, .required = true},
    {.key = "normalized", .kind = BOOLEAN},
    {.key = "count", .kind = WHOLE, .min = 1, .required = true},
    {.key = "type",
     .kind = WORD,
     .choices = "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4",
     .required = true},
    {.key = "sparse", .kind = OBJECT, .members = sparse},
    {0}};

static const rule meshopt[] = {
    {.key = "buffer", .kind = INDEX, .list = BUFFERS, .required = true},
    {.key = "byteOffset", .kind = WHOLE, .max = MAX_SMALL},
    {.key = "byteLength", .kind = WHOLE, .min = 1, .max = MAX_SMALL, .required = true},
    {.key = "byteStride", .kind = WHOLE, .min = 1, .max = 256, .required = true},
    {.key = "count", .kind = WHOLE, .min = 1, .max = MAX_SMALL, .required = true},
    {.key = "mode", .kind = WORD, .choices = "ATTRIBUTES TRIANGLES INDICES", .required = true},
    {.key = "filter", .kind = WORD, .choices = "NONE OCTAHEDRAL QUATERNION EXPONENTIAL"},
    {0}};
static const rule view_extensions[] = {
    {.key = "EXT_meshopt_compression", .kind = OBJECT, .members = meshopt}, {0}};
static const rule view[] = {
    {.key = "buffer", .kind = INDEX, .list = BUFFERS, .required = true},
    {.key = "byteOffset", .kind = WHOLE},
    {.key = "byteLength", .kind = WHOLE, .min = 1, .required = true},
    {.key = "byteStride", .kind = WHOLE, .min = 4, .max = 252, .step = 4},
    {.key = "extensions", .kind = OBJECT, .members = view_extensions},
    {0}};
static const rule buffer[] = {
    {.key = "uri", .kind = STRING},
    {.key = "byteLength", .kind = WHOLE, .min = 1, .max = UINT32_MAX, .required = true},
    {0}};

static const rule asset[] = {{.key = "version", .kind = STRING, .required = true}, {0}};
static const rule outermost[] = {
    {.key = "asset", .kind = OBJECT, .members = asset, .required = true},
    {.key = "scene", .kind = INDEX, .list = SCENES},
    {.key = "scenes", .kind = OBJECTS, .members = scene, .list = SCENES},
    {.key = "nodes", .kind = OBJECTS, .members = node, .list = NODES},
    {.key = "skins", .kind = OBJECTS, .members = skin, .list = SKINS},
    {.key = "meshes", .kind = OBJECTS, .members = mesh, .list = MESHES},
    {.key = "accessors", .kind = OBJECTS, .members = accessor, .list = ACCESSORS},
    {.key = "bufferViews", .kind = OBJECTS, .members = view, .list = VIEWS},
    {.key = "buffers", .kind = OBJECTS, .members = buffer, .list = BUFFERS},
    {.key = "extensionsRequired", .kind = STRINGS},
    {0}};

/* How surfaces look, which is not read. */
static const rule roughness[] = {{.key = "baseColorFactor", .kind = FRACTIONS, .max = 4},
                                 {.key = "metallicFactor", .kind = FRACTION},
                                 {.key = "roughnessFactor", .kind = FRACTION},
                                 {0}};
static const rule material[] = {
    {.key = "pbrMetallicRoughness", .kind = OBJECT, .members = roughness},
    {.key = "emissiveFactor", .kind = FRACTIONS, .max = 3},
    {.key = "alphaMode", .kind = WORD, .choices = "OPAQUE MASK BLEND"},
    {0}};
static const rule looks[] = {{.key = "materials", .kind = OBJECTS, .members = material}, {0}};

/* --- walking through JSON ---------------------------------------------------------------- */

/* A walk through the JSON. It checks only the grammar that it needs; tinygltf refuses the
 * rest. */
typedef struct walker {
    const char *json;
    size_t size, at;
    size_t counts[LIST_COUNT];
    cw_error *err;
} walker;

/* The path to a value in the JSON, for messages. */
typedef struct json_path {
    const struct json_path *up;
    const char *key; /* NULL: an element of a list */
    size_t index;
} json_path;

static cw_status fail_broken(const walker *w)
{
    return cwi_fail(w->err, CW_ERR_FORMAT,
                    "the glTF is not valid: its JSON is broken at byte %zu", w->at);
}

/* Returns the next character that is not a blank; 0 at the end. */
static char next_char(walker *w)
{
    while (w->at < w->size && w->json[w->at] && strchr(" \t\r\n", w->json[w->at]))
        w->at++;
    return w->at < w->size ? w->json[w->at] : '\0';
}

static bool take_char(walker *w, char c)
{
    const bool found = next_char(w) == c;
    w->at += found;
    return found;
}

/* Returns a string's bytes, without its quotes; NULL for anything else. */
static const char *take_string(walker *w, size_t *length)
{
    if (!take_char(w, '"'))
        return NULL;
    const char *start = w->json + w->at;
    for (; w->at < w->size && w->json[w->at] != '"'; w->at++)
        w->at += w->json[w->at] == '\\';
    if (w->at >= w->size)
        return NULL;
    *length = (size_t)(w->json + w->at++ - start);
    return start;
}

/* Returns a number, true, false or null: all characters up to a delimiter. */
static const char *take_bare(walker *w, size_t *length)
{
    next_char(w);
    const char *start = w->json + w->at;
    while (w->at < w->size && w->json[w->at] && !strchr(" \t\r\n,:\"[]{}", w->json[w->at]))
        w->at++;
    *length = (size_t)(w->json + w->at - start);
    return *length ? start : NULL;
}

/* Skips a value, without recursion. */
static bool skip_value(walker *w)
{
    size_t depth = 0, length;
    do {
        const char c = next_char(w);
        const bool opens = c == '{' || c == '[', closes = c == '}' || c == ']';
        if (opens || closes || c == ',' || c == ':') {
            if (!depth && !opens)
                return false;
            depth += opens;
            depth -= closes;
            w->at++;
        } else if (!(c == '"' ? take_string(w, &length) : take_bare(w, &length))) {
            return false;
        }
    } while (depth);
    return true;
}

/* --- messages ---------------------------------------------------------------------------- */

enum { PATH_BYTES = 256, SHOWN_BYTES = 48 };

static size_t put_path(const json_path *p, char path[PATH_BYTES])
{
    if (!p)
        return 0;
    size_t used = put_path(p->up, path);
    const int put =
        p->key ? snprintf(path + used, PATH_BYTES - used, "%s%s", used ? "." : "", p->key)
               : snprintf(path + used, PATH_BYTES - used, "[%zu]", p->index);
    used += put > 0 ? (size_t)put : 0;
    return used < PATH_BYTES ? used : PATH_BYTES - 1;
}

/* Shortens the value that starts at `from` for a message, and makes its untrusted bytes
 * printable. */
static void show_value(const char *from, const char *end, char shown[SHOWN_BYTES])
{
    size_t used = 0;
    if (from < end && (*from == '{' || *from == '[')) {
        snprintf(shown, SHOWN_BYTES, "%s", *from == '{' ? "an object" : "a list");
        return;
    }
    for (; from < end && used + 5 < SHOWN_BYTES; from++)
        shown[used++] = *from >= ' ' && *from <= '~' ? *from : '?';
    snprintf(shown + used, SHOWN_BYTES - used, "%s", from < end ? "..." : "");
}

/* Reports a wrong value: "nodes[3].mesh: -5 is not an index (0 to 7)". The value starts at byte
 * `start`. */
static cw_status fail_value(walker *w, size_t start, const json_path *p, const char *expected)
{
    char path[PATH_BYTES] = "", shown[SHOWN_BYTES];
    w->at = start;
    next_char(w);
    const char *from = w->json + w->at;
    if (!skip_value(w))
        return fail_broken(w);
    put_path(p, path);
    show_value(from, w->json + w->at, shown);
    return cwi_fail(w->err, CW_ERR_FORMAT, "%s: %s is not %s", path, shown, expected);
}

static cw_status fail_index(walker *w, size_t start, const rule *r, const json_path *p)
{
    char expected[96];
    const size_t count = w->counts[r->list];
    if (count)
        snprintf(expected, sizeof expected, "an index (0 to %zu)", count - 1);
    else
        snprintf(expected, sizeof expected, "an index (there are no %s)", list_names[r->list]);
    return fail_value(w, start, p, expected);
}

static cw_status fail_whole(walker *w, size_t start, const rule *r, const json_path *p)
{
    char expected[96];
    const char *kind = r->step ? "a multiple of 4" : "a whole number";
    if (r->max)
        snprintf(expected, sizeof expected, "%s (%llu to %llu)", kind,
                 (unsigned long long)r->min, (unsigned long long)r->max);
    else
        snprintf(expected, sizeof expected, "%s (%llu or more)", kind,
                 (unsigned long long)r->min);
    return fail_value(w, start, p, expected);
}

/* --- values ------------------------------------------------------------------------------ */

static bool is_number(const char *text, size_t length)
{
    return length && (*text == '-' || (*text >= '0' && *text <= '9'));
}

/* Parses a whole number, written without a point or an exponent, as glTF requires. */
static bool parse_whole(const char *text, size_t length, uint64_t *value)
{
    *value = 0;
    if (length == 2 && text[0] == '-' && text[1] == '0')
        return true;
    for (size_t i = 0; i < length; i++)
        if (text[i] < '0' || text[i] > '9' || __builtin_mul_overflow(*value, 10u, value) ||
            __builtin_add_overflow(*value, (uint64_t)(text[i] - '0'), value))
            return false;
    return length > 0;
}

static bool is_choice(const char *choices, const char *text, size_t length)
{
    const char *c = choices;
    while (*c) {
        const size_t n = strcspn(c, " ");
        if (n == length && memcmp(c, text, n) == 0)
            return true;
        c += n + (c[n] == ' ');
    }
    return false;
}

/* Returns the next value if it is bare; for any other one *length is 0. */
static const char *look_at_bare(walker *w, size_t *length)
{
    const size_t start = w->at;
    const char *text = take_bare(w, length);
    w->at = start;
    return text;
}

static cw_status check_index(walker *w, const rule *r, const json_path *p)
{
    size_t length;
    uint64_t value;
    const char *text = look_at_bare(w, &length);
    if (!parse_whole(text, length, &value) || value >= w->counts[r->list])
        return fail_index(w, w->at, r, p);
    return skip_value(w) ? CW_OK : fail_broken(w);
}

static cw_status check_whole(walker *w, const rule *r, const json_path *p)
{
    size_t length;
    uint64_t value;
    const char *text = look_at_bare(w, &length);
    if (!parse_whole(text, length, &value) || value < r->min || (r->max && value > r->max) ||
        (r->step && value % r->step))
        return fail_whole(w, w->at, r, p);
    return skip_value(w) ? CW_OK : fail_broken(w);
}

static cw_status check_number(walker *w, const rule *r, const json_path *p)
{
    char digits[64];
    size_t length;
    double value = NAN;
    const char *text = look_at_bare(w, &length), *at = digits;
    if (!is_number(text, length))
        return fail_value(w, w->at, p, "a number");
    snprintf(digits, sizeof digits, "%.*s", length < sizeof digits ? (int)length : 63, text);
    if (!cwi_parse_double(&at, &value) || !isfinite(value))
        return fail_value(w, w->at, p, "a finite number");
    if (r->kind == FRACTION && !(value >= 0 && value <= 1))
        return fail_value(w, w->at, p, "a number from 0 to 1");
    if (r->largest > 0 && fabs(value) > r->largest)
        return fail_value(w, w->at, p, "a number from -1 to 1");
    return skip_value(w) ? CW_OK : fail_broken(w);
}

static cw_status check_word(walker *w, const rule *r, const json_path *p)
{
    char expected[128];
    const size_t start = w->at;
    size_t length = 0;
    const char *text = r->kind == WORD ? take_string(w, &length) : take_bare(w, &length);
    if (text && is_choice(r->choices, text, length))
        return CW_OK;
    snprintf(expected, sizeof expected, "one of %s", r->choices);
    return fail_value(w, start, p, expected);
}

static cw_status check_plain(walker *w, const rule *r, const json_path *p)
{
    const size_t start = w->at;
    size_t length = 0;
    if (r->kind != BOOLEAN)
        return take_string(w, &length) ? CW_OK : fail_value(w, start, p, "a string");
    const char *text = take_bare(w, &length);
    return text && is_choice("true false", text, length)
               ? CW_OK
               : fail_value(w, start, p, "true or false");
}

static cw_status check_value(walker *w, const rule *r, const json_path *p);

/* Checks the elements of a list: each is of the kind `one`. */
static cw_status check_list(walker *w, const rule *r, value_kind one, const json_path *p)
{
    const size_t start = w->at;
    rule element = *r;
    json_path at = {p, NULL, 0};
    cw_status st = CW_OK;
    element.kind = one;
    if (!take_char(w, '['))
        return fail_value(w, start, p, "a list");
    bool more = next_char(w) != ']';
    for (; st == CW_OK && more; at.index++) {
        st = check_value(w, &element, &at);
        more = st == CW_OK && take_char(w, ',');
    }
    if (st == CW_OK && !take_char(w, ']'))
        return fail_broken(w);
    if (st == CW_OK && (r->kind == NUMBERS || r->kind == FRACTIONS) && r->max &&
        at.index != r->max) {
        char path[PATH_BYTES] = "";
        put_path(p, path);
        return cwi_fail(w->err, CW_ERR_FORMAT, "%s: %zu numbers; %llu were expected", path,
                        at.index, (unsigned long long)r->max);
    }
    return st;
}

/* Returns true if a key as written, possibly with escapes, spells a name. */
static bool key_spells(const char *key, size_t length, const char *name)
{
    size_t i = 0;
    while (i < length && *name) {
        unsigned code = (unsigned char)key[i];
        if (code == '\\' && i + 5 < length && key[i + 1] == 'u') {
            char digits[5];
            int used = 0;
            memcpy(digits, key + i + 2, 4);
            digits[4] = '\0';
            if (sscanf(digits, "%4x%n", &code, &used) != 1 || used != 4)
                return false;
            i += 5;
        }
        if (code != (unsigned char)*name)
            return false;
        i++, name++;
    }
    return i == length && !*name;
}

static size_t find_rule(const rule *rules, const char *key, size_t length)
{
    size_t i = 0;
    while (rules && rules[i].key && !key_spells(key, length, rules[i].key))
        i++;
    return i;
}

static cw_status check_required(const walker *w, const rule *rules, unsigned seen,
                                const json_path *p)
{
    char path[PATH_BYTES] = "the JSON";
    for (size_t i = 0; rules && rules[i].key; i++)
        if (rules[i].required && !(seen & 1u << i)) {
            put_path(p, path);
            return cwi_fail(w->err, CW_ERR_FORMAT, "%s: there is no '%s'", path, rules[i].key);
        }
    return CW_OK;
}

/* Checks the value of one member. glTF requires that its own names are written without
 * escapes. */
static cw_status check_member(walker *w, const rule *r, bool escaped, const json_path *p)
{
    const json_path at = {p, r->key, 0};
    char path[PATH_BYTES] = "";
    if (!take_char(w, ':'))
        return fail_broken(w);
    if (!r->key)
        return skip_value(w) ? CW_OK : fail_broken(w);
    put_path(&at, path);
    if (escaped)
        return cwi_fail(w->err, CW_ERR_FORMAT, "%s: the name is written with an escape", path);
    return check_value(w, r, &at);
}

static cw_status check_object(walker *w, const rule *rules, const json_path *p)
{
    static const rule unknown = {0};
    const size_t start = w->at;
    unsigned seen = 0;
    cw_status st = CW_OK;
    if (!take_char(w, '{'))
        return fail_value(w, start, p, "an object");
    bool more = next_char(w) != '}';
    while (st == CW_OK && more) {
        size_t length, i;
        const char *key = take_string(w, &length);
        if (!key)
            return fail_broken(w);
        i = find_rule(rules, key, length);
        st = check_member(w, rules ? &rules[i] : &unknown, memchr(key, '\\', length), p);
        seen |= rules && rules[i].key ? 1u << i : 0;
        more = st == CW_OK && take_char(w, ',');
    }
    if (st == CW_OK && !take_char(w, '}'))
        return fail_broken(w);
    return st == CW_OK ? check_required(w, rules, seen, p) : st;
}

static cw_status check_value(walker *w, const rule *r, const json_path *p)
{
    next_char(w);
    switch (r->kind) {
    case OBJECT:
        return check_object(w, r->members, p);
    case OBJECTS:
        return check_list(w, r, OBJECT, p);
    case INDICES:
        return check_list(w, r, INDEX, p);
    case STRINGS:
        return check_list(w, r, STRING, p);
    case NUMBERS:
        return p->key ? check_list(w, r, NUMBERS, p) : check_number(w, r, p);
    case FRACTIONS:
        return check_list(w, r, FRACTION, p);
    case FRACTION:
        return check_number(w, r, p);
    case INDEX:
        return check_index(w, r, p);
    case WHOLE:
        return check_whole(w, r, p);
    case WORD:
    case NUMBER_CODE:
        return check_word(w, r, p);
    case BOOLEAN:
    case STRING:
        return check_plain(w, r, p);
    case ANYTHING:
    default:
        return skip_value(w) ? CW_OK : fail_broken(w);
    }
}

/* --- the whole --------------------------------------------------------------------------- */

static bool count_elements(walker *w, size_t *count)
{
    *count = 0;
    if (next_char(w) != '[')
        return skip_value(w);
    w->at++;
    if (take_char(w, ']'))
        return true;
    do {
        if (!skip_value(w))
            return false;
        ++*count;
    } while (take_char(w, ','));
    return take_char(w, ']');
}

/* Counts the outermost lists' elements first, since indices may precede the lists they point
 * into. */
static bool count_lists(walker *w)
{
    if (!take_char(w, '{'))
        return false;
    if (take_char(w, '}'))
        return true;
    do {
        size_t length, unused;
        const char *key = take_string(w, &length);
        if (!key || !take_char(w, ':'))
            return false;
        const rule *r = &outermost[find_rule(outermost, key, length)];
        if (!count_elements(w, r->kind == OBJECTS ? &w->counts[r->list] : &unused))
            return false;
    } while (take_char(w, ','));
    return take_char(w, '}');
}

cw_status cwi_gltf_check(const char *json, size_t size, cw_error *err)
{
    walker w = {.json = json, .size = size, .err = err};
    if (!count_lists(&w))
        return fail_broken(&w);
    w.at = 0;
    return check_object(&w, outermost, NULL);
}

cw_status cwi_gltf_check_look(const char *json, size_t size, cw_error *err)
{
    walker w = {.json = json, .size = size, .err = err};
    return check_object(&w, looks, NULL);
}
