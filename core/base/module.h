/* Modules: shared objects with a heavy library behind them, loaded when first needed.
 *
 * A command that does not write glTF never pays for loading tinygltf, and a program that links
 * libcubewright depends on libc, libm, zlib and OpenMP alone. A module NAME is the file
 * cubewright-NAME.so in the folder `cubewright` beside the library; it exports one constant,
 * cwi_module_NAME, a struct of functions that its NAME_wrap.h declares, and cwi_module_attach().
 * It does not depend on libcubewright: what it calls of it is linked into it. */
#ifndef CORE_BASE_MODULE_H
#define CORE_BASE_MODULE_H

#include "core/base/memory.h"
#include "core/base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sets *functions to the struct exported by a module; it stays loaded.
 * Returns CW_ERR_UNSUPPORTED, with the reason, the build option and the Debian packages, when
 * this build has no such module or it cannot be loaded; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_module_load(const char *name, const void **functions, cw_error *err);

/* As cwi_module_load(), but only looks for the file: another process loads it. */
CW_NODISCARD cw_status cwi_module_find(const char *name, cw_error *err);

/* Whether the file of a module is there; nothing is loaded. */
bool cwi_module_present(const char *name);

/* Exported by every module (module_entry.c), and called when it was loaded. */
CW_API void cwi_module_attach(cwi_memory_account *of_the_program);

#ifdef __cplusplus
}
#endif

#endif
