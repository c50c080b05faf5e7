/* Finds the shared objects of modules, and loads them with dlopen(). */
#define _GNU_SOURCE /* dladdr1 */
#include "core/base/module.h"

#include "core/base/features.h"
#include "core/base/memory.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Finds the file that contains this function: the library, or a program that linked it
 * statically. The loader names the program as it was called. */
static bool find_own_file(char path[PATH_MAX])
{
    static const char here;
    Dl_info info;
    struct link_map *object;
    if (!dladdr1(&here, &info, (void **)&object, RTLD_DL_LINKMAP))
        return false;
    if (*object->l_name)
        return snprintf(path, PATH_MAX, "%s", object->l_name) < PATH_MAX;
    const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX - 1);
    if (length > 0)
        path[length] = 0;
    return length > 0;
}

static bool module_path(const char *name, char *path, size_t size)
{
    static const char *const folders[] = {"cubewright", "../lib/cubewright", CW_MODULE_DIR};
    char own[PATH_MAX];
    if (!find_own_file(own))
        return false;
    const char *slash = strrchr(own, '/');
    const int folder_length = slash ? (int)(slash - own) : 1;
    const char *folder = slash ? own : ".";
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

const cwi_feature_row *cwi_find_module_row(const char *module)
{
    for (size_t i = 0; i < cwi_feature_row_count; i++)
        if (strcmp(cwi_feature_rows[i].module, module) == 0)
            return &cwi_feature_rows[i];
    return NULL;
}

/* Returns true if libraries may get fewer threads than they start while they are loaded:
 * log4cplus, which OpenVDB needs, starts four. */
static bool threads_are_short(void)
{
    enum { ENOUGH = 8 };
    return cwi_try_threads(ENOUGH) < ENOUGH;
}

/* Loads a module first in a child process, which may die of it: constructors of C++ libraries
 * end the process when memory or threads run out. Returns false if the child died, or if there can
 * be none. Other errors are reported by the loading here. */
static bool survives_loading(const char *path)
{
    int how = 0;
    const pid_t child = fork();
    if (child == 0) {
        const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
        if (nowhere >= 0)
            dup2(nowhere, STDERR_FILENO);
        _exit(dlopen(path, RTLD_NOW | RTLD_LOCAL) ? 0 : 1);
    }
    while (child > 0 && waitpid(child, &how, 0) < 0 && errno == EINTR) {
    }
    return child > 0 && !WIFSIGNALED(how);
}

static bool tells_of_memory(const char *words)
{
    return strstr(words, "failed to map segment") || strstr(words, "annot allocate") ||
           strstr(words, "annot create") || strstr(words, "out of memory");
}

static cw_status fail_memory(const char *name, cw_error *err)
{
    return cwi_fail(err, CW_ERR_NO_MEMORY,
                    "memory or threads ran out while the %s module was loaded: see ulimit -v "
                    "and -u",
                    name);
}

static cw_status fail_load(const char *name, const char *packages, cw_error *err)
{
    const char *words = dlerror();
    if (words && tells_of_memory(words))
        return fail_memory(name, err);
    return cwi_fail(err, CW_ERR_UNSUPPORTED, "the %s module cannot be loaded: %s (Debian: %s)",
                    name, words ? words : "unknown error", packages);
}

/* Finds the path of a module that this build has. */
static cw_status find_module(const char *name, char *path, size_t size,
                             const cwi_feature_row **row, cw_error *err)
{
    *row = cwi_find_module_row(name);
    if (!*row)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "there is no module '%s'", name);
    if (module_path(name, path, size))
        return CW_OK;
    const char *s = strchr((*row)->packages, ' ') ? "s" : "";
    if (!*(*row)->reason)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "the %s module is not installed: the Debian package %s has it; from "
                        "sources, configure with -D%s=ON and the Debian package%s %s",
                        name, (*row)->shipped, (*row)->option, s, (*row)->packages);
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "the %s module is not in this build (%s); configure with -D%s=ON and the "
                    "Debian package%s %s",
                    name, (*row)->reason, (*row)->option, s, (*row)->packages);
}

cw_status cwi_module_find(const char *name, cw_error *err)
{
    char path[4096];
    const cwi_feature_row *row;
    return find_module(name, path, sizeof path, &row, err);
}

static cw_status load_module(const char *name, const void **functions, cw_error *err)
{
    char path[4096], symbol[64];
    const cwi_feature_row *row;
    cw_status st = find_module(name, path, sizeof path, &row, err);
    if (st != CW_OK)
        return st;
    if ((cwi_memory_is_limited() || threads_are_short()) && !survives_loading(path))
        return fail_memory(name, err);
    void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    snprintf(symbol, sizeof symbol, "cwi_module_%s", name);
    *functions = module ? dlsym(module, symbol) : NULL;
    void (*attach)(cwi_memory_account *, cwi_thread_pool *) = NULL;
    if (*functions)
        *(void **)&attach = dlsym(module, "cwi_module_attach");
    if (!attach)
        return fail_load(name, row->packages, err);
    attach(cwi_memory_account_get(), cwi_thread_pool_get());
    return CW_OK;
}

cw_status cwi_module_load(const char *name, const void **functions, cw_error *err)
{
    enum { MAX_LOADED = 64 }; /* rows of features */
    static _Atomic(const void *) loaded[MAX_LOADED];
    const cwi_feature_row *row = cwi_find_module_row(name);
    const size_t at = row ? (size_t)(row - cwi_feature_rows) : MAX_LOADED;
    *functions = at < MAX_LOADED ? atomic_load(loaded + at) : NULL;
    if (*functions)
        return CW_OK;
    const cw_status st = load_module(name, functions, err);
    if (st == CW_OK && at < MAX_LOADED)
        atomic_store(loaded + at, *functions);
    return st;
}
