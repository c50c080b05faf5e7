/* Reads glTF: the triangles of a scene, placed by its nodes, merged into one mesh of LPS
 * millimetres. */
#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/texture/join_seams.h"
#include "core/texture/split_seams.h"
#include "formats/bytes/little_endian.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/gltf_wrap.h"

#include <stdio.h>
#include <string.h>

enum { GLB_HEADER = 12, CHUNK_HEADER = 8, FREE_COUNT = 1 << 24 };

/* --- the file ---------------------------------------------------------------------------- */

bool cwi_glb_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return size >= 4 && memcmp(head, "glTF", 4) == 0;
}

bool cwi_gltf_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    size_t i = 0;
    (void)file_size;
    while (i < size && (head[i] == ' ' || (head[i] >= '\t' && head[i] <= '\r')))
        i++;
    return i < size && head[i] == '{';
}

/* Finds a chunk's size and the place of its bytes; fails where the file has no more. */
static cw_status find_chunk(const cwi_input *in, uint64_t at, uint64_t end, const char *kind,
                            uint64_t *size, cw_error *err)
{
    unsigned char head[CHUNK_HEADER];
    size_t got;
    cw_status st = cwi_input_read_at(in->fd, at, head, sizeof head, &got, err);
    if (st != CW_OK)
        return st;
    *size = got == sizeof head ? cwi_get_u32(head) : 0;
    if (got < sizeof head || memcmp(head + 4, kind, 4) != 0 || *size > end - at - CHUNK_HEADER)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the chunk at byte %llu is not a whole one of kind %.4s",
                        (unsigned long long)at, kind);
    return CW_OK;
}

/* Reads the header, a chunk of JSON, and usually one of bytes. */
static cw_status find_chunks(cwi_gltf_reader *r, uint64_t *json, uint64_t *json_size,
                             cw_error *err)
{
    const cwi_input *in = &r->in->file;
    unsigned char head[GLB_HEADER];
    size_t got;
    cw_status st = cwi_input_read_at(in->fd, 0, head, sizeof head, &got, err);
    if (st != CW_OK)
        return st;
    if (got < sizeof head || memcmp(head, "glTF", 4) != 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the file does not begin with 'glTF'");
    const uint64_t end = cwi_get_u32(head + 8);
    if (cwi_get_u32(head + 4) != 2)
        return cwi_fail(err, CW_ERR_FORMAT, "it is of version %u; version 2 is read",
                        cwi_get_u32(head + 4));
    if (end > in->size || end < GLB_HEADER + CHUNK_HEADER)
        return cwi_fail(err, CW_ERR_FORMAT, "the header says %llu bytes; the file has %llu",
                        (unsigned long long)end, (unsigned long long)in->size);
    st = find_chunk(in, GLB_HEADER, end, "JSON", json_size, err);
    *json = GLB_HEADER + CHUNK_HEADER;
    if (st != CW_OK || *json + *json_size + CHUNK_HEADER > end)
        return st;
    r->bytes.chunk = *json + *json_size + CHUNK_HEADER;
    return find_chunk(in, *json + *json_size, end, "BIN\0", &r->bytes.chunk_size, err);
}

/* Checks that a range of bytes lies within the stated size of its buffer. */
static cw_status check_range(const cwi_gltf_scene *scene, size_t view, const char *member,
                             int64_t buffer, uint64_t offset, uint64_t bytes, cw_error *err)
{
    if (buffer < 0 || (uint64_t)buffer >= scene->buffer_count)
        return cwi_fail(err, CW_ERR_FORMAT, "bufferViews[%zu]%s: there is no buffer %lld", view,
                        member, (long long)buffer);
    const uint64_t held = scene->buffers[buffer].bytes;
    if (offset <= held && bytes <= held - offset)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "bufferViews[%zu]%s: %llu bytes from byte %llu on are more than the %llu of "
        "buffers[%lld]",
        view, member, (unsigned long long)bytes, (unsigned long long)offset,
        (unsigned long long)held, (long long)buffer);
}

static cw_status check_views(const cwi_gltf_scene *scene, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; i < scene->view_count && st == CW_OK; i++) {
        const cwi_gltf_view *v = &scene->views[i];
        st = check_range(scene, i, "", v->buffer, v->offset, v->bytes, err);
        if (st == CW_OK && v->packed_buffer >= 0)
            st = check_range(scene, i, ".extensions.EXT_meshopt_compression", v->packed_buffer,
                             v->packed_offset, v->packed_bytes, err);
    }
    return st;
}

