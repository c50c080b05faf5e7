/* Modules: shared objects that contain a large library, loaded when first needed.
 *
 * A command that does not write glTF never pays for loading tinygltf. A program that links
 * libcubewright depends on libc, libm and zlib alone. A module NAME is the file
 * cubewright-NAME.so in the folder `cubewright` beside the library. It exports
 * cwi_module_attach() and one constant, cwi_module_NAME, a struct of functions that its
 * NAME_wrap.h declares. It does not depend on libcubewright: the functions that it calls of it
 * are linked into it. */
#ifndef CORE_BASE_MODULE_H
#define CORE_BASE_MODULE_H

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sets *functions to the struct exported by a module; it stays loaded.
 * Returns CW_ERR_UNSUPPORTED, with the reason, the build option and the Debian packages, when
 * this build has no such module or it cannot be loaded; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_module_load(const char *name, const void **functions, cw_error *err);

/* Finds the file of a module like cwi_module_load(), without loading it: another process
 * does. */
CW_NODISCARD cw_status cwi_module_find(const char *name, cw_error *err);

/* Returns true if the file of a module exists; loads nothing. */
bool cwi_module_present(const char *name);

/* Finds the row of the first feature of a module; NULL when the module is unknown. */
const struct cwi_feature_row *cwi_find_module_row(const char *module);

/* Makes a loaded module use the program's memory account and threads. Every module exports it
 * (module_entry.c). */
CW_API void cwi_module_attach(cwi_memory_account *account, cwi_thread_pool *pool);

#ifdef __cplusplus
}
#endif

#endif
