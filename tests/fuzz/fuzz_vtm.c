/* Fuzzes the volume reader of VTK's lists of blocks. */
#include "fuzz_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_reader("vtm", bytes, size);
}
