/* Fuzzes the volume reader of archives of NumPy arrays. */
#include "fuzz_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_reader("npz", bytes, size);
}
