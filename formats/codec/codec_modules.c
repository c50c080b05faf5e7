/* Loads the modules that compress (draco, meshopt), and frees their decoded arrays. */
#include "core/base/memory.h"
#include "core/base/module.h"
#include "formats/codec/draco_wrap.h"
#include "formats/codec/meshopt_wrap.h"

cw_status cwi_draco_functions_load(const cwi_draco_functions **functions, cw_error *err)
{
    const void *module;
    cw_status st = cwi_module_load("draco", &module, err);
    if (st == CW_OK)
        *functions = module;
    return st;
}

cw_status cwi_meshopt_functions_load(const cwi_meshopt_functions **functions, cw_error *err)
{
    const void *module;
    cw_status st = cwi_module_load("meshopt", &module, err);
    if (st == CW_OK)
        *functions = module;
    return st;
}

void cwi_arrays_free(cwi_arrays *arrays)
{
    cwi_free(arrays->positions);
    cwi_free(arrays->grid_points);
    cwi_free(arrays->normals);
    cwi_free(arrays->colors);
    cwi_free(arrays->texture);
    cwi_free(arrays->tangents);
    cwi_free(arrays->triangles);
    *arrays = (cwi_arrays){0};
}
