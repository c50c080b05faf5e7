/* glTF: the scene is made and written by a module, loaded when the first one is asked for. */
#include "formats/gltf_wrap.h"

#include "core/memory.h"
#include "core/mesh.h"
#include "core/module.h"

cw_status cwi_gltf_functions_load(const cwi_gltf_functions **functions, cw_error *err)
{
    const void *module;
    cw_status st = cwi_module_load("gltf", "CUBEWRIGHT_GLTF", "libtinygltf-dev", &module, err);
    if (st == CW_OK)
        *functions = module;
    return st;
}

cw_status cwi_gltf_prepare(cw_error *err)
{
    const cwi_gltf_functions *functions;
    return cwi_gltf_functions_load(&functions, err);
}

/* --- parts as one mesh ------------------------------------------------------------------- */

static void append_part(cw_mesh *all, const cwi_part *part)
{
    const cw_mesh *m = &part->mesh;
    const size_t at = all->vertex_count;
    for (size_t i = 0; i < 3 * m->vertex_count; i++)
        all->positions[3 * at + i] =
            (float)(cwi_coordinate(part, i / 3, (int)(i % 3)) - all->origin[i % 3]);
    for (size_t i = 0; i < 3 * m->triangle_count; i++)
        all->triangles[3 * all->triangle_count + i] = m->triangles[i] + (uint32_t)at;
    if (all->normals)
        memcpy(all->normals + 3 * at, m->normals, 3 * m->vertex_count * sizeof *m->normals);
    if (all->colors)
        memcpy(all->colors + 4 * at, m->colors, 4 * m->vertex_count);
    all->vertex_count += m->vertex_count;
    all->triangle_count += m->triangle_count;
}

static cw_status merge(const cwi_parts *parts, cw_mesh *all, cw_error *err)
{
    const cw_mesh *one = &parts->items[0].mesh;
    if (parts->vertices > UINT32_MAX)
        return cw_fail(err, CW_ERR_LIMIT, "glTF holds at most 4 GiB");
    cw_status st = cwi_mesh_alloc(all, (size_t)parts->vertices, (size_t)parts->triangles,
                                  one->normals, err);
    if (st == CW_OK && one->colors && !(all->colors = cwi_alloc_array(all->vertex_count, 4)))
        st = cw_fail(err, CW_ERR_NO_MEMORY, "no memory to join %zu parts", parts->count);
    if (st != CW_OK)
        return st;
    memcpy(all->origin, one->origin, sizeof all->origin);
    memcpy(all->affine, one->affine, sizeof all->affine);
    all->vertex_count = all->triangle_count = 0;
    for (size_t i = 0; i < parts->count; i++)
        append_part(all, &parts->items[i]);
    return CW_OK;
}

static cw_status write_scene(const cwi_parts *parts, cwi_mesh_output *out, bool binary,
                             cw_error *err)
{
    const cwi_gltf_functions *functions;
    cw_mesh all = {0};
    cw_status st = cwi_gltf_functions_load(&functions, err);
    if (st == CW_OK && parts->count > 1)
        st = merge(parts, &all, err);
    if (st == CW_OK)
        st =
            functions->write(parts->count > 1 ? &all : &parts->items[0].mesh, out, binary, err);
    cw_mesh_free(&all);
    return st;
}

cw_status cwi_glb_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    return write_scene(parts, out, true, err);
}

cw_status cwi_gltf_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    return write_scene(parts, out, false, err);
}
