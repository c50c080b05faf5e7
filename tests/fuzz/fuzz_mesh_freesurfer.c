/* Fuzzes the mesh reader of FreeSurfer surfaces. */
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_mesh("freesurfer", bytes, size);
}
