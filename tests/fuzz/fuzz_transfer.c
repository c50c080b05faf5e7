/* Fuzzes the parser of transfer functions in JSON. */
#include "viewer/settings/transfer_json.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Checks that a transfer function that was read is usable everywhere. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    cw_transfer t;
    cw_error err;
    if (cwi_transfer_parse((const char *)bytes, size, &t, &err) != CW_OK)
        return 0;
    if (cw_transfer_check(&t, &err) != CW_OK)
        __builtin_trap();
    for (size_t n = 0; n < t.opacity_count; n++) {
        double color[3], opacity;
        const double here = t.opacities[n].value, before = t.opacities[n ? n - 1 : 0].value;
        cw_transfer_at(&t, 0.1 * here + 0.9 * before, color, &opacity);
        if (!(opacity >= 0 && opacity <= 1 && color[0] >= 0 && color[0] <= 1))
            __builtin_trap();
    }
    return 0;
}
