/* Fuzzes the volume reader of N5 stores: an input is a list of files in a folder. */
#define _GNU_SOURCE /* mkdtemp */
#include "fuzz_store.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static const char *const names[] = {
        "attributes.json", "s0/attributes.json", "s1/attributes.json", "0/0/0",
        "0/0/1",           "s0/0/0/0",           "s1/0/0/0",           "a/b/attributes.json"};
    read_store(bytes, size, names, sizeof names / sizeof *names);
    return 0;
}
