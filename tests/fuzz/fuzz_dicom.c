/* Fuzzes the volume reader of DICOM files. */
#include "fuzz_reader.h"

/* In this process, where the fuzzer sees what happens. The file's folder, /proc/self/fd, holds
 * links alone, which are followed only where external files are allowed. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    const cw_read_desc desc = {.reader = "dicom",
                               .max_bytes = (uint64_t)64 << 20,
                               .allow_external = true,
                               .no_sandbox = true};
    return fuzz_with(&desc, bytes, size);
}
