/* Fuzzes the mesh reader of VTKHDF files. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_mesh("vtkhdf", bytes, size);
}