static cw_status parse_json(cwi_gltf_reader *r, uint64_t at, uint64_t size,
                            cw_mesh_file *metadata, cw_error *err)
{
    cw_error fault = {0};
    size_t got;
    if (size > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the JSON has more than 4 GiB");
    char *json = cwi_alloc_array((size_t)size + 1, 1);
    if (!json)
        return cwi_fail_memory(err);
    cw_status st = cwi_input_read_at(r->in->file.fd, at, json, (size_t)size, &got, err);
    if (st == CW_OK)
        st = cwi_gltf_check(json, got, err);
    const bool looks_right = st == CW_OK && cwi_gltf_check_look(json, got, &fault) == CW_OK;
    if (st == CW_OK && !looks_right)
        snprintf(metadata->fault, sizeof metadata->fault, "%.159s", fault.message);
    struct json_t *materials = looks_right ? cwi_gltf_keep_materials(json, got) : NULL;
    if (st == CW_OK)
        st = cwi_gltf_blind(json, got, looks_right, err);
    if (st == CW_OK)
        st = cwi_gltf_parse(json, got, &r->in->desc, &r->scene, err);
    if (st == CW_OK)
        st = check_views(&r->scene, err);
    cwi_free(json);
    if (st == CW_OK)
        st = cwi_gltf_read_materials(r, materials, err);
    cwi_gltf_free_materials(materials);
    return st;
}

/* --- the scene --------------------------------------------------------------------------- */

/* Returns true if all instances are moved alike and not turned; positions then stay to the
 * bit. */
static bool is_shifted(const cwi_gltf_reader *r)
{
    for (size_t i = 0; i < r->instance_count; i++)
        for (int a = 0; a < 3; a++)
            if (!r->instances[i].unturned ||
                r->instances[i].transform[a][3] != r->instances[0].transform[a][3])
                return false;
    return r->instance_count > 0;
}

/* Describes the mesh. The frame is known where each node states it and none has been turned
 * since. */
static void describe_mesh(const cwi_gltf_reader *r, cw_mesh *mesh, cw_mesh_file *metadata)
{
    const cwi_gltf_instance *one = r->instances;
    bool lps = r->instance_count > 0;
    for (size_t i = 0; i < r->instance_count; i++)
        lps = lps && r->instances[i].unturned && r->instances[i].node->lps;
    metadata->known = CW_KNOWN_UNIT | (lps ? CW_KNOWN_FRAME : 0u);
    if (lps && r->instance_count == 1 && one->node->has_affine)
        memcpy(mesh->affine, one->node->affine, sizeof mesh->affine);
    for (int a = 0; a < 3 && r->shifted; a++)
        mesh->origin[a] = one->transform[a][3];
}

/* Returns the maximum number of elements, derived from the real number of bytes. A small file
 * that draws itself many times must not take all memory. */
static uint64_t max_elements(const cwi_gltf_reader *r)
{
    uint64_t largest = 0;
    if (r->in->desc.max_triangles < UINT32_MAX) /* the caller decides */
        return 3 * r->in->desc.max_triangles + FREE_COUNT;
    for (size_t i = 0; i < r->scene.buffer_count; i++) {
        const uint64_t bytes = cwi_gltf_file_bytes(&r->bytes, &r->scene.buffers[i]);
        largest = bytes > largest ? bytes : largest;
    }
    return FREE_COUNT + r->in->file.size + largest;
}

/* Copies the label of a node, with the colour of its material if it has one alone. */
static cw_label label_of(const cwi_gltf_reader *r, const cwi_gltf_instance *at)
{
    const cwi_gltf_node *n = at->node;
    const cwi_gltf_mesh *mesh = &r->scene.meshes[at->mesh];
    cw_label label = {.value = n->label,
                      .layer = n->layer,
                      .id = n->label_id,
                      .is_negative = n->label_is_negative,
                      .name = n->name,
                      .has_color = n->has_color,
                      .category = {n->codes[0], n->codes[1], n->codes[2]},
                      .type = {n->codes[3], n->codes[4], n->codes[5]}};
    memcpy(label.color, n->color, sizeof label.color);
    const cwi_gltf_material *m =
        mesh->first + 1 == mesh->end
            ? cwi_gltf_material_of(r, &r->scene.primitives[mesh->first])
            : NULL;
    if (m && !m->is_plain) {
        label.has_color = true;
        cwi_gltf_base_color(m, label.color);
    }
    return label;
}

/* Begins the part of an instance: by the name of its node, else of its mesh, with its number if the node has several. */
static cw_status begin_part(cwi_gltf_reader *r, const cwi_gltf_instance *at, cw_error *err)
{
    const char *mesh = r->scene.meshes[at->mesh].name;
    const char *given = at->node->name ? at->node->name : mesh ? mesh : "";
    char name[CWI_NAME_BYTES + 24];
    if (at->number)
        snprintf(name, sizeof name, "%.*s%s%zu", CWI_NAME_BYTES - 1, given, *given ? " " : "",
                 at->number);
    cw_status st =
        cwi_mesh_begin_part(r->in, at->number ? name : given, r->build.triangle_count, err);
    if (st != CW_OK || !at->node->has_label)
        return st;
    const cw_label label = label_of(r, at);
    return cwi_mesh_label_part(r->in, &label, err);
}

/* Names what viewers draw otherwise, for the user. */
static void name_not_applied(unsigned features, cw_mesh_file *metadata)
{
    static const char *const names[] = {"skins of meshes that Draco compressed",
                                        "skins of instanced nodes",
                                        "colours of morph targets",
                                        "pictures by TEXCOORD_1",
                                        "differing KHR_texture_transform of one material",
                                        "mirrored textures"};
    size_t used = 0;
    for (size_t n = 0; n < sizeof names / sizeof *names && used < sizeof metadata->not_applied;
         n++)
        if (features >> n & 1)
            used += (size_t)snprintf(metadata->not_applied + used,
                                     sizeof metadata->not_applied - used, "%s%s",
                                     used ? ", " : "", names[n]);
}

static cw_status draw_instances(cwi_gltf_reader *r, cw_mesh_file *metadata, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; i < r->instance_count && st == CW_OK; i++) {
        const cwi_gltf_instance *at = &r->instances[i];
        r->keeps_shapes = i + 1 < r->instance_count && at[1].node == at->node;
        st = cwi_progress(&r->in->desc.progress, "reading",
                          (double)i / (double)r->instance_count, err);
        if (st == CW_OK)
            st = begin_part(r, at, err);
        if (st == CW_OK)
            st = cwi_gltf_add_instance(r, at, metadata, err);
    }
    return st;
}

