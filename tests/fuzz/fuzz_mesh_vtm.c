/* Fuzzes the mesh reader of VTK's lists of blocks. */
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_mesh("vtm", bytes, size);
}
