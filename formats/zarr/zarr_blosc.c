/* Loads the module that decodes Blosc, and calls it. */
#include "core/base/module.h"
#include "formats/zarr/blosc_wrap.h"
#include "formats/zarr/zarr_decode.h"

#include <stdatomic.h>

/* The module, once it was loaded: threads that decode need not load it again. */
static _Atomic(const cwi_blosc_functions *) loaded;

bool cwi_zarr_blosc_present(void)
{
    const void *module;
    if (!atomic_load(&loaded) && cwi_module_load("blosc", &module, NULL) == CW_OK)
        atomic_store(&loaded, (const cwi_blosc_functions *)module);
    return atomic_load(&loaded);
}

bool cwi_zarr_blosc_decode(const unsigned char *packed, size_t packed_size, void *to,
                           size_t capacity, size_t *got, bool *starved)
{
    *got = 0;
    *starved = false;
    return cwi_zarr_blosc_present() &&
           atomic_load(&loaded)->decode(packed, packed_size, to, capacity, got, starved);
}
