/* Fuzzes the volume reader of Zarr stores: an input is a list of files in a folder. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz_store.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static const char *const names[] = {"zarr.json",   ".zarray",   ".zgroup", ".zattrs",
                                        "0/zarr.json", "0/.zarray", "c/0/0/0", "c/0/0/1",
                                        "0.0.0",       "0.0.1",     "0/0.0.0", "0/c/0/0/0"};
    read_store(bytes, size, names, sizeof names / sizeof *names);
    return 0;
}
