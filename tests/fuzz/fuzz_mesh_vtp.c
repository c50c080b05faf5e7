/* Fuzzes the mesh reader of VTP files. */
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_mesh("vtp", bytes, size);
}
