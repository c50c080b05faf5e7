#include "cli/output.h"

#include "core/status.h"

#include <sys/stat.h>

cw_status cli_check_output(const char *output, const char *const *inputs, size_t input_count,
                           cw_error *err)
{
    struct stat out, in;
    if (stat(output, &out) != 0)
        return CW_OK;
    for (size_t i = 0; i < input_count; i++)
        if (stat(inputs[i], &in) == 0 && in.st_dev == out.st_dev && in.st_ino == out.st_ino)
            return cw_fail(err, CW_ERR_OUTPUT,
                           "%s: is the input; inputs are never overwritten, give another -o",
                           output);
    return CW_OK;
}
