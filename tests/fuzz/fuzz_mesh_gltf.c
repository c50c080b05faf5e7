/* Fuzzes the mesh reader of glTF and GLB files. */
#include "fuzz_mesh.h"

#include <string.h>

/* Both forms; in a build without tinygltf, no more than their headers. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    const bool binary = size >= 4 && memcmp(bytes, "glTF", 4) == 0;
    return fuzz_mesh(binary ? "glb" : "gltf", bytes, size);
}
