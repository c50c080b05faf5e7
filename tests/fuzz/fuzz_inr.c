/* Fuzzes the volume reader of INR files. */
#include "fuzz_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_reader("inr", bytes, size);
}
