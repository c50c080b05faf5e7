/* Fuzzes the reader of Neuroglancer's precomputed volumes: an input is a list of files in a folder. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz_store.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static const char *const names[] = {
        "info",      "s/0-4_0-4_0-2", "s/0-4_0-4_2-4", "s/0-4_0-4_0-2.gz",
        "s/0.shard", "s/1.shard",     "s/0.index",     "names/info"};
    read_store(bytes, size, names, sizeof names / sizeof *names);
    return 0;
}
