/* Reads 3MF packages. The relationships name the model, and its own relationships name the
 * models of its parts. Of the rest, only what slicers say of modifiers is read. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "formats/3mf/3mf.h"
#include "formats/3mf/3mf_format.h"

#include <stdio.h>
#include <string.h>

/* The text may be 100 times as large as the archive, once it is beyond a free amount. The XML
 * of real models packs to a tenth. */
enum { FREE_TEXT = 64 << 20, MAX_RATIO = 100 };

bool cwi_3mf_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return size >= 4 && memcmp(head, "PK\3\4", 4) == 0;
}

/* --- relationships ----------------------------------------------------------------------- */

static cw_status start_relationship(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char model[] = "/3dmodel";
    cwi_3mf *m = user;
    const char *type = cwi_attribute(a, "Type"), *target = cwi_attribute(a, "Target");
    const char *mode = cwi_attribute(a, "TargetMode");
    const size_t length = type ? strlen(type) : 0;
    (void)x;
    if (length < strlen(model) || strcmp(type + length - strlen(model), model) != 0 || !target)
        return CW_OK;
    if (mode && strcmp(mode, "External") == 0)
        return cwi_fail(err, CW_ERR_UNSAFE, "its model '%.80s' is outside the package", target);
    if (m->model_count == CWI_3MF_MODELS)
        return cwi_fail(err, CW_ERR_LIMIT, "the package names more than %d models",
                        CWI_3MF_MODELS);
    m->models[m->model_count] = cwi_strdup(target + (*target == '/'));
    if (!m->models[m->model_count])
        return cwi_fail_memory(err);
    m->model_count++;
    return CW_OK;
}

enum { E_RELATIONSHIPS, E_RELATIONSHIP, ELEMENT_COUNT, MAX_RELATIONSHIPS = 10000 };

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_RELATIONSHIPS] = {"Relationships", CWI_XML_ROOT, NULL, NULL},
    [E_RELATIONSHIP] = {"Relationship", E_RELATIONSHIPS, start_relationship, NULL},
};

static const cwi_xml_rules rules = {
    .elements = elements, .element_count = ELEMENT_COUNT, .max_elements = MAX_RELATIONSHIPS};

/* Adds the models that the relationships of a part name. They are in
 * "3D/_rels/3dmodel.model.rels" for "3D/3dmodel.model". */
static cw_status add_related(cwi_3mf *m, const char *part, cw_error *err)
{
    char path[512];
    const char *slash = strrchr(part, '/'), *name = slash ? slash + 1 : part;
    snprintf(path, sizeof path, "%.*s_rels/%s.rels", (int)(name - part), part, name);
    return cwi_unzip_has(&m->zip, path) ? cwi_3mf_read_xml(m, path, &rules, m, err) : CW_OK;
}

/* --- the package ------------------------------------------------------------------------- */

static cw_status read_models(cwi_3mf *m, cw_error *err)
{
    cw_status st = cwi_3mf_read_xml(m, "_rels/.rels", &rules, m, err);
    if (st == CW_OK && m->model_count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the package has no model");
    if (st == CW_OK && m->model_count > 1)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the package names %zu models to build, '%.80s' and '%.80s'; one was "
                        "expected",
                        m->model_count, m->models[0], m->models[1]);
    if (st == CW_OK)
        st = add_related(m, m->models[0], err);
    if (st == CW_OK)
        st = cwi_3mf_read_slicer(m, err);
    if (st == CW_OK)
        st = cwi_3mf_read_model(m, 0, err);
    for (size_t i = 1; i < m->model_count && st == CW_OK; i++)
        if (m->is_wanted[i])
            st = cwi_3mf_read_model(m, i, err);
    return st;
}

static void free_package(cwi_3mf *m)
{
    for (size_t i = 0; i < m->model_count; i++)
        cwi_free(m->models[i]);
    cwi_build_free(&m->build);
    cwi_free(m->point_colors);
    cwi_free(m->face_colors);
    cwi_free(m->colors);
    cwi_free(m->objects);
    cwi_free(m->components);
    cwi_free(m->items);
    cwi_free(m->names);
    cwi_free(m->resources);
    cwi_free(m->modifiers);
    cwi_unzip_close(&m->zip);
    cwi_free(m);
}

/* Leaves out the points of triangles that were left out. */
static cw_status drop_unnamed(cw_mesh *mesh, cw_error *err)
{
    bool *none = cwi_alloc_zeroed(mesh->triangle_count, sizeof *none);
    cw_status st = none ? cwi_mesh_drop_marked(mesh, none, err) : cwi_fail_memory(err);
    cwi_free(none);
    return st;
}

cw_status cwi_3mf_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    const bool stated = in->desc.max_triangles < UINT32_MAX;
    cwi_3mf *m = cwi_alloc_zeroed(1, sizeof *m);
    if (!m)
        return cwi_fail_memory(err);
    m->in = m->build.in = in;
    m->mesh = mesh;
    m->metadata = metadata;
    m->text_left = stated ? UINT64_MAX : FREE_TEXT + MAX_RATIO * in->file.size;
    cw_status st = cwi_unzip_open(&m->zip, &in->file, err);
    if (st == CW_OK)
        st = read_models(m, err);
    if (st == CW_OK)
        st = cwi_3mf_place(m, err);
    if (st == CW_OK && metadata->modifier_triangles)
        st = drop_unnamed(mesh, err);
    free_package(m);
    return st;
}
