/* Fuzzes the mesh reader of PLY files. */
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_mesh("ply", bytes, size);
}
