/* glTF: the scene is made and written by a module, loaded when the first one is asked for. */
#include "formats/gltf_wrap.h"

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

static cw_status write_scene(const cw_mesh *mesh, cwi_mesh_output *out, bool binary,
                             cw_error *err)
{
    const cwi_gltf_functions *functions;
    cw_status st = cwi_gltf_functions_load(&functions, err);
    return st == CW_OK ? functions->write(mesh, out, binary, err) : st;
}

cw_status cwi_glb_write(const cw_mesh *mesh, cwi_mesh_output *out, cw_error *err)
{
    return write_scene(mesh, out, true, err);
}

cw_status cwi_gltf_write(const cw_mesh *mesh, cwi_mesh_output *out, cw_error *err)
{
    return write_scene(mesh, out, false, err);
}
