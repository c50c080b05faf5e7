#define _GNU_SOURCE /* dladdr */
#include "core/module.h"

#include "core/features.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Beside the object this function is in: the library, or a program that linked it statically.
 */
static bool module_path(const char *name, char *path, size_t size)
{
    static const char *const folders[] = {"cubewright", "../lib/cubewright", CW_MODULE_DIR};
    Dl_info here;
    if (!dladdr((const void *)&folders, &here) || !here.dli_fname)
        return false;
    const char *slash = strrchr(here.dli_fname, '/');
    const int folder_length = slash ? (int)(slash - here.dli_fname) : 1;
    const char *folder = slash ? here.dli_fname : ".";
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        const int length = snprintf(path, size, "%.*s/%s/cubewright-%s.so", folder_length,
                                    folder, folders[i], name);
        if (length > 0 && (size_t)length < size && access(path, R_OK) == 0)
            return true;
    }
    return false;
}

bool cwi_module_present(const char *name)
{
    char path[4096];
    return module_path(name, path, sizeof path);
}

cw_status cwi_module_load(const char *name, const void **functions, cw_error *err)
{
    char path[4096], symbol[64];
    const cwi_feature_row *row = cwi_find_module_row(name);
    if (!row)
        return cw_fail(err, CW_ERR_UNSUPPORTED, "there is no module '%s'", name);
    if (!module_path(name, path, sizeof path))
        return cw_fail(err, CW_ERR_UNSUPPORTED,
                       "the %s module is not in this build (%s); configure with -D%s=ON and "
                       "the Debian package%s %s",
                       name, *row->reason ? row->reason : "its file was removed", row->option,
                       strchr(row->packages, ' ') ? "s" : "", row->packages);
    void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    snprintf(symbol, sizeof symbol, "cwi_module_%s", name);
    *functions = module ? dlsym(module, symbol) : NULL;
    if (!*functions)
        return cw_fail(err, CW_ERR_UNSUPPORTED,
                       "the %s module cannot be loaded: %s (Debian: %s)", name, dlerror(),
                       row->packages);
    return CW_OK;
}
