/* Reads what slicers say of the volumes of objects, beside the model: modifiers, blockers of supports and
 * negative volumes are no parts of the print. PrusaSlicer names ranges of an object's triangles, Bambu Studio
 * and OrcaSlicer the objects that others are made of. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/3mf/3mf.h"
#include "formats/text/text_header.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_ELEMENTS = 1000000 };

static const char prusa[] = "Metadata/Slic3r_PE_model.config",
                  bambu[] = "Metadata/model_settings.config";

/* The volume at hand. */
typedef struct slicer {
    cwi_3mf *m;
    cwi_3mf_modifier volume;
    bool is_modifier;
} slicer;

static cw_status read_id(cwi_attributes a, const char *name, uint32_t *to, cw_error *err)
{
    int64_t number = 0;
    const char *text = cwi_attribute(a, name);
    cw_status st = text ? cwi_field_integer(name, text, 0, INT32_MAX, &number, err) : CW_OK;
    *to = (uint32_t)number;
    return st;
}

static cw_status start_object(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return read_id(a, "id", &((slicer *)user)->volume.object, err);
}

static cw_status start_volume(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    slicer *s = user;
    (void)x;
    s->is_modifier = false;
    cw_status st = read_id(a, "firstid", &s->volume.first, err);
    return st == CW_OK ? read_id(a, "lastid", &s->volume.last, err) : st;
}

static cw_status read_metadata(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    slicer *s = user;
    const char *key = cwi_attribute(a, "key"), *value = cwi_attribute(a, "value");
    (void)x, (void)err;
    if (key && value && strcmp(key, "volume_type") == 0)
        s->is_modifier = strcmp(value, "ModelPart") != 0;
    else if (key && value && strcmp(key, "modifier") == 0)
        s->is_modifier = strcmp(value, "1") == 0; /* of older versions */
    return CW_OK;
}

static cw_status keep_volume(void *user, cwi_xml *x, cw_error *err)
{
    slicer *s = user;
    cwi_3mf *m = s->m;
    (void)x;
    if (!s->is_modifier)
        return CW_OK;
    s->is_modifier = false;
    cw_status st = cwi_mesh_grow(m->in, &m->modifiers, &m->modifier_capacity,
                                 m->modifier_count + 1, sizeof *m->modifiers, err);
    if (st == CW_OK)
        m->modifiers[m->modifier_count++] = s->volume;
    return st;
}

/* A part of an object is an object of its own. */
static cw_status start_part(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    slicer *s = user;
    const char *kind = cwi_attribute(a, "subtype");
    s->volume.first = 0;
    s->volume.last = UINT32_MAX;
    s->is_modifier = kind && strcmp(kind, "normal_part") != 0;
    cw_status st = read_id(a, "id", &s->volume.object, err);
    return st == CW_OK ? keep_volume(s, x, err) : st;
}

static const cwi_xml_element prusa_elements[] = {
    {"config", CWI_XML_ROOT, NULL, NULL},
    {"object", 0, start_object, NULL},
    {"volume", 1, start_volume, keep_volume},
    {"metadata", 2, read_metadata, NULL},
};

static const cwi_xml_element bambu_elements[] = {
    {"config", CWI_XML_ROOT, NULL, NULL},
    {"object", 0, NULL, NULL},
    {"part", 1, start_part, NULL},
};

static const cwi_xml_rules prusa_rules = {
    .elements = prusa_elements, .element_count = 4, .max_elements = MAX_ELEMENTS};
static const cwi_xml_rules bambu_rules = {
    .elements = bambu_elements, .element_count = 3, .max_elements = MAX_ELEMENTS};

static int compare_modifiers(const void *a, const void *b)
{
    const cwi_3mf_modifier *x = a, *y = b;
    return x->object != y->object ? (x->object > y->object ? 1 : -1)
                                  : (x->first > y->first) - (x->first < y->first);
}

cw_status cwi_3mf_read_slicer(cwi_3mf *m, cw_error *err)
{
    slicer s = {.m = m};
    cw_status st = CW_OK;
    if (cwi_unzip_has(&m->zip, prusa))
        st = cwi_3mf_read_xml(m, prusa, &prusa_rules, &s, err);
    else if (cwi_unzip_has(&m->zip, bambu))
        st = cwi_3mf_read_xml(m, bambu, &bambu_rules, &s, err);
    if (m->modifier_count)
        qsort(m->modifiers, m->modifier_count, sizeof *m->modifiers, compare_modifiers);
    return st;
}

bool cwi_3mf_is_modifier(const cwi_3mf *m, uint32_t object, size_t triangle)
{
    size_t low = 0, high = m->modifier_count;
    while (low < high) { /* the last range that begins at the triangle or before it */
        const size_t middle = (low + high) / 2;
        const cwi_3mf_modifier *r = &m->modifiers[middle];
        if (r->object < object || (r->object == object && r->first <= triangle))
            low = middle + 1;
        else
            high = middle;
    }
    return low && m->modifiers[low - 1].object == object &&
           triangle <= m->modifiers[low - 1].last;
}