/* Gives the mesh its texture coordinates. Vertices that were split at seams become one within their part. */
static cw_status keep_places(const cwi_gltf_reader *r, cw_mesh *mesh, cw_error *err)
{
    const cwi_marks *marks = &r->in->marks;
    float(*uv)[2];
    cw_status st = cwi_texture_add(mesh, CW_ON_VERTICES, &uv, err);
    uint32_t *groups = cwi_alloc_zeroed(mesh->vertex_count, sizeof *groups);
    if (st == CW_OK && !groups)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        memcpy(uv, r->places, mesh->vertex_count * sizeof *uv);
    for (size_t n = 0; n < marks->count && st == CW_OK; n++) {
        const size_t end =
            n + 1 < marks->count ? marks->items[n + 1].triangle : mesh->triangle_count;
        for (size_t c = 3 * marks->items[n].triangle; c < 3 * end; c++)
            groups[mesh->triangles[c]] = marks->items[n].object;
    }
    if (st == CW_OK)
        st = cwi_join_seams(mesh, groups, err);
    cwi_free(groups);
    return st;
}

static cw_status build_scene(cwi_gltf_reader *r, cw_mesh *mesh, cw_mesh_file *metadata,
                             cw_error *err)
{
    r->max = max_elements(r);
    cw_status st = cwi_gltf_find_instances(r, metadata, err);
    r->shifted = st == CW_OK && is_shifted(r);
    for (size_t i = 0; i < r->scene.material_count; i++)
        r->any_base = r->any_base || !r->scene.materials[i].is_plain;
    metadata->parts = 0;
    if (st == CW_OK)
        st = draw_instances(r, metadata, err);
    if (st != CW_OK)
        return st;
    describe_mesh(r, mesh, metadata);
    name_not_applied(r->not_applied, metadata);
    mesh->colors = r->colors;
    r->colors = NULL;
    if (!r->no_normals) {
        mesh->normals = r->normals;
        r->normals = NULL;
    }
    st = cwi_build_finish(&r->build, mesh, metadata, err);
    if (st == CW_OK && r->places)
        st = keep_places(r, mesh, err);
    return st == CW_OK && r->has_colors && !mesh->colors
               ? cwi_color_mesh(&r->materials, true, mesh, err)
               : st;
}

static cw_status read_scene(cwi_mesh_input *in, bool binary, cw_mesh *mesh,
                            cw_mesh_file *metadata, cw_error *err)
{
    cwi_gltf_reader r = {
        .in = in, .build = {.in = in}, .materials = {.in = in}, .bytes = {.in = &in->file}};
    uint64_t json = 0, json_size = in->file.size;
    r.unpacker.desc = &in->desc;
    r.bytes.unpacker = &r.unpacker;
    /* a missing module is reported first; an existing one is loaded where the file is parsed */
    cw_status st = cwi_module_present("gltf") ? CW_OK : cwi_gltf_prepare(err);
    if (st == CW_OK && binary)
        st = find_chunks(&r, &json, &json_size, err);
    if (st == CW_OK)
        st = parse_json(&r, json, json_size, metadata, err);
    if (st == CW_OK)
        st = build_scene(&r, mesh, metadata, err);
    cwi_build_free(&r.build);
    cwi_arrays_free(&r.arrays);
    cwi_gltf_unpacker_close(&r.unpacker);
    cwi_free(r.world);
    cwi_free(r.visited);
    cwi_free(r.drawings);
    cwi_gltf_free_poses(&r);
    cwi_gltf_free_shapes(&r);
    cwi_free(r.instances);
    cwi_free(r.normals);
    cwi_free(r.colors);
    cwi_free(r.places);
    cwi_free(r.looks);
    cwi_face_colors_free(&r.materials);
    cwi_gltf_scene_free(&r.scene);
    return st;
}

cw_status cwi_glb_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    return read_scene(in, true, mesh, metadata, err);
}

cw_status cwi_gltf_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                        cw_error *err)
{
    return read_scene(in, false, mesh, metadata, err);
}
