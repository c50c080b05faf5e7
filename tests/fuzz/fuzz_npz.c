/* Fuzzes the volume reader of archives of NumPy arrays. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_reader("npz", bytes, size);
}
