/* Fuzzes the volume reader of VTKHDF files. */
#include "fuzz_reader.h"

/* Facts and rows that a damaged file makes of the sandboxed process are what our reader must stand: the
 * library itself (1.10) crashes on such files, as of links in dense groups. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    return fuzz_reader("vtkhdf", bytes, size);
}
