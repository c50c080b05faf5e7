/* Fuzzes the volume readers of PNG and BMP files. */
#include "fuzz_reader.h"

/* In this process, where the fuzzer sees what happens. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    const cw_read_desc desc = {.reader = size > 0 && bytes[0] == 'B' ? "bmp" : "png",
                               .max_bytes = (uint64_t)64 << 20,
                               .no_sandbox = true};
    return fuzz_with(&desc, bytes, size);
}
